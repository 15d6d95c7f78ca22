//! linestereo on a board. The boards are not ported yet; on a PC this only says so, so that `--workspace` commands work.

fn main() {
    println!("linestereo-firmware has no board port yet; run the same core on a PC with `cargo run -p linestereo-sim`");
}
