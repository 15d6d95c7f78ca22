//! Records with ordinary and with extreme numbers, and a seeded source of bytes.

pub(crate) mod examples;

use linestereo::health::{CameraHealth, Noise, Rows, Skewed, Still, Tear};
use linestereo::params::{Margin, Parts};
use linestereo::results::{ImagePosition, Match, Owner, Point, Source, Techniques};
use linestereo::units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};
use linestereo_rig::RigImage;
use linestereo_wire::*;

/// xorshift64*: enough for garbage, the same on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub(crate) fn byte(&mut self) -> u8 {
        (self.next() >> 56) as u8
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.next() >> 32) as usize % end
    }
}

/// A match of arbitrary bits.
pub(crate) fn any_match(random: &mut Random) -> Match {
    let mut disparity = || Disparity::from_bits(random.next() as i16);
    let (disparities, sigma, window, census) =
        ([disparity(), disparity()], disparity(), disparity(), disparity());
    let feature =
        random.next().is_multiple_of(2).then(|| Disparity::from_bits(random.next() as i16));
    let mut depths = || {
        let depth = |bits: u64| {
            if bits.is_multiple_of(5) { INFINITE_DEPTH } else { Depth::from_bits(bits as i32) }
        };
        random.next().is_multiple_of(2).then(|| [depth(random.next()), depth(random.next())])
    };
    let (depth, depth_sigma) = (depths(), depths());
    let mut point = || ImagePosition {
        x: Position::from_bits(random.next() as u16),
        y: Position::from_bits(random.next() as u16),
    };
    Match {
        ends: [point(), point()],
        disparity: disparities,
        sigma,
        confidence: Confidence::from_bits(random.next() as u16),
        owner: [Owner::Left, Owner::Right, Owner::Both][random.below(3)],
        depth,
        depth_sigma,
        techniques: Techniques { feature, window, census },
    }
}

/// A match whose numbers all take their longest form.
pub(crate) fn longest_match() -> Match {
    Match {
        ends: [ImagePosition { x: Position::MAX, y: Position::MAX }; 2],
        disparity: [Disparity::MIN; 2],
        sigma: Disparity::MIN,
        confidence: Confidence::MAX,
        owner: Owner::Both,
        depth: Some([Depth::MIN; 2]),
        depth_sigma: Some([Depth::MIN; 2]),
        techniques: Techniques {
            feature: Some(Disparity::MIN),
            window: Disparity::MIN,
            census: Disparity::MIN,
        },
    }
}

pub(crate) fn counts(value: u16) -> Counts {
    Counts {
        segments_left: value,
        segments_right: value.wrapping_add(1),
        segments_left_dropped: value.wrapping_add(2),
        segments_right_dropped: value.wrapping_add(3),
        edges_cut: value.wrapping_add(10),
        comparisons_cut: value.wrapping_add(11),
        searched_fully: value.wrapping_add(9),
        matched: value.wrapping_add(4),
        points: u32::from(value) << 16,
        rejected: core::array::from_fn(|reason| value.wrapping_add(6 + reason as u16)),
    }
}

pub(crate) fn head(sequence: u32, segments: u16) -> FrameHead {
    FrameHead {
        sequence,
        capture_time_us: 33_333 * u64::from(sequence),
        width: 320,
        height: 240,
        health: Health::SEGMENTS_DROPPED,
        pair: None,
        times: FrameTimes { waiting_us: 1, matching_us: 300, port_us: 2 },
        counts: counts(9),
        segments,
        clock: TimeSource::Board,
    }
}

pub(crate) fn camera(level: u8) -> CameraHealth {
    CameraHealth { level, detail_q4: 2, black_permille: 3, white_permille: 4, view_permille: 5 }
}

fn longest_report() -> PairReport {
    let camera = CameraHealth {
        level: u8::MAX,
        detail_q4: u16::MAX,
        black_permille: u16::MAX,
        white_permille: u16::MAX,
        view_permille: u16::MAX,
    };
    PairReport {
        cameras: [camera; 2],
        skew_us: Some(u32::MAX),
        rows: Some(Rows { offset_q8: i16::MIN, spread_q8: u16::MAX, samples: u8::MAX }),
        row_offset_q8: Some(i16::MIN),
        row_drift_q8: Some(i16::MIN),
        least_disparity_q6: Some(i16::MIN),
        range: Some(RangeReport { windows: u16::MAX, beyond: u16::MAX, disparity: u16::MAX }),
        noise: Some([Noise { deviation_q4: u8::MAX, noiseless_permille: u16::MAX }; 2]),
        still: Some(Still { still_permille: u16::MAX, pattern_permille: i16::MIN }),
        tear: Some(Tear { row: u16::MAX, shift: i16::MIN }),
    }
}

pub(crate) fn full_update() -> ParamUpdate {
    ParamUpdate {
        min_disparity: Some(i16::MIN),
        max_disparity: Some(u16::MAX),
        anchor_gradient: Some(u16::MAX),
        edge_gradient: Some(u16::MAX),
        min_extent: Some(u16::MAX),
        cell: Some(u16::MAX),
        margin: Some(Margin::Metres { nearer: Depth::MIN, farther: Depth::MIN }),
        min_confidence: Some(Confidence::MAX),
        reach: Some(u16::MAX),
        parts: Some(Parts::Support),
        rig: Some(RigUpdate { focal_px: f64::MAX, baseline_m: -1e-300, offset_px: f64::INFINITY }),
    }
}

/// Every kind of message, with ordinary and extreme numbers.
pub(crate) fn messages() -> Vec<Message> {
    let mut random = Random(7);
    let name: Name = "min_confidence (percent)".try_into().unwrap();
    let longest_name: Name = "x".repeat(32).as_str().try_into().unwrap();
    let refusals = [
        Refusal::OutOfRange { name: name.clone(), value: 7, low: 10, high: 99 },
        Refusal::OutOfRange {
            name: longest_name.clone(),
            value: i64::MIN,
            low: i64::MIN,
            high: i64::MAX,
        },
        Refusal::MarginNeedsRig,
        Refusal::MemoryTooSmall { name: longest_name.clone(), needed: u32::MAX, given: 0 },
        Refusal::Focal(f64::MIN),
        Refusal::Baseline(0.0),
        Refusal::Offset(-4096.5),
        Refusal::Unsupported,
        Refusal::Truncated { needed: u32::MAX, given: 153_599 },
        Refusal::Skewed(Skewed { skew_us: u32::MAX, limit_us: 1000 }),
        Refusal::NoRig,
        Refusal::Rig(RigFault::Damaged),
        Refusal::RawSize { needed: [u16::MAX; 2], given: [640, 480] },
        Refusal::NotKept,
        Refusal::Region(u8::MAX),
        Refusal::NoPair,
    ];
    let rig = RigInUse { raw: [u16::MAX; 2], rectified: [u16::MAX; 2], slot: Some(1) };
    let longest_rig =
        RigReport { in_use: Some(rig), slots: [Ok(u32::MAX), Err(RigFault::TooLarge)] };
    let longest_hello = Hello {
        board: longest_name,
        largest_width: u16::MAX,
        largest_height: u16::MAX,
        segments: u16::MAX,
        rig: longest_rig,
        reset: Some(Reset { cause: ResetCause::Unknown, location: u32::MAX }),
    };
    let longest_point = Point {
        x: u16::MAX,
        y: u16::MAX,
        disparity: Disparity::MIN,
        confidence: Confidence::MAX,
        source: Source::Segment(u16::MAX),
    };
    let longest_object = ObjectRecord {
        label: u16::MAX,
        disparity_q6: Ok(i16::MIN),
        sigma_q6: i16::MIN,
        slope_q10: [i16::MIN; 2],
        spread_q6: i16::MIN,
        depth_q16: Some([i32::MIN; 3]),
        support: u16::MAX,
        confidence_q16: u16::MAX,
    };
    let refused_object = ObjectRecord { disparity_q6: Err(3), depth_q16: None, ..longest_object };
    let seen = Sighting { distance_cm: u16::MAX, confidence_q16: u16::MAX, age_ms: u16::MAX };
    let longest_sector = SectorRecord { index: u8::MAX, nearest: Some(seen), drop_off: Some(seen) };
    let photo = PairHead {
        width: u16::MAX,
        height: 1,
        capture_time_us: u64::MAX,
        right_capture_time_us: Some(u64::MAX),
    };
    let silicon = Silicon {
        processor_id: u32::MAX,
        chip_id: u32::MAX,
        core_hz: u32::MAX,
        flash_wait: u8::MAX,
        instruction_cache: true,
        data_cache: false,
    };
    let mut list = examples::messages().into_iter().map(|(message, _)| message).collect::<Vec<_>>();
    list.extend([
        Message::Hello(Hello {
            board: "".try_into().unwrap(),
            largest_width: 0,
            largest_height: 0,
            segments: 0,
            rig: RigReport::NONE,
            reset: None,
        }),
        Message::Hello(longest_hello),
        Message::Frame(FrameHead {
            sequence: u32::MAX,
            capture_time_us: u64::MAX,
            width: u16::MAX,
            height: u16::MAX,
            health: Health::all(),
            pair: Some(longest_report()),
            times: FrameTimes { waiting_us: u32::MAX, matching_us: u32::MAX, port_us: u32::MAX },
            counts: counts(u16::MAX - 20),
            segments: u16::MAX,
            clock: TimeSource::Autopilot,
        }),
        Message::Segments(Segments { sequence: 0, first: 0, list: heapless::Vec::new() }),
        Message::Segments(Segments {
            sequence: u32::MAX,
            first: u16::MAX,
            list: [longest_match(); SEGMENTS_PER_PACKET].into(),
        }),
        Message::Answer(Answer { command: 0, outcome: Outcome::Accepted }),
        Message::Points(Points { sequence: 1, first: 0, list: heapless::Vec::new() }),
        Message::Points(Points {
            sequence: u32::MAX,
            first: u32::MAX,
            list: [longest_point; POINTS_PER_PACKET].into(),
        }),
        Message::Objects(Objects { sequence: 1, list: [refused_object].into_iter().collect() }),
        Message::Objects(Objects {
            sequence: u32::MAX,
            list: [longest_object; OBJECTS_PER_PACKET].into(),
        }),
        Message::Sectors(Sectors { sequence: 1, turn: 4, list: heapless::Vec::new() }),
        Message::Sectors(Sectors {
            sequence: u32::MAX,
            turn: u8::MAX,
            list: [longest_sector; SECTORS_PER_PACKET].into(),
        }),
        Message::Photo(photo),
        Message::Pixels(Pixels { is_right: false, first: 0, list: heapless::Vec::new() }),
        Message::Pixels(Pixels {
            is_right: true,
            first: u32::MAX,
            list: [255; PIXELS_PER_PACKET].into(),
        }),
        Message::Capture(CaptureReport::default()),
        Message::Capture(CaptureReport {
            faults: [[u32::MAX; CaptureReport::KINDS.len()]; 2],
            unpaired: u32::MAX,
            skipped: u32::MAX,
            sensors: [u32::MAX; 2],
        }),
        Message::Machine(MachineReport {
            firmware: "".try_into().unwrap(),
            unit: "".try_into().unwrap(),
            cases: 0,
            expected: 0,
            silicon: None,
        }),
        Message::Machine(MachineReport {
            firmware: "y".repeat(24).as_str().try_into().unwrap(),
            unit: "instructions____".try_into().unwrap(),
            cases: u16::MAX,
            expected: u32::MAX,
            silicon: Some(silicon),
        }),
        Message::Case(CaseReport {
            case: u16::MAX,
            name: "z".repeat(40).as_str().try_into().unwrap(),
            segments: u16::MAX,
            costs: [u64::MAX; 9],
            total: u64::MAX,
            time_us: u32::MAX,
            digests: [u32::MAX; DIGESTS],
        }),
        Message::Setting(SettingValue { number: u8::MAX, value: f32::MIN }),
        Message::Clock(u64::MAX),
        Message::Kept(KeptReport {
            is_kept: true,
            slots: [Ok(u32::MAX), Err(RigFault::OutOfRange)],
        }),
    ]);
    list.extend(
        refusals.map(|why| {
            Message::Answer(Answer { command: u16::MAX, outcome: Outcome::Refused(why) })
        }),
    );
    list.extend((0..20_u16).map(|first| {
        let list = (0..=first as usize % SEGMENTS_PER_PACKET).map(|_| any_match(&mut random));
        Message::Segments(Segments { sequence: 3, first, list: list.collect() })
    }));
    list
}

/// Every kind of command.
pub(crate) fn commands() -> Vec<Command> {
    let pair = PairHead {
        width: u16::MAX,
        height: 240,
        capture_time_us: u64::MAX,
        right_capture_time_us: Some(u64::MAX),
    };
    let mut random = Random(21);
    let rig = (0..RigImage::BYTES).map(|_| random.byte()).collect();
    let longest = RegionBox {
        label: u16::MAX,
        left: u16::MAX,
        top: u16::MAX,
        right: u16::MAX,
        bottom: u16::MAX,
    };
    let regions = Regions { boxes: [longest; MAX_REGIONS].into(), only: true };
    let extremes = [
        Request::Describe,
        Request::Start,
        Request::Photograph,
        Request::RunCase(u16::MAX),
        Request::SetParams(ParamUpdate::default()),
        Request::SetParams(ParamUpdate {
            margin: Some(Margin::Pixels(-Disparity::ONE)),
            ..ParamUpdate::default()
        }),
        Request::SetParams(full_update()),
        Request::Pair(pair),
        Request::SetRig(RigBytes::new()),
        Request::SetRig(rig),
        Request::SetRegions(Regions::default()),
        Request::SetRegions(regions),
        Request::Set(SettingValue { number: 0, value: -0.5 }),
        Request::Set(SettingValue { number: u8::MAX, value: f32::MAX }),
        Request::Settings,
        Request::KeepSettings,
        Request::ResetSettings,
        Request::ReadClock,
        Request::SetClock(u64::MAX),
        Request::Bootloader,
    ];
    let extremes = extremes.into_iter().map(|request| Command { id: u16::MAX, request });
    // Numbers of one, two and three bytes.
    let numbered = [0, 1, 127, 128, 255, 300].map(|id| Command { id, request: Request::Stop });
    let ordinary = examples::commands().into_iter().map(|(command, _)| command);
    ordinary.chain(numbered).chain(extremes).collect()
}

pub(crate) fn packet<T: Record>(record: &T) -> Vec<u8> {
    encode(record, &mut [0xaa; MAX_PACKET]).unwrap().to_vec()
}

/// Everything a fresh decoder says about these bytes, and its counters.
pub(crate) fn decode<T: Record>(bytes: &[u8]) -> (Vec<Result<T, DecodeError>>, Counters) {
    let mut decoder: Decoder<T, MAX_PACKET> = Decoder::new();
    let results = bytes.iter().filter_map(|&byte| decoder.push(byte)).collect();
    (results, decoder.counters())
}
