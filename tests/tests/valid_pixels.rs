//! Pixels without a source: nothing is found there, nothing is claimed there, and what they hold
//! never matters.

use linestereo::image::{MARGIN, Span, ViewError, shrink_to_valid};
use linestereo::results::{Match, Point};
use linestereo::{Capacity, Dims, Gray, Options, Params, units::Confidence};
use linestereo_frames::GrayImage;
use linestereo_tests::drawn::{Random, painted, scenes};
use linestereo_tests::reference::at;
use linestereo_tests::{answers, run_alone};

const DIMS: Dims = Dims { width: 160, height: 120 };
type Memory = linestereo::Memory<{ Capacity::new(DIMS).words() }>;
type Spans = [Span; DIMS.height as usize];

/// Valid pixels of a turned camera: slanted borders left and right, empty rows at the top, fewer
/// pixels at the bottom.
fn turned(mirrored: bool) -> Spans {
    core::array::from_fn(|y| {
        let y = y as u16;
        let (cut, rest) = (12 + y / 6, if y < 7 { DIMS.width } else { y / 12 });
        let (cut, rest) = if mirrored { (rest, cut) } else { (cut, rest) };
        let start = cut.min(DIMS.width);
        Span { start, end: (DIMS.width - rest.min(DIMS.width)).max(start) }
    })
}

fn usable(content: &Spans) -> Spans {
    let mut spans = *content;
    shrink_to_valid(&mut spans, DIMS.width);
    spans
}

/// The image with everything outside of the spans replaced.
fn with_garbage(image: &GrayImage, content: &Spans, mut garbage: impl FnMut() -> u8) -> GrayImage {
    painted(DIMS.width, DIMS.height, |x, y| {
        let span = content[usize::from(y)];
        let is_valid = (span.start..span.end).contains(&x);
        if is_valid { at(image, x.into(), y.into()) as u8 } else { garbage() }
    })
}

fn run(left: Gray<'_>, right: Gray<'_>) -> (Vec<Match>, Vec<Point>) {
    let mut memory = Box::new(Memory::new());
    let params = Params {
        max_disparity: 48,
        min_confidence: Confidence::from_num(0.5),
        ..Params::default()
    };
    answers(&mut run_alone(&params, &mut memory, [left, right], Options::default()).unwrap())
}

#[test]
fn pixels_without_source_never_matter() {
    let contents = [turned(false), turned(true)];
    let spans = contents.map(|content| usable(&content));
    let mut random = Random(3);
    for rendering in scenes(DIMS) {
        let result = |garbage: &mut dyn FnMut() -> u8| {
            let left = with_garbage(&rendering.left, &contents[0], &mut *garbage);
            let right = with_garbage(&rendering.right, &contents[1], &mut *garbage);
            let [left_spans, right_spans] = &spans;
            run(
                left.view().unwrap().with_valid(left_spans).unwrap(),
                right.view().unwrap().with_valid(right_spans).unwrap(),
            )
        };
        let expected = result(&mut || 0);
        assert!(expected.0.len() > 10, "only {} matches: nothing is tested", expected.0.len());
        assert!(result(&mut || 255) == expected, "white pixels matter");
        assert!(result(&mut || random.grey()) == expected, "noise matters");
    }
}

#[test]
fn nothing_is_claimed_where_there_is_no_source() {
    let contents = [turned(false), turned(true)];
    let [left_spans, right_spans] = contents.map(|content| usable(&content));
    let within = |spans: &Spans, x: f64, y: f64| {
        let span = spans[(y.floor() as usize).min(spans.len() - 1)];
        (f64::from(span.start) - 0.51..f64::from(span.end) - 0.49).contains(&x)
    };
    let (mut total, mut without) = (0, 0);
    for rendering in scenes(DIMS) {
        let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
        let (all_matches, _) = run(left, right);
        let (matches, points) =
            run(left.with_valid(&left_spans).unwrap(), right.with_valid(&right_spans).unwrap());
        for found in &matches {
            for (end, d) in found.ends.iter().zip(found.disparity) {
                let (x, y) = (end.x.to_num::<f64>(), end.y.to_num::<f64>());
                assert!(within(&left_spans, x, y), "a match ends at ({x}, {y})");
                assert!(
                    within(&right_spans, x - d.to_num::<f64>(), y),
                    "a match leads to an unusable pixel"
                );
            }
        }
        for point in &points {
            let (x, y) = (f64::from(point.x), f64::from(point.y));
            assert!(
                within(&left_spans, x, y)
                    && within(&right_spans, x - point.disparity.to_num::<f64>(), y)
            );
        }
        total += matches.len();
        without += all_matches.len();
    }
    // The spans leave about three quarters of the common view; what lies well inside is still
    // found.
    assert!(total < without && total * 2 > without, "{total} of {without} matches");
}

#[test]
fn spans_of_the_whole_image_change_nothing() {
    let whole = [Span { start: 0, end: DIMS.width }; DIMS.height as usize];
    for rendering in scenes(DIMS) {
        let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
        let spanned = run(left.with_valid(&whole).unwrap(), right.with_valid(&whole).unwrap());
        assert!(run(left, right) == spanned);
    }
}

#[test]
fn an_image_without_usable_pixels_has_no_depth() {
    let none = [Span::default(); DIMS.height as usize];
    for rendering in scenes(DIMS) {
        let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
        for (left, right) in
            [(left.with_valid(&none).unwrap(), right), (left, right.with_valid(&none).unwrap())]
        {
            assert_eq!(run(left, right), (Vec::new(), Vec::new()));
        }
    }
}

#[test]
fn shrinking_keeps_what_has_content_all_around() {
    let margin = i32::from(MARGIN);
    let content = turned(false);
    let has_content = |x: i32, y: i32| {
        let inside =
            (0..i32::from(DIMS.width)).contains(&x) && (0..i32::from(DIMS.height)).contains(&y);
        let span = content.get(y as usize);
        !inside
            || span.is_some_and(|span| (i32::from(span.start)..i32::from(span.end)).contains(&x))
    };
    let spans = usable(&content);
    for y in 0..i32::from(DIMS.height) {
        for x in 0..i32::from(DIMS.width) {
            let span = spans[y as usize];
            let is_usable = (i32::from(span.start)..i32::from(span.end)).contains(&x);
            let surrounded = (-margin..=margin)
                .all(|dy| (-margin..=margin).all(|dx| has_content(x + dx, y + dy)));
            assert_eq!(is_usable, surrounded, "({x}, {y})");
        }
    }
}

#[test]
fn spans_that_are_none_are_refused() {
    let pixels = [0; DIMS.width as usize * DIMS.height as usize];
    let view = Gray::new(&pixels, DIMS, DIMS.width.into()).unwrap();
    let mut spans = [Span { start: 0, end: DIMS.width }; DIMS.height as usize];
    assert_eq!(
        view.with_valid(&spans[1..]).unwrap_err(),
        ViewError::Spans { rows: 120, given: 119 }
    );
    spans[3] = Span { start: 5, end: 4 };
    assert_eq!(view.with_valid(&spans).unwrap_err(), ViewError::Span { row: 3, span: spans[3] });
    spans[3] = Span { start: 5, end: DIMS.width + 1 };
    let message = view.with_valid(&spans).unwrap_err().to_string();
    assert_eq!(message, "the valid pixels 5 .. 161 of row 3 are no part of the image");
}
