//! The report page in a browser: what it shows is what the run gave. Without a browser these tests
//! say so and pass.

use crate::support::{pole, says, with_file};
use linestereo::{Area, Dims, Params, Rig, results::Rejection};
use linestereo_frames::GrayImage;
use linestereo_frames::regions::{Object, Pixels};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::explain::{CurveLog, Rejected, TestTexts};
use linestereo_sim::report::browser::Browser;
use linestereo_sim::report::{Page, PageFrame, PageSetup};
use linestereo_sim::results::listing;
use linestereo_sim::scene::Kind;
use linestereo_tests::browser::browser;
use linestereo_tests::drawn::rendered;
use std::collections::BTreeMap;

const DIMS: Dims = Dims { width: 320, height: 240 };

struct Run {
    images: [GrayImage; 2],
    result: FrameResult,
    rejected: Vec<Rejected>,
    objects: Vec<(Object, listing::Object)>,
    tests: TestTexts,
}

fn run(seed: u64) -> Run {
    let rendering = rendered(Kind::Boxes, DIMS, 1.0, seed);
    run_of([rendering.left, rendering.right])
}

fn run_of(images: [GrayImage; 2]) -> Run {
    let rig = Rig::new(300.0, 0.1, 0.0).unwrap();
    let params = Params { rig: Some(rig), ..Params::default() };
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let mut log = CurveLog::outcomes_only();
    let views = (images[0].view().unwrap(), images[1].view().unwrap());
    let result = engine.run_next(views, None, &mut log).unwrap();
    let rejected = log.rejected(engine.matched().candidates());
    let area = Area { left: 40, top: 30, right: 200, bottom: 200 };
    let object = Object { label: 5, name: Some("<box>".to_owned()), pixels: Pixels::Box(area) };
    let found = engine.object(&object.region(DIMS).unwrap());
    let objects = vec![(object, listing::Object::new(5, &found, Some("<box>")))];
    let mut log = CurveLog::default();
    engine.run_observed(views.0, views.1, &mut log).unwrap();
    let tests = TestTexts::new(&log, &mut engine, &params, &result);
    Run { images, result, rejected, objects, tests }
}

#[test]
fn every_rejected_segment_is_logged_with_its_reason() {
    for seed in 1..4 {
        let run = run(seed);
        for reason in Rejection::ALL {
            let logged = run.rejected.iter().filter(|lost| lost.reason == reason).count();
            assert_eq!(
                logged,
                usize::from(run.result.counts.rejected(reason)),
                "seed {seed}, {}",
                reason.name()
            );
        }
        assert!(!run.rejected.is_empty() && !run.result.matches.is_empty());
    }
}

fn page(runs: &[Run]) -> String {
    let rig = Rig::new(300.0, 0.1, 0.0).unwrap().with_principal_point([159.5, 119.5]).unwrap();
    let mut page = Page::new(PageSetup { title: "two scenes".to_owned(), many: true });
    for (run, index) in runs.iter().zip(0..) {
        let Run { images, result, rejected, objects, tests } = run;
        page.push(&PageFrame {
            name: format!("frame {index}"),
            max_disparity: 64,
            rig: Some(rig),
            images,
            result,
            rejected,
            objects,
            tests,
        })
        .unwrap();
    }
    page.push_error("frame 2", "right.png is damaged");
    page.html().unwrap()
}

/// Steps of visitors: they move the pointer, press keys, push buttons, and write down what the page
/// says, a line each.
const TOOLS: &str = r##"
const notes = [];
const note = (name, value) => notes.push(`${name}: ${String(value).replace(/\s+/g, " ").trim()}`);
addEventListener("error", event => note("error", event.message));
const $ = id => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const field = name => document.querySelector(`[data-field="${name}"]`)?.textContent;
const move = (side, x, y, type = "pointermove", pointerType = "mouse") => {
  const rect = $(side).getBoundingClientRect(), [w, h] = data[0].size;
  const at = { clientX: rect.left + (x + 0.5) * rect.width / w, clientY: rect.top + (y + 0.5) * rect.height / h };
  $(side).dispatchEvent(new PointerEvent(type, { ...at, pointerType, bubbles: true }));
};
const key = (side, key) => $(side).dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const shown = kind => document.querySelectorAll(`#left svg .${kind}`).length;
const done = () => {
  const out = document.createElement("pre");
  out.id = "notes";
  out.textContent = notes.join("\n");
  document.body.append(out);
};
"##;

const VISITOR: &str = r##"
addEventListener("load", () => {
  note("summary", $("summary").textContent);
  note("left size", $("left").querySelector("img").naturalWidth + "x" + $("left").querySelector("img").naturalHeight);
  note("segments", `${shown("segment")} ${document.querySelectorAll("#right svg .segment").length}`);
  note("hint", $("details").textContent);
  // The middle of every segment is nearest to that segment, unless another crosses it there.
  let right = 0, both = 0;
  data[0].segments.forEach(([x0, y0, x1, y1, d0, d1], id) => {
    move("left", (x0 + x1) / 2, (y0 + y1) / 2);
    const left = document.querySelector("#details h3")?.textContent;
    move("right", (x0 + x1 - d0 - d1) / 2, (y0 + y1) / 2);
    right += left === `Segment ${id}`;
    both += document.querySelector("#details h3")?.textContent === `Segment ${id}`;
  });
  note("pointed", `${right} ${both}`);
  move("left", -400, -400, "pointerdown");
  note("nothing", $("details").textContent);
  key("left", "ArrowRight");
  note("first key", document.querySelector("#details h3").textContent);
  for (const name of ["disparity", "depth", "uncertainty", "confidence", "owner", "feature", "window", "census"]) note(name, field(name));
  note("tests", field("tests"));
  note("highlights", document.querySelectorAll(".chosen").length);
  key("right", "ArrowRight");
  note("second key", document.querySelector("#details h3").textContent);
  key("left", "Escape");
  note("escape", $("details").textContent);
  note("top", `${document.querySelectorAll("#top .segment").length} ${document.querySelectorAll("#top .ring").length > 0} ${document.querySelectorAll("#top .object").length}`);
  note("objects", $("objects").rows[1].textContent);
  $("show-rejected").click();
  note("rejected", shown("rejected"));
  const reason = data[0].rejected[0][4], setup = JSON.parse($("setup").textContent);
  document.querySelector(`[data-reason="${setup.reasons[reason][0]}"]`).click();
  note("one reason", `${setup.reasons[reason][0]} ${shown("rejected")}`);
  $("show-matched").click();
  const [x0, y0, x1, y1] = data[0].rejected[0];
  move("left", (x0 + x1) / 2, (y0 + y1) / 2, "pointerdown", "touch");
  note("why", $("details").textContent);
  $("show-matched").click();
  const slide = to => { $("frame").value = to; $("frame").dispatchEvent(new Event("input")); };
  slide(1);
  note("second", `${$("frame-name").textContent}; ${$("summary").textContent}`);
  $("next").click();
  note("third", `${$("error").textContent}; ${document.querySelector("main").hidden}`);
  $("next").click();
  note("again", `${$("frame-name").textContent}; ${document.querySelector("main").hidden}`);
  note("width", document.documentElement.scrollWidth <= innerWidth);
  note("requests", performance.getEntriesByType("resource").filter(entry => !entry.name.startsWith("data:")).length);
  done();
});
"##;

/// Points at every bar in both images, and goes to the first one by keys.
const VISITOR_OF_BARS: &str = r##"
addEventListener("load", () => {
  const { segments, bars } = data[0], title = () => document.querySelector("#details h3")?.textContent;
  note("summary", $("summary").textContent);
  note("bars", `${shown("outline")} ${document.querySelectorAll("#right svg .outline").length}`);
  let pointed = 0;
  bars.forEach(([x0, y0, x1, y1, width, d0, d1], id) => {
    move("left", (x0 + x1 + width) / 2, (y0 + y1) / 2);
    pointed += title() === `Bar ${id}`;
    move("left", -400, -400, "pointerdown");
    move("right", (x0 + x1 + width - d0 - d1) / 2, (y0 + y1) / 2);
    pointed += title() === `Bar ${id}`;
  });
  note("pointed", pointed);
  key("left", "Escape");
  for (let i = 0; i <= segments.length; i++) key("left", "ArrowRight");
  note("by keys", title());
  for (const name of ["disparity", "depth", "confidence", "width", "tests"]) note(name, field(name));
  $("show-matched").click();
  note("hidden", shown("outline"));
  done();
});
"##;

/// The notes of a visitor, by name.
fn visited(
    browser: &Browser,
    html: &str,
    visitor: &str,
    flags: &[&str],
) -> BTreeMap<String, String> {
    let script = format!("<script>{TOOLS}{visitor}</script></body>");
    let folder = with_file("page.html", html.replace("</body>", &script));
    let document = browser.document(&folder.path().join("page.html"), flags).unwrap();
    let notes = document
        .split_once("<pre id=\"notes\">")
        .map(|(_, rest)| rest.split("</pre>").next().unwrap());
    let notes =
        notes.unwrap_or_else(|| panic!("the visitor did not come to an end: {}", head(&document)));
    let plain = notes.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    let lines = plain.lines().filter_map(|line| line.split_once(": "));
    lines.map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
}

fn head(text: &str) -> String {
    text.chars().take(400).collect()
}

#[test]
fn a_visitor_sees_what_the_run_gave() {
    let Some(browser) = browser() else { return };
    let runs = [run(1), run(2)];
    let html = page(&runs);
    let Run { result, rejected, objects, .. } = &runs[0];
    // Also as narrow as a phone is.
    for flags in [&[][..], &["--window-size=500,1200"]] {
        let notes = visited(&browser, &html, VISITOR, flags);
        let said = |name: &str| notes[name].as_str();
        assert!(!notes.contains_key("error"), "{notes:?}");
        let counts = |result: &FrameResult| {
            let counts = &result.counts;
            format!(
                "{} of {} segments matched, {} points, {} bars",
                counts.matched,
                counts.segments_left,
                counts.points,
                result.bars.len()
            )
        };
        assert!(said("summary").ends_with(&counts(result)), "{notes:?}");
        assert_eq!(said("left size"), "320x240");
        let matched = result.matches.len();
        assert_eq!(said("segments"), format!("{matched} {matched}"));
        assert!(said("hint").starts_with("Point at a segment"));
        let pointed: Vec<usize> =
            said("pointed").split(' ').map(|count| count.parse().unwrap()).collect();
        assert!(
            pointed.iter().all(|&count| count <= matched && 10 * count >= 9 * matched),
            "{pointed:?} of {matched}"
        );
        assert_eq!((said("nothing"), said("escape")), (said("hint"), said("hint")));
        assert_eq!((said("first key"), said("second key")), ("Segment 0", "Segment 1"));

        let first = &result.matches[0];
        let range = |values: [f64; 2], text: &dyn Fn(f64) -> String| match values.map(text) {
            [a, b] if a == b => a,
            [a, b] => format!("{a} to {b}"),
        };
        let px = |value: f64| format!("{value:.2} px");
        assert_eq!(
            close(said("disparity")),
            close(&range(first.disparity.map(|d| d.to_num()), &px))
        );
        let metres = |value: f64| format!("{value:.3} m");
        assert_eq!(
            close(said("depth")),
            close(&range(first.depth.unwrap().map(|z| z.to_num()), &metres))
        );
        let sure = (first.confidence.to_num::<f64>() * 1e3).round() / 1e3;
        let percent =
            if sure > 0.999 { "above 99.9 %".to_owned() } else { format!("{:.1} %", 100.0 * sure) };
        assert_eq!(said("confidence"), percent);
        let tests =
            runs[0].tests.of(first.ends).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            tests.starts_with("search disparities ") && said("tests") == tests,
            "{tests}: {notes:?}"
        );
        assert!(said("uncertainty").starts_with("± ") && said("uncertainty").ends_with(" m"));
        assert_eq!(close(said("window")), close(&px(first.techniques.window.to_num())));
        assert_eq!(close(said("census")), close(&px(first.techniques.census.to_num())));
        assert!(
            ["left side", "right side", "both sides", "above", "below"].contains(&said("owner"))
        );
        assert_eq!(said("highlights"), "3"); // both images and from above

        let placed = result.matches.iter().filter(|found| found.depth.is_some()).count();
        let top: Vec<&str> = said("top").split(' ').collect();
        assert!(top[0].parse::<usize>().unwrap() * 10 >= placed * 9, "{top:?}");
        assert_eq!(
            (top[1], top[2]),
            ("true", if objects[0].1.depth_m.is_some() { "1" } else { "0" })
        );
        assert!(said("objects").starts_with("<box>"), "{}", said("objects"));

        assert_eq!(said("rejected"), rejected.len().to_string());
        let reason = rejected[0].reason;
        assert_eq!(
            said("one reason"),
            format!("{} {}", reason.name(), result.counts.rejected(reason))
        );
        assert!(
            said("why").starts_with(&format!("Rejected: {}", reason.name().replace('_', " "))),
            "{}",
            said("why")
        );
        assert_eq!(said("second").split("; ").next(), Some("2 of 3: frame 1"));
        assert!(said("second").ends_with(&counts(&runs[1].result)));
        assert_eq!(said("third"), "right.png is damaged; true");
        assert_eq!(said("again"), "1 of 3: frame 0; false");
        assert_eq!((said("width"), said("requests")), ("true", "0"));
    }
}

#[test]
fn a_visitor_sees_bars() {
    let Some(browser) = browser() else { return };
    let run = run_of(pole(5, 24, 2));
    let bars = &run.result.bars;
    let notes = visited(&browser, &page(core::slice::from_ref(&run)), VISITOR_OF_BARS, &[]);
    let said = |name: &str| notes[name].as_str();
    assert!(!bars.is_empty() && !notes.contains_key("error"), "{notes:?}");
    assert!(said("summary").ends_with(&format!(" points, {} bars", bars.len())), "{notes:?}");
    assert_eq!(said("bars"), format!("{0} {0}", bars.len()));
    // In both images, unless a segment or another bar crosses it there.
    let pointed: usize = said("pointed").parse().unwrap();
    assert!(pointed <= 2 * bars.len() && 5 * pointed >= 8 * bars.len(), "{notes:?}");
    assert_eq!((said("by keys"), said("hidden")), ("Bar 0", "0"));
    let disparity: f64 = said("disparity").split(' ').next().unwrap().parse().unwrap();
    assert!((disparity - 24.0).abs() <= 1.0, "{notes:?}");
    // 300 px and 0.1 m.
    let depth: f64 = said("depth").split(' ').next().unwrap().parse().unwrap();
    assert!((depth * disparity - 30.0).abs() < 0.1, "{notes:?}");
    assert_eq!(close(said("width")), close(&format!("{:.2}", bars[0].width())));
    let tests: Vec<&str> = run.tests.of_bar(&bars[0]).unwrap().split_whitespace().collect();
    assert_eq!(said("tests"), tests.join(" "));
    assert!(said("tests").contains("probability passed"), "{notes:?}");
}

/// Numbers of a text to one decimal: halves are rounded one way here and the other way there.
fn close(text: &str) -> Vec<String> {
    let numbers = text.split(' ').filter_map(|word| word.parse::<f64>().ok());
    numbers.map(|number| format!("{:.1}", number + 1e-3)).collect()
}

#[test]
fn a_page_without_a_rig_says_what_is_missing() {
    let Some(browser) = browser() else { return };
    let Run { images, mut result, rejected, .. } = run(3);
    result.matches.iter_mut().for_each(|found| (found.depth, found.depth_sigma) = (None, None));
    let mut page = Page::new(PageSetup { title: "pair".to_owned(), many: false });
    page.push(&PageFrame {
        name: "pair".to_owned(),
        max_disparity: 64,
        rig: None,
        images: &images,
        result: &result,
        rejected: &rejected,
        objects: &[],
        tests: &TestTexts::default(),
    })
    .unwrap();
    let folder = with_file("page.html", page.html().unwrap());
    let document = browser.document(&folder.path().join("page.html"), &[]).unwrap();
    let words = ["Metres need a rig", "Point at a segment", "<h1 id=\"title\">pair</h1>"];
    says(&document, &words);
}
