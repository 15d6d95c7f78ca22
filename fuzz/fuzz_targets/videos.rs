#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = linestereo_tests::fuzz::footage("y4m", bytes);
});
