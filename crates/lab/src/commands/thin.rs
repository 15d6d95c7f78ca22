//! `linestereo-lab thin`: poles pasted into pairs with truth, and what must be refused.

use super::batch::collect;
use crate::fitting::{bar_source_text, fit_bars};
use crate::thin::{
    Background, Judged, PastedPair, Refused, Rows, Said, Told, Toll, composite, judge,
};
use anyhow::{Result, bail};
use core::fmt::Write;
use linestereo_calibration::rectify_raw;
use linestereo_frames::SplitMix64;
use linestereo_sim::commands::pairs::for_each_pair;
use linestereo_sim::output::{OutputFiles, OutputPath, print, say};
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  linestereo-lab thin frames/middlebury2006_third
      poles pasted into these scenes and before drawn walls, and what must be refused
  linestereo-lab thin frames/qvga frames/robot_world --count 1500 --seed 11 --fit core/src
      the models of bars, fitted on poles pasted into these scenes and on what is in them

Columns:
  rows      of each pole's rows, %: within 1 px / given what is behind / else wrong, at p >= 0.9
  objects   poles by their masks, %: right / wrong
  pixels    of what must be refused: pixels with a disparity, and % of these that are wrong";

/// Images wider than this are not pasted into, px.
const WIDEST: u16 = 480;

/// Score thin things: poles pasted into pairs with truth, with bars and without.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Folders to search for pairs with ground truth, at any depth.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Pairs with poles; a fifth as many of each kind that must be refused.
    #[arg(long, value_name = "N", default_value_t = 200)]
    count: usize,
    /// Seed of everything random.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Fit the model of bars on the poles, and write it below the folder core/src.
    #[arg(long, value_name = "CORE")]
    fit: Option<PathBuf>,
    /// Score the pairs as they are alone: bars told, and how many are wrong.
    #[arg(long)]
    untouched: bool,
    /// Write the figures as JSON to FILE, or to stdout with "-".
    #[arg(long, value_name = "FILE")]
    json: Option<OutputPath>,
}

/// A pair, judged without bars and with them.
struct Outcome {
    pair: PastedPair,
    judged: [Judged; 2],
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<()> {
    let found = collect(&args.folders, true)?;
    let mut scenes = Vec::new();
    for stored in &found.pairs {
        let scene = stored.load(None, &rectify_raw)?;
        scenes.push(PastedPair::of_scene(&scene)?);
    }
    if args.untouched {
        return untouched(&scenes);
    }
    scenes.retain(|pair| pair.width() <= usize::from(WIDEST));
    if scenes.is_empty() {
        bail!("no pair is at most {WIDEST} px wide; give smaller ones");
    }
    let seeds: Vec<u64> =
        (0..args.count as u64).map(|k| args.seed.wrapping_mul(0x1_0001).wrapping_add(k)).collect();
    let poles = outcomes(&seeds, |random| composite(random, &scenes))?;
    if let Some(folder) = &args.fit {
        let few = &seeds[..seeds.len().div_ceil(5)];
        let mut all = poles;
        for kind in Refused::ALL {
            all.extend(outcomes(few, |random| kind.pair(random, &scenes))?);
        }
        return fit(args, folder, &scenes, all);
    }
    let mut report =
        Report { groups: groups(&poles), refused: Vec::new(), bars: calibration(&poles) };
    let few = &seeds[..seeds.len().div_ceil(5)];
    for kind in Refused::ALL {
        let judged = outcomes(few, |random| kind.pair(random, &scenes))?;
        report.refused.push(RefusedFigures::of(kind, &judged));
    }
    let mut output = OutputFiles::new();
    output.add_json(args.json.as_ref(), &report)?;
    output.commit_and_say(&report.table())
}

fn outcomes(
    seeds: &[u64],
    make: impl Fn(&mut SplitMix64) -> Option<PastedPair> + Sync,
) -> Result<Vec<Outcome>> {
    let all = for_each_pair(seeds, None, u64::to_string, |&seed| {
        let random = &mut SplitMix64(seed);
        let Some(pair) = make(random) else { return Ok(None) };
        let images = pair.captured(random);
        let judged = [judge(&pair, &images, false)?, judge(&pair, &images, true)?];
        Ok(Some(Outcome { pair, judged }))
    })?;
    Ok(all.into_iter().flatten().collect())
}

/// Fits on the poles, and on the scenes as they are.
fn fit(
    args: &Args,
    folder: &std::path::Path,
    scenes: &[PastedPair],
    poles: Vec<Outcome>,
) -> Result<()> {
    let mut samples: Vec<(String, Told)> = Vec::new();
    for (index, Outcome { pair, judged: [_, with] }) in poles.into_iter().enumerate() {
        // A wall is drawn once.
        let name = match pair.background {
            Background::Photograph => pair.name.clone(),
            _ => format!("{} {}", pair.name, index % 8),
        };
        samples.extend(with.rated.into_iter().map(|told| (name.clone(), told)));
    }
    for scene in scenes {
        let images = scene.captured(&mut SplitMix64(args.seed));
        let judged = judge(scene, &images, true)?;
        samples.extend(judged.rated.into_iter().map(|told| (scene.name.clone(), told)));
    }
    let names =
        args.folders.iter().filter_map(|folder| folder.file_name()?.to_str()).collect::<Vec<_>>();
    let origin = format!(
        "{} pairs with poles in scenes of {}, and what repeats",
        args.count,
        names.join(", ")
    );
    let path = folder.join("bars/fitted.rs");
    let mut files = OutputFiles::default();
    files.add(
        &path,
        bar_source_text(&[true, false].map(|is_in_front| fit_bars(&samples, is_in_front)), &origin)
            .as_bytes(),
    )?;
    files.commit()?;
    say(&format!("wrote {} from {} bars\n", path.display(), samples.len()))
}

/// Bars told of pairs as they are.
fn untouched(scenes: &[PastedPair]) -> Result<()> {
    let (mut text, mut all, mut off) = (String::new(), 0, 0);
    for scene in scenes {
        let judged = judge(scene, &scene.stored(), true)?;
        for told in &judged.told {
            let [top, end] = told.bar.rows();
            let error = told.error.unwrap_or(f64::NAN);
            all += usize::from(told.error.is_some());
            off += usize::from(error > 1.0);
            if error > 1.0 || told.share_off() > 0.5 {
                let at = told.bar.columns(top).start;
                let (d, p): (f64, f64) =
                    (told.bar.disparity()[0].to_num(), told.bar.confidence().to_num());
                writeln!(
                    text,
                    "  {}: x {at} rows {top} to {end}, {d:.1} px, {error:.1} px off, \
                     {:.0} % of its pixels off, width {:.1}, p {p:.3}",
                    scene.name,
                    100.0 * told.share_off(),
                    told.bar.width().to_num::<f64>()
                )?;
            }
        }
    }
    writeln!(text, "{} pairs: {all} bars told with truth, {off} wrong", scenes.len())?;
    print(&text)
}

#[derive(Serialize)]
struct Report {
    groups: Vec<Figures>,
    refused: Vec<RefusedFigures>,
    /// Bars told by their probability: from, number, said, right.
    bars: Vec<(f64, usize, f64, f64)>,
}

/// Poles of one kind.
#[derive(Serialize)]
struct Figures {
    name: String,
    poles: usize,
    /// Shares of rows, %: right, what is behind, else wrong; without bars and with them.
    rows: [[f64; 3]; 2],
    /// Shares of masks, %: right, wrong.
    objects: [[f64; 2]; 2],
}

impl Figures {
    fn of(name: String, said: &[[Said; 2]]) -> Self {
        let share = |of: f64| 100.0 * of / said.len() as f64;
        let rows = [0, 1].map(|state: usize| {
            let mean = |of: &dyn Fn(Rows) -> usize| {
                let rows = said.iter().map(|said| said[state].rows);
                share(rows.map(|rows| of(rows) as f64 / rows.all.max(1) as f64).sum())
            };
            [mean(&|rows| rows.right), mean(&|rows| rows.behind), mean(&|rows| rows.wrong)]
        });
        let objects = [0, 1].map(|state: usize| {
            let count = |right: bool| {
                said.iter().filter(|said| said[state].object == Some(right)).count() as f64
            };
            [share(count(true)), share(count(false))]
        });
        Self { name, poles: said.len(), rows, objects }
    }
}

/// A kind that must be refused.
#[derive(Serialize)]
struct RefusedFigures {
    name: &'static str,
    pairs: usize,
    /// Pixels with a disparity, and % of them that are wrong; without bars and with them.
    pixels: [(usize, f64); 2],
    /// Bars told, and wrong ones.
    bars: [usize; 2],
}

impl RefusedFigures {
    fn of(kind: Refused, judged: &[Outcome]) -> Self {
        let pixels = [0, 1].map(|state: usize| {
            let tolls = judged.iter().map(|outcome| outcome.judged[state].toll);
            let Toll { said, wrong } = tolls.fold(Toll::default(), |a, b| Toll {
                said: a.said + b.said,
                wrong: a.wrong + b.wrong,
            });
            (said, 100.0 * wrong as f64 / said.max(1) as f64)
        });
        Self { name: kind.name(), pairs: judged.len(), pixels, bars: told(judged) }
    }
}

/// Bars told, and those that are wrong.
fn told(judged: &[Outcome]) -> [usize; 2] {
    let errors: Vec<f64> =
        judged.iter().flat_map(|o| o.judged[1].told.iter().filter_map(|told| told.error)).collect();
    [errors.len(), errors.iter().filter(|error| **error > 1.0).count()]
}

fn groups(poles: &[Outcome]) -> Vec<Figures> {
    let mut lists: Vec<(String, Vec<[Said; 2]>)> = Vec::new();
    let mut add =
        |name: String, said: [Said; 2]| match lists.iter_mut().find(|(other, _)| *other == name) {
            Some((_, list)) => list.push(said),
            None => lists.push((name, vec![said])),
        };
    for Outcome { pair, judged: [without, with] } in poles {
        for (pole, (&a, &b)) in pair.poles.iter().zip(without.poles.iter().zip(&with.poles)) {
            add(" all".to_owned(), [a, b]);
            add(format!("before {:?}", pair.background).to_lowercase(), [a, b]);
            add(format!("width {:3}", pole.width), [a, b]);
            add(format!("contrast {:3}", pole.contrast), [a, b]);
        }
    }
    lists.sort_by(|a, b| a.0.cmp(&b.0));
    lists.into_iter().map(|(name, said)| Figures::of(name.trim().to_owned(), &said)).collect()
}

fn calibration(poles: &[Outcome]) -> Vec<(f64, usize, f64, f64)> {
    let told: Vec<(f64, f64)> = poles
        .iter()
        .flat_map(|outcome| &outcome.judged[1].told)
        .filter_map(|told| Some((told.bar.confidence().to_num(), told.error?)))
        .collect();
    let bin = |(from, to): (f64, f64)| {
        let inside: Vec<_> = told.iter().filter(|(p, _)| (from..to).contains(p)).collect();
        let count = inside.len().max(1) as f64;
        let said = inside.iter().map(|(p, _)| p).sum::<f64>() / count;
        let right = inside.iter().filter(|(_, error)| *error <= 1.0).count() as f64 / count;
        (from, inside.len(), said, right)
    };
    [(0.9, 0.95), (0.95, 0.98), (0.98, 1.1)].map(bin).to_vec()
}

impl Report {
    fn table(&self) -> String {
        let mut text = format!(
            "{:22}{:>6}{:>24}{:>24}{:>30}\n",
            "", "poles", "rows, no bars", "bars", "objects, no bars > bars"
        );
        for Figures { name, poles, rows: [a, b], objects: [c, d] } in &self.groups {
            let _ = writeln!(
                text,
                "{name:22}{poles:6}{:>24}{:>24}{:>30}",
                format!("{:.1} / {:.1} / {:.1}", a[0], a[1], a[2]),
                format!("{:.1} / {:.1} / {:.1}", b[0], b[1], b[2]),
                format!("{:.0} / {:.1} > {:.0} / {:.1}", c[0], c[1], d[0], d[1]),
            );
        }
        for (from, count, said, right) in &self.bars {
            let _ = writeln!(
                text,
                "bars told at p from {from:.2}: {count}, said {said:.3}, right {right:.3}"
            );
        }
        let _ = writeln!(
            text,
            "{:26}{:>6}{:>22}{:>22}{:>14}",
            "", "pairs", "pixels, no bars", "bars", "told, wrong"
        );
        for RefusedFigures { name, pairs, pixels: [a, b], bars: [told, wrong] } in &self.refused {
            let pixels = |(said, wrong): &(usize, f64)| format!("{said}, {wrong:.1} %");
            let bars = format!("{told}, {wrong}");
            let _ =
                writeln!(text, "{name:26}{pairs:6}{:>22}{:>22}{bars:>14}", pixels(a), pixels(b));
        }
        text
    }
}
