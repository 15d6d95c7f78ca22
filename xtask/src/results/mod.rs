//! `cargo xtask results`: every published figure, from stored measurements to the pages.
//!
//! ```text
//! linestereo-lab bench, compare   --json    ─┐
//!                                            ├─> xtask/scores.json ─┐
//! cargo xtask measure, footprint  --bless ───┴──────────────────────┴─> docs/results.md
//!                                                                       figures of README.md
//! constants of the sources ────────────────────────────────────────────> limits of docs/security.md
//! ```

mod limits;
mod page;
mod readme;
mod stored;

use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use stored::Stored;

/// The page that is generated.
pub const PAGE: &str = "docs/results.md";

const HELP: &str = "\
Write docs/results.md and the figures of README.md from the stored measurements, and the limits of
docs/security.md from the sources.

Usage: cargo xtask results [--check] [--measure [FRAMES]] [--bench FILE] [--compare FILE]

Options:
  --check             Write nothing; fail where a page disagrees with the stored measurements
  --measure [FRAMES]  Score the data sets of this folder first [default: $LINESTEREO_FRAMES]
  --lab PROGRAM       Score with this linestereo-lab instead of building it
  --bench FILE        Take scores from what `linestereo-lab bench FRAMES --json FILE` wrote; sets
                      that it lacks keep theirs
  --compare FILE      Take what `linestereo-lab compare FRAMES/qvga --opencv --threads 1
                      --json FILE` wrote

OpenCV comes from the Python that LINESTEREO_PYTHON names. Numbers of boards are stored by
`cargo xtask measure --bless` and `cargo xtask footprint --bless`.
";

/// Options of `cargo xtask results`.
#[derive(Clone, Debug, Default)]
struct Request {
    check: bool,
    frames: Option<PathBuf>,
    lab: Option<PathBuf>,
    bench: Option<PathBuf>,
    compare: Option<PathBuf>,
}

impl Request {
    fn parse(arguments: &[OsString]) -> Result<Self> {
        let mut request = Self::default();
        let mut rest = arguments.iter().peekable();
        while let Some(argument) = rest.next() {
            let mut file = || rest.next().map(PathBuf::from).context("a file name is missing");
            match argument.to_str() {
                Some("--check") => request.check = true,
                Some("--lab") => request.lab = Some(file()?),
                Some("--bench") => request.bench = Some(file()?),
                Some("--compare") => request.compare = Some(file()?),
                Some("--measure") => {
                    let named = rest.next_if(|next| !next.to_string_lossy().starts_with("--"));
                    let frames = named.cloned().or_else(|| std::env::var_os("LINESTEREO_FRAMES"));
                    let frames = frames.context("name the folder, or set LINESTEREO_FRAMES")?;
                    request.frames = Some(frames.into());
                }
                _ => bail!("unknown argument {}\n\n{HELP}", argument.display()),
            }
        }
        Ok(request)
    }
}

/// Runs the task. `top` is the top of the repository.
pub fn run(top: &Path, arguments: &[OsString]) -> Result<()> {
    if arguments.iter().any(|argument| argument == "--help" || argument == "-h") {
        print!("{HELP}");
        return Ok(());
    }
    let request = Request::parse(arguments)?;
    if request.check {
        return check(top);
    }
    let mut stored = Stored::read(top)?;
    let (mut bench, mut compare) = (request.bench.clone(), request.compare.clone());
    if let Some(frames) = &request.frames {
        [bench, compare] = measure(top, frames, request.lab.as_deref())?.map(Some);
    }
    if let Some(file) = bench {
        stored.take_bench(&file)?;
    }
    if let Some(file) = compare {
        stored.take_compare(&file)?;
    }
    stored.date_boards();
    stored.write(top)?;
    write(&top.join(PAGE), &page::of(&stored)?)?;
    let readme = top.join("README.md");
    write(&readme, &readme::filled(&read(&readme)?, &stored)?)?;
    let security = top.join("docs/security.md");
    write(&security, &limits::filled(&read(&security)?, top)?)?;
    println!("{PAGE} and README.md agree with the stored measurements");
    Ok(())
}

/// An error where a page disagrees with the stored measurements.
pub fn check(top: &Path) -> Result<()> {
    let stored = Stored::read(top)?;
    let advice = "run `cargo xtask results`";
    if !stored.is_dated() {
        bail!("numbers of boards are newer than {PAGE}; {advice}");
    }
    if read(&top.join(PAGE))? != page::of(&stored)? {
        bail!("{PAGE} differs from the stored measurements; {advice}");
    }
    let readme = read(&top.join("README.md"))?;
    if readme::filled(&readme, &stored)? != readme {
        bail!("figures of README.md differ from the stored measurements; {advice}");
    }
    let security = read(&top.join("docs/security.md"))?;
    if limits::filled(&security, top)? != security {
        bail!("limits of docs/security.md differ from the sources; {advice}");
    }
    Ok(())
}

/// Figures of README.md, as they stand in its text.
pub fn readme_figures(top: &Path) -> Result<Vec<String>> {
    readme::figures(&Stored::read(top)?)
}

/// Has the laboratory score these frames: files of `bench` and of `compare`.
fn measure(top: &Path, frames: &Path, lab: Option<&Path>) -> Result<[PathBuf; 2]> {
    let frames = std::path::absolute(frames)?;
    let folder = top.join("target/lab");
    fs::create_dir_all(&folder)?;
    let files = [folder.join("bench.json"), folder.join("compare.json")];
    let qvga = frames.join("qvga");
    let asked: [Vec<&str>; 2] = [
        vec!["bench", path(&frames)?, "--json", path(&files[0])?],
        vec!["compare", path(&qvga)?, "--opencv", "--threads", "1", "--json", path(&files[1])?],
    ];
    for arguments in asked {
        let mut command = match lab {
            Some(program) => Command::new(program),
            None => {
                let mut cargo = Command::new("cargo");
                cargo.args(["run", "--release", "--package", "linestereo-lab", "--"]);
                cargo
            }
        };
        let status = command.args(&arguments).current_dir(top).status();
        if !status.context("cannot start linestereo-lab")?.success() {
            bail!("linestereo-lab {} failed", arguments[0]);
        }
    }
    Ok(files)
}

fn path(path: &Path) -> Result<&str> {
    path.to_str().context("a path that is not UTF-8")
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}
