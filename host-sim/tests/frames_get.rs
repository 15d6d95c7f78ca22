//! `frames get` where packages cannot be brought: what it says, and what works without a network.

use crate::support::{Folder, all_refused, failed, program, says};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Output;

/// `frames get` on a machine that has these programs alone.
fn get(folder: &Path, programs: &[(&str, &str)]) -> Output {
    let bin = folder.join("bin");
    fs::create_dir_all(&bin).unwrap();
    for (name, script) in programs {
        let path = bin.join(name);
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    program(folder, "frames get --out got").env("PATH", &bin).output().unwrap()
}

#[test]
fn without_a_network_it_says_what_to_do() {
    let folder = Folder::new();
    let output = get(
        folder.path(),
        &[("python3", "echo 'WARNING: retrying' >&2; echo 'ERROR: no route to host' >&2; exit 1")],
    );
    let words = [
        "2 of 2 packages could not be fetched: scikit-image (ERROR: no route to host), stereodemo (",
        "connect this machine",
        "pip download --no-deps \"scikit-image>=0.14,<0.27\"",
        "--from",
    ];
    says(&failed(&output), &words);
    assert!(!folder.path().join("got").exists());
}

#[test]
fn without_clients_it_says_so() {
    let folder = Folder::new();
    let line = failed(&get(folder.path(), &[]));
    says(&line, &["no pip on this machine", "--from"]);
}

#[test]
fn a_package_that_was_tampered_with_is_refused() {
    let folder = Folder::new();
    // A registry that serves something else under the right name.
    let serve = "for last; do :; done; while [ $# -gt 0 ]; do [ \"$1\" = --dest ] && to=$2; shift; done; echo evil > \"$to/x-1.whl\"";
    let output = get(folder.path(), &[("python3", serve)]);
    let words = ["scikit-image (", "x-1.whl is no readable package", "stereodemo ("];
    says(&failed(&output), &words);
    assert_eq!(fs::read_dir(folder.path().join("got")).unwrap().count(), 0);
}

#[test]
fn package_files_are_told_by_their_names() {
    let folder = Folder::new();
    let cases = [
        ("frames get --from numpy-2.whl", "none of the packages scikit-image, stereodemo"),
        (
            "frames get --from stereodemo-0.7-py3-none-any.whl",
            "cannot read stereodemo-0.7-py3-none-any.whl",
        ),
    ];
    all_refused(folder.path(), &cases);
}
