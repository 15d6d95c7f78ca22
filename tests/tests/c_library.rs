//! The library for C: its header, its refusals, and its examples against the PC's program, on a PC
//! and on an emulated Cortex-M7.

use super::no_panic::{build, build_for, packages};
use core::fmt::Write as _;
use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::obstacles::{ObstacleParams, Obstacles, Sector};
use linestereo::results::PixelRejection;
use linestereo::units::{Confidence, Disparity};
use linestereo::{Area, Dims, Params, Region, Rig, health::HealthFlags, objects::Reason};
use linestereo_boards::Board;
use linestereo_frames::GrayImage;
use linestereo_sim::board::{qemu, toolchain::Toolchain};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::listing::{self, Answers};
use linestereo_sim::scene::Kind;
use linestereo_tests::board::or_skip;
use linestereo_tests::browser::has;
use linestereo_tests::{captured, drawn};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

#[expect(unreachable_pub, reason = "the library's own file: its texts are compared")]
#[path = "../../bindings/c/src/status.rs"]
mod status;

/// Focal length in px and baseline in m of the pairs, as they are told to the examples.
pub(crate) const RIG: [&str; 2] = ["300.5", "0.1"];
pub(crate) const QVGA: Dims = Dims { width: 320, height: 240 };

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../bindings/c")
}

fn library() -> PathBuf {
    build("../bindings/c/Cargo.toml", "linestereo_c")
}

/// Runs a tool to its end, which is a good one.
fn run(command: &mut Command) -> Vec<u8> {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let said = [&output.stderr[..], &output.stdout[..output.stdout.len().min(2000)]].concat();
    assert!(
        output.status.success(),
        "{command:?}: {} {}",
        output.status,
        String::from_utf8_lossy(&said)
    );
    output.stdout
}

/// A compiled program of C for this machine.
fn compiled(compiler: &str, flags: &[&str], source: &Path, into: &Path) -> PathBuf {
    let program = into.join("program");
    let mut command = Command::new(compiler);
    command
        .args(["-Wall", "-Wextra", "-Werror", "-O1"])
        .args(flags)
        .arg("-I")
        .arg(folder().join("include"));
    run(command.arg(source).args(["-x", "none"]).arg(library()).arg("-o").arg(&program));
    program
}

/// Name of the pair with a pole.
const POLE: &str = "pole";
/// Name of the pair with a floor that ends.
const EDGE: &str = "edge";
/// Line of names before the directions.
const SECTOR_NAMES: &str = "sector,state,distance_cm,confidence,drop_off_cm,drop_off_confidence\n";
/// Line of names before the bars.
const BAR_NAMES: &str = "x0,y0,x1,y1,width_px,disparity0_px,disparity1_px,sigma_px,confidence,\
                         depth0_m,depth1_m,depth0_sigma_m,depth1_sigma_m\n";

/// Ten captured pairs cut to QVGA, and drawn ones, the first with a pole, the second with a
/// drop-off.
pub(crate) fn pairs() -> Vec<(String, [GrayImage; 2])> {
    let drawn =
        [(Kind::Demo, QVGA), (Kind::Demo, Dims { width: 160, height: 120 })].map(|(kind, dims)| {
            let rendering = drawn::rendered(kind, dims, 2.0, 3);
            (format!("drawn-{dims}"), [rendering.left, rendering.right])
        });
    let captured = captured::qvga().unwrap_or_default().into_iter().take(10);
    captured
        .map(|scene| (scene.name, [cut(&scene.left), cut(&scene.right)]))
        .chain([(POLE.to_owned(), super::bars::pair(&[(150, 5, 24)], 2))])
        .chain([(EDGE.to_owned(), super::drop_offs::pair(Some(1.5), 6))])
        .chain(drawn)
        .collect()
}

fn cut(image: &GrayImage) -> GrayImage {
    let height = image.dims.height.min(QVGA.height);
    let pixels = image.pixels[..usize::from(image.dims.width) * usize::from(height)].to_vec();
    GrayImage { dims: Dims { height, ..image.dims }, pixels }
}

fn write_pair(folder: &Path, images: &[GrayImage; 2]) {
    for (name, GrayImage { dims, pixels }) in ["left.pgm", "right.pgm"].into_iter().zip(images) {
        let head = format!("P5\n# made by a test\n{} {}\n255\n", dims.width, dims.height);
        std::fs::write(folder.join(name), [head.as_bytes(), pixels].concat()).unwrap();
    }
}

/// Output of the examples before the bars, by the PC's program: its CSV, its points, an object, its
/// health.
pub(crate) fn expected(images: &[GrayImage; 2]) -> String {
    results(images, None).0
}

/// Output of the examples, by the PC's program: [`expected`], its ground, the bars of its JSON,
/// its directions.
fn printed(images: &[GrayImage; 2], pose: Option<CameraPose>) -> String {
    let (text, result) = results(images, pose);
    let ground = result.ground.map_or(String::new(), |plane| {
        let GroundPlane { down_q16, across_q16, origin_q16 } = plane;
        format!("ground: {down_q16},{across_q16},{origin_q16}\n")
    });
    text + &ground + &bars(images[0].dims, &result) + &sectors(images[0].dims, &result)
}

/// Directions in view as the examples print them, by the core.
fn sectors(dims: Dims, result: &FrameResult) -> String {
    let params = Params { rig: Some(rig()), ..Params::default() };
    let plan = ObstacleParams::DEFAULT.plan(&params, dims).unwrap();
    let mut obstacles = Obstacles::new();
    let points = result.obstacle_points.iter().copied();
    let health = result.health.of_pair();
    obstacles.update(&plan.on_ground(result.ground), &result.matches, points, health, 0);
    let probability = |p: Confidence| (p.to_num::<f64>() * 1e5).round() / 1e5;
    let mut text = SECTOR_NAMES.to_owned();
    for (index, sector) in (0..).zip(obstacles.sectors(&plan, 0)) {
        let said = match sector {
            Sector::Outside => continue,
            Sector::Unknown => "unknown,0,0".to_owned(),
            Sector::Free { confidence, .. } => format!("free,0,{}", probability(confidence)),
            Sector::Obstacle { distance_cm, confidence, .. } => {
                format!("obstacle,{distance_cm},{}", probability(confidence))
            }
        };
        let drop_off = obstacles
            .drop_off(&plan, index, 0)
            .map_or((0, 0.0), |found| (found.distance_cm, probability(found.confidence)));
        writeln!(text, "{index},{said},{},{}", drop_off.0, drop_off.1).unwrap();
    }
    text
}

/// The bars of the program's JSON as the examples print them, with their depths.
fn bars(dims: Dims, result: &FrameResult) -> String {
    let json = listing::json(dims, result, &Answers::default()).unwrap();
    let listing: Value = serde_json::from_str(&json).unwrap();
    let mut text = BAR_NAMES.to_owned();
    for bar in listing["bars"].as_array().unwrap() {
        let number = |value: &Value| value.as_f64().unwrap();
        let both = |values: &Value| [&values[0], &values[1]].map(number);
        let ([from, to], sigma) = (both(&bar["disparity_px"]), number(&bar["sigma_px"]));
        let [width, confidence] = ["width_px", "confidence"].map(|name| number(&bar[name]));
        let [[x0, y0], [x1, y1]] = [&bar["left"][0], &bar["left"][1]].map(both);
        write!(text, "{x0},{y0},{x1},{y1},{width},{from},{to},{sigma},{confidence}").unwrap();
        let (rig, [from, to, sigma]) = (rig(), [from, to, sigma].map(Disparity::from_num));
        let sigmas = [rig.depth_sigma(from, sigma), rig.depth_sigma(to, sigma)];
        for metres in [rig.depth(from), rig.depth(to)].into_iter().chain(sigmas) {
            let finite = listing::finite_metres(metres);
            write!(text, ",{}", finite.map_or(String::new(), |z| z.to_string())).unwrap();
        }
        text.push('\n');
    }
    text
}

/// The rig of [`RIG`].
pub(crate) fn rig() -> Rig {
    let [focal, baseline] = RIG.map(|text| text.parse().unwrap());
    Rig::new(focal, baseline, 0.0).unwrap()
}

/// [`expected`], and the result that it is made from.
fn results(images: &[GrayImage; 2], pose: Option<CameraPose>) -> (String, FrameResult) {
    let params = Params { rig: Some(rig()), ..Params::default() };
    let dims = images[0].dims;
    let mut engine = Engine::new(&params, dims).unwrap();
    engine
        .matcher
        .expect_ground(pose.map(|pose| GroundPlane::of_pose(pose, &rig(), dims).unwrap()));
    let result = linestereo_tests::run(&mut engine, images.each_ref());
    let mut text = listing::csv(&result) + "x,y,disparity_px,confidence\n";
    let decimals = |value: f64| (value * 1e5).round() / 1e5;
    for point in &result.points {
        let (disparity, confidence) =
            (point.disparity.to_num::<f64>(), decimals(point.confidence.to_num()));
        writeln!(text, "{},{},{disparity},{confidence}", point.x, point.y).unwrap();
    }
    let [width, height] = [dims.width / 4, dims.height / 4];
    let middle = Area { left: width, top: height, right: 3 * width, bottom: 3 * height };
    let flags: HealthFlags = engine.matched().health().flags;
    match engine.object(&Region::boxed(0, middle, dims).unwrap()) {
        Err(reason) => writeln!(text, "middle: {reason}").unwrap(),
        Ok(object) => {
            let pixels = [object.disparity, object.sigma].map(Disparity::to_num::<f64>);
            let metres = object.metres.unwrap();
            let metres =
                [metres.depth, metres.nearest].map(|depth| listing::finite_metres(depth).unwrap());
            writeln!(text, "middle: {} +- {} px,{},{}", pixels[0], pixels[1], metres[0], metres[1])
                .unwrap();
        }
    }
    writeln!(text, "health: {flags}, {}", if flags.is_fit() { "fit" } else { "not fit" }).unwrap();
    (text, result)
}

/// True when one of the directions has one.
fn has_drop_off(printed: &str) -> bool {
    let (_, sectors) = printed.split_once(SECTOR_NAMES).unwrap();
    sectors.lines().any(|line| !line.ends_with(",0,0"))
}

#[track_caller]
pub(crate) fn assert_equal(name: &str, found: &[u8], expected: &str) {
    let found = String::from_utf8_lossy(found);
    let differs = found.lines().zip(expected.lines()).find(|(found, expected)| found != expected);
    assert!(found == expected, "{name}: {} and {} bytes; {differs:?}", found.len(), expected.len());
}

#[test]
fn the_header_is_what_cbindgen_makes_of_the_source() {
    let target = packages().join("cargo");
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["run", "--quiet", "--locked", "-p", "linestereo-c-header", "--target-dir"])
        .arg(target);
    let made =
        run(cargo.current_dir(folder()).env_remove("RUSTFLAGS").env_remove("CARGO_BUILD_TARGET"));
    let kept = std::fs::read_to_string(folder().join("include/linestereo.h")).unwrap();
    let how = "cd bindings/c && cargo run -p linestereo-c-header -- include/linestereo.h";
    assert!(
        String::from_utf8(made).unwrap() == kept,
        "include/linestereo.h is not up to date: {how}"
    );
    let version = format!("#define LINESTEREO_VERSION \"{}\"\n", env!("CARGO_PKG_VERSION"));
    assert!(kept.contains(&version), "the library has another version than the core: {version}");
}

#[test]
fn reasons_have_the_texts_of_the_core() {
    use status::Status;
    let text = |status: Status| Status::text(status as i32).unwrap().to_str().unwrap().to_owned();
    for reason in Reason::ALL {
        assert_eq!(text(reason.into()), reason.to_string());
    }
    let of_pixels =
        PixelRejection::ALL.into_iter().filter(|&reason| Status::from(reason) as i32 >= 100);
    assert_eq!(of_pixels.clone().count(), 7);
    for reason in of_pixels {
        assert_eq!(text(reason.into()), reason.to_string());
    }
}

#[test]
fn what_no_caller_may_do_is_refused() {
    let source = folder().join("tests/refusals.c");
    for (compiler, flags) in [("cc", &["-std=c99", "-pedantic"][..]), ("c++", &["-x", "c++"])] {
        if has(compiler) {
            let into = tempfile::tempdir().unwrap();
            run(&mut Command::new(compiled(compiler, flags, &source, into.path())));
        }
    }
}

#[test]
fn the_example_for_a_pc_prints_the_bytes_of_the_program() {
    if !has("cc") {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let program =
        compiled("cc", &["-std=c99", "-pedantic"], &folder().join("examples/pc.c"), into.path());
    let run_on = |arguments: &[&str]| {
        Command::new(&program).current_dir(into.path()).args(arguments).output().unwrap()
    };
    for (name, images) in pairs() {
        write_pair(into.path(), &images);
        let found = run_on(&["left.pgm", "right.pgm", "64", RIG[0], RIG[1]]);
        let expected = printed(&images, None);
        let names = format!("{BAR_NAMES}{SECTOR_NAMES}");
        assert!(name != POLE || !expected.contains(&names), "no bar on the pole");
        assert!(name != EDGE || expected.contains("\nground: "), "no ground before the drop-off");
        assert!(name != EDGE || has_drop_off(&expected), "no drop-off of the floor that ends");
        assert_equal(&name, &found.stdout, &expected);
        // Lower than the drawn camera stands, and rolled.
        let pose = CameraPose { height_m: 0.15, pitch_deg: 4.5, roll_deg: -2.5 };
        let stated = ["left.pgm", "right.pgm", "64", RIG[0], RIG[1], "0.15", "4.5", "-2.5"];
        let of_pose = printed(&images, Some(pose));
        let [without, with] =
            [&expected, &of_pose].map(|text| text.split_once(SECTOR_NAMES).unwrap().1);
        assert!(name != EDGE || without != with, "the pose says nothing of directions");
        assert_equal(&name, &run_on(&stated).stdout, &of_pose);
    }
    let of_baseline = "baseline_m is outside 0.0001 to 10: is it in mm?\n";
    let of_pose = "height_m is outside 0.01 to 100 or below a quarter of the baseline, \
                   or pitch_deg or roll_deg outside -80 to 80\n";
    let of_focal = "focal_px is outside 1 to 100000\n";
    for (arguments, text) in [
        (
            &["5000"][..],
            "max_disparity is outside 8 to 256 above min_disparity, or not below the width\n",
        ),
        (&["64", "300.5", "0,1"], of_baseline), // not 1 m
        (&["64", "300.5", "-0.1"], of_baseline),
        (&["64", "3e2", "0.1"], of_focal),
        (&["64", "300", "0.1", "0.3", "4", "5,0"], of_pose),
        (&["64", "300", "0.1", "0.02", "4", "5"], of_pose),
    ] {
        let refused = run_on(&[&["left.pgm", "right.pgm"], arguments].concat());
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert_eq!(String::from_utf8_lossy(&refused.stderr), text, "{arguments:?}");
    }
}

/// Target of the Cortex-M7, by Rust's name.
const M7: &str = "thumbv7em-none-eabihf";

/// Builds a package of the library's workspace for a Cortex-M7: its static library.
fn for_m7(toolchain: &Toolchain, package: &str) -> PathBuf {
    let (built_in, _) = build_for(toolchain, M7, &folder(), &["-p", package]);
    built_in.join(format!("lib{}.a", package.replace('-', "_")))
}

/// Links a program for a Cortex-M7 without a C library: sources of C and a static library.
fn linked_for_m7(sources: &[PathBuf], library: &Path, elf: &Path) {
    let mut gcc = Command::new("arm-none-eabi-gcc");
    gcc.args([
        "-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard", "-std=c99", "-Wall",
        "-Wextra",
    ]);
    gcc.args(["-Werror", "-Os", "-ffreestanding", "-nostdlib", "-ffunction-sections"]);
    gcc.args(["-Wl,--gc-sections,-z,noexecstack", "-I"]).arg(folder().join("include"));
    gcc.arg("-T")
        .arg(folder().join("examples/cortex-m7/link.ld"))
        .args(sources)
        .arg(library)
        .arg("-o")
        .arg(elf);
    run(&mut gcc);
}

/// By `arm-none-eabi-gcc` and QEMU; what is linked has no way to a panic.
#[test]
fn the_example_for_a_cortex_m7_prints_the_bytes_of_the_program() {
    if !has("arm-none-eabi-gcc") {
        return;
    }
    let Some(toolchain) = or_skip(Toolchain::for_target(M7)) else { return };
    let into = tempfile::tempdir().unwrap();
    let elf = into.path().join("pair.elf");
    linked_for_m7(
        &[folder().join("examples/cortex-m7/main.c")],
        &for_m7(&toolchain, "linestereo-c"),
        &elf,
    );

    let bytes = std::fs::read(&elf).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let names: Vec<&str> = object::Object::symbols(&file)
        .filter_map(|s| object::ObjectSymbol::name(&s).ok())
        .collect();
    assert!(
        names.contains(&"linestereo_run") && !names.contains(&"linestereo_panic"),
        "a panic is linked"
    );

    for (name, images) in pairs() {
        write_pair(into.path(), &images);
        let arguments = ["left.pgm", "right.pgm", "64", RIG[0], RIG[1]];
        let Some(mut machine) =
            or_skip(qemu::command(&Board::MPS2_AN500, &elf, &arguments, into.path()))
        else {
            return;
        };
        assert_equal(&name, &run(machine.args(["-serial", "none"])), &printed(&images, None));
    }
}

/// A project that knows nothing but the folder: once with a library that cargo builds, once with
/// one that is there.
#[test]
fn a_fresh_cmake_project_links_it() {
    if !has("cmake") || !has("cc") {
        return;
    }
    let into = tempfile::tempdir().unwrap();
    let project = format!(
        "cmake_minimum_required(VERSION 3.16)\nproject(robot C)\nadd_subdirectory({} linestereo)\n\
         add_executable(robot {})\ntarget_link_libraries(robot PRIVATE linestereo::linestereo)\n",
        folder().canonicalize().unwrap().display(),
        folder().join("examples/pc.c").canonicalize().unwrap().display(),
    );
    std::fs::write(into.path().join("CMakeLists.txt"), project).unwrap();
    let (_, images) = pairs().remove(0);
    write_pair(into.path(), &images);
    let given = format!("-DLINESTEREO_LIBRARY={}", library().display());
    for (folder, settings) in [("given", &[given.as_str()][..]), ("built", &[])] {
        run(Command::new("cmake")
            .current_dir(into.path())
            .args(["-S", ".", "-B", folder])
            .args(settings));
        let mut build = Command::new("cmake");
        build.current_dir(into.path()).args(["--build", folder]);
        // Libraries that cargo has built are there again.
        let shared = packages().join("cargo");
        if settings.is_empty() {
            std::fs::create_dir_all(into.path().join(folder).join("linestereo")).unwrap();
            let link = into.path().join(folder).join("linestereo/cargo");
            link_folder(&shared, &link);
        }
        run(&mut build);
        let mut robot = Command::new(into.path().join(folder).join("robot"));
        let found = run(robot
            .current_dir(into.path())
            .args(["left.pgm", "right.pgm", "64"])
            .args(RIG.map(OsStr::new)));
        assert_equal(folder, &found, &printed(&images, None));
    }
}

#[cfg(unix)]
fn link_folder(from: &Path, to: &Path) {
    std::os::unix::fs::symlink(from, to).unwrap();
}

#[cfg(not(unix))]
fn link_folder(_: &Path, _: &Path) {}
