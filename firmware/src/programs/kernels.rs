//! Do the kernels of this machine equal the portable ones? Every length and alignment, down to inputs that the core never gives them.
//!
//! In: the kernels, and [`Rooms`] that hold what they read and write. Out: per kernel, comparisons made and the first difference.
//!
//! ```text
//! for each kernel, length, contents:
//!     place inputs and output at every alignment, once at the front of their rooms and once at the back, next to a fence
//!     kernel, portable kernel: the whole rooms must be equal, not the output alone
//! ```
//!
//! On a board the fences are forbidden memory (`fence.rs`): a kernel that reads or writes one byte too far ends in a fault.

use linestereo::kernel::{self, Crossing, LANES, LargestStep, STRIP, Strip, portable};

/// The kernels of one machine.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, clippy::type_complexity, reason = "each is described where it is defined")]
pub struct Kernels {
    pub gradient_row: fn(&[u8], &[u8], &[u8], &mut [u8]),
    pub census_row: fn([&[u8]; 3], &mut [u8]),
    pub reverse_row: fn(&mut [u8]),
    pub sad_curve: fn(&[Strip<'_>], &mut [u16]),
    pub hamming_curve: fn(&[(u8, &[u8])], &mut [u16]),
    pub sum_curve: fn(&[u16], &[u16], &mut [u16]),
    pub lower_curve: fn(&[u16], &[u16], &mut [u16]),
    pub lower_sum_curve: fn(&[u16], &[u16], &[u16], &mut [u16]),
    pub lowest: fn(&[u16]) -> u16,
    pub largest_step: fn(&[u8], usize, usize) -> LargestStep,
    pub census_code: fn(&[u8], usize, usize) -> Option<u8>,
    pub crossing_of_rows: fn(&[u8], usize, usize, i32) -> Option<Crossing>,
    pub crossing_of_columns: fn(&[u8], usize, usize, i32) -> Option<Crossing>,
}

impl Kernels {
    /// Number of kernels.
    pub const COUNT: usize = 13;

    /// Those that the core uses on this machine.
    pub const CHOSEN: Self = Self {
        gradient_row: kernel::gradient_row,
        census_row: kernel::census_row,
        reverse_row: kernel::reverse_row,
        sad_curve: kernel::sad_curve,
        hamming_curve: kernel::hamming_curve,
        sum_curve: kernel::sum_curve,
        lower_curve: kernel::lower_curve,
        lower_sum_curve: kernel::lower_sum_curve,
        lowest: kernel::lowest,
        largest_step: kernel::largest_step,
        census_code: kernel::census_code,
        crossing_of_rows: kernel::crossing_of_rows,
        crossing_of_columns: kernel::crossing_of_columns,
    };

    /// Control: each is wrong for few inputs, as a kernel with a forgotten case is, and must be found.
    pub const WRONG: Self = Self {
        gradient_row: |above, row, below, out| {
            portable::gradient_row(above, row, below, out);
            if let (77, Some(last)) = (row.len(), out.get_mut(75)) {
                *last ^= 1;
            }
        },
        census_row: |rows, out| {
            portable::census_row(rows, out);
            if let (61, Some(beyond)) = (rows[1].len(), out.get_mut(59)) {
                *beyond = 1;
            }
        },
        reverse_row: |row| {
            if row.len() != 43 {
                row.reverse();
            }
        },
        sad_curve: |strips, curve| {
            let forgotten = usize::from(strips.len() == 7);
            portable::sad_curve(strips.get(forgotten..).unwrap_or(&[]), curve);
        },
        hamming_curve: |points, curve| {
            portable::hamming_curve(points, curve);
            if let (31, Some(cost)) = (points.len(), curve.get_mut(17)) {
                *cost = cost.wrapping_add(256);
            }
        },
        sum_curve: |a, b, out| {
            for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
                *out = a.wrapping_add(*b);
            }
        },
        lower_curve: |a, b, out| {
            portable::lower_curve(a, b, out);
            if let (Some(out), Some(a)) = (out.get_mut(69), a.get(69)) {
                *out = *a;
            }
        },
        lower_sum_curve: |a, b, c, out| {
            for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
                *out = a.min(b).wrapping_add(*c);
            }
        },
        lowest: |curve| portable::lowest(curve.get(..curve.len() & !1).unwrap_or(&[])),
        largest_step: |pixels, stride, count| {
            let found = portable::largest_step(pixels, stride, count);
            if count == 19 { LargestStep { place: 0, ..found } } else { found }
        },
        census_code: |pixels, first, stride| {
            let (_, shorter) = pixels.split_last()?;
            portable::census_code(shorter, first, stride)
        },
        crossing_of_rows: |pixels, first, stride, sign| {
            let (_, shorter) = pixels.split_last()?;
            portable::crossing_of_rows(shorter, first, stride, sign)
        },
        crossing_of_columns: |pixels, first, stride, sign| {
            portable::crossing_of_columns(pixels, first, stride.wrapping_mul(7) / 7, sign)
        },
    };
}

/// Bytes that no kernel may touch: the first half of a page.
#[derive(Debug)]
#[repr(C)]
pub struct Fence([u8; Self::BYTES]);

impl Fence {
    /// A power of two, as memory protection units want it.
    pub const BYTES: usize = PAGE / 2;
    const NEW: Self = Self([0xc3; Self::BYTES]);
}

/// Rooms end where a page does: QEMU looks at the end of an unaligned word only when it lies in another page than the start.
const PAGE: usize = 1024;

/// Memory for one slice, and the fence before it. The one behind is that of the next room.
#[derive(Debug)]
#[repr(C)]
struct Room<T, const N: usize> {
    before: Fence,
    contents: [T; N],
}

impl<T: Copy, const N: usize> Room<T, N> {
    const fn new(value: T) -> Self {
        const { assert!(size_of::<Self>().is_multiple_of(PAGE)) };
        Self { before: Fence::NEW, contents: [value; N] }
    }
}

/// Bytes for a row.
const ROW: usize = PAGE - Fence::BYTES;
/// Entries for a curve.
const CURVE: usize = (2 * PAGE - Fence::BYTES) / 2;
/// Bytes for an image.
const IMAGE: usize = 7 * PAGE - Fence::BYTES;
/// Places in a room of which each slice takes every one.
const ALIGNMENTS: usize = 4;
/// Of an output that nothing was written to.
const UNTOUCHED: u8 = 0xa5;

/// Memory for the inputs and the output of a kernel.
#[derive(Debug)]
#[repr(C, align(1024))]
pub struct Rooms {
    rows: [Room<u8, ROW>; 3],
    out: Room<u8, ROW>,
    curve: Room<u16, CURVE>,
    image: Room<u8, IMAGE>,
    behind: Fence,
}

impl Default for Rooms {
    fn default() -> Self {
        Self::new()
    }
}

impl Rooms {
    /// Number of fences.
    pub const FENCES: usize = 7;

    /// Empty rooms.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            rows: [const { Room::new(0) }; 3],
            out: Room::new(0),
            curve: Room::new(0),
            image: Room::new(0),
            behind: Fence::NEW,
        }
    }

    /// The fences around all rooms.
    #[must_use]
    pub const fn fences(&self) -> [&Fence; Self::FENCES] {
        let [a, b, c] = &self.rows;
        [&a.before, &b.before, &c.before, &self.out.before, &self.curve.before, &self.image.before, &self.behind]
    }
}

/// Where a kernel was found to differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Length of the row, curve or slice of pixels.
    pub length: usize,
    /// Number of strips, points or pixels; for crossings the index of the first pixel.
    pub count: usize,
    /// From pixel to pixel, or row to row.
    pub stride: usize,
    /// Position of inputs and output within a word (pixels) or an entry (curves).
    pub alignments: [u8; 4],
}

/// One kernel against the portable one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Its name.
    pub kernel: &'static str,
    /// Comparisons made.
    pub comparisons: u32,
    /// The first difference.
    pub first: Option<Difference>,
}

impl Compared {
    const fn new(kernel: &'static str) -> Self {
        Self { kernel, comparisons: 0, first: None }
    }

    fn note(&mut self, equal: bool, length: usize, (count, stride): (usize, usize), starts: [usize; 4]) {
        self.comparisons += 1;
        if !equal && self.first.is_none() {
            let alignments = starts.map(|start| (start % ALIGNMENTS) as u8);
            self.first = Some(Difference { length, count, stride, alignments });
        }
    }
}

/// Compares every kernel, and says whether all are equal to the portable ones.
pub fn run(kernels: &Kernels, rooms: &mut Rooms, mut tell: impl FnMut(&Compared)) -> bool {
    let compare: [fn(&Kernels, &mut Rooms) -> Compared; Kernels::COUNT] = [
        |kernels, rooms| {
            let ours = |[a, r, b]: [&[u8]; 3], out: &mut [u8]| (kernels.gradient_row)(a, r, b, out);
            rows("gradient_row", ours, |[a, r, b], out| portable::gradient_row(a, r, b, out), rooms)
        },
        |kernels, rooms| rows("census_row", kernels.census_row, portable::census_row, rooms),
        reversed_rows,
        sad_curves,
        hamming_curves,
        |kernels, _| {
            let ours = |[a, b, _]: [&[u16]; 3], out: &mut [u16]| (kernels.sum_curve)(a, b, out);
            combined_curves("sum_curve", ours, |[a, b, _], out| portable::sum_curve(a, b, out))
        },
        |kernels, _| {
            let ours = |[a, b, _]: [&[u16]; 3], out: &mut [u16]| (kernels.lower_curve)(a, b, out);
            combined_curves("lower_curve", ours, |[a, b, _], out| portable::lower_curve(a, b, out))
        },
        |kernels, _| {
            let ours = |[a, b, c]: [&[u16]; 3], out: &mut [u16]| (kernels.lower_sum_curve)(a, b, c, out);
            combined_curves("lower_sum_curve", ours, |[a, b, c], out| portable::lower_sum_curve(a, b, c, out))
        },
        lowest_entries,
        largest_steps,
        |kernels, rooms| {
            let ours = |pixels: &[u8], first, stride, _| (kernels.census_code)(pixels, first, stride);
            crossings(
                "census_code",
                ours,
                |pixels, first, stride, _| portable::census_code(pixels, first, stride),
                rooms,
            )
        },
        |kernels, rooms| crossings("crossing_of_rows", kernels.crossing_of_rows, portable::crossing_of_rows, rooms),
        |kernels, rooms| {
            crossings("crossing_of_columns", kernels.crossing_of_columns, portable::crossing_of_columns, rooms)
        },
    ];
    let mut all_equal = true;
    for compare in compare {
        let compared = compare(kernels, rooms);
        all_equal &= compared.first.is_none();
        tell(&compared);
    }
    all_equal
}

/// Numbers without a pattern, the same in every run (xorshift, Marsaglia 2003).
struct Random(u32);

impl Random {
    const fn new() -> Self {
        Self(0x9e37_79b9)
    }

    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() >> 8) as usize % end
    }

    /// Any entry of a curve, often an extreme one.
    fn entry(&mut self) -> u16 {
        match self.below(8) {
            0 => u16::MAX,
            1 => 0,
            2 => 0x8000,
            _ => self.next() as u16,
        }
    }
}

/// What pixels look like.
#[derive(Clone, Copy, PartialEq)]
enum Contents {
    Random,
    Black,
    White,
    Alternating,
    /// Black and white, in turn after one to nine pixels.
    Steps,
    /// Five levels next to each other: ties, and gradients that are not clipped.
    Similar,
}

impl Contents {
    const ALL: [Self; 6] = [Self::Random, Self::Black, Self::White, Self::Alternating, Self::Steps, Self::Similar];

    fn fill(self, random: &mut Random, pixels: &mut [u8]) {
        let mut last = 0;
        for pixel in pixels {
            last = match self {
                Self::Random => random.next() as u8,
                Self::Black => 0,
                Self::White => 255,
                Self::Alternating => !last,
                Self::Steps => {
                    if random.below(5) == 0 {
                        !last
                    } else {
                        last
                    }
                }
                Self::Similar => 126 + random.below(5) as u8,
            };
            *pixel = last;
        }
    }
}

/// Where a slice lies in its room of `room` entries: so far from the front, or from the back.
fn place(room: usize, length: usize, distance: usize, at_back: bool) -> core::ops::Range<usize> {
    let start = if at_back { room - length - distance } else { distance };
    start..start + length
}

/// A kernel that computes a row from three, at every width; then with rows that are not equally long.
fn rows(
    name: &'static str,
    kernel: impl Fn([&[u8]; 3], &mut [u8]),
    definition: impl Fn([&[u8]; 3], &mut [u8]),
    rooms: &mut Rooms,
) -> Compared {
    let mut compared = Compared::new(name);
    let mut random = Random::new();
    let mut expected = [0; ROW];
    let mut compare = |rooms: &mut Rooms, lengths: [usize; 4], distances: [usize; 4], at_back: bool| {
        let mut places = [const { 0..0 }; 4];
        for ((place, length), distance) in places.iter_mut().zip(lengths).zip(distances) {
            *place = self::place(ROW, length, distance, at_back);
        }
        let starts = [0, 1, 2, 3].map(|i: usize| places[i].start);
        let [a, r, b, to] = places;
        let [above, row, below] = &rooms.rows;
        let inputs = [&above.contents[a], &row.contents[r], &below.contents[b]];
        let out = &mut rooms.out.contents;
        out.fill(UNTOUCHED);
        expected.fill(UNTOUCHED);
        kernel(inputs, &mut out[to.clone()]);
        definition(inputs, &mut expected[to]);
        compared.note(*out == expected, lengths[1], (3, 0), starts);
    };
    for width in (1..=80).chain([320]) {
        for contents in Contents::ALL {
            for room in &mut rooms.rows {
                contents.fill(&mut random, &mut room.contents);
            }
            for at_back in [false, true] {
                // Every combination once; with other contents all alignments of each slice, in twenty combinations.
                let step = if contents == Contents::Random { 1 } else { 13 };
                for combination in (0..256_usize).step_by(step) {
                    let distances = [0, 2, 4, 6].map(|bit| combination >> bit & 3);
                    compare(rooms, [width; 4], distances, at_back);
                }
            }
        }
    }
    for round in 0..4000 {
        let mut around = || random.below(32);
        let length = around();
        // Often one of them alone is off.
        let mut lengths = [length; 4];
        lengths[round % 4] = around();
        if round % 3 == 0 {
            lengths = [around(), around(), around(), around()];
        }
        compare(rooms, lengths, [0; 4].map(|_: usize| random.below(ALIGNMENTS)), round % 8 < 4);
    }
    compared
}

fn reversed_rows(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    let mut compared = Compared::new("reverse_row");
    let mut random = Random::new();
    for length in (0..=80).chain([320]) {
        for distance in 0..ALIGNMENTS {
            for at_back in [false, true] {
                let place = place(ROW, length, distance, at_back);
                let out = &mut rooms.out.contents;
                Contents::Random.fill(&mut random, out);
                let mut expected = *out;
                (kernels.reverse_row)(&mut out[place.clone()]);
                portable::reverse_row(&mut expected[place.clone()]);
                compared.note(*out == expected, length, (1, 0), [place.start, 0, 0, 0]);
            }
        }
    }
    compared
}

/// Lengths of cost curves: whole blocks, and such that are none.
fn curve_lengths() -> impl Iterator<Item = usize> {
    (0..=256_usize).filter(|length| *length <= 40 || matches!(length % LANES, 0 | 1 | 8 | 15))
}

/// Most strips or points of one curve here.
const MOST: usize = 34;

/// Curves that sum what `count` slices of pixels give, with slices that are too short or longer than need be among them. `given` runs a
/// kernel on the slices; the first of both runs is that of the kernel.
fn summed_curves(
    compared: &mut Compared,
    rooms: &mut Rooms,
    counts: core::ops::RangeInclusive<usize>,
    beyond: usize,
    mut run: impl FnMut(&[&[u8]], u32, &mut [u16], &mut [u16]),
) {
    let mut random = Random::new();
    for length in curve_lengths() {
        for count in counts.clone() {
            let contents = Contents::ALL[random.below(6)];
            for room in &mut rooms.rows {
                contents.fill(&mut random, &mut room.contents);
            }
            for distance in 0..ALIGNMENTS {
                let needed = length + beyond;
                let mut others: [&[u8]; MOST] = [&[]; MOST];
                let mut starts = [0; 4];
                let some_short = random.below(2) == 0;
                for (i, other) in others.iter_mut().enumerate().take(count) {
                    let long = match random.below(12) {
                        0 if some_short => random.below(needed + 1),
                        1 if some_short => needed.saturating_sub(1),
                        2 => needed + 1 + random.below(20),
                        _ => needed,
                    };
                    let place = place(ROW, long, (distance + i) % ALIGNMENTS, random.below(2) == 0);
                    if let Some(start) = starts.get_mut(i).filter(|_| i < 3) {
                        *start = place.start;
                    }
                    *other = &rooms.rows[i % 3].contents[place];
                }
                let curve = &mut rooms.curve.contents;
                curve.fill_with(|| random.entry());
                let mut expected = *curve;
                let place = place(CURVE, length, distance / 2, distance % 2 == 0);
                starts[3] = place.start;
                run(&others[..count], random.next(), &mut curve[place.clone()], &mut expected[place]);
                compared.note(*curve == expected, length, (count, 0), starts);
            }
        }
    }
}

fn sad_curves(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    let mut compared = Compared::new("sad_curve");
    summed_curves(&mut compared, rooms, 0..=10, STRIP - 1, |others, seed, ours, theirs| {
        let mut random = Random(seed | 1);
        let mut strips = [Strip { reference: [0; STRIP], other: &[] }; MOST];
        for (strip, &other) in strips.iter_mut().zip(others) {
            Contents::ALL[random.below(6)].fill(&mut random, &mut strip.reference);
            strip.other = other;
        }
        let strips = &strips[..others.len()];
        (kernels.sad_curve)(strips, ours);
        portable::sad_curve(strips, theirs);
    });
    compared
}

fn hamming_curves(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    let mut compared = Compared::new("hamming_curve");
    // Three more than the most that are allowed: no reason to give other bits.
    summed_curves(&mut compared, rooms, 0..=MOST, 0, |others, seed, ours, theirs| {
        let mut random = Random(seed | 1);
        let mut points: [(u8, &[u8]); MOST] = [(0, &[]); MOST];
        let extreme = seed & 0x100 != 0;
        for (point, &other) in points.iter_mut().zip(others) {
            let code = random.next() as u8;
            *point = (if extreme { !other.first().unwrap_or(&0) } else { code }, other);
        }
        let points = &points[..others.len()];
        (kernels.hamming_curve)(points, ours);
        portable::hamming_curve(points, theirs);
    });
    compared
}

/// Entries of the longest curve that is combined with others.
const COMBINED: usize = 72;

fn combined_curves(
    name: &'static str,
    kernel: impl Fn([&[u16]; 3], &mut [u16]),
    definition: impl Fn([&[u16]; 3], &mut [u16]),
) -> Compared {
    let mut compared = Compared::new(name);
    let mut random = Random::new();
    for length in 0..=70 {
        for round in 0..64_usize {
            let mut inputs = [[0; COMBINED]; 3];
            inputs.as_flattened_mut().fill_with(|| random.entry());
            let mut starts = [0, 1, 2, 3].map(|bit| round >> bit & 1);
            let mut lengths = [length; 4];
            if round >= 48 {
                lengths = [0; 4].map(|_: usize| random.below(length + 1));
            } else if round >= 32 {
                lengths[round % 4] = random.below(length + 1);
            }
            let [a, b, c, to] = [0, 1, 2, 3].map(|i: usize| starts[i]..starts[i] + lengths[i]);
            let given = [&inputs[0][a], &inputs[1][b], &inputs[2][c]];
            let mut out = [0; COMBINED];
            out.fill_with(|| random.entry());
            let mut expected = out;
            kernel(given, &mut out[to.clone()]);
            definition(given, &mut expected[to]);
            starts = starts.map(|start| 2 * start);
            compared.note(out == expected, length, (3, 0), starts);
        }
    }
    compared
}

fn lowest_entries(kernels: &Kernels, _: &mut Rooms) -> Compared {
    let mut compared = Compared::new("lowest");
    let mut random = Random::new();
    for length in 0..=70 {
        for round in 0..64 {
            let mut curve = [u16::MAX; COMBINED];
            match round {
                0 | 1 => {}
                2..10 => curve[random.below(COMBINED)] = random.next() as u16,
                10..20 => curve.fill_with(|| 0xffff - (random.next() & 3) as u16),
                _ => curve.fill_with(|| random.entry()),
            }
            let start = round % 2;
            let curve = &curve[start..start + length];
            compared.note((kernels.lowest)(curve) == portable::lowest(curve), length, (1, 0), [2 * start, 0, 0, 0]);
        }
    }
    compared
}

fn largest_steps(kernels: &Kernels, rooms: &mut Rooms) -> Compared {
    const FAR: [usize; 5] = [usize::MAX / 20, usize::MAX / 2, usize::MAX / 2 + 1, usize::MAX - 1, usize::MAX];
    let mut compared = Compared::new("largest_step");
    let mut random = Random::new();
    for contents in Contents::ALL {
        contents.fill(&mut random, &mut rooms.image.contents);
        for stride in (0..=5).chain([8, 63, 255, 319, 320, 321, 322, 640]).chain(FAR) {
            for count in (0..=20).chain([500, 0xfffe, 0xffff, 0x1_0000, usize::MAX]) {
                if stride == 0 && count > 500 && (contents != Contents::Random || count > 0x1_0000) {
                    continue; // the same pixel for ever
                }
                let needed = count.saturating_sub(1).saturating_mul(stride).saturating_add(1);
                for length in [needed, needed.saturating_add(1), needed - 1, needed - needed.min(stride), needed / 2, 0]
                {
                    let length = length.min(IMAGE - ALIGNMENTS);
                    for distance in 0..ALIGNMENTS {
                        let place = place(IMAGE, length, distance, count % 2 == 0);
                        let starts = [place.start, 0, 0, 0];
                        let pixels = &rooms.image.contents[place];
                        let ours = (kernels.largest_step)(pixels, stride, count);
                        let equal = ours == portable::largest_step(pixels, stride, count);
                        compared.note(equal, length, (count, stride), starts);
                        if count > 500 {
                            break;
                        }
                    }
                }
            }
        }
    }
    compared
}

fn crossings<T: PartialEq>(
    name: &'static str,
    kernel: impl Fn(&[u8], usize, usize, i32) -> Option<T>,
    definition: impl Fn(&[u8], usize, usize, i32) -> Option<T>,
    rooms: &mut Rooms,
) -> Compared {
    const FAR: [usize; 12] = [
        usize::MAX,
        usize::MAX - 1,
        usize::MAX - 2,
        usize::MAX - 6,
        usize::MAX - 7,
        usize::MAX - 13,
        usize::MAX / 2,
        usize::MAX / 2 + 1,
        usize::MAX / 6,
        usize::MAX / 6 + 1,
        usize::MAX / 7,
        usize::MAX / 7 + 1,
    ];
    let mut compared = Compared::new(name);
    let mut random = Random::new();
    let mut compare = |image: &[u8; IMAGE], length: usize, first: usize, stride: usize, distance: usize, at_back| {
        let place = place(IMAGE, length, distance, at_back);
        let start = place.start;
        let pixels = &image[place];
        for sign in [1, -1] {
            let equal = kernel(pixels, first, stride, sign) == definition(pixels, first, stride, sign);
            compared.note(equal, length, (first, stride), [start, 0, 0, 0]);
        }
    };
    for contents in Contents::ALL {
        contents.fill(&mut random, &mut rooms.image.contents);
        let image = &rooms.image.contents;
        for length in 0..=24 {
            for first in (0..length + 2).chain(FAR) {
                for stride in (0..9).chain(FAR) {
                    compare(image, length, first, stride, length % ALIGNMENTS, false);
                    compare(image, length, first, stride, 0, true);
                }
            }
        }
        for round in 0..1000 {
            // Just long enough, or just not, or anything.
            let (first, stride) = (random.below(700), [random.below(400), 320, 64][round % 3]);
            let needed = first + [6 * stride + 2, stride + 7][round % 2];
            let length = (needed + 1 - random.below(3)).min(IMAGE - ALIGNMENTS);
            compare(image, length, first, stride, round % ALIGNMENTS, round % 8 < 4);
        }
    }
    compared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_of_this_machine_equal_the_portable_ones() {
        let mut rooms = Box::new(Rooms::new());
        let (mut names, mut comparisons) = (Vec::new(), 0);
        let all_equal = run(&Kernels::CHOSEN, &mut rooms, |compared| {
            assert_eq!(compared.first, None, "{}", compared.kernel);
            assert!(compared.comparisons >= 600, "{compared:?}");
            names.push(compared.kernel);
            comparisons += compared.comparisons;
        });
        assert!(all_equal && names.len() == Kernels::COUNT);
        assert!(comparisons > 300_000, "{comparisons}");
        assert!(rooms.fences().iter().all(|fence| fence.0 == Fence::NEW.0));
    }

    #[test]
    fn every_wrong_kernel_is_found() {
        let mut rooms = Box::new(Rooms::new());
        let mut found = Vec::new();
        assert!(!run(&Kernels::WRONG, &mut rooms, |compared| found.push((compared.kernel, compared.first))));
        assert!(found.iter().all(|(_, first)| first.is_some()), "{found:?}");
        let of = |name: &str| found.iter().find(|(kernel, _)| *kernel == name).and_then(|(_, first)| *first).unwrap();
        assert_eq!(of("gradient_row").length, 77);
        assert_eq!(of("census_row").length, 61);
        assert_eq!(of("reverse_row").length, 43);
        assert_eq!(of("sad_curve").count, 7);
        assert_eq!((of("hamming_curve").length, of("hamming_curve").count), (18, 31));
        assert_eq!(of("lowest").length % 2, 1);
        assert_eq!(of("largest_step").count, 19);
    }

    #[test]
    fn slices_meet_fences_at_both_ends() {
        let rooms = Box::new(Rooms::new());
        let ends = |contents: &[u8]| (contents.as_ptr().addr(), contents.as_ptr_range().end.addr());
        let fences = rooms.fences().map(|fence| (&raw const *fence).addr());
        assert!(fences.iter().all(|fence| fence % PAGE == 0));
        let [a, b, c] = &rooms.rows;
        let places = [&a.contents[..], &b.contents, &c.contents, &rooms.out.contents].map(ends);
        for (place, fences) in places.iter().zip(fences.windows(2)) {
            assert_eq!(*place, (fences[0] + Fence::BYTES, fences[1]));
        }
        assert_eq!(ends(&rooms.image.contents), (fences[5] + Fence::BYTES, fences[6]));
        assert_eq!(rooms.curve.contents.as_ptr_range().end.addr(), fences[5]);
    }
}
