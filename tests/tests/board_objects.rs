//! Objects on the boards under QEMU: the PC's bits, also of pairs that are matched around them
//! alone.

use linestereo::{Area, Dims, Params};
use linestereo_sim::board;
use linestereo_sim::engine::Engine;
use linestereo_sim::scene::{Kind, Rendering};
use linestereo_tests::board::{machine, measured};
use linestereo_tests::drawn::rendered;
use linestereo_wire::{ObjectRecord, RegionBox, Regions, RigUpdate};

const RIG: RigUpdate = RigUpdate { focal_px: 300.0, baseline_m: 0.1, offset_px: 0.0 };

/// Boxes all over the image, some across its border.
fn boxes(dims: Dims) -> Vec<RegionBox> {
    let Dims { width, height } = dims;
    let of = |label: u16| {
        let (left, top) = (label * 37 % width, label * 53 % height);
        RegionBox::from((
            label,
            Area { left, top, right: left + width / 3, bottom: top + height / 3 },
        ))
    };
    (0..16).map(of).collect()
}

/// On the PC: of the whole frame, or of what lies around the boxes.
fn expected(
    engine: &mut Engine,
    rendering: &Rendering,
    boxes: &[RegionBox],
    only: bool,
) -> Vec<ObjectRecord> {
    let dims = rendering.left.dims;
    let regions: Vec<_> = boxes.iter().map(|of| of.region(dims).unwrap()).collect();
    engine.areas = only.then(|| regions.iter().map(linestereo::Region::area).collect());
    // The next pair of the same cameras: the ground is looked for near that of the pair before.
    let images = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
    engine.run_next(images, None, &mut ()).unwrap();
    regions.iter().map(|of| ObjectRecord::new(of.label(), &engine.object(of))).collect()
}

#[test]
fn a_board_says_of_objects_what_the_pc_says() {
    for board in measured() {
        let dims = board.largest;
        let Some(machine) = machine(board) else { return };
        let boxes = boxes(dims);
        let regions = |only| Regions { boxes: boxes.iter().copied().collect(), only };
        // The first pair is matched as a whole, and tells how far the rows are apart.
        let pairs = [
            rendered(Kind::Boxes, dims, 1.0, 3),
            rendered(Kind::Boxes, dims, 1.0, 4),
            rendered(Kind::Boxes, dims, 1.0, 5),
        ];
        let asked: Vec<_> = pairs
            .iter()
            .zip([false, true, true])
            .map(|(pair, only)| (&pair.left, &pair.right, regions(only)))
            .collect();
        let update = board::update(&Params::default(), Some(RIG));
        let replayed = machine.run_pairs_with_objects(&update, &asked).unwrap();
        let mut answered = 0;
        let rig = RIG.rig().ok();
        let mut engine = Engine::new(&Params { rig, ..Params::default() }, dims).unwrap();
        for ((pair, found), only) in pairs.iter().zip(&replayed.pairs).zip([false, true, true]) {
            let found = &found.as_ref().unwrap().objects;
            assert_eq!(*found, expected(&mut engine, pair, &boxes, only), "{}", board.name);
            answered += found.iter().filter(|object| object.depth_q16.is_some()).count();
        }
        assert_eq!(replayed.pairs.len(), 3);
        assert!(answered > 12, "{answered} of 48 objects");
    }
}
