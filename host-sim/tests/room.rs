//! The depths that are told of the objects of the built-in room.

use linestereo_sim::commands::demo::{Demonstration, RoomObject};

/// Least mean number of answers a room: seven of its twelve objects are wide and textured.
const LEAST_ANSWERS: usize = 7;

/// Every answer about the objects of these rooms is right, at the object's centre and by its range, and the table says what is scored.
fn check(seeds: &[u64]) {
    let (mut answers, rooms) = (0, seeds.len());
    let mut worst = 0.0_f32;
    for &seed in seeds {
        let shown = Demonstration::new(seed, 1.0).unwrap();
        let told: Vec<_> = shown.objects.iter().filter_map(|object| Some((object, object.answer.ok()?))).collect();
        let unsure: Vec<_> =
            told.iter().filter(|(object, (_, probability))| object.is_wrong() || *probability < 0.9).collect();
        assert!(unsure.is_empty(), "seed {seed}: {unsure:?}");
        table_says_what_is_scored(&shown);
        answers += told.len();
        worst = told.iter().map(|(object, (at, _))| (at - object.true_at_centre).abs()).fold(worst, f32::max);
    }
    println!("{answers} answers in {rooms} rooms, at most {worst:.2} px off at the centre");
    assert!(answers > LEAST_ANSWERS * rooms, "{answers} answers prove little");
}

/// Rows, their numbers and the line below them are the scores.
fn table_says_what_is_scored(shown: &Demonstration) {
    let Demonstration { text, objects, .. } = shown;
    let rows = text.lines().skip_while(|line| !line.starts_with("object ")).skip(1).take_while(|line| !line.is_empty());
    let rows: Vec<&str> = rows.collect();
    assert_eq!(rows.len(), objects.len(), "{text}");
    for (row, object) in rows.iter().zip(objects) {
        let RoomObject { name, answer, true_at_centre, .. } = object;
        let numbers = row.strip_prefix(&**name).unwrap_or_else(|| panic!("{row:?} is of {name}"));
        assert_eq!(answer.is_err(), numbers.contains("no depth"), "{row}");
        if let Ok((disparity, _)) = answer {
            let said: Vec<&str> = numbers.split_whitespace().collect();
            assert_eq!(said[0], format!("{disparity:.2}"), "{row}");
            assert_eq!(said[2], format!("{true_at_centre:.2}"), "{row}");
            assert_eq!(object.is_wrong(), row.contains("wrong"), "{row}");
        }
    }
    let count = |is: &dyn Fn(&RoomObject) -> bool| objects.iter().filter(|object| is(object)).count();
    let answered = count(&|object| object.answer.is_ok());
    let line =
        format!("Objects:  {answered} of {} have a depth; {} of them", objects.len(), count(&RoomObject::is_wrong));
    assert!(text.contains(&line), "{line:?} is not in\n{text}");
}

/// The room that is shown, and rooms with an answer that was wrong before the core was mended: two of the slanted wall, and two of the small box
/// and one of the blank wall that are refused now.
#[test]
fn objects_of_rooms_have_their_depth_or_none() {
    check(&[1, 22, 31, 52, 96, 121]);
}

/// `cargo test --release -p linestereo-sim --test topics two_hundred -- --ignored --nocapture`: some 130 s of one core.
#[test]
#[ignore = "two hundred rooms are rendered: minutes"]
fn objects_of_two_hundred_rooms_have_their_depth_or_none() {
    check(&(1..=200).collect::<Vec<u64>>());
}
