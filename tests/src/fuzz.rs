//! Every input of others, as a function of bytes that may do nothing but return:
//! `fuzz/fuzz_targets` calls one by coverage, `tests/tests/fuzz.rs` all of them for some seconds.
//!
//! ```text
//! wire          a byte for the direction, then a record: framed, decoded, encoded again; settings
//!               are planned
//! rig_image     a rig for a board's flash, its checksum put right: decoded, encoded again, its
//!               meshes built
//! rig_files     a byte for the format, then a file: read, written in every format, read again
//! images        an image file as grey
//! disparities   PFM, NPY or NPZ
//! objects       a byte for the kind and one for the reduction, then a file of a detector: regions
//!               that the core takes
//! recordings    MCAP: pairs found, images of each decoded
//! videos        Y4M: the same
//! pair          size, settings, an area and pixels that repeat: matched, twice to the same result
//! ```

use crate::drawn::Random;
use core::cell::RefCell;
use crc::{CRC_32_ISO_HDLC, Crc};
use linestereo::{Area, Dims, Gray, Params};
use linestereo_calibration::interchange::{self, Format, Options};
use linestereo_calibration::rectify::PairRectifier;
use linestereo_frames::regions::{self, Frame};
use linestereo_frames::{FrameError, StoredPair, load_disparities, load_gray, load_images};
use linestereo_recordings::Footage;
use linestereo_rig::RigImage;
use linestereo_sim::engine::Engine;
use linestereo_wire::{
    Command, Decoder, MAX_COMMAND, MAX_PACKET, Message, ParamUpdate, Record, Request, encode,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A function of bytes.
pub type Target = fn(&[u8]);

/// Every function, with the name of its corpus.
pub const TARGETS: [(&str, Target); 9] = [
    ("wire", wire),
    ("rig_image", rig_image),
    ("rig_files", rig_files),
    ("images", images),
    ("disparities", disparities),
    ("objects", objects),
    ("recordings", |bytes| _ = footage("mcap", bytes)),
    ("videos", |bytes| _ = footage("y4m", bytes)),
    ("pair", pair),
];

const CRC_32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
const DIMS: Dims = Dims { width: 64, height: 48 };
/// Lengths whose sums and products overflow, and limits of ours.
const EXTREMES: [u64; 8] =
    [0, 9, 0x7fff_ffff, 0xffff_ffff, 1 << 25, (1 << 25) + 1, 1 << 40, u64::MAX];

/// The examples of a function.
///
/// # Panics
/// Without its folder.
pub fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(name);
    let mut files: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// One of these inputs with bytes changed, parts cut, repeated or of another input, or numbers that
/// lengths overflow by.
#[must_use]
pub fn mutated(inputs: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let pick = |random: &mut Random| &inputs[random.index(inputs.len())];
    let mut bytes = pick(random).clone();
    // One change in half of the inputs, two in a quarter: what lies behind them is reached.
    for _ in 0..=random.bits().trailing_zeros() {
        let length = bytes.len();
        let from = random.index(length + 1);
        let longest = if random.below(4) == 0 { length } else { 16 };
        let part = from..(from + random.index(longest + 1)).min(length);
        let at = random.index(length);
        match random.below(11) {
            _ if bytes.is_empty() => bytes.push(random.bits() as u8),
            0..=2 => bytes[at] ^= 1 << random.below(8),
            3 => bytes[at] = random.bits() as u8,
            4 => bytes[at] = *b"0-9.e,[{\xff\x80 \n".get(random.index(13)).unwrap_or(&0),
            5..=6 => {
                let extreme = EXTREMES[random.index(EXTREMES.len())].to_le_bytes();
                let width = [1, 4, 8][random.index(3)].min(length - from);
                bytes[from..from + width].copy_from_slice(&extreme[..width]);
            }
            7 => _ = bytes.drain(part),
            8 => bytes.splice(from..from, bytes[part].to_vec()).for_each(drop),
            9 => {
                let other = pick(random);
                let end = random.index(other.len() + 1);
                bytes
                    .splice(part, other[end.saturating_sub(16)..end].iter().copied())
                    .for_each(drop);
            }
            _ => bytes.truncate(from),
        }
    }
    bytes
}

/// Packets of both directions.
pub fn wire(bytes: &[u8]) {
    let Some((direction, record)) = bytes.split_first() else { return };
    if direction % 2 == 0 {
        record_again::<Message, MAX_PACKET>(record);
    } else if let Some(command) = record_again::<Command, MAX_COMMAND>(record) {
        match command.request {
            Request::SetParams(update) => _ = update.checked(Params::default(), DIMS),
            Request::SetRig(bytes) => _ = RigImage::decode(&bytes),
            Request::SetRegions(asked) => {
                asked.boxes.iter().for_each(|asked| _ = asked.region(DIMS))
            }
            _ => {}
        }
    }
}

/// The record in a payload; what is decoded is encoded to bytes that decode to it.
fn record_again<T: Record, const N: usize>(record: &[u8]) -> Option<T> {
    let mut decoder = Decoder::<T, N>::new();
    // As it came, and as a whole packet.
    for &byte in record {
        let _ = decoder.push(byte);
    }
    let _ = decoder.push(0);
    let payload = sealed([&[T::TAG], record, &[0; 4]].concat());
    let mut packet = vec![0; cobs::max_encoding_length(payload.len()) + 1];
    cobs::encode(&payload, &mut packet);
    let decoded = packet.iter().find_map(|&byte| decoder.push(byte))?.ok()?;
    let (mut first, mut second) = ([0; MAX_PACKET], [0; MAX_PACKET]);
    let encoded = encode(&decoded, &mut first).expect("a record fits the largest packet");
    let again =
        encoded.iter().find_map(|&byte| decoder.push(byte)).expect("a packet").expect("a record");
    assert_eq!(encode(&again, &mut second), Ok(encoded));
    Some(decoded)
}

/// Bytes whose last four are the checksum of those before it.
pub fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some((content, crc)) = bytes.split_last_chunk_mut::<4>() {
        *crc = CRC_32.checksum(content).to_le_bytes();
    }
    bytes
}

/// A rig for a board.
pub fn rig_image(bytes: &[u8]) {
    let image = sealed(bytes.to_vec());
    let Ok(rig) = RigImage::decode(&image) else { return };
    assert_eq!(RigImage::decode(&rig.encode(7)), Ok(rig));
    let _ = rig.params(Params::default());
    let _ = PairRectifier::new(rig.remap());
}

/// Calibrations of every format.
pub fn rig_files(bytes: &[u8]) {
    let Some((kind, text)) = bytes.split_first() else { return };
    let name = ["rig.toml", "rig.yaml", "rig.xml", "rig.txt"][usize::from(kind % 4)];
    let path = file(name, text);
    let swap = kind & 4 != 0;
    let files = if kind & 8 == 0 { vec![path] } else { vec![path.clone(), path] };
    let Ok(read) = interchange::load_rig(&files, &Options { swap, ..Options::default() }) else {
        return;
    };
    for format in [
        Format::RigToml,
        Format::OpencvYaml,
        Format::OpencvXml,
        Format::Kalibr,
        Format::Ros,
        Format::Euroc,
    ] {
        let Ok(written) = interchange::export(&read.rig, format) else { continue };
        let name = |index| {
            if format == Format::RigToml {
                "again.toml".to_owned()
            } else {
                format!("again{index}")
            }
        };
        let files: Vec<PathBuf> = (0..)
            .zip(&written.texts)
            .map(|(i, text): (u8, _)| file(&name(i), text.as_bytes()))
            .collect();
        let again =
            interchange::load_rig(&files, &Options { from: Some(format), ..Options::default() });
        assert!(again.is_ok(), "{format}: {again:?}");
    }
}

/// Image files.
pub fn images(bytes: &[u8]) {
    let Ok(image) = load_gray(&file("image", bytes)) else { return };
    assert_eq!(image.pixels.len(), usize::from(image.dims.width) * usize::from(image.dims.height));
}

/// Files of disparities.
pub fn disparities(bytes: &[u8]) {
    let Ok((dims, values)) = load_disparities(&file("disparities", bytes)) else { return };
    assert_eq!(values.len(), usize::from(dims.width) * usize::from(dims.height));
}

/// Files of detectors.
pub fn objects(bytes: &[u8]) {
    let [kind, reduction, text @ ..] = bytes else { return };
    let matched = [DIMS, Dims { width: 48, height: 36 }, Dims { width: 31, height: 23 }]
        [usize::from(reduction % 3)];
    let path = file(["o.json", "o.txt", "o.csv", "o.pgm"][usize::from(kind % 4)], text);
    let Ok(objects) = regions::load(
        &path,
        None,
        Frame { given: DIMS, matched, image: Some(Path::new("left.png")) },
    ) else {
        return;
    };
    assert!(objects.list.len() <= regions::MAX_OBJECTS);
    for object in &objects.list {
        object.region(matched).expect("a region of the image");
    }
}

/// Recordings and videos, by the ending of their names: the number of pairs whose images are read.
///
/// # Errors
/// As [`Footage::open`].
pub fn footage(ending: &str, bytes: &[u8]) -> Result<usize, FrameError> {
    let found = Footage::open(&file(&format!("footage.{ending}"), bytes), false, || false)?;
    let is_read =
        |pair: &&StoredPair| pair.info().is_ok() & load_images(&pair.images, None).is_ok();
    Ok(found.pairs.iter().filter(is_read).count())
}

/// A pair of images, matched with any settings in any area.
pub fn pair(bytes: &[u8]) {
    let &[
        width,
        height,
        range,
        first,
        gradient,
        cell,
        extent,
        reach,
        left,
        top,
        right,
        bottom,
        ref pixels @ ..,
    ] = bytes
    else {
        return;
    };
    if pixels.is_empty() {
        return;
    }
    let dims = Dims { width: 16 + u16::from(width), height: 16 + u16::from(height) };
    let update = ParamUpdate {
        min_disparity: Some(-i16::from(first)),
        max_disparity: Some(8 + u16::from(range)),
        anchor_gradient: Some(gradient.into()),
        edge_gradient: Some(u16::from(gradient / 2)),
        min_extent: Some(extent.into()),
        cell: Some(8 + u16::from(cell)),
        reach: Some(reach.into()),
        ..ParamUpdate::default()
    };
    // Refused parameters are left out, so that most inputs are matched.
    let params = update
        .checked(Params::default(), dims)
        .or_else(|_| {
            ParamUpdate { max_disparity: Some(8), ..ParamUpdate::default() }
                .checked(Params::default(), dims)
        })
        .expect("fits any image");
    let count = usize::from(dims.width) * usize::from(dims.height);
    let image =
        |from: usize| pixels.iter().cycle().skip(from).take(count).copied().collect::<Vec<u8>>();
    let images = [image(0), image(usize::from(range) % pixels.len())];
    let [left_image, right_image] = images
        .each_ref()
        .map(|image| Gray::new(image, dims, dims.width.into()).expect("of its size"));
    let area =
        Area { left: left.into(), top: top.into(), right: right.into(), bottom: bottom.into() };
    ENGINES.with_borrow_mut(|engines| {
        if engines.len() > MOST_ENGINES {
            engines.clear();
        }
        let key = format!("{params:?} {dims}");
        let engine =
            engines.entry(key).or_insert_with(|| Engine::new(&params, dims).expect("was planned"));
        let run = |engine: &mut Engine| {
            // Without health, which refuses most of what is drawn so.
            let matched = engine.run_in_place(left_image, right_image);
            crate::answers(&mut matched.expect("of the planned size"))
        };
        let first = run(engine);
        for point in &first.1 {
            assert!(point.x < dims.width && point.y < dims.height);
        }
        engine.areas = Some(vec![area]);
        let _ = engine.run(left_image, right_image).expect("of the planned size");
        assert!(first == run(engine), "memory of another pair is seen");
    });
}

const MOST_ENGINES: usize = 8;

thread_local! {
    static ENGINES: RefCell<BTreeMap<String, Engine>> = const { RefCell::new(BTreeMap::new()) };
    static FOLDER: TempDir = TempDir::new().expect("a place for files");
}

/// A file with this content.
fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = FOLDER.with(|folder: &TempDir| Path::join(folder.path(), name));
    fs::write(&path, bytes).expect("a file");
    path
}
