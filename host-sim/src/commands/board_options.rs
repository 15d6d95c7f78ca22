//! Options that say which board was, or will be, photographed.

use super::arguments::both;
use anyhow::{Result, anyhow, bail};
use linestereo_calibration::boards::{Board, Dictionary, Pattern};

#[derive(Clone, Copy, Debug)]
pub(super) struct BoardSize {
    kind: Kind,
    sides: [u8; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Chessboard,
    Charuco,
    AprilGrid,
}

/// Reads `9x6`, `charuco:8x6`, `aprilgrid:6x6`.
pub(super) fn parse_board(text: &str) -> Result<BoardSize, String> {
    let (kind, size) = match text.split_once(':') {
        None => (Kind::Chessboard, text),
        Some(("charuco", size)) => (Kind::Charuco, size),
        Some(("aprilgrid", size)) => (Kind::AprilGrid, size),
        Some((kind, _)) => {
            return Err(format!(
                "no boards of the kind {kind}: give charuco: or aprilgrid:, or 9x6"
            ));
        }
    };
    let sides = size.split_once('x').and_then(both);
    let sides =
        sides.ok_or("give inner corners as COLSxROWS, for example 9x6; charuco:8x6 are squares, aprilgrid:6x6 tags")?;
    Ok(BoardSize { kind, sides })
}

/// Lengths and markers of a board.
#[derive(Debug, clap::Args)]
pub(super) struct BoardOptions {
    /// Side of a square.
    #[arg(long, value_name = "MM")]
    pub(super) square_mm: Option<f64>,
    /// ChArUco: side of a marker.
    #[arg(long, value_name = "MM")]
    marker_mm: Option<f64>,
    /// ChArUco: the set of its markers, by OpenCV's name.
    #[arg(long, value_name = "NAME")]
    dictionary: Option<String>,
    /// ChArUco with an even number of rows: the upper left square is white, as before OpenCV 4.6.
    #[arg(long)]
    legacy_pattern: bool,
    /// AprilGrid: side of a tag with its black rim.
    #[arg(long, value_name = "MM")]
    tag_mm: Option<f64>,
    /// AprilGrid: gap between tags as the share of a tag's side.
    #[arg(long, value_name = "SHARE")]
    spacing: Option<f64>,
}

impl BoardOptions {
    pub(super) fn board(&self, size: BoardSize) -> Result<Board> {
        self.check(size.kind)?;
        let given = |value: Option<f64>, option: &str| {
            value.ok_or_else(|| {
                anyhow!("the board's size in mm is missing; measure it and give {option}")
            })
        };
        let [cols, rows] = size.sides;
        let board = match size.kind {
            Kind::Chessboard => Board::new(cols, rows, given(self.square_mm, "--square-mm")? / 1e3),
            Kind::Charuco => {
                let square = given(self.square_mm, "--square-mm")? / 1e3;
                let marker = given(self.marker_mm, "--marker-mm")? / 1e3;
                Board::charuco(size.sides, square, marker, self.dictionary()?, self.legacy_pattern)
            }
            Kind::AprilGrid => {
                let tag = given(self.tag_mm, "--tag-mm")? / 1e3;
                let spacing =
                    self.spacing.ok_or_else(|| anyhow!("give --spacing, Kalibr's is 0.3"))?;
                Board::april_grid(size.sides, tag, spacing)
            }
        };
        let right = match size.kind {
            Kind::Chessboard => "inner corners, for example 9x6, and --square-mm",
            Kind::Charuco => "squares, for example charuco:8x6, --square-mm and --marker-mm",
            Kind::AprilGrid => "tags, for example aprilgrid:6x6, --tag-mm and --spacing",
        };
        board.map_err(|error| anyhow!("{error}; give --board as {right}"))
    }

    /// No option of another kind.
    fn check(&self, kind: Kind) -> Result<()> {
        let options = [
            ("--square-mm", self.square_mm.is_some(), kind != Kind::AprilGrid),
            ("--marker-mm", self.marker_mm.is_some(), kind == Kind::Charuco),
            ("--dictionary", self.dictionary.is_some(), kind == Kind::Charuco),
            ("--legacy-pattern", self.legacy_pattern, kind == Kind::Charuco),
            ("--tag-mm", self.tag_mm.is_some(), kind == Kind::AprilGrid),
            ("--spacing", self.spacing.is_some(), kind == Kind::AprilGrid),
        ];
        if let Some((name, ..)) = options.iter().find(|(_, given, meant)| *given && !meant) {
            let board = match kind {
                Kind::Chessboard => "a chessboard",
                Kind::Charuco => "a ChArUco board",
                Kind::AprilGrid => "an AprilGrid",
            };
            bail!(
                "{name} is not of {board}; leave it out, or give another --board: 9x6, \
                 charuco:8x6, aprilgrid:6x6"
            );
        }
        Ok(())
    }

    fn dictionary(&self) -> Result<Dictionary> {
        let Some(name) = &self.dictionary else {
            bail!(
                "the board's markers are not known; give --dictionary, for example DICT_5X5_100, \
                 as it was printed"
            );
        };
        let names = || Dictionary::names().join(", ");
        Dictionary::named(name)
            .ok_or_else(|| anyhow!("no dictionary {name}; give --dictionary as one of {}", names()))
    }

    pub(super) fn described(&self, board: &Board) -> String {
        let rounded = |mm: f64| (1e6 * mm).round() / 1e6;
        let mm = rounded(1e3 * board.square());
        match board.pattern() {
            Pattern::Chessboard => {
                format!("{board} chessboard, squares of {} mm", self.square_mm.unwrap_or(mm))
            }
            Pattern::Charuco { dictionary, marker, .. } => {
                format!(
                    "{board} board, squares of {mm} mm, markers of {} mm, {}",
                    rounded(mm * marker),
                    dictionary.name()
                )
            }
            Pattern::AprilGrid { spacing } => {
                format!("{board} board, tags of {mm} mm, spacing {spacing}")
            }
        }
    }
}
