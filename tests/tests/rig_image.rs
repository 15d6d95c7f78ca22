//! The rig as bytes: the same bits back, and nothing else is taken for a rig.

use linestereo::{Dims, Params};
use linestereo_rig::{
    Calibration, Camera, CameraSide, Lens, Mesh, RectifyError, RigImage, RigImageError,
    RigImageHead, View, mesh_nodes,
};
use linestereo_tests::drawn::Random;
use linestereo_tests::fuzz::sealed;

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
