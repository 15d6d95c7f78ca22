//! Damaged pairs on a board under QEMU: the PC's bits of flags, health figures, segments, points,
//! and depths of objects or why there is none. The worst damages of the fault bench on drawn pairs,
//! and on captured ones.

use linestereo::{Area, Dims, Matcher, Params, health::HealthFlags, objects::Reason};
use linestereo_firmware::boards::mps2_an500;
use linestereo_frames::{Scene, load_scene};
use linestereo_lab::faults::{Damage, Source};
use linestereo_sim::board;
use linestereo_sim::results::mask::Mask;
use linestereo_sim::scene::Kind;
use linestereo_tests::board::{Twin, machine};
use linestereo_tests::captured;
use linestereo_tests::drawn::{rendered, with_truth};
use linestereo_wire::{RegionBox, Regions, RigUpdate};
use std::collections::BTreeSet;

const RIG: RigUpdate = RigUpdate { focal_px: 300.0, baseline_m: 0.1, offset_px: 0.0 };
const DIMS: Dims = mps2_an500::BOARD.largest;

/// The flag that each of them raises on the drawn pairs; none for what is on the objects alone.
/// Flags stay for some pairs: those without come first.
const DAMAGES: [(Damage, Option<HealthFlags>); 8] = [
    (Damage::None, None),
    (Damage::Bars(8.0), None),
    (Damage::Bars(16.0), None),
    (Damage::Torn(8.0), Some(HealthFlags::TORN)),
    (Damage::ColumnNoise(15.0), Some(HealthFlags::SAME_PIXEL)),
    (Damage::OneCameraTwice, Some(HealthFlags::NO_PARALLAX)),
    (Damage::FixedPattern(25.0), Some(HealthFlags::NO_PARALLAX)),
    (Damage::RowsOff(3.0), Some(HealthFlags::FEW_MATCHES)), // further than the matcher looks for rows
];

/// Twelve boxes side by side, not up to the border.
fn boxes() -> Vec<RegionBox> {
    let of = |label: u16| {
        let (left, top) = (12 + label % 4 * 76, 12 + label / 4 * 76);
        RegionBox::from((label, Area { left, top, right: left + 60, bottom: top + 60 }))
    };
    (0..12).map(of).collect()
}

/// Sends every damage to the board, of both scenes in turn and as pairs of one rig; gives its
/// flags, and why objects have no depth.
fn compare(scenes: [&Scene; 2]) -> Option<Vec<(HealthFlags, BTreeSet<String>)>> {
    let machine = machine(mps2_an500::BOARD)?;
    let (boxes, dims) = (boxes(), scenes[0].left.dims);
    let regions: Vec<_> = boxes.iter().filter_map(|of| of.region(dims).ok()).collect();
    let is_object = |(x, y): (i32, i32)| regions.iter().any(|region| region.contains(x, y));
    let pixels =
        (0..i32::from(dims.height)).flat_map(|y| (0..i32::from(dims.width)).map(move |x| (x, y)));
    let objects = Mask::new(dims, pixels.map(is_object).collect());
    let pairs: Vec<_> = DAMAGES
        .iter()
        .zip([scenes, [scenes[1], scenes[0]]].into_iter().cycle())
        .map(|((damage, _), [scene, other])| {
            damage.apply(&Source {
                scene,
                other: [&other.left, &other.right],
                objects: &objects,
                seed: 1,
            })
        })
        .collect();
    let wanted = || Regions { boxes: boxes.iter().copied().collect(), only: false };
    let sent: Vec<_> = pairs.iter().map(|[left, right]| (left, right, wanted())).collect();
    let params =
        Params { max_disparity: scenes[0].max_disparity, rig: RIG.rig().ok(), ..Params::default() };
    let replayed =
        machine.run_pairs_with_objects(&board::update(&params, Some(RIG)), &sent).unwrap();
    assert_eq!((replayed.pairs.len(), replayed.bad_packets), (pairs.len(), 0));

    let (mut twin, mut matcher) =
        (Twin::of(&mps2_an500::BOARD), Matcher::new(params, dims).unwrap());
    let mut seen = Vec::new();
    for ((pair, found), (damage, _)) in pairs.iter().zip(replayed.pairs).zip(DAMAGES) {
        let (expected, objects) = twin.run_next(&mut matcher, pair.each_ref(), &regions).unwrap();
        let (found, name) = (found.unwrap(), format!("{}: {damage}", scenes[0].name));
        assert_eq!(
            (found.result.health, found.result.pair),
            (expected.health, expected.pair),
            "{name}"
        );
        assert_eq!(found.result.counts, expected.counts, "{name}");
        assert_eq!(found.result.matches, expected.matches, "{name}");
        assert_eq!(found.result.points, expected.points, "{name}");
        assert_eq!(found.objects, objects, "{name}");
        let refusals = found.objects.iter().filter_map(|object| object.depth().err());
        seen.push((
            found.result.health.of_pair(),
            refusals.map(|why| format!("{:?}", why.reason)).collect(),
        ));
    }
    Some(seen)
}

#[test]
fn damaged_drawn_pairs_have_the_bits_of_the_pc() {
    let scenes = [5, 6].map(|seed| with_truth(rendered(Kind::Demo, DIMS, 1.5, seed)));
    let Some(seen) = compare(scenes.each_ref()) else { return };
    let unhealthy = format!("{:?}", Reason::UnhealthyPair);
    for ((flags, refusals), (damage, flag)) in seen.iter().zip(DAMAGES) {
        let is_named = flag.is_none_or(|flag| flags.contains(flag));
        assert!(is_named && flags.is_fit() == flag.is_none(), "{damage}: {flags:?}");
        assert_eq!(!flags.is_fit(), refusals.contains(&unhealthy), "{damage}: {refusals:?}");
    }
    let kinds: BTreeSet<_> = seen.iter().flat_map(|(_, refusals)| refusals).collect();
    assert!(kinds.len() > 1, "objects are refused for other reasons too: {kinds:?}");
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn damaged_captured_pairs_have_the_bits_of_the_pc() {
    let Some(folder) = captured::folder("qvga") else { return };
    // Reduced to the board's height.
    let scenes = ["art", "books"].map(|name| load_scene(&folder.join(name), Some(300)).unwrap());
    let Some(seen) = compare(scenes.each_ref()) else { return };
    assert!(seen[0].0.is_fit() && seen.iter().any(|(flags, _)| !flags.is_fit()), "{seen:?}");
}
