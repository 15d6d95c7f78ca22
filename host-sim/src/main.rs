//! `linestereo`: sparse stereo depth on captured frames.

use std::process::ExitCode;

fn main() -> ExitCode {
    linestereo_sim::commands::main()
}
