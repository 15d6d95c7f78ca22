//! Does nothing: cargo minds build dependencies, which ask for features of macros, only beside a
//! build script.

fn main() {}
