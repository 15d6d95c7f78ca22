//! OpenCV's StereoSGBM and StereoBM, and NumPy's noise, through workers in Python.
//!
//! `opencv.py` states the protocol. A worker answers the pairs of a request one after the other,
//! and matches the next one while an answer is scored.

use super::cells::Hypothesis;
use super::grid::Grid;
use super::product::Pair;
use crate::opencv::OpenCv;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Stdio};

const SCRIPT: &str = include_str!("opencv.py");
/// Steps of OpenCV's disparities in one px.
const STEPS: f64 = 16.0;
/// Part of the distance between two levels that a draw adds to a confidence.
const TIE: f64 = 0.5;

/// One pair of a request.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PairRequest {
    pub(crate) left: PathBuf,
    pub(crate) right: PathBuf,
    pub(crate) disparities: u16,
}

/// Pairs that share a random generator.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Request {
    pub(crate) pairs: Vec<PairRequest>,
    pub(crate) damage: &'static str,
    /// Each pair has a generator of its own instead.
    pub(crate) generator_per_pair: bool,
    /// Where maps are kept for the next run.
    pub(crate) cache: Option<PathBuf>,
}

/// A pair as OpenCV was given it, and what it found. Disparities are not a number in gaps.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) pair: Pair,
    /// Of SGBM with uniqueness 15 and a speckle filter.
    pub(crate) sgbm: Grid<f64>,
    /// Of BM with the same.
    pub(crate) bm: Grid<f64>,
    /// Each pixel of SGBM, with the largest uniqueness ratio that it survives as confidence.
    pub(crate) hypotheses: Vec<Hypothesis>,
}

#[derive(Deserialize)]
struct Head {
    width: usize,
    height: usize,
    answered: usize,
}

/// A process that matches pairs on one core.
#[derive(Debug)]
pub(crate) struct Worker {
    process: Child,
    answers: BufReader<ChildStdout>,
}

impl Worker {
    /// Starts the process.
    pub(crate) fn start(opencv: &OpenCv) -> Result<Self> {
        let mut command = Command::new(opencv.python());
        command.args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process =
            command.spawn().with_context(|| format!("cannot run {}", opencv.python().display()))?;
        let answers = process.stdout.take().map(BufReader::new).context("Python has no stdout")?;
        Ok(Self { process, answers })
    }

    /// Asks for the pairs of a request; [`Worker::answer`] gives them in their order.
    pub(crate) fn ask(&mut self, request: &Request) -> Result<()> {
        let line = serde_json::to_string(request)? + "\n";
        let stdin = self.process.stdin.as_mut().context("Python has no stdin")?;
        stdin
            .write_all(line.as_bytes())
            .and_then(|()| stdin.flush())
            .context("Python ended early; its message is above")
    }

    /// The next pair.
    pub(crate) fn answer(&mut self) -> Result<Answer> {
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let head: Head =
            serde_json::from_str(&line).context("Python ended early; its message is above")?;
        let count = head.width * head.height;
        let bytes_of_pixels = |grid: Vec<u8>| Grid::new(head.width, grid);
        let pair = Pair {
            left: bytes_of_pixels(self.bytes(count)?),
            right: bytes_of_pixels(self.bytes(count)?),
        };
        let mut map = || Ok::<_, anyhow::Error>(Grid::new(head.width, self.disparities(count)?));
        let (sgbm, bm, best) = (map()?, map()?, map()?);
        let levels = Grid::new(head.width, self.bytes(count)?);
        let ties = self.bytes(8 * head.answered)?;
        let ties = ties.as_chunks().0.iter().map(|bytes| f64::from_ne_bytes(*bytes));
        let pixels = levels.positions().filter(|&(x, y)| levels.at(x, y) > 0);
        let hypotheses = pixels.zip(ties).map(|((x, y), tie)| {
            let confidence = f64::from(levels.at(x, y)) + tie * TIE;
            Hypothesis { x, y, disparity: best.at(x, y), confidence }
        });
        Ok(Answer { hypotheses: hypotheses.collect(), pair, sgbm, bm })
    }

    fn bytes(&mut self, count: usize) -> Result<Vec<u8>> {
        let mut bytes = vec![0; count];
        self.answers.read_exact(&mut bytes).context("Python ended early; its message is above")?;
        Ok(bytes)
    }

    fn disparities(&mut self, count: usize) -> Result<Vec<f64>> {
        let bytes = self.bytes(2 * count)?;
        let steps = bytes.as_chunks().0.iter().map(|bytes| i16::from_ne_bytes(*bytes));
        Ok(steps.map(|steps| if steps > 0 { f64::from(steps) / STEPS } else { f64::NAN }).collect())
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // It ends by itself once nothing more is asked; a request that failed may still be at work.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
