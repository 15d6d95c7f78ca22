//! The bench of damaged pairs on the captured scoring set.

use crate::support::json;
use linestereo_tests::captured;

/// Promise for damages that a pair can show: wrong answers at most 1 %, far off at
/// most 0.3 %, and this not by silence.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_answers_under_damage_are_right_or_refused() {
    let Some(qvga) = captured::folder("qvga") else { return };
    let report = json(&qvga, &["faults", ".", "--json", "-"]);
    let of = |tally: &serde_json::Value, key: &str| tally[key].as_u64().unwrap();
    let shown = &report["shown_by_a_pair"];
    let [answers, wrong, far_off] = ["answers", "wrong", "far_off"].map(|key| of(shown, key));
    println!("{answers} answers, {wrong} wrong, {far_off} far off");
    assert!(answers >= 3000, "{answers}");
    assert!(
        wrong * 100 <= answers && far_off * 1000 <= answers * 3,
        "{wrong}, {far_off} of {answers}: {shown}"
    );
    let undamaged = &report["damages"][0];
    assert_eq!(["refused", "wrong"].map(|key| of(undamaged, key)), [0, 0], "{undamaged}");
    assert!(of(undamaged, "answers") >= 88, "{undamaged}");
}
