//! Files of detectors: every form gives the same regions, and what is wrong with one object costs
//! nothing else.

use crate::support::says;
use linestereo::{Area, Dims, image::Span, objects::Run};
use linestereo_frames::regions::{
    Frame, MAX_OBJECTS, Object, Objects, ObjectsError, Pixels, Skipped, load,
};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const GIVEN: Dims = Dims { width: 40, height: 20 };

fn frame(matched: Dims) -> Frame<'static> {
    Frame { given: GIVEN, matched, image: Some(Path::new("left.png")) }
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, contents).unwrap();
        path
    }

    fn load(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<Objects, ObjectsError> {
        load(&self.file(name, contents), None, frame(GIVEN))
    }
}

fn boxed(left: u16, top: u16, right: u16, bottom: u16) -> Pixels {
    Pixels::Box(Area { left, top, right, bottom })
}

/// The pixels as a drawing of the whole image.
fn drawn(object: &Object, dims: Dims) -> String {
    let region = object.region(dims).unwrap();
    let row =
        |y| (0..dims.width).map(move |x| if region.contains(x.into(), y) { '#' } else { '.' });
    (0..i32::from(dims.height)).flat_map(|y| row(y).chain(['\n'])).collect()
}

#[test]
fn boxes_are_the_same_in_every_form() {
    let folder = Folder::new();
    let expected = [(0, boxed(4, 5, 14, 15)), (1, boxed(20, 0, 40, 10))];
    folder.file("classes.txt", "cup\nbook\n");
    let files = [
        (
            "annotations.json",
            r#"{"images": [{"id": 7, "file_name": "x/left.png", "width": 40, "height": 20}, {"id": 8, "file_name": "other.png"}],
                "categories": [{"id": 1, "name": "cup"}, {"id": 2, "name": "book"}],
                "annotations": [{"image_id": 7, "category_id": 1, "bbox": [4, 5, 10, 10]},
                                {"image_id": 8, "category_id": 1, "bbox": [0, 0, 5, 5]},
                                {"image_id": 7, "category_id": 2, "bbox": [20, 0, 20, 10], "segmentation": []}]}"#,
        ),
        (
            "results.json",
            r#"[{"image_id": 3, "category_id": 1, "bbox": [4, 5, 10, 10], "score": 0.5},
                {"image_id": 3, "category_id": 2, "bbox": [20, 0, 20, 10], "score": 0.5}]"#,
        ),
        ("yolo.txt", "0 0.225 0.5 0.25 0.5\n\n1 0.75 0.25 0.5 0.5 0.9\n"),
        ("tracked.txt", "0 0.225 0.5 0.25 0.5 0.8 1\n1 0.75 0.25 0.5 0.5 0.9 7\n"),
        ("table.csv", "name, x0,y0,x1,y1\ncup, 4,5,14,15\nbook,20,0,40,10\n"),
        ("plain.csv", "4,5,14,15,0,cup\n20,0,40,10,1,book\n"),
        (
            "own.json",
            r#"{"objects": [{"name": "cup", "box": [4, 5, 14, 15]}, {"name": "book", "box": [20, 0, 40, 10]}]}"#,
        ),
    ];
    for (name, contents) in files {
        let objects = folder.load(name, contents).unwrap();
        let found: Vec<_> =
            objects.list.iter().map(|object| (object.label, object.pixels.clone())).collect();
        assert_eq!(found, expected, "{name}");
        assert_eq!(objects.skipped, Skipped::default(), "{name}");
        let names: Vec<_> = objects.list.iter().map(|object| object.name.as_deref()).collect();
        let expected =
            if name == "results.json" { [None, None] } else { [Some("cup"), Some("book")] };
        assert_eq!(names, expected, "{name}");
    }
}

#[test]
fn a_plain_table_may_lack_labels() {
    let [plain, named] = ["", "x0,y0,x1,y1,label,name\n"]
        .map(|head| Folder::new().load("a.csv", format!("{head}4,5,14,15,7,cup\n20,0,40,10\n")));
    let (plain, named) = (plain.unwrap(), named.unwrap());
    // A detector that found nothing.
    assert_eq!(Folder::new().load("a.csv", "").unwrap(), Objects::default());
    assert_eq!(plain.list, named.list);
    assert_eq!((plain.list[0].label, plain.list[0].name.as_deref()), (7, Some("cup")));
}

#[test]
fn masks_are_the_same_in_every_form() {
    let folder = Folder::new();
    // Columns 3 and 4, rows 2 to 5, of 40x20: 62 before, 4, 16 between, 4, the rest.
    let counts = "[62, 4, 16, 4, 714]";
    let label = |value: u16| {
        let (width, height) = (u32::from(GIVEN.width), u32::from(GIVEN.height));
        let inside = |x, y| (3..5).contains(&x) && (2..6).contains(&y);
        image_of(width, height, move |x, y| if inside(x, y) { value } else { 0 })
    };
    let mut drawings = Vec::new();
    let files = [
        ("a.json", coco_mask(counts)),
        ("b.json", coco_mask("\"n14`00je0\"")),
        ("c.json", r#"[{"segmentation": [[3, 2, 5, 2, 5, 6, 3, 6]]}]"#.to_owned()),
    ];
    for (name, contents) in files {
        let objects = folder.load(name, contents).unwrap();
        assert_eq!(
            (objects.list.len(), objects.skipped.objects()),
            (1, 0),
            "{name}: {:?}",
            objects.skipped
        );
        assert_eq!(objects.list[0].label, 0);
        drawings.push(drawn(&objects.list[0], GIVEN));
    }
    for value in [3, 40_000] {
        let objects = folder.load("mask.png", label(value)).unwrap();
        assert_eq!(objects.list.len(), 1);
        assert_eq!(objects.list[0].label, value);
        drawings.push(drawn(&objects.list[0], GIVEN));
    }
    let row = |inside| {
        if inside { format!("...##{}\n", ".".repeat(35)) } else { format!("{}\n", ".".repeat(40)) }
    };
    let expected: String = (0..20).map(|y| row((2..6).contains(&y))).collect();
    for drawing in drawings {
        assert_eq!(drawing, expected);
    }
}

fn labels(objects: &Objects) -> Vec<u16> {
    objects.list.iter().map(|object| object.label).collect()
}

fn coco_mask(counts: &str) -> String {
    format!(
        r#"[{{"segmentation": {{"size": [20, 40], "counts": {counts}}}, "bbox": [0, 0, 1, 1]}}]"#
    )
}

/// A 16-bit PGM.
fn image_of(width: u32, height: u32, value: impl Fn(u32, u32) -> u16) -> Vec<u8> {
    let mut bytes = format!("P5\n{width} {height}\n65535\n").into_bytes();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    bytes.extend(pixels.flat_map(|(x, y)| value(x, y).to_be_bytes()));
    bytes
}

#[test]
fn boxes_and_masks_follow_the_image() {
    let folder = Folder::new();
    let half = Dims { width: 20, height: 10 };
    let load = |name: &str, contents: &[u8]| {
        load(&folder.file(name, contents), None, frame(half)).unwrap()
    };
    let objects = load("a.csv", b"x0,y0,x1,y1\n4,5,14,15\n6,6,6.2,6.2\n39.9,19.9,50,50\n");
    let pixels: Vec<_> = objects.list.into_iter().map(|object| object.pixels).collect();
    // To the nearest border; what has an area keeps a pixel.
    assert_eq!(pixels, [boxed(2, 3, 7, 8), boxed(3, 3, 4, 4), boxed(19, 9, 20, 10)]);
    let mask = image_of(40, 20, |x, y| u16::from((4..8).contains(&x) && y == 3) * 9);
    let expected = [Object {
        label: 9,
        name: None,
        pixels: Pixels::Mask(vec![Run { label: 9, y: 1, span: Span { start: 2, end: 4 } }]),
    }];
    assert_eq!(load("mask.png", &mask).list, expected);
    // A mask of the image as matched is taken as it is.
    let mask = image_of(20, 10, |x, y| u16::from((2..4).contains(&x) && y == 1) * 9);
    assert_eq!(load("mask.png", &mask).list, expected);
}

#[test]
fn what_is_wrong_with_one_object_skips_it() {
    let folder = Folder::new();
    let table = "x0,y0,x1,y1,label\n1,1,5,5,8\n40,0,50,9,\n-9,0,0,9,\n3,3,3,9,\n5,3,2,9,\n1,2,x,4,\n1,2\nNaN,1,2,3,\n1,1,9,9,70000\n2,2,4,4,\n";
    let objects = folder.load("a.csv", table).unwrap();
    assert_eq!(labels(&objects), [8, 9]);
    assert_eq!(
        objects.skipped,
        Skipped { outside: 2, empty: 2, unreadable: 4, ..Skipped::default() }
    );
    assert_eq!(
        objects.skipped.summary(),
        "objects skipped: 2 outside of the image, 2 without area, 4 unreadable\n"
    );
    let first = |name: &str, text: &str| folder.load(name, text).unwrap().first_skipped.unwrap();
    let outside = "line 3: it lies outside of the left image, which is 40x20; give pixels";
    says(&first("a.csv", table), &[outside]);
    says(&first("b.csv", "0.1,0.1,0.4,0.5\n"), &["line 1: its numbers are shares of the image"]);
    says(&first("a.txt", "0 0.5 0.5 0.1 0.1\n\n0 20 10 4 4\n"), &["line 3: ", "give shares of"]);
    says(&first("a.json", "[{\"bbox\": [1, 1, 0, 5]}]"), &["object 0: it has no area"]);

    let masks = [
        r#"[62, 4, 16, 4, 713]"#, r#"[62, 4, 9999]"#, r#""~~""#, r#"[-1, 801]"#, r#"{}"#,
        "[62, 4, 16, 4, 714]", "[800]",
    ];
    let list: Vec<String> =
        masks.map(|counts| coco_mask(counts).trim_matches(['[', ']']).to_owned()).into();
    let other_size = coco_mask("[800]").replace("[20, 40]", "[40, 20]");
    let json = format!("[{}, {}]", list.join(", "), other_size.trim_matches(['[', ']']));
    let objects = folder.load("a.json", &json).unwrap();
    assert_eq!(labels(&objects), [5], "{json}");
    assert_eq!(
        objects.skipped,
        Skipped { broken_mask: 5, empty: 1, mask_size: 1, ..Skipped::default() }
    );

    folder.file("classes.txt", "cup\n");
    let objects = folder
        .load("b.txt", "0 0.5 0.5 0.1 0.1\n7 0.5 0.5 0.1 0.1\n0 2 2 0.1 0.1\ncup 0.5 0.5 0.1 0.1\n0 0.1 0.1 0.9 0.1 0.9 0.9 0.8 12\n")
        .unwrap();
    assert_eq!(
        objects.list.iter().map(|object| object.name.as_deref()).collect::<Vec<_>>(),
        [Some("cup"), None]
    );
    assert_eq!(
        objects.skipped,
        Skipped { outside: 1, unreadable: 2, unknown_class: 1, ..Skipped::default() }
    );
    let json = r#"{"categories": [{"id": 1, "name": "cup"}], "annotations": [{"category_id": 2, "bbox": [1, 1, 5, 5]}]}"#;
    assert_eq!(
        folder.load("c.json", json).unwrap().skipped,
        Skipped { unknown_class: 1, ..Skipped::default() }
    );
}

#[test]
fn too_many_are_counted() {
    let folder = Folder::new();
    let table: String = "x0,y0,x1,y1\n".to_owned() + &"1,1,9,9\n".repeat(10_000);
    let objects = folder.load("a.csv", table).unwrap();
    assert_eq!((objects.list.len(), objects.skipped.too_many), (MAX_OBJECTS, 10_000 - MAX_OBJECTS));
}

#[test]
fn what_is_wrong_with_the_file_is_said() {
    let folder = Folder::new();
    let error = |name: &str, contents: &str| folder.load(name, contents).unwrap_err().to_string();
    for (name, contents, part) in [
        ("a.json", "{\"annotations\": [", "EOF"),
        ("a.json", "{\"annotations\": 3}", "no list of annotations"),
        ("a.json", "3", "no list of annotations"),
        ("a.json", r#"{"annotations": [], "categories": [{"id": "x"}]}"#, "categories"),
        (
            "a.json",
            r#"[{"image_id": 1, "bbox": [1,1,2,2]}, {"image_id": 2, "bbox": [1,1,2,2]}]"#,
            "2 images",
        ),
        (
            "a.json",
            r#"{"images": [{"id": 1, "width": 80, "height": 40}], "annotations": [{"image_id": 1, "bbox": [1,1,2,2]}]}"#,
            "80x40",
        ),
        ("a.csv", "a,b\n1,2\n", "no column x0"),
        ("a.xml", "<a/>", "no known kind"),
        ("a.png", "no image", "not a readable image"),
    ] {
        says(&error(name, contents), &[part, name, "; "]);
    }
    let mask = image_of(41, 20, |_, _| 1);
    let error = load(&folder.file("mask.png", mask), None, frame(GIVEN)).unwrap_err();
    assert!(
        matches!(error, ObjectsError::MaskSize { mask: Dims { width: 41, height: 20 }, .. }),
        "{error}"
    );
    let error = load(Path::new("missing.json"), None, frame(GIVEN)).unwrap_err();
    assert!(matches!(error, ObjectsError::Read(..)), "{error}");
}
