//! Debian's packages: where neither rustup nor an installed program helps, and only for root.

use super::process;
use anyhow::{Result, bail};
use core::time::Duration;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

const LIMIT: Duration = Duration::from_secs(600);

/// Installs packages, or says how a user does it.
pub(crate) fn install(what_for: &str, packages: &[&str]) -> Result<()> {
    let list = packages.join(" ");
    if process::first_line(Command::new("id").arg("-u")).as_deref() != Some("0") {
        bail!("{what_for} needs {list}; install: sudo apt-get install {list}");
    }
    // One at a time: apt-get refuses to work beside another one, and what one caller has installed
    // the next one finds.
    static INSTALLING: Mutex<()> = Mutex::new(());
    let _installing = INSTALLING.lock().unwrap_or_else(PoisonError::into_inner);
    eprintln!("installing {list}");
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command
            .args(["-qq", "-o", "DPkg::Lock::Timeout=600"])
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive");
        process::run(&mut command, LIMIT).is_ok_and(|outcome| outcome.status.success())
    };
    let mut arguments = vec!["install", "-y", "--no-install-recommends"];
    arguments.extend(packages);
    if apt(&arguments) || (apt(&["update"]) && apt(&arguments)) {
        return Ok(());
    }
    bail!("{what_for} needs {list}, which apt-get cannot install here; install them by hand")
}
