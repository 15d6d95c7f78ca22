//! No panic is reachable from the core's public entry points, as compiled for release.
//!
//! `tests/no-panic` is built as a static library whose panic handler calls an undefined function. Its machine code is read as a
//! graph (who refers to whom, by relocations) and walked from every exported `proof_*` function: the undefined function must not
//! be met. When it is, the shortest way to it and the source positions it was compiled from are the failure message. The library for C is walked
//! as it is linked by its users, from every function of its header.

use object::read::archive::ArchiveFile;
use object::{
    File, Object, ObjectSection, ObjectSymbol, Relocation, RelocationTarget, SectionIndex, SymbolIndex, SymbolKind,
};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Functions that panic handlers call: of the library for the proof, and of the one for C.
const PANICS: [&str; 2] = ["panic_is_reachable", "linestereo_panic"];

/// Builds a library for this machine and returns its path. All have the same profile, and share what they are made of.
pub(crate) fn build(manifest: &str, library: &str) -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join(manifest);
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no-panic");
    let output = Command::new(env!("CARGO"))
        .args(["build", "--release", "--locked", "--manifest-path"])
        .arg(manifest)
        .arg("--target-dir")
        .arg(&target)
        // The proof is about the profile in its manifest, not about flags or targets of whoever runs the tests.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET")
        .output()
        .expect("cargo runs");
    let hint = "when core's dependencies changed: cargo update --workspace --manifest-path with this manifest";
    assert!(output.status.success(), "{}\n{hint}", String::from_utf8_lossy(&output.stderr));
    let names = [format!("lib{library}.a"), format!("{library}.lib")];
    let found = names.map(|name| target.join("release").join(name)).into_iter().find(|path| path.is_file());
    found.expect("cargo built a static library")
}

/// A function or a piece of data: its section and the address where it starts.
type Place = (usize, u64);

/// References between functions in one object file.
struct Code<'a> {
    file: File<'a>,
    /// Start of everything that has a name, and of every section.
    names: BTreeMap<Place, String>,
    references: BTreeMap<Place, Vec<(u64, Reference)>>,
}

#[derive(Clone, PartialEq)]
enum Reference {
    Inside(usize, u64),
    Outside(String),
}

impl<'a> Code<'a> {
    fn new(file: File<'a>) -> Self {
        let mut names = BTreeMap::new();
        for section in file.sections() {
            names.insert((section.index().0, section.address()), section.name().unwrap_or("?").to_owned());
        }
        for symbol in file.symbols() {
            if let (Some(SectionIndex(section)), Ok(name)) = (symbol.section_index(), symbol.name())
                && !name.is_empty()
            {
                names.insert((section, symbol.address()), plain(name));
            }
        }
        let mut code = Self { file, names, references: BTreeMap::new() };
        let mut references: BTreeMap<Place, Vec<(u64, Reference)>> = BTreeMap::new();
        for section in code.file.sections() {
            for (offset, relocation) in section.relocations() {
                if let Some(reference) = code.reference(&relocation) {
                    let from = section.address() + offset;
                    references.entry(code.place(section.index().0, from)).or_default().push((from, reference));
                }
            }
        }
        code.references = references;
        code
    }

    /// The named thing that an address lies in.
    fn place(&self, section: usize, address: u64) -> Place {
        let start = self.names.range((section, 0)..=(section, address)).next_back();
        start.map_or((section, 0), |(&place, _)| place)
    }

    fn reference(&self, relocation: &Relocation) -> Option<Reference> {
        let from_symbol = |index: SymbolIndex| {
            let symbol = self.file.symbol_by_index(index).ok()?;
            let Some(SectionIndex(section)) = symbol.section_index() else {
                return Some(Reference::Outside(plain(symbol.name().ok()?)));
            };
            // Only a section symbol needs the addend to say which part is meant; it may be 4 short, counted from the next
            // instruction.
            let is_section = symbol.kind() == SymbolKind::Section;
            let shift = if is_section { relocation.addend().max(0).cast_unsigned() } else { 0 };
            Some(Reference::Inside(section, symbol.address() + shift))
        };
        match relocation.target() {
            RelocationTarget::Symbol(index) => from_symbol(index),
            RelocationTarget::Section(index) => {
                let section = self.file.section_by_index(index).ok()?;
                Some(Reference::Inside(index.0, section.address() + relocation.addend().max(0).cast_unsigned()))
            }
            _ => None,
        }
    }

    fn name(&self, place: Place) -> &str {
        self.names.get(&place).map_or("?", String::as_str)
    }

    fn entries(&self, prefix: &str) -> Vec<Place> {
        self.names.iter().filter(|(_, name)| name.starts_with(prefix)).map(|(&place, _)| place).collect()
    }

    /// Everything reachable from `entry`, each with the place it was first met from; the nearest one that refers to
    /// one of [`PANICS`], if any.
    fn walk(&self, entry: Place) -> (BTreeMap<Place, Place>, Option<Place>) {
        let mut met = BTreeMap::from([(entry, entry)]);
        let mut panicking = None;
        let mut pending = VecDeque::from([entry]);
        while let Some(place) = pending.pop_front() {
            for (_, reference) in self.references.get(&place).into_iter().flatten() {
                match reference {
                    Reference::Outside(name) if PANICS.contains(&name.as_str()) => {
                        panicking = panicking.or(Some(place))
                    }
                    Reference::Outside(_) => {}
                    &Reference::Inside(section, address) => {
                        if PANICS.contains(&self.name(self.place(section, address))) {
                            panicking = panicking.or(Some(place));
                        }
                        met.entry(self.place(section, address)).or_insert_with_key(|&target| {
                            pending.push_back(target);
                            place
                        });
                    }
                }
            }
        }
        (met, panicking)
    }

    /// The way from `entry` to the panic in words, and the source positions that its functions can panic at.
    fn explain(&self, met: &BTreeMap<Place, Place>, last: Place) -> String {
        let mut way = vec![last];
        while let Some(&previous) = met.get(&way[0])
            && previous != way[0]
        {
            way.insert(0, previous);
        }
        let names: Vec<&str> = way.iter().map(|&place| self.name(place)).collect();
        let positions: BTreeSet<String> = met.keys().flat_map(|&place| self.panic_positions(place)).collect();
        let positions: Vec<String> = positions.into_iter().collect();
        format!("{}\n    panics compiled in: {}", names.join("\n    -> "), positions.join("\n      "))
    }

    /// Every `core::panic::Location` that a function refers to.
    fn panic_positions(&self, function: Place) -> Vec<String> {
        let targets = self.references.get(&function).into_iter().flatten();
        targets
            .filter_map(|(_, reference)| match reference {
                &Reference::Inside(section, address) => self.position(section, address),
                Reference::Outside(_) => None,
            })
            .collect()
    }

    /// Reads a `core::panic::Location`: pointer to the file name, its length, line and column.
    fn position(&self, section: usize, address: u64) -> Option<String> {
        let (_, name) =
            self.references.get(&self.place(section, address))?.iter().find(|(from, _)| *from == address)?;
        let &Reference::Inside(name_section, name_address) = name else { return None };
        let pointer = if self.file.is_64() { 8 } else { 4 };
        let number = |offset: u64, size: u64| {
            let bytes = self.bytes(section, address + offset, size)?;
            Some(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
        };
        let length = number(pointer, pointer).filter(|&length| length < 4096)?;
        let file = core::str::from_utf8(self.bytes(name_section, name_address, length)?).ok()?;
        let (line, column) = (number(2 * pointer, 4)?, number(2 * pointer + 4, 4)?);
        file.ends_with(".rs").then(|| format!("{file}:{line}:{column}"))
    }

    fn bytes(&self, section: usize, address: u64, size: u64) -> Option<&'a [u8]> {
        self.file.section_by_index(SectionIndex(section)).ok()?.data_range(address, size).ok()?
    }
}

/// A demangled name without its hash and without the underscore that Mach-O puts before C names.
fn plain(name: &str) -> String {
    let name = format!("{:#}", rustc_demangle::demangle(name));
    name.strip_prefix('_').unwrap_or(&name).to_owned()
}

/// Of a library: entry points that start with `prefix`, those of `control_`, and the failure messages of the former.
fn examine(library: &Path, prefix: &str) -> (usize, usize, Vec<String>) {
    let bytes = std::fs::read(library).unwrap();
    let archive = ArchiveFile::parse(&*bytes).unwrap();
    let mut entries = 0;
    let mut controls = 0;
    let mut reachable = BTreeSet::new();
    let mut failures = Vec::new();
    for member in archive.members() {
        let Ok(file) = File::parse(member.unwrap().data(&*bytes).unwrap()) else { continue };
        let code = Code::new(file);
        for entry in code.entries("control_") {
            controls += 1;
            assert!(code.walk(entry).1.is_some(), "the detector overlooks the indexing in {}", code.name(entry));
        }
        let is_exported = |name: &str| !name.contains("::") && !PANICS.contains(&name);
        for entry in code.entries(prefix).into_iter().filter(|&entry| is_exported(code.name(entry))) {
            entries += 1;
            let (met, panicking) = code.walk(entry);
            failures.extend(panicking.map(|last| code.explain(&met, last)));
            reachable.extend(met.keys().map(|&place| code.name(place).to_owned()));
        }
    }
    println!("{} functions and tables are reachable", reachable.len());
    (entries, controls, failures)
}

#[test]
fn no_panic_is_reachable_from_the_public_entry_points() {
    let (entries, controls, failures) = examine(&build("no-panic/Cargo.toml", "linestereo_no_panic"), "proof_");
    assert_eq!((entries, controls), (45, 1), "entry points found in the library");
    assert!(failures.is_empty(), "a panic is reachable:\n\n  {}\n", failures.join("\n\n  "));
}

#[test]
fn no_panic_is_reachable_from_c() {
    let (entries, _, failures) = examine(&build("../bindings/c/Cargo.toml", "linestereo_c"), "linestereo_");
    assert_eq!(entries, 15, "functions found in the library");
    assert!(failures.is_empty(), "a panic is reachable:\n\n  {}\n", failures.join("\n\n  "));
}
