//! The rig as bytes: the same bits back, and nothing else is taken for a rig. Then its two slots in
//! a flash that loses power.

use core::fmt::Debug;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use linestereo::{Dims, Params};
use linestereo_firmware::settings::KeptSettings;
use linestereo_firmware::slot_store::{
    BoardStore, Keeper as _, LayoutError, RigStore, Slot, SlotError, SlotImage, SlotStore,
    StoreError,
};
use linestereo_rig::{
    Calibration, Camera, CameraSide, Lens, Mesh, RectifyError, RigImage, RigImageError,
    RigImageHead, View, mesh_nodes,
};
use linestereo_tests::drawn::Random;
use linestereo_tests::fuzz::sealed;
use linestereo_wire::{RegionBox, Regions, SETTINGS};

const QVGA: Dims = Dims { width: 320, height: 240 };
const VGA: Dims = Dims { width: 640, height: 480 };

fn barrel() -> Camera {
    let lens = Lens::BrownConrady { k: [-0.28, 0.07, 1e-3], p: [1e-4, -2e-5] };
    Camera::new(VGA, [458.654, 457.296], [367.215, 248.375], 0.125, lens).unwrap()
}

fn fisheye() -> Camera {
    let lens = Lens::Fisheye { k: [0.01, -0.002, 0.0003, -0.00004] };
    Camera::new(VGA, [300.1, 301.2], [321.5, 238.25], 0.0, lens).unwrap()
}

fn rational() -> Camera {
    let lens = Lens::Rational { k: [0.2, 0.05, 0.001, 0.5, 0.06, 0.002], p: [1e-4, -2e-5] };
    Camera::new(VGA, [458.654, 457.296], [321.5, 238.25], 0.0, lens).unwrap()
}

/// A quaternion that is no unit one, in bits that its own division does not give back.
fn calibration(left: Camera, right: Camera) -> Calibration {
    Calibration::new(left, right, [0.9998, 0.003, -0.011, 0.007], [-0.1101, 0.0004, 0.0008])
        .unwrap()
}

fn image(view: View) -> RigImage {
    RigImage::new(calibration(barrel(), fisheye()), QVGA, view, (-4, 60)).unwrap()
}

/// A rig like no other of these.
fn numbered(n: u16) -> RigImage {
    let camera = barrel();
    RigImage::new(calibration(camera, camera), QVGA, View::Alpha(0.0), (0, 32 + n)).unwrap()
}

/// The checksum, bit by bit.
fn crc_32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
        })
    })
}

/// Bytes with these at this place, and the checksum that belongs to them.
fn resealed(mut bytes: Vec<u8>, at: usize, with: &[u8]) -> Vec<u8> {
    bytes[at..at + with.len()].copy_from_slice(with);
    sealed(bytes)
}

#[test]
fn an_image_comes_back_with_the_same_bits() {
    for view in [View::Alpha(0.0), View::Alpha(0.75), View::Focal(123.4)] {
        for (left, right) in [
            (barrel(), fisheye()),
            (fisheye(), barrel()),
            (barrel(), barrel()),
            (rational(), barrel()),
        ] {
            let image = RigImage::new(calibration(left, right), QVGA, view, (-32, 200)).unwrap();
            let bytes = image.encode(0xdead_beef);
            let again = RigImage::decode(&bytes).unwrap();
            assert_eq!(again, image);
            assert_eq!(again.encode(0xdead_beef), bytes, "bit for bit");
            let head = RigImageHead::check(&bytes).unwrap();
            let expected = RigImageHead {
                version: 3,
                length: RigImage::BYTES as u16,
                sequence: 0xdead_beef,
                is_whole: true,
            };
            assert_eq!(head, expected);
            let rectification = calibration(left, right).rectify(QVGA, view).unwrap();
            assert_eq!(again.remap(), &rectification.remap());
            let params = again.params(Params::default()).unwrap();
            assert_eq!((params.min_disparity, params.max_disparity), (-32, 200));
            assert_eq!(params.rig, rectification.rig().ok());
        }
    }
}

#[test]
fn a_rotation_that_was_made_a_unit_one_stays_as_it_is() {
    let mut random = Random(5);
    for _ in 0..20_000 {
        let mut part = || (random.bits() % 2001) as f64 / 4000.0 - 0.25;
        let rotation = [0.9 + part() / 10.0, part(), part(), part()];
        let Ok(once) = Calibration::new(barrel(), barrel(), rotation, [-0.1, 0.0, 0.0]) else {
            continue;
        };
        let twice =
            Calibration::new(barrel(), barrel(), once.rotation(), [-0.1, 0.0, 0.0]).unwrap();
        assert_eq!(
            once.rotation().map(f64::to_bits),
            twice.rotation().map(f64::to_bits),
            "{rotation:?}"
        );
    }
}

#[test]
fn the_layout_is_the_documented_one() {
    let image = image(View::Focal(150.5));
    let bytes = image.encode(0x0102_0304);
    assert_eq!(bytes.len(), 236);
    let numbers = |at: usize, count: usize| {
        bytes[at..at + 4 * count]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect::<Vec<_>>()
    };
    let rectification = calibration(barrel(), fisheye()).rectify(QVGA, View::Focal(150.5)).unwrap();
    let [cx, cy] = rectification.centre().map(|v| v as f32);
    assert_eq!(&bytes[..12], b"LSRG\x03\x00\xec\x00\x04\x03\x02\x01");
    assert_eq!(
        &bytes[12..24],
        [64, 1, 240, 0, 252, 255, 60, 0, 128, 2, 224, 1],
        "320, 240, -4, 60, 640, 480"
    );
    assert_eq!(numbers(24, 4), [150.5, cx, cy, rectification.baseline() as f32]);
    // The rows of the rotation from common to camera coordinates are the columns of its inverse.
    let columns = |side: usize| {
        let rows = rectification.rotations()[side];
        (0..9).map(|i| rows[i % 3][i / 3] as f32).collect::<Vec<_>>()
    };
    assert_eq!(numbers(40, 9), columns(0));
    assert_eq!(numbers(76, 5), [458.654, 457.296, 367.215, 248.375, 0.125]);
    assert_eq!(&bytes[96..100], [0, 0, 0, 0], "Brown-Conrady");
    assert_eq!(numbers(100, 8), [-0.28, 0.07, 1e-3, 1e-4, -2e-5, 0.0, 0.0, 0.0]);
    assert_eq!(numbers(132, 1), [4.0], "it does not fold");
    assert_eq!(numbers(136, 9), columns(1));
    assert_eq!(numbers(172, 5), [300.1, 301.2, 321.5, 238.25, 0.0]);
    assert_eq!(&bytes[192..196], [1, 0, 0, 0], "fisheye");
    assert_eq!(numbers(196, 9), [0.01, -0.002, 0.0003, -0.00004, 0.0, 0.0, 0.0, 0.0, 4.0]);
    assert_eq!(bytes[232..], crc_32(&bytes[..232]).to_le_bytes());
    let bytes = RigImage::new(calibration(rational(), fisheye()), QVGA, View::Alpha(0.0), (0, 64))
        .unwrap()
        .encode(0);
    assert_eq!(&bytes[96..100], [2, 0, 0, 0], "rational");
    let stored: Vec<f32> = bytes[100..132]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(stored, [0.2, 0.05, 0.001, 1e-4, -2e-5, 0.5, 0.06, 0.002]);
}

#[test]
fn no_flipped_bit_and_no_truncation_is_accepted() {
    let good = image(View::Alpha(0.0)).encode(7);
    let mut names = [0_u32; 4];
    for bit in 0..8 * good.len() {
        let mut damaged = good;
        damaged[bit / 8] ^= 1 << (bit % 8);
        let expected = match (RigImage::decode(&damaged), bit / 8) {
            (Err(RigImageError::Foreign), 0..4) => 0,
            (Err(RigImageError::Length { .. }), 6..8) => 1,
            (Err(RigImageError::Damaged), 4..6 | 8..) => 2,
            (other, byte) => panic!("bit {bit} in byte {byte}: {other:?}"),
        };
        names[expected] += 1;
    }
    assert_eq!(names, [32, 16, 8 * 230, 0]);
    for given in 0..good.len() {
        let truncated = RigImageError::Truncated { needed: RigImage::BYTES, given };
        assert_eq!(RigImage::decode(&good[..given]), Err(truncated));
    }
    for more in [1, 4, 1000] {
        let longer = [&good[..], &vec![0xff; more]].concat();
        let surplus =
            RigImageError::Surplus { needed: RigImage::BYTES, given: RigImage::BYTES + more };
        assert_eq!(RigImage::decode(&longer), Err(surplus));
    }
    // The rest of a row of erased or cut off bytes in the middle.
    for from in 0..good.len() {
        let mut damaged = good;
        damaged[from..].fill(0xff);
        assert!(RigImage::decode(&damaged).is_err(), "erased from {from}");
    }
}

#[test]
fn erased_foreign_and_later_images_have_names() {
    assert_eq!(RigImage::decode(&[0xff; RigImage::BYTES]), Err(RigImageError::Empty));
    assert_eq!(RigImage::decode(&[0; RigImage::BYTES]), Err(RigImageError::Foreign));
    assert_eq!(RigImage::decode(b"\x89PNG\r\n"), Err(RigImageError::Foreign));
    let good = image(View::Alpha(0.0)).encode(0).to_vec();
    assert_eq!(
        RigImage::decode(&resealed(good.clone(), 4, &[1, 0])),
        Err(RigImageError::OtherVersion { found: 1 })
    );
    let before = resealed([&good[..208], &[0; 4]].concat(), 4, &[2, 0, 212, 0]);
    assert_eq!(RigImage::decode(&before), Err(RigImageError::OtherVersion { found: 2 }));
    // A later version may be longer or shorter.
    for (length, is_this_version) in [(300_usize, false), (200, false), (300, true), (16, false)] {
        let mut other = good.clone();
        other.resize(length, 0);
        other[4] = if is_this_version { 3 } else { 9 };
        let other = resealed(other, 6, &(length as u16).to_le_bytes());
        let expected = if is_this_version {
            RigImageError::Length { found: length as u16 }
        } else {
            RigImageError::OtherVersion { found: 9 }
        };
        assert_eq!(RigImage::decode(&other), Err(expected));
    }
}

#[test]
fn the_number_that_is_refused_has_a_name() {
    let good = image(View::Alpha(0.0)).encode(0).to_vec();
    let cases: [(usize, &[u8], &str); 16] = [
        (12, &2000_u16.to_le_bytes(), "rectified view: rectified images of 2000x240 are outside"),
        (16, &5_i16.to_le_bytes(), "disparity range: min_disparity is 5"),
        (18, &320_u16.to_le_bytes(), "disparity range: max_disparity is 320"),
        (20, &8_u16.to_le_bytes(), "left camera: a raw image of 8x480 is outside"),
        (24, &f32::NAN.to_le_bytes(), "rectified view: focal length NaN px is outside"),
        (28, &3000_f32.to_le_bytes(), "rectified view: principal point: 3000 px is outside"),
        (36, &f32::INFINITY.to_le_bytes(), "rectified view: baseline inf m is outside"),
        (40, &2_f32.to_le_bytes(), "rectified view: the left rectifying matrix is no rotation"),
        (
            168,
            &f32::NAN.to_le_bytes(),
            "rectified view: the right rectifying matrix is no rotation",
        ),
        (76, &0_f32.to_le_bytes(), "left camera: focal length 0 px is outside"),
        (84, &1e9_f32.to_le_bytes(), "left camera: the optical centre (1000000000, 248.375) px"),
        (96, &7_u32.to_le_bytes(), "left camera: lens 7 is not known"),
        (100, &f32::NAN.to_le_bytes(), "left camera: lens coefficient NaN is outside"),
        (188, &(-2000_f32).to_le_bytes(), "right camera: skew -2000 px is outside"),
        (
            228,
            &4.5_f32.to_le_bytes(),
            "right camera: the lens coefficients fold the image over at a tangent of 4.50",
        ),
        (228, &f32::NAN.to_le_bytes(), "right camera: the lens coefficients fold the image over"),
    ];
    for (at, with, says) in cases {
        let error = RigImage::decode(&resealed(good.clone(), at, with)).expect_err(says);
        assert!(error.to_string().contains(says), "{error} does not say {says}");
    }
    let wrong = RigImage::decode(&resealed(good, 76, &0_f32.to_le_bytes()));
    assert!(matches!(wrong, Err(RigImageError::Camera(CameraSide::Left, _))));
    let pair = calibration(barrel(), barrel());
    let wrong = RigImage::new(pair, QVGA, View::Focal(f64::NAN), (0, 64));
    assert!(matches!(wrong, Err(RigImageError::View(RectifyError::Rig(_)))), "{wrong:?}");
}

/// A flash stricter than hardware: it panics where hardware would do something undefined, and its
/// power fails on demand.
///
/// Words that an interrupted write or erase was at hold garbage; so does an erased block beyond the
/// place where its erase was stopped.
#[derive(Clone, Debug)]
struct Flash<const READ: usize, const WRITE: usize, const ERASE: usize> {
    bytes: Vec<u8>,
    /// Was this word written since it was erased?
    is_written: Vec<bool>,
    /// Bytes that can still be erased or written.
    power: usize,
    erases: u32,
    random: u64,
    /// Reads of these addresses fail, as they do where error correction gives up.
    unreadable: core::ops::Range<usize>,
    /// Bits that no longer become 0.
    is_worn: bool,
}

const UNLIMITED: usize = usize::MAX;

impl<const READ: usize, const WRITE: usize, const ERASE: usize> Flash<READ, WRITE, ERASE> {
    fn new(blocks: usize) -> Self {
        let size = blocks * ERASE;
        // Not erased: what is there is nobody's.
        let bytes = (0..size).map(|at| (at * 7) as u8).collect();
        let is_written = vec![true; size / WRITE];
        Self {
            bytes,
            is_written,
            power: UNLIMITED,
            erases: 0,
            random: 9,
            unreadable: 0..0,
            is_worn: false,
        }
    }

    /// Takes power for so many bytes, and says for how many it suffices.
    fn spend(&mut self, bytes: usize) -> usize {
        let spent = bytes.min(self.power);
        if self.power != UNLIMITED {
            self.power -= spent;
        }
        spent
    }

    fn garbage(&mut self, range: core::ops::Range<usize>) {
        let mut random = Random(self.random);
        self.bytes[range].fill_with(|| random.bits() as u8);
        self.random = random.bits();
    }

    /// The image that lies at this address, written there by somebody else.
    fn put(&mut self, start: usize, bytes: &[u8]) {
        self.erase(start as u32, (start + bytes.len().next_multiple_of(ERASE)) as u32).unwrap();
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(WRITE), 0xff);
        self.write(start as u32, &padded).unwrap();
    }
}

impl<const READ: usize, const WRITE: usize, const ERASE: usize> ErrorType
    for Flash<READ, WRITE, ERASE>
{
    type Error = NorFlashErrorKind;
}

impl<const READ: usize, const WRITE: usize, const ERASE: usize> ReadNorFlash
    for Flash<READ, WRITE, ERASE>
{
    const READ_SIZE: usize = READ;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let start = offset as usize;
        assert!(
            start.is_multiple_of(READ) && bytes.len().is_multiple_of(READ),
            "an unaligned read"
        );
        if self.power == 0 || self.unreadable.contains(&start) {
            return Err(NorFlashErrorKind::Other);
        }
        bytes.copy_from_slice(&self.bytes[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const READ: usize, const WRITE: usize, const ERASE: usize> NorFlash
    for Flash<READ, WRITE, ERASE>
{
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = ERASE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        let (from, to) = (from as usize, to as usize);
        assert!(
            from.is_multiple_of(ERASE) && to.is_multiple_of(ERASE) && from < to,
            "an unaligned erase"
        );
        assert!(to <= self.bytes.len(), "an erase beyond the flash");
        self.erases += 1;
        let done = from + self.spend(to - from);
        self.bytes[from..done].fill(0xff);
        if done < to {
            // A block is not erased byte by byte: half of the time nothing of the old content is
            // left, half of the time all.
            if self.random.is_multiple_of(2) {
                self.garbage(done..to);
            }
            self.random = self.random.wrapping_mul(25_214_903_917).wrapping_add(11) >> 1;
            self.is_written[from / WRITE..to / WRITE].fill(true); // to be erased again
            return Err(NorFlashErrorKind::Other);
        }
        self.is_written[from / WRITE..to / WRITE].fill(false);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        let start = offset as usize;
        assert!(
            start.is_multiple_of(WRITE) && bytes.len().is_multiple_of(WRITE),
            "an unaligned write"
        );
        assert!(start + bytes.len() <= self.bytes.len(), "a write beyond the flash");
        let words = start / WRITE..(start + bytes.len()) / WRITE;
        assert!(
            self.is_written[words.clone()].iter().all(|is_written| !is_written),
            "a write without an erase"
        );
        let done = self.spend(bytes.len());
        let whole = done - done % WRITE;
        self.bytes[start..start + whole].copy_from_slice(&bytes[..whole]);
        self.is_written[words].fill(true);
        if self.is_worn {
            self.bytes[start + 11] |= 1; // of the number, which is small
        }
        if done < bytes.len() {
            if done > whole {
                self.garbage(start + whole..start + whole + WRITE);
            }
            return Err(NorFlashErrorKind::Other);
        }
        Ok(())
    }
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

/// Coefficients that no lens has put positions at the limits of what is computed.
#[test]
fn a_rig_of_wild_coefficients_is_refused_or_has_a_mesh() {
    let good = image(View::Alpha(0.0)).encode(0).to_vec();
    let mut random = Random(3);
    let mut mesh: Box<Mesh<{ mesh_nodes(QVGA) }, 240>> = Box::new(Mesh::new());
    let mut meshes = 0;
    for _ in 0..3000 {
        let mut put = good.clone();
        for at in [76, 80] {
            put[at..at + 4].copy_from_slice(&1e5_f32.to_le_bytes());
        }
        for k in 0..3 {
            let sign = if random.below(2) == 0 { -1.0 } else { 1.0 };
            let value = sign * 10_f64.powf(random.uniform(0.0, 4.0));
            put[100 + 4 * k..104 + 4 * k].copy_from_slice(&(value as f32).to_le_bytes());
        }
        let Ok(image) = RigImage::decode(&sealed(put)) else { continue };
        meshes += u32::from(mesh.build(image.remap(), CameraSide::Left).is_ok());
    }
    assert!(meshes > 100, "{meshes}");
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
            let mut store = open(Flash { power: n, ..before.clone() });
            let outcome = store.store(&new);
            let mut store = open(Flash { power: UNLIMITED, ..store.into_flash() });
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
        let cut = Flash { power, ..flash.clone() };
        let mut store = BoardStore::new(cut, starts.0, starts.1).unwrap();
        let _ = store.store_settings(&settings(50));
        let flash = Flash { power: UNLIMITED, ..store.into_flash() };
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
