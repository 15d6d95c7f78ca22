//! Words of the command line to requests.
//!
//! In: `start`, `stop`, `describe`, `photograph`, `sync`, `settings`, `keep`, `defaults`,
//! `bootloader`, `rig=FILE`, `box=...`, `NAME=VALUE`. Out: requests in the same order; neighbouring
//! parameters go together, so that two which only fit together can be changed, and so do
//! neighbouring boxes. Ranges are the board's to check; here a value only has to be one that can be
//! sent.

use anyhow::{Context, Result, anyhow, bail};
use core::str::FromStr;
use linestereo::params::{Margin, Parts};
use linestereo::units::{Confidence, Depth, Disparity};
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use linestereo_rig::RigImage;
use linestereo_wire::{
    KeptReport, MAX_REGIONS, ParamUpdate, RegionBox, Regions, Request, RigBytes, RigUpdate,
    Setting, SettingValue,
};

/// Every name of a parameter that can stand before `=`; those of the vehicle are [`Setting`]s.
pub const NAMES: [&str; 15] = [
    "min_disparity", "max_disparity", "anchor_gradient", "edge_gradient", "min_extent", "cell",
    "reach", "min_confidence", "margin_px", "margin_nearer_m", "margin_farther_m", "focal_px",
    "baseline_m", "offset_px", "parts",
];

/// A request and how it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    pub request: Request,
    pub words: String,
}

pub fn parse(words: &[String]) -> Result<Vec<Wanted>> {
    let mut list = Vec::new();
    for group in words.chunk_by(|before, after| {
        Kind::of(before) == Kind::of(after) && Kind::of(after).goes_together()
    }) {
        let request = match group {
            [word, ..] if Kind::of(word) == Kind::Box => regions(group, false)?,
            [word, ..] if Kind::of(word) == Kind::OnlyBox => regions(group, true)?,
            [word] if Kind::of(word) == Kind::Rig => rig(word)?,
            [word] if !word.contains('=') => match word.as_str() {
                "start" => Request::Start,
                "stop" => Request::Stop,
                "describe" => Request::Describe,
                "photograph" => Request::Photograph,
                "settings" => Request::Settings,
                "sync" => Request::ReadClock,
                "bootloader" => Request::Bootloader,
                "keep" => Request::KeepSettings,
                "defaults" => Request::ResetSettings,
                _ => bail!(
                    "--send {word} is unknown; give start, stop, describe, photograph, sync, \
                     settings, keep, defaults, bootloader, rig=FILE, box= or only_box=LABEL:LEFT,TOP,RIGHT,BOTTOM, or NAME=VALUE"
                ),
            },
            [word] if Kind::of(word) == Kind::Vehicle => vehicle(word)?,
            parameters => Request::SetParams(update(parameters)?),
        };
        list.push(Wanted { request, words: group.join(" ") });
    }
    Ok(list)
}

/// Kind of request that a word stands for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Plain,
    Rig,
    Box,
    OnlyBox,
    Vehicle,
    Parameter,
}

impl Kind {
    fn of(word: &str) -> Self {
        match word.split_once('=') {
            None => Self::Plain,
            Some(("rig", _)) => Self::Rig,
            Some(("box", _)) => Self::Box,
            Some(("only_box" | "only-box", _)) => Self::OnlyBox,
            Some((name, _)) if vehicle_setting(name).is_some() => Self::Vehicle,
            Some(_) => Self::Parameter,
        }
    }

    /// Do neighbours of this kind make one request?
    const fn goes_together(self) -> bool {
        matches!(self, Self::Parameter | Self::Box | Self::OnlyBox)
    }
}

/// A rig for a board's flash: what `linestereo flash-image` writes.
fn rig(word: &str) -> Result<Request> {
    let path = word.split_once('=').map_or("", |(_, path)| path);
    let bytes = untrusted::read(path.as_ref(), SETTINGS_BYTES)
        .with_context(|| format!("--send {word}: {path} cannot be read"))?;
    RigImage::decode(&bytes).with_context(|| {
        format!("--send {word}: {path} is no rig for a board; make one with linestereo flash-image")
    })?;
    let bytes =
        RigBytes::from_slice(&bytes).map_err(|_| anyhow!("--send {word}: {path} is too long"))?;
    Ok(Request::SetRig(bytes))
}

/// Objects whose depths are wanted from now on; `none` asks for no more.
fn regions(words: &[String], only: bool) -> Result<Request> {
    let mut regions = Regions { only, ..Regions::default() };
    for word in words {
        let text = word.split_once('=').map_or("", |(_, text)| text);
        if text == "none" {
            regions.boxes.clear();
            continue;
        }
        let numbers: Option<Vec<u16>> =
            text.split([':', ',']).map(|number| number.trim().parse().ok()).collect();
        let Some(&[label, left, top, right, bottom]) = numbers.as_deref() else {
            bail!(
                "--send {word}: give LABEL:LEFT,TOP,RIGHT,BOTTOM in whole pixels of the \
                 rectified left image, or none"
            );
        };
        let of = RegionBox { label, left, top, right, bottom };
        regions
            .boxes
            .push(of)
            .map_err(|_| anyhow!("--send {word}: a board takes {MAX_REGIONS} boxes"))?;
    }
    Ok(Request::SetRegions(regions))
}

fn update(words: &[String]) -> Result<ParamUpdate> {
    let mut update = ParamUpdate::default();
    let [mut nearer, mut farther, mut focal, mut baseline, mut offset] = [None; 5];
    for word in words {
        let (name, text) =
            word.split_once('=').ok_or_else(|| anyhow!("--send {word}: give NAME=VALUE"))?;
        let value = Value { word, text };
        match name.replace('-', "_").as_str() {
            "min_disparity" => update.min_disparity = Some(value.whole()?),
            "max_disparity" => update.max_disparity = Some(value.whole()?),
            "anchor_gradient" => update.anchor_gradient = Some(value.whole()?),
            "edge_gradient" => update.edge_gradient = Some(value.whole()?),
            "min_extent" => update.min_extent = Some(value.whole()?),
            "cell" => update.cell = Some(value.whole()?),
            "reach" => update.reach = Some(value.whole()?),
            "min_confidence" => {
                let probability = value.checked("0 to 0.9999", Confidence::checked_from_num)?;
                update.min_confidence = Some(probability);
            }
            "margin_px" => {
                let margin = value.checked("-512 to 511", Disparity::checked_from_num)?;
                update.margin = Some(Margin::Pixels(margin));
            }
            "margin_nearer_m" => nearer = Some(value.metres()?),
            "margin_farther_m" => farther = Some(value.metres()?),
            "focal_px" => focal = Some(value.number()?),
            "baseline_m" => baseline = Some(value.number()?),
            "offset_px" => offset = Some(value.number()?),
            "parts" => {
                update.parts = Some(match text {
                    "both" => Parts::Both,
                    "support" => Parts::Support,
                    _ => bail!("--send {word}: parts are both or support"),
                });
            }
            _ => {
                let vehicle = Setting::ALL.split_at(Setting::VEHICLE).1.iter().map(|of| of.name);
                bail!(
                    "--send {word}: {name} is no parameter; there are {}, and of the vehicle {}",
                    NAMES.join(", "),
                    vehicle.collect::<Vec<_>>().join(", ")
                )
            }
        }
    }
    match (nearer, farther) {
        (None, None) => {}
        (Some(_), Some(_)) if update.margin.is_some() => {
            bail!(
                "--send sets the margin in pixels and in metres; give margin_px, or \
                 margin_nearer_m and margin_farther_m"
            )
        }
        (Some(nearer), Some(farther)) => {
            let [nearer, farther] = [nearer, farther].map(Depth::from_num);
            update.margin = Some(Margin::Metres { nearer, farther });
        }
        _ => bail!(
            "--send sets half of a margin; give margin_nearer_m and margin_farther_m one after \
             the other"
        ),
    }
    match (focal, baseline) {
        (None, None) if offset.is_none() => {}
        (Some(focal_px), Some(baseline_m)) => {
            update.rig = Some(RigUpdate { focal_px, baseline_m, offset_px: offset.unwrap_or(0.0) });
        }
        _ => bail!(
            "--send sets part of a rig; give focal_px and baseline_m (and offset_px) one after \
             the other"
        ),
    }
    Ok(update)
}

/// Number of a setting of the vehicle.
fn vehicle_setting(name: &str) -> Option<u8> {
    Setting::number(name.replace('-', "_").as_bytes())
        .filter(|&number| usize::from(number) >= Setting::VEHICLE)
}

/// Words of settings whose values are a choice.
const CHOICES: [(&str, &[&str]); 4] = [
    ("parts", &["both", "support"]),
    ("policy", &["silent", "block", "unknown"]),
    ("distance_sensor", &["off", "on"]),
    ("sectors", &["off", "on"]),
];

/// A change of the vehicle.
fn vehicle(word: &str) -> Result<Request> {
    let (name, text) =
        word.split_once('=').ok_or_else(|| anyhow!("--send {word}: give NAME=VALUE"))?;
    let number =
        vehicle_setting(name).ok_or_else(|| anyhow!("--send {word}: {name} is no setting"))?;
    let name = Setting::ALL[usize::from(number)].name;
    let value = match choices(name) {
        Some(choices) => {
            let place = choices.iter().position(|&choice| choice == text);
            place.ok_or_else(|| anyhow!("--send {word}: {name} is {}", choices.join(" or ")))?
                as f32
        }
        None => Value { word, text }.number()? as f32,
    };
    Ok(Request::Set(SettingValue { number, value }))
}

fn choices(name: &str) -> Option<&'static [&'static str]> {
    CHOICES.iter().find(|(of, _)| *of == name).map(|(_, choices)| *choices)
}

/// Settings as the words that would set them, and what is kept of them.
pub fn listing(values: &[SettingValue], report: &KeptReport) -> String {
    let words =
        values.iter().filter_map(|of| {
            let name = Setting::get(of.number)?.name;
            let choice = choices(name).and_then(|choices| choices.get(of.value as usize));
            Some(choice.map_or_else(
                || format!("{name}={}", of.value),
                |choice| format!("{name}={choice}"),
            ))
        });
    let words: Vec<String> = words.collect();
    let kept = if report.is_kept { "kept" } else { "not kept: lost with the next reset" };
    let slots = report.slots.map(|slot| {
        slot.map_or_else(|fault| fault.to_string(), |number| format!("image {number}"))
    });
    format!("settings ({kept}; slots: {}): {}", slots.join(", "), words.join(" "))
}

/// A word `key=value` and its value.
struct Value<'a> {
    word: &'a str,
    text: &'a str,
}

impl Value<'_> {
    /// A whole number of 16 bits.
    fn whole<T: FromStr>(&self) -> Result<T> {
        self.text.parse().map_err(|_| {
            anyhow!("--send {}: {} is no whole number of 16 bits", self.word, self.text)
        })
    }

    fn number(&self) -> Result<f64> {
        self.text.parse().map_err(|_| anyhow!("--send {}: {} is no number", self.word, self.text))
    }

    fn checked<T>(&self, range: &str, convert: impl FnOnce(f64) -> Option<T>) -> Result<T> {
        let number = Some(self.number()?).filter(|number| number.is_finite());
        number.and_then(convert).ok_or_else(|| {
            anyhow!("--send {}: {} cannot be sent; give {range}", self.word, self.text)
        })
    }

    /// A depth in metres that fits its format.
    fn metres(&self) -> Result<f64> {
        self.checked("0.001 to 1000", |metres| Depth::checked_from_num(metres).map(|_| metres))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Area;
    use linestereo_wire::RigFault;

    fn requests(words: &[&str]) -> Result<Vec<Request>> {
        let words: Vec<String> = words.iter().map(ToString::to_string).collect();
        Ok(parse(&words)?.into_iter().map(|wanted| wanted.request).collect())
    }

    #[test]
    fn neighbouring_parameters_go_together() {
        let none = ParamUpdate::default();
        let list =
            requests(&["stop", "cell=8", "min-disparity=-3", "start", "reach=2", "describe"])
                .unwrap();
        let first = ParamUpdate { cell: Some(8), min_disparity: Some(-3), ..none };
        let second = ParamUpdate { reach: Some(2), ..none };
        let expected = [
            Request::Stop,
            Request::SetParams(first),
            Request::Start,
            Request::SetParams(second),
            Request::Describe,
        ];
        assert_eq!(list, expected);
    }

    #[test]
    fn neighbouring_boxes_go_together_and_none_clears() {
        let list = requests(&[
            "box=1:10,20,30,40", "box=2:0,0,9,9", "cell=8", "only_box=3:1,2,3,4", "box=none",
        ])
        .unwrap();
        let boxes = |list: &[[u16; 5]], only| {
            let of = |&[label, left, top, right, bottom]: &[u16; 5]| {
                RegionBox::from((label, Area { left, top, right, bottom }))
            };
            Request::SetRegions(Regions { boxes: list.iter().map(of).collect(), only })
        };
        assert_eq!(list.len(), 4);
        assert_eq!(list[0], boxes(&[[1, 10, 20, 30, 40], [2, 0, 0, 9, 9]], false));
        assert_eq!(list[2..], [boxes(&[[3, 1, 2, 3, 4]], true), boxes(&[], false)]);
    }

    #[test]
    fn a_rig_is_checked_before_it_is_sent() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let word = format!("rig={}", file.path().display());
        let error = format!("{:#}", requests(&[&word]).unwrap_err());
        assert!(error.contains("flash-image"), "{error}");
        assert!(requests(&["rig=nowhere.bin"]).unwrap_err().to_string().contains("cannot be read"));
    }

    #[test]
    fn every_name_is_known_and_sets_its_field() {
        let words: Vec<String> = NAMES
            .iter()
            .filter(|name| !["margin_px", "parts"].contains(name))
            .map(|name| format!("{name}=0.25"))
            .collect();
        let (whole, fractions) = words.split_at(7);
        let whole: Vec<String> = whole
            .iter()
            .enumerate()
            .map(|(i, word)| word.replace("0.25", &i.to_string()))
            .collect();
        let expected = ParamUpdate {
            min_disparity: Some(0),
            max_disparity: Some(1),
            anchor_gradient: Some(2),
            edge_gradient: Some(3),
            min_extent: Some(4),
            cell: Some(5),
            reach: Some(6),
            min_confidence: Some(Confidence::from_num(0.25)),
            margin: Some(Margin::Metres {
                nearer: Depth::from_num(0.25),
                farther: Depth::from_num(0.25),
            }),
            rig: Some(RigUpdate { focal_px: 0.25, baseline_m: 0.25, offset_px: 0.25 }),
            parts: None,
        };
        assert_eq!(update(&[&whole[..], fractions].concat()).unwrap(), expected);
        let pixels = ParamUpdate {
            margin: Some(Margin::Pixels(Disparity::from_num(0.25))),
            ..ParamUpdate::default()
        };
        assert_eq!(update(&["margin_px=0.25".to_owned()]).unwrap(), pixels);
        let parts = ParamUpdate { parts: Some(Parts::Support), ..ParamUpdate::default() };
        assert_eq!(update(&["parts=support".to_owned()]).unwrap(), parts);
    }

    /// The words with which a board lists its settings set them.
    #[test]
    fn the_list_of_settings_can_be_sent() {
        let words =
            ["yaw_deg=-12.5", "range_m=6", "lowest-m=-1", "highest_m=2", "system=7", "rate_hz=12"];
        let more = ["policy=silent", "block_cm=80", "distance_sensor=on"];
        let sent = requests(&[&words[..], &more].concat()).unwrap();
        let of_vehicle = [-12.5, 6.0, -1.0, 2.0, 7.0, 12.0, 0.0, 80.0, 1.0];
        let set = |(number, value)| Request::Set(SettingValue { number, value });
        assert_eq!(sent, (9..).zip(of_vehicle).map(set).collect::<Vec<_>>());

        let of_params = [-2.0, 64.0, 48.0, 20.0, 6.0, 16.0, 4.0, 0.5, 1.0];
        let values = (0..)
            .zip([of_params, of_vehicle].concat())
            .map(|(number, value)| SettingValue { number, value });
        let report = KeptReport { is_kept: false, slots: [Ok(3), Err(RigFault::Empty)] };
        let text = listing(&values.collect::<Vec<_>>(), &report);
        let (head, words) = text.split_once("): ").unwrap();
        assert_eq!(head, "settings (not kept: lost with the next reset; slots: image 3, empty");
        let all = requests(&words.split(' ').collect::<Vec<_>>()).unwrap();
        assert_eq!(all[1..], sent);
        let params = ParamUpdate {
            min_disparity: Some(-2),
            max_disparity: Some(64),
            anchor_gradient: Some(48),
            edge_gradient: Some(20),
            min_extent: Some(6),
            cell: Some(16),
            reach: Some(4),
            min_confidence: Some(Confidence::from_num(0.5)),
            parts: Some(Parts::Support),
            ..ParamUpdate::default()
        };
        assert_eq!(all[0], Request::SetParams(params));
        assert_eq!(
            requests(&["settings", "keep", "defaults"]).unwrap(),
            [Request::Settings, Request::KeepSettings, Request::ResetSettings]
        );
    }

    #[test]
    fn what_cannot_be_sent_is_named() {
        let cases: [(&[&str], &str); 20] = [
            (&["policy=stop"], "silent or block or unknown"),
            (&["distance_sensor=1"], "off or on"),
            (&["range_m=far"], "no number"),
            (&["begin"], "begin"),
            (&["box=1,2,3"], "LABEL:LEFT,TOP,RIGHT,BOTTOM"),
            (&["box=1:2,x,3,4,5"], "whole pixels"),
            (&["box=0:0,0,9,9"; 17], "16 boxes"),
            (&["size=3"], "size is no parameter"),
            (&["cell="], "no whole number"),
            (&["cell=8.5"], "8.5"),
            (&["cell=65536"], "65536"),
            (&["max_disparity=-1"], "max_disparity=-1"),
            (&["min_confidence=1"], "min_confidence=1"),
            (&["min_confidence=NaN"], "NaN"),
            (&["margin_px=512"], "512"),
            (&["focal_px=400"], "baseline_m"),
            (&["focal_px=400", "start", "baseline_m=0.1"], "one after the other"),
            (&["offset_px=1"], "part of a rig"),
            (&["margin_nearer_m=1"], "margin_farther_m"),
            (&["margin_nearer_m=1", "margin_farther_m=1", "margin_px=1"], "margin_px"),
        ];
        for (words, says) in cases {
            let error = requests(words).unwrap_err().to_string();
            assert!(error.contains(says), "{words:?} does not say {says}: {error}");
        }
    }
}
