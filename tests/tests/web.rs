//! The page for browsers: its modules in Node and the page in a browser, against the PC's program,
//! byte for byte.

use super::c_library::{self, QVGA, RIG, expected, pairs};
use super::no_panic::packages;
use core::mem::MaybeUninit;
use image::{DynamicImage, ImageBuffer, Luma, LumaA, Pixel, Rgb, Rgba};
use linestereo::{Area, Capacity, Matcher, MemorySlice, Params, Region};
use linestereo_firmware::programs::kernels::Kernels;
use linestereo_frames::{GrayImage, PairFiles, area_average, load_images};
use linestereo_sim::report::browser::Browser;
use linestereo_tests::board::or_skip;
use linestereo_tests::browser::{Visit, browser, has, node, visit};
use linestereo_tests::drawn::Random;
use linestereo_tests::matched;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use xtask::web::{self, MOST_BYTES, WebPage};

const TESTS: &str = env!("CARGO_MANIFEST_DIR");

/// The page, built once; `None` where no compiler for it can be had, or no Node.
fn page() -> Option<&'static WebPage> {
    static PAGE: OnceLock<Option<WebPage>> = OnceLock::new();
    let build = || {
        let top = Path::new(TESTS).parent().unwrap();
        let folder = packages();
        std::fs::create_dir_all(&folder).unwrap();
        or_skip(web::build(top, &folder))
    };
    has("node").then(|| PAGE.get_or_init(build).as_ref())?
}

fn in_node(page: &WebPage, tasks: Vec<Value>) -> Vec<Value> {
    let source = Path::new(TESTS).join("../bindings/web/page").canonicalize().unwrap();
    let done = node(
        "pairs.mjs",
        &json!({"page": source, "matcher": page.matcher, "images": page.images, "tasks": tasks}),
    );
    done.as_array().unwrap().clone()
}

fn png(folder: &Path, name: &str, image: &GrayImage) -> PathBuf {
    let path = folder.join(name);
    let (width, height) = (image.dims.width.into(), image.dims.height.into());
    image::save_buffer(&path, &image.pixels, width, height, image::ColorType::L8).unwrap();
    path
}

/// Both files of each pair.
fn files(folder: &Path, pairs: &[(String, [GrayImage; 2])]) -> Vec<[PathBuf; 2]> {
    let write = |(name, [left, right]): &(String, [GrayImage; 2])| {
        [
            png(folder, &format!("{name}-left.png"), left),
            png(folder, &format!("{name}-right.png"), right),
        ]
    };
    pairs.iter().map(write).collect()
}

fn rig() -> Value {
    let [focal_px, baseline_m] = RIG.map(|text| text.parse::<f64>().unwrap());
    json!({"focal_px": focal_px, "baseline_m": baseline_m})
}

#[track_caller]
fn assert_equal(name: &str, found: &Value, expected: &str) {
    let text = found["text"].as_str().unwrap_or_else(|| panic!("{name}: {found}"));
    c_library::assert_equal(name, text.as_bytes(), expected);
}

#[test]
fn the_modules_in_node_give_the_bytes_of_the_program() {
    let Some(page) = page() else { return };
    let (pairs, folder) = (pairs(), tempfile::tempdir().unwrap());
    let tasks = files(folder.path(), &pairs).into_iter().map(
        |files| json!({"files": files, "width": 0, "out": folder.path().join("out"), "rig": rig()}),
    );
    let found = in_node(page, tasks.collect());
    for ((name, images), found) in pairs.iter().zip(&found) {
        assert_equal(name, found, &expected(images));
    }
}

#[test]
fn kernels_of_webassembly_equal_the_portable_ones() {
    if !has("node") {
        return;
    }
    let built = packages().join("cargo");
    let arguments = ["build", "--config", &web::vectors()];
    let top = Path::new(TESTS).parent().unwrap();
    let module =
        web::module(top, &built, "tests/wasm-kernels", "linestereo_wasm_kernels.wasm", &arguments);
    let Some(module) = or_skip(module) else { return };
    let found = node("kernels.mjs", &json!({"module": module}));
    let all = (1_u32 << Kernels::COUNT) - 1;
    assert_eq!(found, json!({"vectors": true, "count": Kernels::COUNT, "differing": [0, all]}));
}

/// An image of 70 x 41 pixels.
fn buffer<P: Pixel>(values: Vec<P::Subpixel>) -> DynamicImage
where
    DynamicImage: From<ImageBuffer<P, Vec<P::Subpixel>>>,
{
    ImageBuffer::from_raw(70, 41, values).unwrap().into()
}

/// PNG of every depth and number of channels, PGM and PPM, in two files, side by side and reduced.
#[test]
fn images_are_the_grey_of_the_program() {
    let Some(page) = page() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(7);
    let mut noise = |channels: u32, most: u16| -> Vec<u16> {
        (0..70 * 41 * channels)
            .map(|_| (u16::from(random.grey()) << 8 | u16::from(random.grey())) % most)
            .collect()
    };
    let bytes = |values: Vec<u16>| values.into_iter().map(|value| value as u8).collect::<Vec<u8>>();
    let mut images: Vec<(String, DynamicImage)> = Vec::new();
    for (side, most) in [(0, u16::MAX), (1, 900)] {
        let of_kind: [(&str, DynamicImage); 9] = [
            ("l8", buffer::<Luma<u8>>(bytes(noise(1, 256)))),
            ("la8", buffer::<LumaA<u8>>(bytes(noise(2, 256)))),
            ("rgb8", buffer::<Rgb<u8>>(bytes(noise(3, 256)))),
            ("rgba8", buffer::<Rgba<u8>>(bytes(noise(4, 256)))),
            ("l16", buffer::<Luma<u16>>(noise(1, most))),
            ("ten", buffer::<Luma<u16>>(noise(1, 1000))),
            ("la16", buffer::<LumaA<u16>>(noise(2, most))),
            ("rgb16", buffer::<Rgb<u16>>(noise(3, most))),
            ("rgba16", buffer::<Rgba<u16>>(noise(4, most))),
        ];
        images.extend(of_kind.map(|(name, image)| (format!("{name}-{side}.png"), image)));
        for (name, extension) in [("l8", "pgm"), ("rgb8", "ppm")] {
            let of = images
                .iter()
                .find(|(given, _)| *given == format!("{name}-{side}.png"))
                .unwrap()
                .1
                .clone();
            images.push((format!("{name}-{side}.{extension}"), of));
        }
    }
    for (name, image) in &images {
        let path = folder.path().join(name);
        match Path::new(name).extension().and_then(|extension| extension.to_str()) {
            Some("png") => image.save(path).unwrap(),
            kind => {
                let head = format!(
                    "{}\n# made by a test\n70 41\n255\n",
                    if kind == Some("pgm") { "P5" } else { "P6" }
                );
                std::fs::write(path, [head.as_bytes(), image.as_bytes()].concat()).unwrap();
            }
        }
    }
    let mut tasks = Vec::new();
    let mut wanted = Vec::new();
    for name in images.iter().map(|(name, _)| name).filter(|name| name.contains("-0.")) {
        let [left, right] =
            [name.clone(), name.replace("-0.", "-1.")].map(|name| folder.path().join(name));
        for (given, width) in [
            (vec![left.clone(), right.clone()], 0),
            (vec![left.clone()], 0),
            (vec![left, right], 37),
        ] {
            let from = match &given[..] {
                [left, right] => PairFiles::Two([left.clone(), right.clone()]),
                _ => PairFiles::SideBySide(given[0].clone()),
            };
            let pair = load_images(&from, None).unwrap();
            wanted.push(if width == 0 {
                pair
            } else {
                pair.map(|image| area_average(&image, width).unwrap())
            });
            tasks.push(json!({"files": given, "width": width, "out": folder.path().join(tasks.len().to_string())}));
        }
    }
    for (i, (found, pair)) in in_node(page, tasks.clone()).iter().zip(&wanted).enumerate() {
        assert_eq!(
            found["size"],
            json!([pair[0].dims.width, pair[0].dims.height]),
            "{} {found}",
            tasks[i]
        );
        for (side, image) in ["left", "right"].into_iter().zip(pair) {
            let grey = std::fs::read(folder.path().join(format!("{i}-{side}"))).unwrap();
            assert!(grey == image.pixels, "{side}: {}", tasks[i]);
        }
    }
    assert_eq!(wanted.len(), 33);
}

#[test]
fn what_is_no_image_is_refused_by_what_to_do() {
    let Some(page) = page() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let (_, [image, _]) = pairs().pop().unwrap();
    let good = std::fs::read(png(folder.path(), "good.png", &image)).unwrap();
    let turned = [&good[..33], &exif_chunk(6), &good[33..]].concat();
    let mut huge = good.clone();
    huge[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&huge[12..29]);
    huge[29..33].copy_from_slice(&crc.to_be_bytes());
    let half = png(folder.path(), "half.png", &area_average(&image, 80).unwrap());
    let cases = [
        (
            vec![file("notes.txt", b"hello")],
            0,
            "not an image that is read; give PNG, PGM, or what this browser shows, such as JPEG",
        ),
        (
            vec![file("empty.png", b"")],
            0,
            "not an image that is read; give PNG, PGM, or what this browser shows, such as JPEG",
        ),
        (vec![file("cut.png", &good[..good.len() / 2])], 0, "a damaged PNG; give another file"),
        (vec![file("turned.png", &turned)], 0, "a PNG that its EXIF turns; store it upright"),
        (
            vec![file("huge.png", &huge)],
            0,
            "an image of more than 128 MiB of pixels is not read; give a smaller one",
        ),
        (
            vec![file("cut.pgm", b"P5 9 9 255\n123")],
            0,
            "a PGM or PPM that is damaged or not of 8 bits; give another file, or a PNG",
        ),
        (
            vec![file("good.png", &good), half],
            0,
            "the left image is 160x120 but the right one is 80x60; give two images of one size",
        ),
        (
            vec![file("good.png", &good)],
            81,
            "a width of 81 px is not between 1 and the image's 80; images are only ever reduced",
        ),
        (vec![], 0, "give two images, or one with both side by side"),
        // One photo is cut in two where somebody says so.
        (
            vec![file("photo.png", &good)],
            0,
            "one image of 160x120 is no pair; give the other one too, or say that it holds both",
        ),
    ];
    let out = folder.path().join("out");
    let is_photo = |files: &[PathBuf]| files.iter().any(|file| file.ends_with("photo.png"));
    let task = |(files, width, _): &(Vec<PathBuf>, u32, &str)| json!({"files": files, "both": !is_photo(files), "width": width, "out": out});
    let tasks = cases.iter().map(task);
    for (found, (files, _, expected)) in in_node(page, tasks.collect()).iter().zip(&cases) {
        assert_eq!(found["refused"], *expected, "{files:?}");
    }
}

/// A chunk of a PNG with the orientation alone.
fn exif_chunk(orientation: u8) -> Vec<u8> {
    let entry = [0x01, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0, 0, 0, 0, 0];
    let body = [&b"eXIfMM\0*\0\0\0\x08\0\x01"[..], &entry].concat();
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&body);
    [&((body.len() - 4) as u32).to_be_bytes()[..], &body, &crc.to_be_bytes()].concat()
}

/// A box over nearly all of a small image may have more hypotheses, points and segments, than the
/// image has squares.
#[test]
fn memory_has_room_for_all_hypotheses_of_an_object() {
    let (_, pair) = pairs().pop().unwrap();
    let (pair, dims) = (pair.each_ref(), pair[0].dims);
    let area = Area { left: 3, top: 5, right: dims.width - 8, bottom: dims.height - 9 };
    let region = Region::boxed(0, area, dims).unwrap();
    let capacity = Capacity { segments: 1024, ..Capacity::new(dims) };
    let mut words = vec![MaybeUninit::uninit(); capacity.words()];
    let [left, right] = pair.map(|image| image.view().unwrap());
    let mut matcher = Matcher::new(Params::default(), dims).unwrap();
    let memory = MemorySlice::new(&mut words, capacity.segments);
    let found = matcher.run(memory, left, right).unwrap().object(&region);
    assert_eq!(found, matched(&Params::default(), pair).0.object(&region));
}

/// Line of an object, as the page has to say it.
fn said(images: &[GrayImage; 2], area: Area) -> String {
    let params = Params { rig: Some(c_library::rig()), ..Params::default() };
    let (mut engine, _) = matched(&params, images.each_ref());
    let found = match engine.object(&Region::boxed(0, area, images[0].dims).unwrap()) {
        Err(reason) => return format!("no depth: {reason}"),
        Ok(found) => found,
    };
    // A browser rounds halves up, such as 22.125; Rust to the even digit.
    let disparity = found.disparity.to_num::<f64>() + 1e-9;
    let metres = found.metres.unwrap();
    let [depth, sigma, nearest] = [metres.depth, metres.sigma, metres.nearest].map(|z| {
        let z = z.to_num::<f64>();
        format!("{z:.*} m", if z < 10.0 { 3 } else { 1 })
    });
    let (px, sure) = (found.sigma.to_num::<f64>(), 100.0 * found.confidence.to_num::<f64>());
    format!(
        "{depth} ± {sigma}, nearest {nearest}; {disparity:.2} ± {px:.2} px, within 1 px with {sure:.1} %"
    )
}

#[test]
fn a_visitor_sees_the_bytes_of_the_program_and_the_depth_of_a_box() {
    let Some((page, browser)) = page().zip(browser()) else { return };
    assert!(
        std::fs::metadata(&page.page).unwrap().len() <= MOST_BYTES as u64,
        "the page grew beyond its limit"
    );
    let (pairs, folder) = (pairs(), tempfile::tempdir().unwrap());
    let written = files(folder.path(), &pairs);
    let notes = folder.path().join("notes.txt");
    std::fs::write(&notes, "hello").unwrap();
    let boxes = |[left, _]: &[GrayImage; 2]| {
        let [w, h] = [left.dims.width, left.dims.height];
        [
            Area { left: w / 4, top: h / 4, right: w / 2, bottom: h / 2 },
            Area { left: 3, top: 5, right: w - 8, bottom: h - 9 },
        ]
    };
    let mut steps = vec![json!({"settings": {"focal": RIG[0], "baseline": RIG[1]}})];
    for (files, (_, images)) in written.iter().zip(&pairs) {
        // The right one first: names say which is which.
        steps.push(json!({"files": [files[1], files[0]], "text": true}));
        for area in boxes(images) {
            steps.push(json!({"box": [area.left, area.top, area.right, area.bottom]}));
        }
    }
    steps.push(json!({"files": [notes, written[0][0]]}));
    steps.push(json!({"files": [written[0][0], written[0][1], notes]}));
    steps.push(json!({"files": written[0], "text": true}));
    // The focal length is that of the files: half of it holds for images of half the width.
    let focal = 2.0 * RIG[0].parse::<f64>().unwrap();
    let width = pairs[0].1[0].dims.width / 2;
    steps
        .push(json!({"settings": {"focal": focal, "width": width}, "changes": true, "text": true}));
    steps.push(json!({"settings": {"baseline": ""}, "changes": true}));
    // 65600 is 64 in 16 bits.
    steps.push(json!({"settings": {"max-disparity": "65600"}, "changes": true}));
    let Visit { found, logged } = visit(&browser, &page.page, &[], &json!(steps));
    assert_eq!(logged.len(), 1, "the page alone is fetched, and nothing fails: {logged:?}");
    for (step, (name, images)) in found[1..].chunks(3).zip(&pairs) {
        assert_equal(name, &step[0], &expected(images));
        let lines: Vec<String> = boxes(images).iter().map(|&area| said(images, area)).collect();
        assert_eq!(step[2]["objects"], json!(lines), "{name}");
        assert!(step[2]["summary"].as_str().unwrap().contains(" segments matched, "), "{name}");
        assert_eq!((&step[2]["error"], &step[2]["wide"]), (&json!(""), &json!(false)), "{name}");
    }
    let [text_file, three, again, reduced, half_a_rig, too_many] = &found[1 + 3 * pairs.len()..]
    else {
        panic!("{found:?}")
    };
    let refused = "notes.txt: not an image that is read; give PNG, PGM, or what this browser shows, such as JPEG";
    assert_eq!(text_file["error"], refused);
    assert_eq!(
        three["error"],
        "3 files were given; give left and right, or one with both side by side"
    );
    assert_equal("again", again, &expected(&pairs[0].1));
    let halves = pairs[0].1.each_ref().map(|image| area_average(image, width).unwrap());
    assert_equal("reduced", reduced, &expected(&halves));
    assert_eq!(
        half_a_rig["error"],
        "metres need both, focal length and baseline; give the other one, or neither"
    );
    assert!(too_many["error"].as_str().unwrap().contains("Disparities below"), "{too_many}");
}

/// All that a mouse does keys do, and what is drawn is told in words; a single photo is no pair.
#[test]
fn a_visitor_without_mouse_or_eyes_gets_the_same() {
    let Some((page, browser)) = page().zip(browser()) else { return };
    let (name, images) = pairs().into_iter().find(|(name, _)| name == "drawn-320x240").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let [left, right] = files(folder.path(), &[(name, images.clone())]).remove(0);
    const SHIFT: u32 = 8;
    const CTRL: u32 = 2;
    let steps = [
        json!({"settings": {"focal": RIG[0], "baseline": RIG[1]}}),
        json!({"files": [left]}),
        json!({"settings": {"both": true}, "changes": true}),
        json!({"settings": {"both": false}, "changes": true}),
        json!({"files": [left, right]}),
        // The first key puts a box into the middle.
        json!({"keys": [["ArrowRight", 0], ["ArrowLeft", 0], ["ArrowUp", CTRL], ["ArrowDown", SHIFT], ["ArrowRight", SHIFT]]}),
        json!({"keys": [["Enter", 0]], "tree": true}),
        json!({"keys": [["ArrowDown", 0], ["Escape", 0], ["Enter", 0]]}),
    ];
    let Visit { found, logged } = visit(&browser, &page.page, &[], &json!(steps));
    assert_eq!(logged.len(), 1, "{logged:?}");
    let refused =
        "one image of 320x240 is no pair; give the other one too, or say that it holds both";
    assert!(found[1]["error"].as_str().unwrap().ends_with(refused), "{}", found[1]);
    assert!(
        found[2]["names"].as_str().unwrap().contains("cut in the middle: left | right"),
        "{}",
        found[2]
    );
    assert!(found[2]["summary"].as_str().unwrap().starts_with("160x240: "), "{}", found[2]);
    assert_eq!(found[5]["box"], "Box: 120,95 to 192,151 px");
    let area = Area { left: 120, top: 95, right: 192, bottom: 151 };
    assert_eq!(found[6]["objects"], json!([said(&images, area)]));
    assert_eq!((&found[7]["objects"], &found[7]["box"]), (&found[6]["objects"], &json!("")));
    let tree: Vec<&str> =
        found[6]["tree"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for node in [
        "application: Left image with what was matched",
        "image: Points seen from above",
        "button: remove box 1",
        "checkbox: One image holds both, left | right",
    ] {
        assert!(tree.contains(&node), "{node}: {tree:?}");
    }
}

/// The browser's own camera for tests shows a drawn pair side by side.
#[test]
fn a_camera_is_followed() {
    let Some((page, browser)) = page().zip(browser()) else { return };
    // Brightness differs from frame to frame: what does not change is a frozen camera. The film is
    // a second long, so that a slow page does not see one of its frames over and over.
    let brightness: Vec<u8> = (0..31).map(|frame| 2 * frame).collect();
    let moving = camera(page, &browser, &brightness);
    let summary = moving["summary"].as_str().unwrap();
    let matched = summary.strip_prefix("320x240: ").and_then(|rest| rest.split_once(' ')).unwrap();
    // The browser's colours are not the drawn bytes: about as many segments.
    assert!(matched.0.parse::<u32>().unwrap() > 60, "{moving:?}");
    assert_eq!(moving["names"], "Camera, both side by side");

    let frozen = camera(page, &browser, &[0]);
    let health = frozen["health"].as_str().unwrap();
    assert!(health.contains("left_frozen: left image does not change"), "{frozen:?}");
    assert!(frozen["summary"].as_str().unwrap().starts_with("320x240: 0 of "), "{frozen:?}");
}

/// Before the camera is there it is asked for again, and files are chosen.
#[test]
fn files_take_the_place_of_a_camera_that_was_asked_for_before() {
    let Some((page, browser)) = page().zip(browser()) else { return };
    let folder = tempfile::tempdir().unwrap();
    let files = files(folder.path(), &pairs()[..1]).remove(0);
    let counted = "(() => { const of = navigator.mediaDevices, ask = of.getUserMedia.bind(of); \
                   globalThis.streams = []; of.getUserMedia = async wanted => { \
                   const made = await ask(wanted); streams.push(made); \
                   await new Promise(then => setTimeout(then, 300)); return made; }; \
                   return true; })()";
    let twice = "(['camera', 'camera'].forEach(id => document.getElementById(id).click()), true)";
    let is_off = "streams.length === 1 && \
                  streams[0].getTracks().every(track => track.readyState === 'ended')";
    let steps = json!([
        {"until": counted}, {"until": twice}, {"files": files},
        {"until": "document.getElementById('summary').checkVisibility()"}, {"until": is_off}
    ]);
    let flags = ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream"];
    let Visit { found, .. } = visit(&browser, &page.page, &flags.map(str::to_owned), &steps);
    let name = files[0].file_name().unwrap().to_str().unwrap();
    assert!(found[4]["names"].as_str().unwrap().starts_with(name), "{}", found[4]);
}

/// State of the page at the fifth frame of a camera that repeats the drawn pair, brighter by each
/// of these grey levels.
fn camera(page: &WebPage, browser: &Browser, brighter: &[u8]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let (_, images) = pairs().into_iter().find(|(name, _)| name == "drawn-320x240").unwrap();
    let mut video =
        format!("YUV4MPEG2 W{} H{} F30:1 Ip C420jpeg\n", 2 * QVGA.width, QVGA.height).into_bytes();
    for brighter in brighter {
        video.extend(b"FRAME\n");
        let [left, right] =
            images.each_ref().map(|image| image.pixels.chunks_exact(QVGA.width.into()));
        for row in left.zip(right).flat_map(|(left, right)| [left, right]) {
            video.extend(row.iter().map(|pixel| pixel.saturating_add(*brighter)));
        }
        let colours = usize::from(QVGA.width) * usize::from(QVGA.height); // both
        video.resize(video.len() + colours, 128);
    }
    let file = folder.path().join("pair.y4m");
    std::fs::write(&file, video).unwrap();
    let camera = format!("--use-file-for-fake-video-capture={}", file.display());
    let flags = ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream", &camera]
        .map(str::to_owned);
    let steps = json!([{"click": "camera", "frames": 5}]);
    let Visit { found, logged } = visit(browser, &page.page, &flags, &steps);
    assert_eq!(logged.len(), 1, "{logged:?}");
    found[0].clone()
}
