//! The depths that are told of the objects of the built-in room.

use linestereo_sim::commands::demo::{Demonstration, RoomObject};

/// Least mean number of answers a room: seven of its twelve objects are wide and textured.
const LEAST_ANSWERS: usize = 7;

/// The room that is shown, and rooms that are hard: every answer about their objects is right, at
/// the object's centre and by its range, and the table says what is scored.
#[test]
fn objects_of_rooms_have_their_depth_or_none() {
    let (rooms, mut answers) = ([1, 22, 31, 52, 96, 121], 0);
    for seed in rooms {
        let shown = Demonstration::new(seed).unwrap();
        for (object, (_, probability)) in
            shown.objects.iter().filter_map(|object| Some((object, object.answer.ok()?)))
        {
            assert!(!object.is_wrong() && probability >= 0.9, "seed {seed}: {object:?}");
            answers += 1;
        }
        table_says_what_is_scored(&shown);
    }
    assert!(answers > LEAST_ANSWERS * rooms.len(), "{answers} answers prove little");
}

/// Rows, their numbers and the line below them are the scores.
fn table_says_what_is_scored(shown: &Demonstration) {
    let Demonstration { text, objects, .. } = shown;
    let rows = text
        .lines()
        .skip_while(|line| !line.starts_with("object "))
        .skip(1)
        .take_while(|line| !line.is_empty());
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
    let count =
        |is: &dyn Fn(&RoomObject) -> bool| objects.iter().filter(|object| is(object)).count();
    let answered = count(&|object| object.answer.is_ok());
    let line = format!(
        "Objects:  {answered} of {} have a depth; {} of them",
        objects.len(),
        count(&RoomObject::is_wrong)
    );
    assert!(text.contains(&line), "{line:?} is not in\n{text}");
}
