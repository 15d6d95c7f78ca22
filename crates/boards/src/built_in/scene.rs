//! Scenes of the built-in pairs, painted by integers alone: the same bytes on every machine,
//! without a file.
//!
//! In: a scene and a size. Out: both images. Every pixel is a function of its coordinates, so
//! nothing is kept. `Blocks` looks like a scene; the others are what costs the method most, each in
//! another way.

use linestereo::Dims;

/// Scene that is painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// Textured boards, some of them slanted, nearer ones in front of farther ones; a little noise.
    Blocks,
    /// The same with the right image one row lower.
    RowsOff,
    /// Bricks of random grey, shifted by 8 px: as many segments as an image can hold, all of which
    /// match.
    Bricks,
    /// Bricks of black and white, shifted by 12 px.
    Contrast,
    /// Noise, shifted by 4 px.
    Noise,
    /// A checkerboard: every edge looks like every other.
    Checkerboard,
    /// Vertical stripes of 3 px.
    Columns,
    /// Horizontal stripes of 5 px.
    Rows,
    /// Diagonal ramps.
    Diagonals,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum CameraSide {
    Left,
    Right,
}

impl Scene {
    /// Every scene.
    pub const ALL: [Self; 9] = [
        Self::Blocks,
        Self::RowsOff,
        Self::Bricks,
        Self::Contrast,
        Self::Noise,
        Self::Checkerboard,
        Self::Columns,
        Self::Rows,
        Self::Diagonals,
    ];

    /// In snake case, as it stands in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::RowsOff => "rows_off",
            Self::Bricks => "bricks",
            Self::Contrast => "contrast",
            Self::Noise => "noise",
            Self::Checkerboard => "checkerboard",
            Self::Columns => "columns",
            Self::Rows => "rows",
            Self::Diagonals => "diagonals",
        }
    }

    /// Paints the left and the right image at the start of their memories; what does not fit is
    /// left out.
    pub fn paint(self, dims: Dims, left: &mut [u8], right: &mut [u8]) {
        for (image, eye) in [(left, CameraSide::Left), (right, CameraSide::Right)] {
            let rows =
                image.chunks_exact_mut(usize::from(dims.width).max(1)).take(dims.height.into());
            for (row, y) in rows.zip(0..) {
                for (pixel, x) in row.iter_mut().zip(0..) {
                    *pixel = self.grey(x, y, eye, dims.width.into());
                }
            }
        }
    }

    fn grey(self, x: i32, y: i32, eye: CameraSide, width: i32) -> u8 {
        let shifted = |d: i32| if eye == CameraSide::Right { x + d } else { x };
        let black_or_white = |white: bool| if white { 255 } else { 0 };
        match self {
            Self::Blocks => blocks(x, y, eye, width),
            Self::RowsOff => {
                blocks(x, if eye == CameraSide::Right { y - 1 } else { y }, eye, width)
            }
            Self::Bricks => hash(shifted(8) >> 3, y >> 3, 1) as u8,
            Self::Contrast => black_or_white(hash(shifted(12) >> 3, y >> 3, 2) & 1 == 1),
            Self::Noise => hash(shifted(4), y, 3) as u8,
            Self::Checkerboard => black_or_white(((x >> 2) + (y >> 2)) & 1 == 1),
            Self::Columns => black_or_white((x / 3) & 1 == 1),
            Self::Rows => black_or_white((y / 5) & 1 == 1),
            Self::Diagonals => ((x + y) * 9) as u8,
        }
    }
}

/// Boards in front of a wall.
const BOARDS: i32 = 12;

/// The nearest board at this pixel, or the wall.
fn blocks(x: i32, y: i32, eye: CameraSide, width: i32) -> u8 {
    let noise = (hash(x, y, if eye == CameraSide::Left { 4 } else { 5 }) & 3) as i32;
    for board in 0..BOARDS {
        let random = |what: i32, below: i32| (hash(board, what, 6) >> 8) as i32 % below.max(1);
        let d = (44 - 3 * board) * width / 320; // px, nearest first
        let u = if eye == CameraSide::Right { x + d } else { x };
        let (across, down) = (u - random(0, width), y - random(1, width * 3 / 4));
        let slant = random(2, 9) - 4; // sixteenths of a px per row
        if down.abs() <= width / 24 + random(3, width / 12)
            && (across - ((slant * down) >> 4)).abs() <= width / 32 + random(4, width / 10)
        {
            return (texture(u, y, 8 + board) / 2 + random(5, 128) + noise) as u8;
        }
    }
    (texture(if eye == CameraSide::Right { x + width / 100 } else { x }, y, 7) / 2 + 60 + noise)
        as u8
}

/// Spots of 3 px on spots of 11 px, 0 to 90.
fn texture(x: i32, y: i32, seed: i32) -> i32 {
    (hash(x / 11, y / 11, seed) & 63) as i32 + (hash(x / 3, y / 3, seed) & 31) as i32
        - 4 * i32::from(x & 16 == 0)
}

/// Bits that look random: the finaliser of MurmurHash3 (Appleby) over the three numbers.
fn hash(x: i32, y: i32, seed: i32) -> u32 {
    let mut bits = (x as u32)
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add((y as u32).wrapping_mul(0x85eb_ca77))
        .wrapping_add((seed as u32).wrapping_mul(0xc2b2_ae3d));
    bits = (bits ^ bits >> 16).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ bits >> 13).wrapping_mul(0xc2b2_ae35);
    bits ^ bits >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMS: Dims = Dims { width: 160, height: 120 };

    fn painted(scene: Scene) -> (Vec<u8>, Vec<u8>) {
        let (mut left, mut right) = (vec![0; 160 * 120], vec![0; 160 * 120]);
        scene.paint(DIMS, &mut left, &mut right);
        (left, right)
    }

    #[test]
    fn shifted_scenes_are_shifted() {
        for (scene, d) in [(Scene::Bricks, 8), (Scene::Contrast, 12), (Scene::Noise, 4)] {
            let (left, right) = painted(scene);
            for (l, r) in left.chunks(160).zip(right.chunks(160)) {
                assert_eq!(l[d..], r[..160 - d], "{}", scene.name());
            }
        }
    }

    #[test]
    fn rows_off_is_blocks_one_row_lower() {
        let ((left, right), (same, lower)) = (painted(Scene::Blocks), painted(Scene::RowsOff));
        assert_eq!(left, same);
        let noise = |(a, b): (&u8, &u8)| a.abs_diff(*b);
        assert!(right.iter().zip(&lower[160..]).map(noise).max() <= Some(3));
    }

    #[test]
    fn a_memory_that_is_too_small_is_filled_by_whole_rows() {
        let (mut left, mut right) = ([1; 250], [1; 10]);
        Scene::Checkerboard.paint(Dims { width: 100, height: 100 }, &mut left, &mut right);
        assert_eq!(left[200..], [1; 50]);
        assert_eq!(right, [1; 10]);
    }
}
