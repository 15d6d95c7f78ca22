//! The functions of `fuzz/`, on mutations of its corpora by a seeded generator: what a
//! coverage-guided run would find first.

use core::time::Duration;
use linestereo_tests::drawn::Random;
use linestereo_tests::fuzz::TARGETS;
use std::fs;
use std::path::Path;
use std::time::Instant;

/// Time for each function; `LINESTEREO_FUZZ_S` gives another.
const EACH: Duration = Duration::from_millis(500);
/// Of the generator.
const SEED: u64 = 20;
/// No input may take so long.
const HANG: Duration = Duration::from_secs(10);

/// Changes bytes, cuts, repeats, or puts a part of another input in.
fn mutated(inputs: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let pick = |random: &mut Random| &inputs[random.below(inputs.len() as u64) as usize];
    let mut bytes = pick(random).clone();
    for _ in 0..=random.below(6) {
        let length = bytes.len() as u64;
        let [from, to] = [0; 2].map(|_: u8| random.below(length + 1) as usize);
        let part = from.min(to)..from.max(to);
        match random.below(7) {
            _ if bytes.is_empty() => bytes.push(random.bits() as u8),
            0 => bytes[random.below(length) as usize] ^= 1 << random.below(8),
            1 => bytes[random.below(length) as usize] = random.bits() as u8,
            2 => {
                bytes[random.below(length) as usize] =
                    *b"0-9.e,[{\xff\x80 \n".get(random.below(13) as usize).unwrap_or(&0)
            }
            3 => _ = bytes.drain(part),
            4 => bytes.splice(from..from, bytes[part].to_vec()).for_each(drop),
            5 => {
                let other = pick(random);
                let end = random.below(other.len() as u64 + 1) as usize;
                bytes
                    .splice(part, other[end.saturating_sub(16)..end].iter().copied())
                    .for_each(drop);
            }
            _ => bytes.truncate(from),
        }
    }
    bytes
}

#[test]
fn mutated_inputs_are_answered_or_refused() {
    let each = std::env::var("LINESTEREO_FUZZ_S")
        .ok()
        .map_or(EACH, |s| Duration::from_secs(s.parse().expect("seconds")));
    for (name, target) in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(name);
        let mut files: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        let inputs: Vec<Vec<u8>> = files.iter().map(|path| fs::read(path).unwrap()).collect();
        inputs.iter().for_each(|bytes| target(bytes));
        let (mut random, begin) = (Random(SEED), Instant::now());
        let (mut count, mut length, mut slowest) = (0, 0, Duration::ZERO);
        while begin.elapsed() < each {
            let bytes = mutated(&inputs, &mut random);
            let start = Instant::now();
            // A panic says for which bytes.
            let outcome = std::panic::catch_unwind(|| target(&bytes));
            slowest = slowest.max(start.elapsed());
            assert!(
                outcome.is_ok(),
                "{name}, input {count}: {:?}",
                String::from_utf8_lossy(&bytes)
            );
            count += 1;
            length += bytes.len();
        }
        println!(
            "{name}: {} examples, {count} inputs, {length} bytes, the slowest {} ms",
            inputs.len(),
            slowest.as_millis()
        );
        assert!(slowest < HANG, "{name}: an input takes {slowest:?}");
    }
}
