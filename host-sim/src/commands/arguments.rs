//! Checks of the arguments of every command, by their types and names of values alone.
//!
//! ```text
//! OutputPath   an output: under "Outputs" in the help; neither an input nor another output; in the
//!              format that its name says
//! PathBuf      an input
//! numbers      may be negative: what is out of range is said in words
//! ```

use crate::output::{OutputPath, place};
use anyhow::{Result, bail};
use clap::{Arg, ArgMatches, Command};
use core::any::TypeId;
use core::ops::RangeInclusive;
use core::str::FromStr;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Endings that say what is in a file; another one says nothing.
const FORMATS: [&str; 17] = [
    "png", "jpg", "jpeg", "bmp", "gif", "tif", "tiff", "webp", "pfm", "ply", "pcd", "npy", "svg",
    "pdf", "html", "txt", "csv",
];

/// The command as it is shown and parsed.
pub(super) fn prepared(command: Command) -> Command {
    let of_all = |arg: Arg| {
        let takes_values = arg.get_action().takes_values();
        let arg = if takes_values && !arg.is_positional() {
            arg.allow_negative_numbers(true)
        } else {
            arg
        };
        if is_output(&arg) && !arg.is_positional() { arg.help_heading("Outputs") } else { arg }
    };
    command.mut_args(of_all).mut_subcommands(prepared)
}

/// The arguments with `--name=first` of an option of two values as `--name first`: the second one
/// follows.
pub(super) fn separated(
    command: &Command,
    arguments: impl IntoIterator<Item = OsString>,
) -> Vec<OsString> {
    let takes_two = |name: &str| {
        let commands = core::iter::once(command).chain(command.get_subcommands());
        commands.flat_map(Command::get_arguments).any(|arg| {
            arg.get_long() == Some(name)
                && arg.get_num_args().is_some_and(|values| values.min_values() == 2)
        })
    };
    let mut is_option = true;
    let mut out = Vec::new();
    for argument in arguments {
        is_option &= argument != "--";
        let pair = argument
            .to_str()
            .filter(|_| is_option)
            .and_then(|text| text.strip_prefix("--")?.split_once('='));
        match pair.filter(|(name, _)| takes_two(name)) {
            Some((name, first)) => out.extend([format!("--{name}").into(), first.into()]),
            None => out.push(argument),
        }
    }
    out
}

/// A parser of numbers in this range; `advice` is the error of everything else.
pub(super) fn number_in(
    range: RangeInclusive<f64>,
    advice: &'static str,
) -> impl Fn(&str) -> Result<f64, &'static str> + Clone {
    move |text| text.parse().ok().filter(|value| range.contains(value)).ok_or(advice)
}

/// Both parts of a split text as values.
pub(super) fn both<T: FromStr>((first, second): (&str, &str)) -> Option<[T; 2]> {
    Some([first.parse().ok()?, second.parse().ok()?])
}

/// A column and a row with a comma between them.
pub(super) fn position<T: FromStr>(text: &str) -> Option<[T; 2]> {
    both(text.split_once(',').map(|(x, y)| (x.trim(), y.trim()))?)
}

fn is_output(arg: &Arg) -> bool {
    arg.get_value_parser().type_id() == TypeId::of::<OutputPath>()
}

/// Refuses outputs that would replace an input or one another, and those whose name says another
/// format.
pub(super) fn check(command: &Command, matches: &ArgMatches) -> Result<()> {
    if let Some((name, matches)) = matches.subcommand()
        && let Some(command) = command.find_subcommand(name)
    {
        return check(command, matches);
    }
    let mut taken: Vec<(String, PathBuf)> = Vec::new();
    for arg in command.get_arguments() {
        for path in values::<PathBuf>(arg, matches).filter(|path| path.is_file()) {
            taken.push((shown(arg, path), place(path)));
        }
    }
    for arg in command.get_arguments() {
        for path in values::<OutputPath>(arg, matches) {
            let name = shown(arg, path);
            check_format(arg, path, &name)?;
            if path.exists() && !path.is_file() {
                continue; // a device, or a folder, which nothing is written over
            }
            let at = if path.is_stdout() { path.to_path_buf() } else { place(path) };
            if let Some((other, _)) = taken.iter().find(|(_, there)| *there == at) {
                bail!("{name} and {other} are the same; write to another file");
            }
            taken.push((name, at));
        }
    }
    Ok(())
}

fn values<'a, T: Clone + Send + Sync + 'static>(
    arg: &Arg,
    matches: &'a ArgMatches,
) -> impl Iterator<Item = &'a T> {
    matches.try_get_many::<T>(arg.get_id().as_str()).ok().flatten().into_iter().flatten()
}

/// `--csv a.csv`, or the path alone of what has no name.
fn shown(arg: &Arg, path: &Path) -> String {
    arg.get_long()
        .map_or_else(|| path.display().to_string(), |name| format!("--{name} {}", path.display()))
}

/// Refuses a name of another format: an option whose help says `FILE.png` writes PNG, whatever the
/// name; of several the first one is what it writes under a name that says nothing.
fn check_format(arg: &Arg, path: &Path, name: &str) -> Result<()> {
    let names = arg.get_value_names().and_then(|names| names.first()).map_or("", |name| name);
    let wanted: Vec<&str> =
        names.split('|').filter_map(|name| Some(name.rsplit_once('.')?.1)).collect();
    let given = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let (Some(first), Some(given)) = (wanted.first(), given) else { return Ok(()) };
    if !wanted.contains(&&*given) && FORMATS.contains(&&*given) {
        let right = path.with_extension(first);
        bail!("{name} would be written as {}; call it {}", first.to_uppercase(), right.display());
    }
    Ok(())
}
