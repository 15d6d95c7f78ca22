//! A photo -> the board's corners.
//!
//! In: a grey image and the board. Out: all inner corners of a chessboard, or those corners of a
//! board with markers that are seen, to a few hundredths of a pixel, numbered as
//! [`board`](super::board) says, or why not.
//!
//! ```text
//! for each way of looking (scales, ring sizes, ChESS or Radon), the cheapest first:
//!     X-junctions -> grids of them                 chess-corners, calib-targets-chessboard
//!     a grid that holds the whole board, and no other place for it -> each corner to sub-pixel
//!         precision
//! else: the largest grid seen says what is wrong
//! boards with markers: the first ways that show some of it; which corners they are, markers say
//!                      (charuco, april)
//! ```
//!
//! # Cost
//! 5 to 20 ms for VGA where the first way succeeds, up to a second where none does.

use super::board::{Board, BoardCorners};
use super::grid::{Grid, NotFound, more_telling};
use super::markers::Pattern;
use super::reader::view;
use super::{april, charuco, corner};
use calib_targets_chessboard::{
    ChessboardDetector, ChessboardParams, DetectorConfig, detect_corners,
};
use chess_corners::{ChessRing, ImageRefiner, OnRefinerReject, UpscaleConfig};
use linestereo_frames::GrayImage;
use linestereo_frames::untrusted;

/// Finds a board in an image.
pub trait BoardFinder: Sync {
    /// The corners of the board, or why they are not there.
    fn find(&self, image: &GrayImage, board: &Board) -> Result<BoardCorners, NotFound>;
}

/// [`BoardFinder`] over the crates `chess-corners` and `calib-targets-chessboard`, and for markers
/// `calib-targets-aruco`.
#[derive(Clone, Copy, Debug, Default)]
pub struct JunctionFinder;

/// Images of a shorter side, px, hold no board: the detector's rings reach 10 px to each side.
const LEAST_SIDE: u16 = 32;
/// Responses below this are no corners.
const LEAST_RESPONSE: f32 = 15.0;
/// Images of more pixels are not enlarged, or not looked at by the slow Radon transform.
const LARGEST_ENLARGED: usize = 400_000;
const LARGEST_RADON: usize = 1_000_000;

/// Ways of looking of which the one that shows most of a board with markers is taken; more only
/// where these show nothing.
const TOGETHER: usize = 4;

impl BoardFinder for JunctionFinder {
    fn find(&self, image: &GrayImage, board: &Board) -> Result<BoardCorners, NotFound> {
        if image.dims.width.min(image.dims.height) < LEAST_SIDE {
            return Err(NotFound::Nothing);
        }
        let found = match board.pattern() {
            Pattern::Chessboard => untrusted::guarded(|| found(image, board)),
            _ => untrusted::guarded(|| marked(image, board)),
        };
        found.unwrap_or(Err(NotFound::Nothing))
    }
}

/// The board by the first way of looking that shows all of it.
fn found(image: &GrayImage, board: &Board) -> Result<BoardCorners, NotFound> {
    let view = view(image);
    let mut why = NotFound::Nothing;
    for (config, least) in ways(image.pixels.len()) {
        let junctions = detect_corners(&view, &config);
        for mut params in ChessboardParams::sweep_default() {
            params.min_corner_strength = least;
            let Ok(detector) = ChessboardDetector::new(params) else { continue };
            for detection in detector.detect_all(&junctions) {
                match placed(image, board, &Grid::new(&detection)) {
                    Ok(corners) => return Ok(corners),
                    Err(other) => why = more_telling(why, other),
                }
            }
        }
    }
    Err(why)
}

/// The corners of a board with markers that the first successful ways of looking show.
fn marked(image: &GrayImage, board: &Board) -> Result<BoardCorners, NotFound> {
    let mut best: Result<BoardCorners, NotFound> = Err(NotFound::Nothing);
    for (index, (config, least)) in ways(image.pixels.len()).into_iter().enumerate() {
        if best.as_ref().is_ok_and(|best| index >= TOGETHER || best.len() == board.corners()) {
            break;
        }
        let junctions = detect_corners(&view(image), &config);
        let found = match board.pattern() {
            Pattern::Charuco { dictionary, marker, .. } => {
                let mut params = ChessboardParams::default();
                params.min_corner_strength = least;
                let grids =
                    ChessboardDetector::new(params).map(|detector| detector.detect_all(&junctions));
                let grids: Vec<Grid> = grids.unwrap_or_default().iter().map(Grid::new).collect();
                charuco::numbered(image, board, (dictionary, marker), &grids)
            }
            _ => april::numbered(image, board, &junctions),
        };
        best = match (best, found) {
            (Ok(best), Ok(found)) => Ok(if found.len() > best.len() { found } else { best }),
            (Err(why), Err(other)) => Err(more_telling(why, other)),
            (Ok(found), _) | (_, Ok(found)) => Ok(found),
        };
    }
    best
}

/// Ways of looking with their least responses, cheap before dear.
fn ways(pixels: usize) -> Vec<(DetectorConfig, f32)> {
    let tuned = |config: DetectorConfig| {
        let keep = |chess: &mut chess_corners::ChessConfig| {
            chess.on_refiner_reject = OnRefinerReject::KeepCenterOfMass
        };
        config
            .with_threshold(LEAST_RESPONSE)
            .with_chess(keep)
            .with_refiner(ImageRefiner::saddle_point())
    };
    let chess = tuned(DetectorConfig::chess());
    let mut ways = vec![
        (tuned(DetectorConfig::chess_multiscale()), LEAST_RESPONSE),
        (chess, LEAST_RESPONSE),
        (chess.with_chess(|chess| chess.ring = ChessRing::Broad), LEAST_RESPONSE),
    ];
    if pixels <= LARGEST_ENLARGED {
        ways.push((chess.with_upscale(UpscaleConfig::Fixed(2)), LEAST_RESPONSE));
        ways.push((chess.with_upscale(UpscaleConfig::Fixed(3)), LEAST_RESPONSE));
        ways.push((DetectorConfig::radon().with_upscale(UpscaleConfig::Fixed(2)), 0.0));
    }
    if pixels <= LARGEST_RADON {
        ways.push((DetectorConfig::radon(), 0.0));
    }
    ways
}

/// The board's corners if the grid holds exactly one whole board.
fn placed(image: &GrayImage, board: &Board, grid: &Grid) -> Result<BoardCorners, NotFound> {
    let (cols, rows) = (board.cols() as i32, board.rows() as i32);
    let (left, top, wide, high) = grid.trimmed();
    let upright = (wide, high) == (cols, rows);
    let full = wide > 0 && high > 0 && grid.filled(left, top, wide, high) >= 1.0;
    if !upright && (high, wide) != (cols, rows) {
        let sides = [wide.max(high) as usize, wide.min(high) as usize];
        return Err(if full && sides[1] >= 3 {
            NotFound::OtherSize(sides[0], sides[1])
        } else {
            NotFound::Part(grid.at.len())
        });
    }
    if !full {
        return Err(NotFound::Part(grid.at.len()));
    }
    let (turned, left, top) =
        if upright { (None, left, top) } else { (Some(grid.transposed()), top, left) };
    let grid = turned.as_ref().unwrap_or(grid);
    let places = (top..top + rows).flat_map(|v| (left..left + cols).map(move |u| (u, v)));
    let rough: Vec<[f64; 2]> = places.filter_map(|key| grid.at.get(&key).copied()).collect();
    let exact = refined(image, board, &rough);
    BoardCorners::new(image, board.cols(), board.rows(), exact).ok_or(NotFound::Nothing)
}

/// Every corner to sub-pixel precision.
fn refined(image: &GrayImage, board: &Board, rough: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (cols, rows) = (board.cols(), board.rows());
    let distance =
        |a: usize, b: usize| (rough[a][0] - rough[b][0]).hypot(rough[a][1] - rough[b][1]);
    let refine = |index: usize| {
        let (col, row) = (index % cols, index / cols);
        let neighbours = [
            (col > 0).then(|| index - 1),
            (col + 1 < cols).then_some(index + 1),
            (row > 0).then(|| index - cols),
            (row + 1 < rows).then_some(index + cols),
        ];
        let spacing = neighbours
            .into_iter()
            .flatten()
            .map(|other| distance(index, other))
            .fold(f64::MAX, f64::min);
        let outermost = neighbours.contains(&None);
        // A corner that cannot be refined, at the border of the image, keeps the detector's place.
        corner::refine(image, rough[index], spacing, outermost).unwrap_or(rough[index])
    };
    (0..rough.len()).map(refine).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;

    /// The detector's rings reach 10 px: it looked beyond the rows of images that are narrower than
    /// two of them, and so ended all photos.
    #[test]
    fn photos_of_every_size_are_looked_at() {
        let board = Board::new(9, 6, 0.02).unwrap();
        for (width, height) in
            (1..48).flat_map(|side| [(side, 16), (side, 100), (16, side), (100, side)])
        {
            let dims = Dims { width, height };
            let pixels = (0..usize::from(width) * usize::from(height))
                .map(|i| ((i * i * 37) >> 3) as u8)
                .collect();
            assert!(JunctionFinder.find(&GrayImage { dims, pixels }, &board).is_err(), "{dims}");
        }
    }
}
