//! `docs/results.md`, table by table.

use super::stored::{BOARD_FILES, DataSet, Stored, number};
use anyhow::{Context, Result};

/// Data sets: folder, what a table calls it.
pub(super) const SETS: [(&str, &str); 18] = [
    ("robot_world", "rendered rooms, 320 px"),
    ("robot_world_640", "rendered rooms, 640 px"),
    ("robot_sequences/corridor", "rendered drive, corridor"),
    ("robot_sequences/dining_legs", "rendered drive, table legs"),
    ("robot_sequences/drone_living", "rendered flight, living room"),
    ("robot_sequences/drop_off", "rendered drive, drop-off"),
    ("robot_sequences/ramp", "rendered drive, ramp"),
    ("robot_sequences/sill_doorway", "rendered drive, doorway"),
    ("kitti2012_640", "KITTI 2012 roads, 640 px"),
    ("oakd_agreed_320", "OAK-D Lite homes, 320 px"),
    ("oakd_agreed_640", "OAK-D Lite homes, 640 px"),
    ("qvga", "Middlebury, 320 px"),
    ("middlebury2001", "Middlebury 2001"),
    ("middlebury2003", "Middlebury 2003"),
    ("middlebury2005_half", "Middlebury 2005, half size"),
    ("middlebury2006_third", "Middlebury 2006, third size"),
    ("middlebury2006_half", "Middlebury 2006, half size"),
    ("middlebury2014_quarter", "Middlebury 2014, quarter size"),
];

const DAMAGES: [(&str, &str); 4] = [
    ("noise2", "noise of 2 grey levels"),
    ("noise5", "noise of 5 grey levels"),
    ("blur1", "blur of 1 px"),
    ("gain", "right image of other exposure"),
];

const HEAD: &str = "\
# Results

`cargo xtask results` writes this page from stored measurements. Do not edit it.

**No board has run it yet.** Counts for boards are instructions that QEMU executed. They are not
cycles: QEMU models neither caches nor wait states.
";

const SOURCES: &str = "\
## Data sets

The frames are not part of this repository. `FRAMES` is a folder of data sets; the
[bench](contributing.md#the-bench) says what a data set holds.

| data set | truth | where it comes from |
|---|---|---|
| rendered rooms and drives | exact | rendered by path tracing for rigs of vacuums, rovers, drones and desk arms; not published |
| KITTI 2012 | laser, visible pixels | [cvlibs.net](https://www.cvlibs.net/datasets/kitti/), CC BY-NC-SA 3.0; reduced from 1242x375 |
| OAK-D Lite homes | pixels where 5 of 8 dense matchers agree | the pairs of `linestereo frames get` |
| Middlebury | structured light | [vision.middlebury.edu](https://vision.middlebury.edu/stereo/data/); the QVGA set is reduced to 320 px by area |

OAK-D's truth favours dense matchers and says nothing where they disagree. The models of linestereo
were fitted on these data sets, so new scenes may be worse. SGBM and StereoBM have no model.
";

/// The page.
pub(super) fn of(stored: &Stored) -> Result<String> {
    let parts = [
        HEAD.to_owned(),
        accuracy(stored),
        SOURCES.to_owned(),
        compare(stored),
        boards(stored)?,
        rates(stored)?,
        memory(stored)?,
    ];
    Ok(parts.join("\n"))
}

/// A table; the head has strokes between its cells.
fn table(head: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let rows: String = rows.into_iter().map(|row| format!("| {} |\n", row.join(" | "))).collect();
    format!("| {head} |\n|{}\n{rows}", "---|".repeat(head.split('|').count()))
}

fn shown(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// Values of the first methods, with a stroke between them.
fn versus(values: [Option<f64>; 3], methods: usize, decimals: usize) -> String {
    let values: Vec<String> =
        values.iter().take(methods).map(|&value| shown(value, decimals)).collect();
    values.join(" / ")
}

fn accuracy(stored: &Stored) -> String {
    let bench = &stored.scores.bench;
    let sets = || SETS.iter().filter_map(|&(set, title)| Some((title, bench.sets.get(set)?)));
    let counted = |title: &str, set: &DataSet| format!("{title} ({})", set.scenes);
    let curve = |title: String, set: &DataSet, metric: &str| {
        let at = |share| format!("first {share} % of all cells: off by > 1 px, %");
        let errors = [50, 60, 70, 80].map(|share| versus(set.figure(metric, &at(share)), 2, 1));
        [vec![title], errors.to_vec()].concat()
    };
    let damaged = sets().flat_map(|(title, set)| {
        let damages = DAMAGES.iter().map(move |&(damage, said)| (format!("cells, {damage}"), said));
        let damages = damages.filter(|(metric, _)| set.metrics.contains_key(metric));
        damages.map(move |(metric, said)| curve(format!("{title}, {said}"), set, &metric))
    });
    let heads = "linestereo / SGBM | 50 % | 60 % | 70 % | 80 %";
    let curves = table(heads, sets().map(|(title, set)| curve(counted(title, set), set, "cells")));
    let seen = sets().filter(|(_, set)| set.metrics.contains_key("seen")).map(|(title, set)| {
        let answered = versus(set.figure("seen", "answered, %"), 3, 0);
        vec![
            counted(title, set),
            answered,
            versus(set.figure("seen", "answers off by > 1 px, %"), 3, 1),
        ]
    });
    let seen = table("linestereo / SGBM / StereoBM | answered, % | of these wrong, %", seen);
    let classes = ["floor", "wall", "furniture", "thin", "below the floor"];
    let rooms = sets().filter(|(_, set)| set.metrics.contains_key("classes"));
    let rooms = rooms.flat_map(|(title, set)| {
        classes.iter().filter_map(move |class| {
            let of = |what: &str| set.figure("classes", &format!("{class}: {what}, %"));
            let (seen, wrong) = (versus(of("seen"), 3, 0), versus(of("off by > 1 px"), 3, 1));
            (seen != "- / - / -").then(|| vec![format!("{title}: {class}"), seen, wrong])
        })
    });
    let rooms = table("linestereo / SGBM / StereoBM | answered, % | of these wrong, %", rooms);
    let objects = sets().filter(|(_, set)| set.metrics.contains_key("objects"));
    let objects = objects.flat_map(|(title, set)| {
        ["thin", "other"].map(|kind| {
            let of = |what: &str| shown(set.figure("objects", &format!("{kind}: {what}, %"))[0], 1);
            vec![format!("{title}: {kind} objects"), of("answered"), of("wrong of these")]
        })
    });
    let objects = table("linestereo | answered, % | of these wrong, %", objects);
    let sectors =
        sets().filter(|(_, set)| set.metrics.contains_key("obstacles")).map(|(title, set)| {
            let outcomes = [
                "obstacle: told right, %", "obstacle: called free, %",
                "obstacle: a ghost nearer, %", "clear: free, %", "clear: a ghost, %",
                "drop-off: told right, %", "drop-off: not told, %", "no drop-off: one told, %",
            ];
            let of = |outcome: &str| shown(set.figure("obstacles", outcome)[0], 0);
            [vec![title.to_owned()], outcomes.map(of).to_vec()].concat()
        });
    let sector_heads = "linestereo, % of sectors | obstacle: right | called free | ghost nearer | \
                        clear: free | ghost | drop-off: right | not told | ghost";
    let sectors = table(sector_heads, sectors);
    let stated = sets().map(|(title, set)| {
        let of = |figure: &str| shown(set.figure("stated", figure)[0], 1);
        let bin = |bin: &str| {
            ["said", "right"].map(|what| of(&format!("p {bin}: {what}, %"))).join(" / ")
        };
        vec![title.to_owned(), bin("0.90 to 0.95"), bin("0.95 to 1.00")]
    });
    let stated = table("linestereo | 0.90 to 0.95: stated / right, % | 0.95 to 1.00", stated);
    let opencv = bench.opencv.as_deref().unwrap_or("-");
    let dates = || bench.sets.values().map(|set| &*set.date);
    let date = match (dates().min().unwrap_or("-"), dates().max().unwrap_or("-")) {
        (first, last) if first == last => first.to_owned(),
        (first, last) => format!("{first} to {last}"),
    };
    let damaged = table(heads, damaged);
    format!(
        "\
## Accuracy

`linestereo-lab bench FRAMES`, {date}, OpenCV {opencv} in the same run, default parameters. An
answer is wrong if it is more than 1 px off.

### The most confident cells

Each image is cut into cells of 16x16 px, and each cell keeps its most confident point. Cells are
sorted by confidence. The table gives the error rate, in percent, among the first 50 to 80 % of
*all* cells. SGBM's confidence is the largest uniqueness ratio that a pixel survives. Scenes are in
brackets.

{curves}
Damaged images:

{damaged}
### Answers of at least 90 %

Share of the cells with an answer of probability 0.9 or more, and the error rate of these answers.
SGBM and StereoBM: uniqueness 15 with a speckle filter, median of a cell.

{seen}
Rendered rooms by kind of surface, cells of 8x8 px:

{rooms}
### Objects of rendered rooms

Depth of each object by its mask. *Thin* objects are narrower than 8 px.

{objects}
### Obstacles by direction

Sectors of 5 degrees, obstacles 0.05 to 0.4 m above the floor within 3 m, with the camera's pose
given. A *ghost* is an obstacle or a drop-off that is not there. What is missing to 100 is unknown
or farther. Drop-offs are those whose edge is within 3 m.

{sectors}
### Stated probability

Mean of the stated probability and share of points within 1 px, in two bins.

{stated}"
    )
}

fn compare(stored: &Stored) -> String {
    let compare = &stored.scores.compare;
    let ours = compare.methods.iter().find(|method| method.name == "linestereo");
    let our_time = ours.map_or(f64::NAN, |method| method.milliseconds);
    let pair = |[first, second]: [f64; 2]| format!("{first:.2} / {second:.2}");
    let dense = compare.methods.iter().map(|method| {
        vec![
            method.name.clone(),
            format!("{:.0}", method.points),
            format!("{:.0}", method.cells_percent),
            pair(method.visible),
            pair(method.all),
            format!("{:.1}", method.milliseconds),
            format!("{:.1}", method.milliseconds / our_time),
        ]
    });
    let heads = "method | points | cells, % | visible, % | all, % | ms | linestereo = 1";
    let dense = table(heads, dense);
    let outlines = ["given", "too_large", "eroded", "box"];
    let objects = compare.methods.iter().map(|method| {
        let of = |outline: &str| match method.objects.get(outline) {
            Some(&[objects, answered, wrong]) if objects > 0 && answered > 0 => {
                let percent = |part: u64, whole: u64| 100.0 * part as f64 / whole as f64;
                format!("{:.1} / {:.0}", percent(wrong, answered), percent(answered, objects))
            }
            _ => "-".to_owned(),
        };
        [vec![method.name.clone()], outlines.map(of).to_vec()].concat()
    });
    let heads = "wrong / answered, % | mask | 2 px too large | 2 px eroded | drawn box";
    let objects = table(heads, objects);
    let count =
        |outline| ours.and_then(|method| method.objects.get(outline)).map_or(0, |counts| counts[0]);
    format!(
        "\
## Time on a PC, and dense methods

`linestereo-lab compare FRAMES/qvga --opencv --threads 1`, {}, {} pairs, one thread.
Processor: {}.
Times depend on the machine and its load: read them as ratios. `strict` methods use a uniqueness of
80 or more. *Cells* are cells of 16x16 px with an answer; *visible* and *all* are the
shares of points more than 1 / 2 px off. [When dense matching is better](limits.md#dense-matching).

{dense}
Depth of {} surfaces by their masks, and of {} objects by drawn boxes. A dense method answers with
the median of the disparities inside.

{objects}",
        compare.date,
        compare.pairs,
        compare.machine,
        count("given"),
        count("box"),
    )
}

/// Boards, what they stand for, and the size that is measured.
const BOARDS: [(&str, &str, &str); 6] = [
    ("mps2-an500", "Cortex-M7", "320x240"),
    ("mps2-an386", "Cortex-M4", "160x120"),
    ("mps2-an386", "Cortex-M4", "128x96"),
    ("mps2-an505", "Cortex-M33", "320x240"),
    ("mps3-an547", "Cortex-M55", "320x240"),
    ("riscv-virt", "RV32IMAC", "320x240"),
];

const STAGES: [&str; 9] = [
    "lines_left", "lines_right", "selection", "support", "rows", "matching", "consistency",
    "report", "health",
];

fn millions(value: Option<u64>) -> String {
    shown(value.map(|value| value as f64 / 1e6), 2)
}

fn boards(stored: &Stored) -> Result<String> {
    let get = |path: &[&str]| stored.number(&[&["boards"], path].concat());
    let taken = stored.scores.boards.get(BOARD_FILES[0]);
    let date = &taken.context("numbers of boards have no date")?.date;
    let pairs = BOARDS.map(|(board, processor, size)| {
        let of = |kind: &str, which: &str| millions(get(&[board, kind, size, which]));
        vec![
            processor.to_owned(),
            size.to_owned(),
            board.to_owned(),
            of("captured", "median"),
            of("captured", "largest"),
            of("built_in", "median"),
            of("built_in", "largest"),
        ]
    });
    let heads =
        "processor | pair | machine | captured: median | largest | built-in: median | largest";
    let pairs = table(heads, pairs);
    let sizes = [("mps2-an500", "320x240"), ("mps2-an386", "160x120")];
    let stages = STAGES.map(|stage| {
        let of = |(board, size)| millions(get(&[board, "captured", size, "by_stage", stage]));
        [vec![stage.replace('_', " ")], sizes.map(of).to_vec()].concat()
    });
    let stages = table("stage | Cortex-M7, 320x240 | Cortex-M4, 160x120", stages);
    let m7 = |path: &[&str]| get(&[&["mps2-an500"], path].concat());
    let share = |which: &str| {
        let permille = m7(&["objects", "320x240", which]);
        shown(permille.map(|value| value as f64 / 10.0), 0) + " % of the pair"
    };
    let row = |what: &str, value: String| vec![what.to_owned(), value];
    let rectify = |rig: &str| millions(m7(&["rectify", &format!("{rig}_320x240"), "rows"]));
    let set_up = |rig: &str| millions(m7(&["rectify", &format!("{rig}_320x240"), "set_up"]));
    let extras = [
        row("match around three boxes alone, a tenth of the pixels", share("tenth_permille")),
        row("match around one such box alone", share("one_box_permille")),
        row("list of all points", millions(m7(&["objects", "320x240", "points"]))),
        row("depth of eight objects", millions(m7(&["objects", "320x240", "eight"]))),
        row("72 sectors", millions(m7(&["autopilot", "obstacles"]))),
        row("two MAVLink messages", millions(m7(&["autopilot", "mavlink"]))),
        row("rectify both images, 75 degrees of view", rectify("moderate")),
        row("rectify both images, 110 degrees, strong barrel", rectify("strong")),
        row("set up a rig once, 75 degrees", set_up("moderate")),
        row("set up a rig once, 110 degrees", set_up("strong")),
    ];
    let extras = table("Cortex-M7, 320x240 | million instructions", extras);
    Ok(format!(
        "\
## Cost of a pair on a board

`cargo xtask measure`, {date}. Million instructions to match two rectified frames, 64
disparities; what is asked of a pair comes on top. *Captured*: Middlebury scenes cut to the size.
*Built-in*: painted patterns, most of them worst cases.

{pairs}
By stage, median of the captured scenes:

{stages}
What else a pair can take:

{extras}"
    ))
}

/// Times of a board with cameras beside its instructions.
struct Camera {
    board: &'static str,
    /// Number of the instructions of a pair.
    matching: &'static [&'static str],
    megahertz: f64,
    /// Cycles an instruction: the least and the most that is expected.
    cycles: [f64; 2],
    /// Exposures of a pair, ms.
    exposure: [f64; 2],
    /// Readouts of a pair, ms.
    readout: f64,
}

/// Instructions of a pair on one core.
const ONE_CORE: &[&str] = &["mps2-an500", "captured", "320x240", "median"];
/// Clocks and sensors: pages of the boards.
const CAMERAS: [Camera; 4] = [
    Camera {
        board: "stm32h743",
        matching: ONE_CORE,
        megahertz: 400.0,
        cycles: [0.7, 1.1],
        exposure: [10.0, 10.0],
        readout: 13.2,
    },
    Camera {
        board: "portenta-h7",
        matching: ONE_CORE,
        megahertz: 400.0,
        cycles: [0.7, 1.1],
        exposure: [5.0, 5.0],
        readout: 7.0,
    },
    PICO_2,
    Camera {
        board: "pico2, two cores",
        matching: &["mps2-an505", "cores", "320x240", "busier"],
        ..PICO_2
    },
];
const PICO_2: Camera = Camera {
    board: "pico2",
    matching: ONE_CORE,
    megahertz: 150.0,
    cycles: [1.0, 1.3],
    exposure: [1.0, 32.0],
    readout: 31.0,
};

fn rates(stored: &Stored) -> Result<String> {
    let millions = |path: &[&str]| {
        let number = stored.number(&[&["boards"], path].concat());
        number
            .map(|number| number as f64 / 1e6)
            .with_context(|| format!("no number {}", path.join(".")))
    };
    let rows = millions(&["mps2-an500", "rectify", "moderate_320x240", "rows"])?;
    let range = |[least, most]: [f64; 2]| format!("{least:.0} to {most:.0}");
    let mut rates = Vec::new();
    for camera in CAMERAS {
        let ms = |millions: f64| {
            camera.cycles.map(|cycles| millions * cycles * 1000.0 / camera.megahertz)
        };
        let (matching, rectifying) = (ms(millions(camera.matching)?), ms(rows));
        let pair =
            [0, 1].map(|i| camera.exposure[i] + camera.readout.max(rectifying[i]) + matching[i]);
        rates.push(vec![
            camera.board.to_owned(),
            format!("{:.0}", camera.megahertz),
            camera.cycles.map(|cycles| cycles.to_string()).join(" to "),
            range(rectifying),
            range(matching),
            range(pair),
            range([1000.0 / pair[1], 1000.0 / pair[0]]),
        ]);
    }
    let heads = "board | MHz | cycles each | rectify, ms | match, ms | pair, ms | pairs a second";
    let rates = table(heads, rates);
    Ok(format!(
        "\
## Estimated pairs a second

**Estimates by arithmetic, not measurements.** Instructions of a 320x240 pair, times an assumed
number of cycles each, and the exposure and readout of the board's cameras. Rows are rectified while
they are read. Caches and flash wait states come on top. `linestereo bench-board` measures true
cycles; no file has been sent yet. On the Pico 2 `live` uses both cores: the line for two has the
instructions of the busier one. That for one core holds where the second does not start.

{rates}"
    ))
}

fn memory(stored: &Stored) -> Result<String> {
    let taken = stored.scores.boards.get(BOARD_FILES[1]);
    let date = &taken.context("sizes of boards have no date")?.date;
    let kib =
        |bytes: Option<u64>| bytes.map_or("-".to_owned(), |bytes| bytes.div_ceil(1024).to_string());
    let sizes = stored.sizes.iter().filter(|(_, size)| size.is_table()).map(|(board, _)| {
        let size = |what| kib(number(&stored.sizes, &[board, what]));
        vec![board.clone(), size("flash"), size("ram")]
    });
    let sizes = table("board | flash, KiB | RAM, KiB", sizes);
    let used = [("mps2-an500", "320x240"), ("mps2-an386", "160x120")].map(|(board, pair)| {
        let of = |what| kib(stored.number(&["boards", board, "bytes", what]));
        vec![format!("{board}, {pair}"), of("static_ram"), of("stack_used"), of("ram")]
    });
    let used = table("KiB | frames, rig and lists | stack used | together", used);
    Ok(format!(
        "\
## RAM and flash

`cargo xtask footprint`, {date}. The program `live` without logs: cameras, matching, objects,
sectors, host and autopilot. RAM includes both frames and all that is set aside for stacks.

{sizes}
RAM that a pair uses, from `cargo xtask measure`:

{used}"
    ))
}
