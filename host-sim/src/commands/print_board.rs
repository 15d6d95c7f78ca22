//! `linestereo print-board`: a board to print and photograph.

use super::board_options::{BoardOptions, BoardSize, parse_board};
use crate::output::{OutputFiles, OutputPath};
use anyhow::Result;
use core::fmt::Write;
use linestereo_calibration::boards::Board;

/// Write a calibration board as SVG in true size.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/print-board.txt"))]
pub struct Args {
    /// Kind and size: inner corners of a chessboard, squares of a ChArUco board, tags of an
    /// AprilGrid.
    #[arg(value_name = "[KIND:]COLSxROWS", value_parser = parse_board)]
    board: BoardSize,
    #[command(flatten)]
    options: BoardOptions,
    /// The file; "-" is stdout.
    #[arg(long, value_name = "FILE.svg")]
    out: OutputPath,
}

/// White around the board, mm: half a square, at least.
const RIM: f64 = 10.0;
/// Height of the line of text below the board, mm.
const TEXT: f64 = 5.0;

pub fn run(args: &Args) -> Result<()> {
    let board = args.options.board(args.board)?;
    let described = args.options.described(&board);
    let (svg, [width, height]) = svg(&board, &described);
    let mut output = OutputFiles::new();
    output.add(&args.out, svg.as_bytes())?;
    output.commit_and_say(&format!(
        "{described}\nwrote {}: {width:.0} x {height:.0} mm; print it at 100 %, and measure it\n",
        args.out.display()
    ))
}

/// The drawing, and the page's sides in mm.
fn svg(board: &Board, described: &str) -> (String, [f64; 2]) {
    let [left, top, width, height] = board.extent().map(|m| 1e3 * m);
    let rim = RIM.max(500.0 * board.square());
    let page = [width + 2.0 * rim, height + 2.0 * rim];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.4}mm\" height=\"{1:.4}mm\" viewBox=\"{2:.4} {3:.4} {0:.4} {1:.4}\">\n\
         <rect x=\"{2:.4}\" y=\"{3:.4}\" width=\"{0:.4}\" height=\"{1:.4}\" fill=\"white\"/>\n<path fill=\"black\" d=\"",
        page[0],
        page[1],
        left - rim,
        top - rim,
    );
    for [x, y, w, h] in board.black().iter().map(|black| black.map(|m| 1e3 * m)) {
        let _ = write!(text, "M{x:.4} {y:.4}h{w:.4}v{h:.4}h{:.4}z", -w);
    }
    let _ = write!(
        text,
        "\"/>\n<text x=\"{left:.4}\" y=\"{:.4}\" font-family=\"sans-serif\" font-size=\"{:.4}\">{described}</text>\n</svg>\n",
        top + height + rim / 2.0 + TEXT / 2.0,
        0.6 * TEXT,
    );
    (text, page)
}
