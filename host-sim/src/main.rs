//! `linestereo`: sparse stereo depth on captured frames.
fn main() {}
