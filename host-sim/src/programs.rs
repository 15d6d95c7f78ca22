//! Other programs of this machine: run with a time limit, with their output caught and with errors
//! that say what to do. Debian's packages are installed where a program is missing, only for root.

use crate::output::tell;
use anyhow::{Context, Result, anyhow, bail};
use core::time::Duration;
use std::io::Read;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Longest installation.
const LIMIT: Duration = Duration::from_secs(600);

/// Outcome of a program: status and output.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) status: ExitStatus,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

/// Runs a program to its end; one that takes longer than `limit` is ended and is an error.
pub(crate) fn run(command: &mut Command, limit: Duration) -> Result<Outcome> {
    let name = command.get_program().to_string_lossy().into_owned();
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().with_context(|| format!("cannot start {name}"))?;
    let stdout = read_all(child.stdout.take());
    let stderr = read_all(child.stderr.take());
    let status = wait(&mut child, limit).with_context(|| format!("{name} did not end"))?;
    let all = |reader: std::thread::JoinHandle<Vec<u8>>| {
        reader.join().map_err(|_| anyhow!("cannot read from {name}"))
    };
    Ok(Outcome {
        status,
        stdout: all(stdout)?,
        stderr: String::from_utf8_lossy(&all(stderr)?).into_owned(),
    })
}

fn read_all(pipe: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            let _ = pipe.read_to_end(&mut bytes); // what came until then counts
        }
        bytes
    })
}

/// Waits for the end of a program, and ends it when it takes too long.
fn wait(child: &mut Child, limit: Duration) -> Result<ExitStatus> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            bail!("stopped after {} s", limit.as_secs());
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The first line that the program wrote to stdout, when it ran and succeeded.
pub(crate) fn first_line(command: &mut Command) -> Option<String> {
    let outcome =
        run(command, Duration::from_secs(60)).ok().filter(|outcome| outcome.status.success())?;
    String::from_utf8(outcome.stdout).ok()?.lines().next().map(str::to_owned)
}

/// Installs packages, or says how a user does it.
pub(crate) fn install(what_for: &str, packages: &[&str]) -> Result<()> {
    let list = packages.join(" ");
    if first_line(Command::new("id").arg("-u")).as_deref() != Some("0") {
        bail!("{what_for} needs {list}; install: sudo apt-get install {list}");
    }
    // One at a time: apt-get refuses to work beside another one, and what one caller has installed
    // the next one finds.
    static INSTALLING: Mutex<()> = Mutex::new(());
    let _installing = INSTALLING.lock().unwrap_or_else(PoisonError::into_inner);
    tell(&format!("installing {list}"));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command
            .args(["-qq", "-o", "DPkg::Lock::Timeout=600"])
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive");
        run(&mut command, LIMIT).is_ok_and(|outcome| outcome.status.success())
    };
    let mut arguments = vec!["install", "-y", "--no-install-recommends"];
    arguments.extend(packages);
    if apt(&arguments) || (apt(&["update"]) && apt(&arguments)) {
        return Ok(());
    }
    bail!("{what_for} needs {list}, which apt-get cannot install here; install them by hand")
}
