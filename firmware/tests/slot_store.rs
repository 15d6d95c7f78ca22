//! The two slots of a rig, and those of settings, in a flash that loses power.

use crate::support::flash::{Flash, UNLIMITED};
use core::fmt::Debug;
use embedded_storage::nor_flash::{NorFlash, NorFlashErrorKind};
use linestereo::Dims;
use linestereo_firmware::settings::KeptSettings;
use linestereo_firmware::slot_store::{
    BoardStore, Keeper as _, LayoutError, RigStore, Slot, SlotError, SlotImage, SlotStore,
    StoreError,
};
use linestereo_rig::checksum::CRC_32;
use linestereo_rig::{Calibration, Camera, Lens, RigImage, RigImageError, View};
use linestereo_wire::{RegionBox, Regions, SETTINGS};

/// A rig like no other of these.
fn numbered(n: u16) -> RigImage {
    let dims = Dims { width: 320, height: 240 };
    let camera = Camera::new(dims, [230.0; 2], [160.0, 120.0], 0.0, Lens::NONE).unwrap();
    let pair = Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.1, 0.0, 0.0]).unwrap();
    RigImage::new(pair, dims, View::Alpha(0.0), (0, 32 + n)).unwrap()
}

/// Bytes with these at this place, and the checksum that belongs to them.
fn resealed(mut bytes: Vec<u8>, at: usize, with: &[u8]) -> Vec<u8> {
    bytes[at..at + with.len()].copy_from_slice(with);
    let (content, crc) = bytes.split_last_chunk_mut().unwrap();
    *crc = CRC_32.checksum(content).to_le_bytes();
    bytes
}

/// As on an STM32G4 (8-byte words, 2 KiB pages), and a small one that is quick to try everything
/// on.
type Pages = Flash<1, 8, 2048>;
type Small = Flash<4, 4, 128>;

fn loaded<F: NorFlash + Debug>(store: &mut RigStore<F>) -> Option<(Slot, RigImage)> {
    store.load().newest
}

#[test]
fn slots_are_written_in_turn_and_the_newest_is_used() {
    let mut store = RigStore::new(Pages::new(4), [2048, 6144]).unwrap();
    let nothing = store.load();
    assert_eq!(nothing.newest, None);
    assert_eq!(nothing.slots, [Err(SlotError::Image(RigImageError::Foreign)); 2]);
    for (n, expected) in (0..6).zip([Slot::First, Slot::Second].into_iter().cycle()) {
        assert_eq!(store.store(&numbered(n)), Ok(expected));
        assert_eq!(loaded(&mut store), Some((expected, numbered(n))));
    }
    assert_eq!(store.load().slots, [Ok(4), Ok(5)]);
    // An image that is there already is not written again.
    assert_eq!(store.store(&numbered(5)), Ok(Slot::Second));
    assert_eq!(store.load().slots, [Ok(4), Ok(5)]);
    let flash = store.into_flash();
    assert_eq!(flash.erases, 6);
    assert!(
        flash.bytes[..2048].iter().enumerate().all(|(at, &byte)| byte == (at * 7) as u8),
        "not its bytes"
    );
}

#[test]
fn sequence_numbers_wrap() {
    let mut flash = Pages::new(2);
    flash.put(0, &numbered(0).encode(u32::MAX - 1));
    flash.put(2048, &numbered(1).encode(u32::MAX));
    let mut store = RigStore::new(flash, [0, 2048]).unwrap();
    assert_eq!(loaded(&mut store), Some((Slot::Second, numbered(1))));
    for (n, slot, slots) in [
        (2, Slot::First, [Ok(0), Ok(u32::MAX)]),
        (3, Slot::Second, [Ok(0), Ok(1)]),
        (4, Slot::First, [Ok(2), Ok(1)]),
    ] {
        assert_eq!(store.store(&numbered(n)), Ok(slot));
        assert_eq!(store.load().slots, slots);
        assert_eq!(loaded(&mut store), Some((slot, numbered(n))));
    }
}

/// Settings name the rig that they are for by its number: those for one that this program cannot
/// read are not for the next one.
#[test]
fn images_of_another_version_keep_their_numbers() {
    for used in [[Some(7), None], [Some(7), Some(8)], [Some(u32::MAX), None], [None, Some(3)]] {
        let mut flash = Pages::new(4);
        for (slot, sequence) in used.into_iter().enumerate() {
            let Some(sequence) = sequence else { continue };
            let image = numbered(1).encode(sequence).to_vec();
            let later = resealed(image, 4, &9_u16.to_le_bytes());
            let at = slot * RigStore::<Pages>::SLOT as usize;
            flash.bytes[at..at + later.len()].copy_from_slice(&later);
        }
        let mut store = RigStore::new(flash, [0, RigStore::<Pages>::SLOT]).unwrap();
        assert_eq!(loaded(&mut store), None);
        store.store(&numbered(2)).unwrap();
        let newest = used.into_iter().flatten().last().unwrap();
        assert_eq!(store.load().slots[0], Ok(newest.wrapping_add(1)), "{used:?}");
    }
}

#[test]
fn a_damaged_slot_is_named_and_the_older_one_used() {
    let mut store = RigStore::new(Pages::new(2), [0, 2048]).unwrap();
    for n in 0..2 {
        store.store(&numbered(n)).unwrap();
    }
    let good = store.into_flash();
    let with = |change: &dyn Fn(&mut Pages)| {
        let mut flash = good.clone();
        change(&mut flash);
        RigStore::new(flash, [0, 2048]).unwrap()
    };
    let mut damaged = with(&|flash| flash.bytes[2048 + 100] ^= 4);
    let found = damaged.load();
    assert_eq!(found.newest, Some((Slot::First, numbered(0))));
    assert_eq!(found.slots, [Ok(0), Err(SlotError::Image(RigImageError::Damaged))]);
    assert_eq!(
        found.slots[1].unwrap_err().to_string(),
        "damaged: the checksum does not match the bytes"
    );
    // The damaged one is the one that is written next.
    assert_eq!(damaged.store(&numbered(9)), Ok(Slot::Second));
    assert_eq!(loaded(&mut damaged), Some((Slot::Second, numbered(9))));

    let found = with(&|flash| flash.unreadable = 2048..2049).load();
    assert_eq!(found.newest, Some((Slot::First, numbered(0))));
    assert_eq!(found.slots[1], Err(SlotError::Flash(NorFlashErrorKind::Other)));

    // Whole, but no rig.
    let unusable = resealed(numbered(7).encode(8).to_vec(), 76, &0_f32.to_le_bytes());
    let mut store = with(&|flash| flash.put(2048, &unusable));
    let found = store.load();
    assert_eq!(found.newest, Some((Slot::First, numbered(0))));
    assert!(
        found.slots[1].unwrap_err().to_string().starts_with("left camera: focal length 0"),
        "{found:?}"
    );
    assert_eq!(store.store(&numbered(3)), Ok(Slot::Second));
    assert_eq!(loaded(&mut store), Some((Slot::Second, numbered(3))));

    let mut both = with(&|flash| {
        flash.bytes[2048 + 100] ^= 4;
        flash.put(0, &[0xff; RigImage::BYTES]);
    });
    let found = both.load();
    assert_eq!(found.newest, None);
    assert_eq!(
        found.slots,
        [RigImageError::Empty, RigImageError::Damaged].map(|error| Err(SlotError::Image(error)))
    );
    assert_eq!(both.store(&numbered(3)), Ok(Slot::First));

    let mut worn = with(&|flash| flash.is_worn = true);
    assert_eq!(worn.store(&numbered(3)), Err(StoreError::NotKept));
    assert_eq!(
        loaded(&mut worn),
        Some((Slot::Second, numbered(1))),
        "the one in use is still there"
    );
}

/// Cuts the power of a flash after these numbers of bytes that are erased or written, from every
/// state that two images can leave.
fn cut<const READ: usize, const WRITE: usize, const ERASE: usize, T>(
    flash: Flash<READ, WRITE, ERASE>,
    starts: [u32; 2],
    cuts: impl Iterator<Item = usize>,
    [first, old, new, after]: [T; 4],
) where
    T: SlotImage + Debug + PartialEq,
{
    let open = |flash| SlotStore::<_, T>::new(flash, starts).unwrap();
    let mut store = open(flash);
    assert_eq!(store.store(&first), Ok(Slot::First));
    let one = store.into_flash();
    let mut store = open(one.clone());
    assert_eq!(store.store(&old), Ok(Slot::Second));
    let two = store.into_flash();
    let (mut kept, mut replaced) = (0, 0);
    for n in cuts {
        for (before, in_use) in [(&one, &first), (&two, &old)] {
            let mut store = open(before.with_power(n));
            let outcome = store.store(&new);
            let mut store = open(store.into_flash().with_power(UNLIMITED));
            let found =
                store.load().newest.unwrap_or_else(|| panic!("nothing after a cut at {n}")).1;
            assert!(found == *in_use || found == new, "cut at {n}: {found:?} was never stored");
            assert!(outcome.is_err() || found == new, "cut at {n}: said to be stored, but is not");
            if found == new {
                replaced += 1
            } else {
                kept += 1
            }
            if n.is_multiple_of(37) {
                assert!(store.store(&after).is_ok(), "cut at {n}: cannot be written again");
                assert_eq!(store.load().newest.unwrap().1, after);
            }
        }
    }
    assert!(kept > 100 && replaced > 1, "{kept} cuts before the end, {replaced} after it");
}

#[test]
fn power_may_fail_at_any_byte() {
    let slot = RigStore::<Small>::SLOT as usize;
    assert_eq!(slot, 256);
    let rigs = || [0, 1, 2, 3].map(numbered);
    cut(Small::new(8), [0, 512], 0..=slot + 240, rigs());
    // Every byte of the write, and some of the erase before it.
    type Large = Flash<1, 32, 131_072>;
    let cuts = (0..131_072).step_by(4001).chain(131_071..131_072 + 300);
    cut(Large::new(2), [0, 131_072], cuts, rigs());
    let kept = [40, 41, 50, 51].map(settings);
    cut(Small::new(8), [0, 512], 0..=KeptSettings::BYTES * 3, kept);
}

/// Settings with a range of their own.
fn settings(max_disparity: u8) -> KeptSettings {
    let mut values = [None; SETTINGS];
    (values[1], values[10], values[17]) = (Some(max_disparity.into()), Some(6.5), Some(1.0));
    let boxes = (0..3)
        .map(|n| RegionBox { label: 7 + n, left: 1, top: 2, right: 300, bottom: 200 + n })
        .collect();
    KeptSettings { rig: Some(3), values, regions: Regions { boxes, only: true } }
}

fn settings_image(settings: &KeptSettings, sequence: u32) -> Vec<u8> {
    let mut bytes = vec![0xff; KeptSettings::BYTES];
    settings.put(sequence, &mut bytes);
    bytes
}

#[test]
fn settings_lie_beside_the_rig() {
    let starts = ([0, 512], [1024, 1536]);
    let mut store = BoardStore::new(Small::new(16), starts.0, starts.1).unwrap();
    assert_eq!(store.load_settings().newest, None);
    store.store_rig(&numbered(1)).unwrap();
    for n in 40..42 {
        store.store_settings(&settings(n)).unwrap();
    }
    assert_eq!(store.store_settings(&settings(41)), Ok(Slot::Second), "there already");
    assert_eq!(store.load_settings().slots, [Ok(0), Ok(1)]);
    // A cut while settings are written leaves the rig.
    let flash = store.into_flash();
    for power in 0..=KeptSettings::BYTES * 3 {
        let mut store = BoardStore::new(flash.with_power(power), starts.0, starts.1).unwrap();
        let _ = store.store_settings(&settings(50));
        let flash = store.into_flash().with_power(UNLIMITED);
        let mut store = BoardStore::new(flash, starts.0, starts.1).unwrap();
        assert_eq!(store.load_rig().newest, Some((Slot::First, numbered(1))), "cut at {power}");
    }

    let at = |rig, settings| BoardStore::new(Small::new(16), rig, settings).map(drop);
    assert_eq!(at([0, 384], [768, 1152]), Ok(()));
    assert_eq!(at([0, 512], [512, 1024]), Err(LayoutError::Overlap));
    assert_eq!(at([0, 512], [256, 1024]), Err(LayoutError::Overlap));
}

#[test]
fn what_is_damaged_or_of_another_version_holds_no_settings() {
    let bare = KeptSettings { rig: None, values: [None; SETTINGS], regions: Regions::default() };
    let of = RegionBox { label: u16::MAX, left: 1, top: 2, right: 3, bottom: u16::MAX - 1 };
    let full = Regions { boxes: [of; linestereo_wire::MAX_REGIONS].into(), only: true };
    let full =
        KeptSettings { rig: Some(u32::MAX - 1), values: [Some(f32::MIN); SETTINGS], regions: full };
    for good in [bare, full, settings(40)] {
        let image = settings_image(&good, 7);
        assert_eq!(
            (KeptSettings::sequence(&image), KeptSettings::decode(&image)),
            (Ok(7), Ok(good))
        );
    }
    let good = settings_image(&settings(40), 7);
    for at in 0..good.len() {
        let mut damaged = good.clone();
        damaged[at] ^= 0x10;
        let expected = if at < 4 { RigImageError::Foreign } else { RigImageError::Damaged };
        assert_eq!(KeptSettings::decode(&damaged), Err(expected), "byte {at}");
    }
    assert_eq!(KeptSettings::decode(&[0xff; KeptSettings::BYTES]), Err(RigImageError::Empty));
    for length in 0..good.len() {
        assert!(KeptSettings::decode(&good[..length]).is_err(), "{length} bytes");
    }
    let other = resealed(good, 4, &1_u16.to_le_bytes());
    assert_eq!(KeptSettings::decode(&other), Err(RigImageError::OtherVersion { found: 1 }));
}

#[test]
fn slots_lie_where_the_flash_can_erase_them() {
    let at = |starts| RigStore::new(Pages::new(4), starts).map(drop);
    assert_eq!(RigStore::<Pages>::SLOT, 2048);
    assert_eq!(at([0, 6144]), Ok(()));
    assert_eq!(at([0, 1024]), Err(LayoutError::NotAligned(Slot::Second)));
    assert_eq!(at([8192, 0]), Err(LayoutError::OutOfBounds(Slot::First)));
    assert_eq!(at([0, 0]), Err(LayoutError::Overlap));
    let small = |starts| RigStore::new(Small::new(8), starts).map(drop);
    assert_eq!(small([0, 128]), Err(LayoutError::Overlap));
    assert_eq!(small([256, 0]), Ok(()));
    assert_eq!(small([896, 0]), Err(LayoutError::OutOfBounds(Slot::First)));
    assert_eq!(
        RigStore::new(Flash::<1, 1024, 4096>::new(2), [0, 4096]).map(drop),
        Err(LayoutError::Granularity)
    );
}
