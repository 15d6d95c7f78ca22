//! `linestereo-lab`: what judges the method. Users need none of it; the program for them is
//! `linestereo`.

use std::process::ExitCode;

fn main() -> ExitCode {
    linestereo_lab::commands::main()
}
