//! Pages in a browser without a window, and scripts of Node, for tests.

use linestereo_sim::report::browser::{Browser, VARIABLE};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// A page and its steps.
#[derive(Debug)]
pub struct Visit {
    /// State of the page after each step.
    pub found: Vec<Value>,
    /// Addresses that were fetched, and exceptions.
    pub logged: Vec<String>,
}

/// Says so where a tool is missing; the test ends there.
pub fn has(tool: &str) -> bool {
    let output = Command::new(tool).arg("--version").output();
    or_skipped(output.is_ok_and(|output| output.status.success()), tool)
}

/// The browser that is there; says so where none is.
pub fn browser() -> Option<Browser> {
    let browser = Browser::find();
    let name = format!("a browser (install chromium, or name one in {VARIABLE})");
    or_skipped(browser.is_some(), &name).then_some(browser)?
}

fn or_skipped(is_there: bool, tool: &str) -> bool {
    if !is_there {
        // Not by a macro: those are silent in tests that pass.
        let _ = writeln!(std::io::stderr(), "\nSKIPPED: {tool} is not installed\n");
    }
    is_there
}

/// Runs a script of `tests/web` in Node on a task.
///
/// # Panics
/// If Node cannot run it.
pub fn node(script: &str, task: &Value) -> Value {
    let mut command = Command::new("node");
    command
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/web").join(script))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped());
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(task.to_string().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Visits a page, a file or an address, with these flags of the browser.
///
/// # Panics
/// If the browser fails, or a step does not come to its end.
pub fn visit(browser: &Browser, page: &Path, flags: &[String], steps: &Value) -> Visit {
    let task = json!({"browser": browser.path(), "page": page, "flags": flags, "steps": steps});
    let mut done = node("visit.mjs", &task);
    let [found, logged] = ["found", "logged"].map(|name| done[name].take());
    Visit {
        found: serde_json::from_value(found).unwrap(),
        logged: serde_json::from_value(logged).unwrap(),
    }
}
