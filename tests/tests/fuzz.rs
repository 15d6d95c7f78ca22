//! The functions of `fuzz/`, on mutations of its corpora by a seeded generator: what a
//! coverage-guided run would find first.

use core::time::Duration;
use linestereo_tests::drawn::Random;
use linestereo_tests::fuzz::{TARGETS, corpus, footage, mutated};
use std::time::Instant;

/// Time for each function; `LINESTEREO_FUZZ_S` gives another.
const EACH: Duration = Duration::from_millis(500);
/// Of the generator.
const SEED: u64 = 20;
/// No input may take so long.
const HANG: Duration = Duration::from_secs(10);

#[test]
fn examples_of_recordings_and_videos_are_read() {
    for (name, ending) in [("recordings", "mcap"), ("videos", "y4m")] {
        let pairs: Vec<_> = corpus(name).iter().map(|bytes| footage(ending, bytes)).collect();
        assert!(pairs.iter().all(|pairs| matches!(pairs, Ok(2))), "{name}: {pairs:?}");
    }
}

#[test]
fn mutated_inputs_are_answered_or_refused() {
    let each = std::env::var("LINESTEREO_FUZZ_S")
        .ok()
        .map_or(EACH, |s| Duration::from_secs(s.parse().expect("seconds")));
    for (name, target) in TARGETS {
        let inputs = corpus(name);
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
