//! The firmware example of the README, built for boards as a package outside of this workspace.

use super::no_panic::{build_for, for_m7};
use linestereo_sim::board::{is_long, toolchain::Toolchain};
use linestereo_tests::board::or_skip;
use object::{Object as _, ObjectSection as _};
use serde_json::Value;
use std::path::Path;

/// Objects of the core as it is built for a target, by a package outside of this workspace.
fn core_objects(toolchain: &Toolchain, target: &str, features: &[&str]) -> Vec<u8> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    // A copy elsewhere: no configuration of this workspace reaches it.
    let folder = tempfile::tempdir().unwrap();
    let core = top.join("core").canonicalize().unwrap();
    let example = top.join("docs/firmware-example");
    let manifest = std::fs::read_to_string(example.join("Cargo.toml")).unwrap();
    std::fs::create_dir(folder.path().join("src")).unwrap();
    let manifest = manifest.replace("../../core", core.to_str().unwrap());
    std::fs::write(folder.path().join("Cargo.toml"), manifest).unwrap();
    for name in ["Cargo.lock", "src/lib.rs"] {
        std::fs::copy(example.join(name), folder.path().join(name)).unwrap();
    }
    // Kernels are assembly, and there at every level: the quickest one.
    let level = "--config=profile.release.opt-level=0";
    let features = format!("--features={}", features.join(","));
    let arguments = ["--message-format=json", level, &features];
    let (_, printed) = build_for(toolchain, target, folder.path(), &arguments);
    let messages = printed.split(|&byte| byte == b'\n').filter(|line| !line.is_empty());
    let artifacts = messages.map(|line| serde_json::from_slice::<Value>(line).unwrap());
    let library = artifacts.filter(|artifact| artifact["target"]["name"] == "linestereo").find_map(
        |artifact| {
            let files = artifact["filenames"].as_array()?.iter().filter_map(Value::as_str);
            files.filter(|file| file.ends_with(".rlib")).map(str::to_owned).next()
        },
    );
    std::fs::read(library.unwrap()).unwrap()
}

/// USADA8 (Armv7-M Architecture Reference Manual, A7.7.201).
fn is_usada8(first: u16, second: u16) -> bool {
    first & 0xfff0 == 0xfb70 && second & 0xf0 == 0 && second >> 12 != 15
}

/// VABAV of unsigned lanes (Armv8-M Architecture Reference Manual, C2.4).
fn is_vabav(first: u16, second: u16) -> bool {
    first & 0xffc1 == 0xfe80 && second & 0xf51 == 0xf01
}

/// How often an instruction is in the code of a library.
fn count(library: &[u8], is: fn(u16, u16) -> bool) -> usize {
    let archive = object::read::archive::ArchiveFile::parse(library).unwrap();
    let members = archive.members().map(|member| member.unwrap().data(library).unwrap());
    let files = members.filter_map(|data| object::File::parse(data).ok());
    let of_file = |file: object::File<'_>| -> usize {
        let code = file.sections().filter(|section| section.kind() == object::SectionKind::Text);
        let count = |data: &[u8]| {
            let halves: Vec<u16> =
                data.chunks_exact(2).map(|half| u16::from_le_bytes([half[0], half[1]])).collect();
            halves.windows(2).filter(|two| is(two[0], two[1])).count()
        };
        code.map(|section| count(section.data().unwrap())).sum()
    };
    files.map(of_file).sum()
}

#[test]
fn the_readme_shows_firmware_that_builds() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let source = std::fs::read_to_string(top.join("docs/firmware-example/src/lib.rs")).unwrap();
    let readme = std::fs::read_to_string(top.join("README.md")).unwrap();
    assert!(
        readme.contains(&format!("```rust\n{source}```\n")),
        "docs/firmware-example/src/lib.rs is shown as it is"
    );
}

/// A dependent of the core gets its DSP kernels: on thumbv7em always, on thumbv8m.main by a
/// feature; and those of Helium by another one. The README's package is built in the long form:
/// otherwise its code is read, and the kernels are looked for, in `tests/no-panic`.
#[test]
fn firmware_elsewhere_gets_the_kernels() {
    let cases: [(&str, &[&str], bool, bool); 4] = [
        ("thumbv7em-none-eabihf", &[], true, false),
        ("thumbv8m.main-none-eabihf", &["dsp"], true, false),
        ("thumbv8m.main-none-eabihf", &["helium"], true, true),
        ("thumbv8m.main-none-eabihf", &[], false, false),
    ];
    let processors = if is_long() { cases.len() } else { 1 };
    for (target, features, has_dsp, has_helium) in cases.into_iter().take(processors) {
        let Some(toolchain) = or_skip(Toolchain::for_target(target)) else { return };
        let library = if is_long() {
            core_objects(&toolchain, target, features)
        } else {
            std::fs::read(for_m7(&toolchain)).unwrap()
        };
        let found = [count(&library, is_usada8), count(&library, is_vabav)];
        for (found, has, most) in [(found[0], has_dsp, 20), (found[1], has_helium, 10)] {
            assert_eq!(found > most, has, "{target}, features {features:?}: {found}");
            assert!(has || found == 0, "{target}: {found}");
        }
    }
}
