//! The scenes that come with the program.

use super::Scene;
use super::geometry::{Pair, Surface, Vector};
use super::texture::{Pattern, Texture, hash, unit_from};
use linestereo::Dims;

/// A built-in scene; [`summary`](Self::summary) describes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "`summary` describes each, and the program prints it")]
pub enum Kind {
    Demo,
    Cards,
    Corridor,
    Poles,
    Boxes,
    Blank,
    Repetition,
}

impl Kind {
    /// Every built-in scene.
    pub const ALL: [Self; 7] = [
        Self::Demo,
        Self::Cards,
        Self::Corridor,
        Self::Poles,
        Self::Boxes,
        Self::Blank,
        Self::Repetition,
    ];

    /// Its name on the command line, and a line about it.
    const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Demo => [
                "demo",
                "a room: textured and blank walls, floor, boxes, a leaning board, thin poles, \
                 occlusion",
            ],
            Self::Cards => [
                "cards",
                "cards facing the cameras at many sub-pixel disparities before a textured wall",
            ],
            Self::Corridor => {
                ["corridor", "long slanted walls, floor and ceiling that end in a door"]
            }
            Self::Poles => [
                "poles",
                "poles 1 to 8 px wide (in images of 320 px), upright and leaning, before a \
                     textured wall",
            ],
            Self::Boxes => ["boxes", "boxes of random place and turn that hide each other"],
            Self::Blank => ["blank", "blank walls and boxes: outlines are all there is"],
            Self::Repetition => {
                ["repetition", "stripes, squares and a picket fence: look-alikes everywhere"]
            }
        }
    }

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Description, one line.
    pub const fn summary(self) -> &'static str {
        self.words()[1]
    }
}

/// A built-in scene for images of this size; the seed changes every texture and every random place.
pub fn build(kind: Kind, dims: Dims, seed: u64) -> Scene {
    let pair = Pair::centred(dims, 0.9 * f64::from(dims.width), 0.12);
    let mut studio = Studio { surfaces: Vec::new(), objects: Vec::new(), draws: 0, seed };
    match kind {
        Kind::Demo => demo(&mut studio),
        Kind::Cards => cards(&mut studio, &pair, dims),
        Kind::Corridor => corridor(&mut studio),
        Kind::Poles => poles(&mut studio),
        Kind::Boxes => boxes(&mut studio, false),
        Kind::Blank => boxes(&mut studio, true),
        Kind::Repetition => repetition(&mut studio),
    }
    Scene { pair, surfaces: studio.surfaces, objects: studio.objects }
}

/// The scene so far, and a source of seeds and random numbers.
struct Studio {
    surfaces: Vec<Surface>,
    objects: Vec<&'static str>,
    draws: u32,
    seed: u64,
}

impl Studio {
    fn next(&mut self) -> u64 {
        self.draws += 1;
        hash(self.seed, f64::from(self.draws), 0.0)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * unit_from(self.next())
    }

    /// Rectangles of random grey, `size` metres wide, with grain.
    fn mosaic(&mut self, greys: [f64; 2], size: f64) -> Texture {
        Texture::grained(
            Pattern::Mosaic { greys, cell: [1.3 * size, size] },
            18.0,
            0.12 * size,
            self.next(),
        )
    }

    /// One grey with grain.
    fn rough(&mut self, grey: f64, size: f64) -> Texture {
        Texture::grained(Pattern::Blank(grey), 45.0, size, self.next())
    }

    /// Surfaces added from here on belong to a new object.
    fn object(&mut self, name: &'static str) -> &mut Self {
        self.objects.push(name);
        self
    }

    fn label(&self) -> u8 {
        self.objects.len() as u8
    }

    fn rectangle(&mut self, corner: Vector, across: Vector, down: Vector, texture: Texture) {
        self.surfaces.push(Surface::rectangle(corner, across, down, texture, self.label()));
    }

    /// A rectangle that faces the cameras.
    fn facing(&mut self, corner: Vector, [width, height]: [f64; 2], texture: Texture) {
        self.rectangle(corner, [width, 0.0, 0.0], [0.0, height, 0.0], texture);
    }

    /// A box standing upright, turned about the vertical axis so that its front looks along
    /// `(-turn, -1)`.
    fn cuboid(&mut self, centre: Vector, size: Vector, turn: f64, textures: [Texture; 3]) {
        let norm = (1.0 + turn * turn).sqrt();
        let (cosine, sine) = (1.0 / norm, turn / norm);
        let [width, height, depth] = size;
        let edges = [
            [width * cosine, 0.0, -width * sine],
            [0.0, height, 0.0],
            [depth * sine, 0.0, depth * cosine],
        ];
        self.surfaces.extend(Surface::cuboid(centre, edges, textures, self.label()));
    }

    /// A wall that faces the cameras and fills their view.
    fn wall(&mut self, depth: f64, texture: Texture) {
        self.facing([-2.0 * depth, -2.0 * depth, depth], [4.0 * depth; 2], texture);
    }
}

fn plain(grey: f64) -> Texture {
    Texture::plain(Pattern::Blank(grey))
}

fn demo(studio: &mut Studio) {
    // Back wall 4 m away: textured on the left, blank on the right.
    let texture = studio.mosaic([60.0, 200.0], 0.45);
    studio.object("textured wall").facing([-4.0, -3.0, 4.0], [4.3, 6.0], texture);
    studio.object("blank wall").facing([0.3, -3.0, 4.0], [2.0, 6.0], plain(185.0));
    // A slanted wall on the right with a window in it, and the floor.
    let texture = studio.mosaic([90.0, 160.0], 0.3);
    studio.object("slanted wall").rectangle(
        [1.75, -3.0, 4.0],
        [-0.65, 0.0, -2.4],
        [0.0, 6.0, 0.0],
        texture,
    );
    studio.object("window").rectangle(
        [1.65, -0.9, 3.7],
        [-0.3, 0.0, -1.11],
        [0.0, 0.8, 0.0],
        plain(230.0),
    );
    let texture = studio.mosaic([40.0, 120.0], 0.35);
    studio.object("floor").rectangle([-4.0, 0.85, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -3.4], texture);
    // Boxes: one turned, one stacked on top, one before the border of the blank wall.
    let faces = [
        studio.mosaic([120.0, 220.0], 0.12),
        studio.rough(90.0, 0.05),
        studio.mosaic([70.0, 190.0], 0.12),
    ];
    studio.object("turned box").cuboid([-0.75, 0.6, 2.5], [0.6, 0.5, 0.5], 0.55, faces);
    let faces = [plain(150.0), plain(215.0), plain(70.0)];
    studio.object("small box").cuboid([-0.8, 0.2, 2.55], [0.35, 0.3, 0.3], 0.35, faces);
    let faces = [studio.rough(70.0, 0.06), studio.rough(170.0, 0.06), studio.rough(120.0, 0.05)];
    studio.object("tall box").cuboid([0.42, 0.15, 3.0], [0.55, 1.4, 0.3], -0.25, faces);
    // A board that leans to one side and away.
    let texture = studio.mosaic([50.0, 230.0], 0.16);
    studio.object("leaning board").rectangle(
        [-1.05, -0.75, 2.9],
        [0.85, 0.2, 0.35],
        [-0.2, 0.6, 0.1],
        texture,
    );
    // A thin pole, a thinner one that leans, and a card close by.
    studio.object("thin pole").facing([-0.1, -2.0, 1.7], [0.035, 4.0], plain(25.0));
    studio.object("leaning pole").rectangle(
        [0.2, -2.0, 1.5],
        [0.018, 0.004, 0.0],
        [-0.5, 4.0, 0.2],
        plain(245.0),
    );
    let texture = studio.mosaic([60.0, 210.0], 0.06);
    studio.object("near card").rectangle(
        [0.22, -0.36, 0.95],
        [0.2, -0.03, 0.02],
        [0.03, 0.2, -0.02],
        texture,
    );
}

fn cards(studio: &mut Studio, pair: &Pair, dims: Dims) {
    let texture = studio.mosaic([50.0, 210.0], 0.6);
    studio.object("wall").wall(8.0, texture);
    let (columns, rows) = (5, 4);
    let (width, height) =
        (f64::from(dims.width) / f64::from(columns), f64::from(dims.height) / f64::from(rows));
    for row in 0..rows {
        for column in 0..columns {
            let disparity =
                8.0 + f64::from(7 * ((row * columns + column) % 5)) + studio.between(0.0, 1.0);
            let disparity = disparity * f64::from(dims.width) / 320.0;
            let depth = pair.depth(disparity);
            let metres = depth / pair.focal_px;
            let corner = pair.point(
                (f64::from(column) + 0.2) * width,
                (f64::from(row) + 0.2) * height,
                depth,
            );
            let grey = studio.between(60.0, 200.0);
            let texture = studio.rough(grey, 7.0 * metres);
            let lean = studio.between(-0.3, 0.3);
            let (across, down) = (0.6 * width * metres, 0.6 * height * metres);
            studio.object("card").rectangle(
                corner,
                [across, lean * across, 0.0],
                [-lean * down, down, 0.0],
                texture,
            );
        }
    }
}

fn corridor(studio: &mut Studio) {
    let forward = [0.0, 0.0, 9.0];
    let near = 0.5;
    let texture = studio.mosaic([60.0, 200.0], 0.4);
    studio.object("left wall").rectangle([-0.8, -1.0, near], forward, [0.0, 2.0, 0.0], texture);
    let texture = studio.mosaic([80.0, 180.0], 0.6);
    studio.object("right wall").rectangle([1.0, -1.0, near], forward, [0.0, 2.0, 0.0], texture);
    let texture = studio.mosaic([30.0, 110.0], 0.3);
    studio.object("floor").rectangle([-0.8, 0.7, near], [1.8, 0.0, 0.0], forward, texture);
    studio.object("ceiling").rectangle([-0.8, -1.0, near], [1.8, 0.0, 0.0], forward, plain(225.0));
    let texture = studio.rough(140.0, 0.2);
    studio.object("end wall").facing([-0.8, -1.0, 7.0], [1.8, 1.7], texture);
    studio.object("door").facing([-0.2, -0.6, 6.98], [0.7, 1.3], plain(60.0));
}

fn poles(studio: &mut Studio) {
    let texture = studio.mosaic([70.0, 190.0], 0.5);
    studio.object("wall").wall(5.0, texture);
    for pole in 0..8 {
        let depth = studio.between(1.2, 3.5);
        let width = f64::from(pole + 1) * depth / 288.0;
        let x = (f64::from(pole) - 3.6) * 0.13 * depth;
        let lean = if pole % 2 == 0 { 0.0 } else { studio.between(-0.25, 0.25) };
        let away = studio.between(-0.1, 0.1);
        let grey = if pole % 3 == 0 { 235.0 } else { 30.0 };
        let height = 3.0 * depth;
        let corner = [x - 0.5 * lean * height, -0.5 * height, depth - 0.5 * away * height];
        studio.object("pole").rectangle(
            corner,
            [width, 0.0, 0.0],
            [lean * height, height, away * height],
            plain(grey),
        );
    }
}

fn boxes(studio: &mut Studio, blank: bool) {
    let texture = if blank { plain(200.0) } else { studio.mosaic([60.0, 200.0], 0.5) };
    studio.object("wall").wall(5.0, texture);
    let texture = if blank { plain(110.0) } else { studio.mosaic([40.0, 130.0], 0.4) };
    studio.object("floor").rectangle([-6.0, 0.9, 5.0], [12.0, 0.0, 0.0], [0.0, 0.0, -4.0], texture);
    for _ in 0..9 {
        let depth = studio.between(1.5, 4.2);
        let size = [studio.between(0.15, 0.5), studio.between(0.2, 0.7), studio.between(0.15, 0.5)];
        let centre = [
            studio.between(-0.5, 0.5) * depth,
            0.9 - studio.between(0.2, 1.4) * 0.3 * depth,
            depth,
        ];
        let turn = studio.between(-1.0, 1.0);
        let faces = [(); 3].map(|()| {
            let grey = studio.between(40.0, 220.0);
            if blank { plain(grey) } else { studio.rough(grey, 0.03 * depth) }
        });
        studio.object("box").cuboid(centre, size, turn, faces);
    }
}

fn repetition(studio: &mut Studio) {
    let texture = Texture::plain(Pattern::Checker { greys: [90.0, 170.0], side: 0.2 });
    studio.object("checkered wall").facing([-5.0, -4.0, 4.0], [5.0, 8.0], texture);
    let texture = Texture::plain(Pattern::Stripes { greys: [60.0, 190.0], period: 0.16 });
    studio.object("striped wall").facing([0.0, -4.0, 4.0], [5.0, 8.0], texture);
    let texture = studio.rough(100.0, 0.2);
    studio.object("floor").rectangle([-5.0, 0.8, 4.0], [10.0, 0.0, 0.0], [0.0, 0.0, -3.0], texture);
    for picket in 0..14 {
        let x = f64::from(picket) * 0.14 - 1.0;
        studio.object("picket").facing([x, 0.0, 2.0], [0.06, 0.75], plain(225.0));
    }
    let texture = studio.mosaic([50.0, 220.0], 0.08);
    studio.object("card").rectangle([-0.5, -0.65, 1.6], [0.45, 0.0, 0.1], [0.0, 0.4, 0.0], texture);
}
