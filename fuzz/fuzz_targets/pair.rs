#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| linestereo_tests::fuzz::pair(bytes));
