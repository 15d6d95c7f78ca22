//! Running other programs: with a time limit, with their output caught, and with errors that say
//! what to do.

use anyhow::{Context, Result, anyhow, bail};
use core::time::Duration;
use std::io::Read;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Instant;

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
pub(crate) fn wait(child: &mut Child, limit: Duration) -> Result<ExitStatus> {
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
