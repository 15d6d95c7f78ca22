//! The bench of thin things on captured scenes.

use crate::support::json;
use linestereo_tests::captured;

/// Of fences, stripes and walls that repeat next to nothing is said that is wrong, and bars are
/// still told.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn what_repeats_is_refused() {
    let Some(scenes) = captured::folder("middlebury2006_third") else { return };
    let report = json(&scenes, &["thin", ".", "--count", "60", "--seed", "4711", "--json", "-"]);
    let kinds = report["refused"].as_array().unwrap();
    let of = |name: &str| {
        let kind = kinds.iter().find(|kind| kind["name"].as_str().unwrap().starts_with(name));
        let with_bars = &kind.unwrap()["pixels"][1];
        let (said, wrong) = (with_bars[0].as_u64().unwrap(), with_bars[1].as_f64());
        let pairs = kind.unwrap()["pairs"].as_u64().unwrap();
        (said, said as f64 * wrong.unwrap_or(0.0) / 100.0, pairs)
    };
    for name in ["fences", "striped walls", "wallpaper"] {
        let (said, wrong, pairs) = of(name);
        println!("{name}: {said} pixels, {wrong:.0} wrong, in {pairs} pairs");
        // With edges that repeat (`matching::repetition`) it would be 176 a fence, 290 a wallpaper.
        assert!(pairs >= 8 && wrong <= 100.0 * pairs as f64, "{name}: {wrong} in {pairs} pairs");
    }
    let (said, wrong, pairs) = of("two or three equal legs");
    assert!(said >= 500 * pairs && wrong * 100.0 <= said as f64, "{said} {wrong} {pairs}");
}
