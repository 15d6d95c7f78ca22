//! Settings of a board as numbered values, and as an image for two slots of a flash.
//!
//! In: parameters and vehicle. Out: [`SettingValues`] and back, and [`KeptSettings::BYTES`] bytes
//! and back.
//!
//! ```text
//! offset  bytes            words of 32 bits, little endian; the first twelve bytes and the last four are as in a rig image
//!      0      4  magic     "LSST"
//!      4    2+2  version   3, length of the whole image
//!      8      4  sequence  counted by boards that write images into two slots
//!     12      4  rig       number of the rig's image in the flash; all ones: no rig there
//!     16   20*4  values    f32 in the order of Setting::ALL; all ones: as the board was built
//!     96    2+2  boxes     how many, and 1 to match around them alone
//!    100  16*12  boxes     label, left, top, right, bottom, 0; zeros behind the last one
//!    292      4  CRC-32    of all bytes before it
//! ```

use crate::vehicle::{VEHICLE, Vehicle};
use linestereo::{Params, params::Parts, units::Confidence};
use linestereo_mavlink::Policy;
use linestereo_rig::RigImageError;
use linestereo_rig::checksum::{CRC_32, CRC_BYTES};
use linestereo_wire::{MAX_REGIONS, RegionBox, Regions, SETTINGS, SettingValues};

/// Numbers of the first settings, which a rig brings along: its disparity range.
pub const OF_RIG: usize = 2;

/// Settings as this program was built.
pub fn built() -> SettingValues {
    values(&Params::DEFAULT, &VEHICLE)
}

/// Parameters and vehicle as values.
pub fn values(params: &Params, vehicle: &Vehicle) -> SettingValues {
    let mut values = [0.0; SETTINGS];
    let of_params = [
        params.min_disparity.into(),
        params.max_disparity.into(),
        params.anchor_gradient.into(),
        params.edge_gradient.into(),
        params.min_extent.into(),
        params.cell.into(),
        params.reach.into(),
        f32::from(params.min_confidence.to_bits()) / ONE,
        f32::from(u8::from(params.parts == Parts::Support)),
    ];
    for (value, from) in values.iter_mut().zip(of_params.into_iter().chain(vehicle.values())) {
        *value = from;
    }
    values
}

/// Probability 1 as [`Confidence`] bits.
const ONE: f32 = 65_536.0;

/// `params` with the values that they have settings for, and the vehicle. The values are in their
/// ranges ([`linestereo_wire::Setting::check`]).
pub fn with_values(params: Params, values: &SettingValues) -> (Params, Vehicle) {
    let [
        min_disparity,
        max_disparity,
        anchor,
        edge,
        extent,
        cell,
        reach,
        confidence,
        parts,
        vehicle @ ..,
    ] = *values;
    let params = Params {
        min_disparity: min_disparity as i32 as i16,
        max_disparity: max_disparity as i32 as u16,
        anchor_gradient: anchor as i32 as u16,
        edge_gradient: edge as i32 as u16,
        min_extent: extent as i32 as u16,
        cell: cell as i32 as u16,
        reach: reach as i32 as u16,
        min_confidence: Confidence::from_bits((confidence * ONE + 0.5).min(ONE - 1.0) as i32 as u16),
        parts: if parts > 0.0 { Parts::Support } else { Parts::Both },
        ..params
    };
    let [
        yaw_deg,
        range_m,
        lowest,
        highest,
        system,
        rate_hz,
        policy,
        block_cm,
        distance_sensor,
        drop_m,
        sectors,
    ] = vehicle;
    let policy = Policy::ALL.get(policy as i32 as usize).copied().unwrap_or(Policy::Block);
    let block_cm = (block_cm > 0.0).then_some(block_cm as i32 as u16);
    let (system, rate_hz, distance_sensor) =
        (system as i32 as u8, rate_hz as i32 as u8, distance_sensor > 0.0);
    let vehicle = Vehicle {
        yaw_deg,
        range_m,
        heights_m: [lowest, highest],
        drop_m: (drop_m > 0.0).then_some(drop_m),
        system,
        rate_hz,
        policy,
        block_cm,
        distance_sensor,
        sectors: sectors > 0.0,
    };
    (params, vehicle)
}

/// Settings that outlive a reset.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptSettings {
    /// The number of the rig in flash that they were made with: with another one, the disparity
    /// range is that of that rig.
    pub rig: Option<u32>,
    /// Values; `None` for those that the board was built with.
    pub values: [Option<f32>; SETTINGS],
    /// Objects whose depths are wanted.
    pub regions: Regions,
}

const MAGIC: [u8; 4] = *b"LSST";
const VERSION: u16 = 3;
/// A word that says nothing; of a value it would not be a number.
const NOTHING: u32 = u32::MAX;
/// Words before those of the settings.
const HEAD: usize = 3;
/// Words of a box.
const BOX: usize = 3;
/// Words before the checksum.
const WORDS: usize = HEAD + 1 + SETTINGS + 1 + MAX_REGIONS * BOX;

impl KeptSettings {
    /// Size of an image, bytes.
    pub const BYTES: usize = 4 * WORDS + CRC_BYTES;

    /// Writes the image at the start of `bytes`, which are [`KeptSettings::BYTES`] or more.
    pub fn put(&self, sequence: u32, bytes: &mut [u8]) {
        let Regions { boxes, only } = &self.regions;
        let mut words = [0; WORDS];
        let mut places = words.iter_mut();
        let mut put = |word| {
            if let Some(place) = places.next() {
                *place = word;
            }
        };
        put(u32::from_le_bytes(MAGIC));
        put(word([VERSION, Self::BYTES as u16]));
        put(sequence);
        put(self.rig.unwrap_or(NOTHING));
        self.values.iter().for_each(|value| put(value.map_or(NOTHING, f32::to_bits)));
        put(word([boxes.len() as u16, (*only).into()]));
        for &RegionBox { label, left, top, right, bottom } in boxes {
            [[label, left], [top, right], [bottom, 0]].into_iter().for_each(|pair| put(word(pair)));
        }
        let (places, _) = bytes.as_chunks_mut();
        for (place, word) in places.iter_mut().zip(words) {
            *place = word.to_le_bytes();
        }
        if let Some((content, crc)) =
            bytes.get_mut(..Self::BYTES).and_then(<[u8]>::split_last_chunk_mut)
        {
            *crc = CRC_32.checksum(content).to_le_bytes();
        }
    }

    /// The sequence number of a whole image of this version.
    pub fn sequence(bytes: &[u8]) -> Result<u32, RigImageError> {
        if bytes.iter().all(|&byte| byte == 0xff) {
            return Err(RigImageError::Empty);
        }
        let (content, crc) = bytes.split_last_chunk().ok_or(RigImageError::Damaged)?;
        let mut words = words(content);
        let [magic, layout, sequence] = [(); HEAD].map(|()| words.next().unwrap_or(0));
        if magic != u32::from_le_bytes(MAGIC) {
            return Err(RigImageError::Foreign);
        }
        if CRC_32.checksum(content) != u32::from_le_bytes(*crc) {
            return Err(RigImageError::Damaged);
        }
        let [found, _] = halves(layout);
        if found == VERSION { Ok(sequence) } else { Err(RigImageError::OtherVersion { found }) }
    }

    /// Decodes an image; its numbers are as unchecked as those of a command.
    pub fn decode(bytes: &[u8]) -> Result<Self, RigImageError> {
        Self::sequence(bytes)?;
        let mut words = words(bytes).skip(HEAD);
        let mut next = || words.next().unwrap_or(0);
        let mut kept = || Some(next()).filter(|&word| word != NOTHING);
        let (rig, values) = (kept(), [(); SETTINGS].map(|()| kept().map(f32::from_bits)));
        let [count, only] = halves(next());
        let mut boxes = heapless::Vec::new();
        for _ in 0..count {
            let [[label, left], [top, right], [bottom, _]] = [(); BOX].map(|()| halves(next()));
            let _ = boxes.push(RegionBox { label, left, top, right, bottom }); // as many as there is room for
        }
        Ok(Self { rig, values, regions: Regions { boxes, only: only > 0 } })
    }
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word))
}

/// A word of two numbers, the first one in the low half.
fn word([low, high]: [u16; 2]) -> u32 {
    u32::from(low) | u32::from(high) << 16
}

fn halves(word: u32) -> [u16; 2] {
    [word as u16, (word >> 16) as u16]
}
