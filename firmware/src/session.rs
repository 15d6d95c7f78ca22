//! Commands of a host so far, and their answers: the same for a serial port and for a file.

use crate::memory::{Memory, NoRoom, PairError};
use crate::settings::{self, KeptSettings};
use crate::slot_store::{Keeper, Loaded, Slot};
use crate::vehicle::{VEHICLE, Vehicle};
use heapless::Vec;
use linestereo::obstacles::ObstaclePlan;
use linestereo::results::Counts;
use linestereo::{Area, Dims, Matched, Matcher, Params, health::HealthLimits, image::MIN_SIDE};
use linestereo_boards::Board;
use linestereo_rig::RigImage;
use linestereo_wire::{
    Answer, Command, FrameHead, Health, Hello, KeptReport, MAX_REGIONS, Message, ObjectRecord,
    Outcome, PairHead, Refusal, Regions, Request, Reset, RigFault, RigInUse, RigReport, Setting,
    SettingValue, SettingValues, name,
};

/// The state that commands change.
#[derive(Debug)]
pub struct Session<'a> {
    board: Board,
    params: Params,
    /// Directions, for the size of the last pair.
    directions: Option<(Dims, ObstaclePlan)>,
    /// Objects whose depths are wanted.
    regions: Regions,
    /// A reset changes none of the settings.
    is_kept: bool,
    settings_slots: [Result<u32, RigFault>; 2],
    /// For pairs of the size of the last one; `None` before the first.
    matcher: Option<Matcher>,
    /// Limits of a pair's health.
    pub limits: HealthLimits,
    /// The rig that the memory was made ready for, as bytes: it is smaller so.
    rig: Option<[u8; RigImage::BYTES]>,
    /// How the cameras sit on the vehicle, and what its autopilot wants.
    pub vehicle: Vehicle,
    /// Why the board was reset, if it knows.
    pub reset: Option<Reset>,
    /// Can the board leave its program for a boot loader?
    pub has_bootloader: bool,
    report: RigReport,
    keeper: Option<&'a mut dyn Keeper>,
    /// Send results?
    pub running: bool,
    sequence: u32,
}

/// Consequence of a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// An answer.
    Answer(Answer),
    /// A description, then the answer.
    Describe(Answer),
    /// All settings, then the answer.
    Settings(Answer),
    /// The time of the clock of pairs, then the answer.
    Clock(Answer),
    /// Times are in the host's clock from now on, which was so many microseconds when the board's
    /// was 0.
    SetClock(Answer, u64),
    /// An answer, then the end of the program.
    Leave(Answer),
    /// The next pair is wanted as it comes; the answer when it has come.
    Photograph {
        /// The id of the command.
        command: u16,
    },
    /// Pixels of a pair follow; the answer when they were matched.
    Pair {
        /// The id of the command.
        command: u16,
        /// Number, size and kind of the pixels.
        head: PairHead,
        /// Are they raw?
        is_raw: bool,
    },
}

impl<'a> Session<'a> {
    /// The state after a reset of a board without flash.
    pub const fn new(board: Board) -> Self {
        Self {
            board,
            params: Params::DEFAULT,
            directions: None,
            regions: NO_REGIONS,
            is_kept: true,
            settings_slots: RigReport::NONE.slots,
            matcher: None,
            limits: HealthLimits::DEFAULT,
            rig: None,
            vehicle: VEHICLE,
            reset: None,
            has_bootloader: false,
            report: RigReport::NONE,
            keeper: None,
            running: false,
            sequence: 0,
        }
    }

    /// The state after a reset of a board whose flash keeps rigs and settings: the newest good ones
    /// are used.
    #[must_use]
    pub fn with_flash(board: Board, keeper: &'a mut dyn Keeper, memory: &mut impl Memory) -> Self {
        let mut session = Self::new(board);
        session.load_rig(keeper, memory);
        session.load_settings(keeper);
        session.keeper = Some(keeper);
        session
    }

    #[inline(never)] // its images are on the stack only while it works
    fn load_rig(&mut self, keeper: &mut dyn Keeper, memory: &mut impl Memory) {
        let Loaded { newest, slots } = keeper.load_rig();
        self.report.slots = slots.map(|slot| slot.map_err(RigFault::from));
        if let Some((slot, image)) = newest {
            let params = self.params_for(&image);
            match params.and_then(|params| {
                memory.set_rig(image.remap()).map(|()| params).map_err(Refusal::from)
            }) {
                Ok(params) => self.use_rig(&image, params, Some(slot)),
                Err(_) => *slot.of(&mut self.report.slots) = Err(RigFault::TooLarge),
            }
        }
    }

    /// Takes the kept settings. If this program does not take one, none of the values is taken and
    /// the slot says so.
    #[inline(never)]
    fn load_settings(&mut self, keeper: &mut dyn Keeper) {
        let Loaded { newest, slots } = keeper.load_settings();
        self.settings_slots = slots.map(|slot| slot.map_err(RigFault::from));
        let Some((slot, kept)) = newest else { return };
        let mut values = self.values();
        let has_its_rig = kept.rig == self.rig_sequence();
        for (number, (value, kept)) in values.iter_mut().zip(kept.values).enumerate() {
            if has_its_rig || number >= settings::OF_RIG {
                *value = kept.unwrap_or(*value);
            }
        }
        let taken = [self.use_values(&values), self.set_regions(&kept.regions)];
        self.is_kept = taken.iter().all(Result::is_ok);
        if !self.is_kept {
            *slot.of(&mut self.settings_slots) = Err(RigFault::OutOfRange);
        }
    }

    /// The number of the rig in flash that is in use.
    fn rig_sequence(&self) -> Option<u32> {
        let slot = self.report.in_use?.slot?;
        self.report.slots.get(usize::from(slot)).copied()?.ok()
    }

    /// Name, version and limits of the board.
    pub fn hello(&self) -> Hello {
        let mut board = linestereo_wire::BoardName::new();
        let _ = board.push_str(self.board.name); // names are short
        let Dims { width, height } = self.board.largest;
        let segments = u16::try_from(self.board.segments).unwrap_or(u16::MAX);
        let (rig, reset) = (self.report, self.reset);
        Hello { board, largest_width: width, largest_height: height, segments, rig, reset }
    }

    /// Takes a command. What is refused changes nothing.
    pub fn command(&mut self, command: &Command, memory: &mut impl Memory) -> Reply {
        let id = command.id;
        let accepted = Answer { command: id, outcome: Outcome::Accepted };
        let done = match &command.request {
            Request::Describe => return Reply::Describe(accepted),
            Request::Settings => return Reply::Settings(accepted),
            Request::ReadClock => return Reply::Clock(accepted),
            Request::SetClock(offset_us) => return Reply::SetClock(accepted, *offset_us),
            Request::Bootloader if self.has_bootloader => return Reply::Leave(accepted),
            Request::Photograph => return Reply::Photograph { command: id },
            Request::Pair(head) => {
                return Reply::Pair { command: id, head: *head, is_raw: false };
            }
            Request::RawPair(head) => {
                return Reply::Pair { command: id, head: *head, is_raw: true };
            }
            Request::Start => {
                self.running = true;
                Ok(())
            }
            Request::Stop => {
                self.running = false;
                Ok(())
            }
            Request::SetParams(update) => {
                update.checked(self.params, self.widest()).map(|params| {
                    self.set_params(params);
                    self.is_kept = false;
                })
            }
            Request::SetRig(bytes) => self.set_rig(bytes, memory),
            Request::SetRegions(regions) => self.set_regions(regions),
            Request::Set(SettingValue { number, value }) => self.set(*number, *value),
            Request::KeepSettings => self.keep_settings(),
            Request::ResetSettings => self.reset_settings(),
            Request::RunCase(_) | Request::Bootloader => Err(Refusal::Unsupported),
        };
        Reply::Answer(Answer { command: id, outcome: done.into() })
    }

    fn set_params(&mut self, params: Params) {
        self.params = params;
        self.directions = None;
    }

    /// Values of all settings.
    pub fn values(&self) -> SettingValues {
        settings::values(&self.params, &self.vehicle)
    }

    /// Changes a setting.
    #[inline(never)]
    pub fn set(&mut self, number: u8, value: f32) -> Result<(), Refusal> {
        let mut values = self.values();
        *values.get_mut(usize::from(number)).ok_or(Refusal::Unsupported)? = value;
        self.use_values(&values)
    }

    #[inline(never)] // copies are on the stack only while it works
    fn use_values(&mut self, values: &SettingValues) -> Result<(), Refusal> {
        for (number, &value) in (0..).zip(values) {
            Setting::check(number, value)?;
        }
        let (params, vehicle) = settings::with_values(self.params, values);
        params.check(self.widest())?;
        vehicle.check()?;
        self.set_params(params);
        self.vehicle = vehicle;
        self.is_kept = false;
        Ok(())
    }

    /// Writes the settings into the flash.
    #[inline(never)] // its images are on the stack only while it works
    pub fn keep_settings(&mut self) -> Result<(), Refusal> {
        let mut values = self.values().map(Some);
        for (number, (value, built)) in values.iter_mut().zip(settings::built()).enumerate() {
            if number >= settings::OF_RIG && *value == Some(built) {
                *value = None;
            }
        }
        let settings =
            KeptSettings { rig: self.rig_sequence(), values, regions: self.regions.clone() };
        let Some(keeper) = &mut self.keeper else { return Err(Refusal::NotKept) };
        self.is_kept = keeper.store_settings(&settings).is_ok();
        self.settings_slots = keeper.load_settings().slots.map(|slot| slot.map_err(RigFault::from));
        if self.is_kept { Ok(()) } else { Err(Refusal::NotKept) }
    }

    /// Goes back to the settings that the board was built with and to the disparity range of its
    /// rig, in the flash as well if there is one.
    #[inline(never)]
    fn reset_settings(&mut self) -> Result<(), Refusal> {
        let mut params = Params::DEFAULT;
        if let Some(bytes) = &self.rig
            && let Ok(image) = RigImage::decode(bytes)
            && let Ok(with_rig) = image.params(params)
        {
            params = with_rig;
        }
        self.set_params(params);
        (self.vehicle, self.regions) = (VEHICLE, NO_REGIONS);
        self.is_kept = true;
        if self.keeper.is_some() { self.keep_settings() } else { Ok(()) }
    }

    /// State of the stored settings.
    pub fn kept(&self) -> KeptReport {
        KeptReport { is_kept: self.is_kept, slots: self.settings_slots }
    }

    /// Every setting and what is kept of them, as records.
    pub fn report_settings(&self, mut write: impl FnMut(&Message)) {
        for (number, value) in (0..).zip(self.values()) {
            write(&Message::Setting(SettingValue { number, value }));
        }
        write(&Message::Kept(self.kept()));
    }

    /// Takes the objects whose depths are wanted from now on.
    fn set_regions(&mut self, regions: &Regions) -> Result<(), Refusal> {
        let outside =
            (0..).zip(&regions.boxes).find(|(_, of)| of.region(self.board.largest).is_err());
        if let Some((index, _)) = outside {
            return Err(Refusal::Region(index));
        }
        self.regions = regions.clone();
        self.is_kept = false;
        Ok(())
    }

    /// The parts of a pair that are to be matched; `None` is all of it.
    pub fn areas(&self) -> Option<Vec<Area, MAX_REGIONS>> {
        (self.regions.only && !self.regions.boxes.is_empty()).then(|| {
            let mut areas = Vec::new();
            for of in &self.regions.boxes {
                let _ = areas.push(of.area()); // as many as there are
            }
            areas
        })
    }

    /// Depths of the wanted objects in this pair. Boxes that a smaller pair does not show are left
    /// out.
    #[inline(never)]
    pub fn objects(&self, matched: &mut Matched<'_>) -> Vec<ObjectRecord, MAX_REGIONS> {
        let mut found = Vec::new();
        for of in &self.regions.boxes {
            let Ok(region) = of.region(matched.dims()) else { continue };
            // As many as there are.
            let _ = found.push(ObjectRecord::new(of.label, &matched.object(&region)));
        }
        found
    }

    /// Uses a rig from now on, and keeps it.
    #[inline(never)] // its images are on the stack only while it works
    fn set_rig(&mut self, bytes: &[u8], memory: &mut impl Memory) -> Result<(), Refusal> {
        let image = RigImage::decode(bytes).map_err(|error| Refusal::Rig(error.into()))?;
        let params = self.params_for(&image)?;
        let ready = memory.set_rig(image.remap()).map_err(Refusal::from);
        match ready.and_then(|()| self.keep(&image)) {
            Ok(slot) => self.use_rig(&image, params, slot),
            Err(refusal) => {
                if let Some(Ok(before)) = self.rig.map(|bytes| RigImage::decode(&bytes)) {
                    let _ = memory.set_rig(before.remap()); // it fitted before
                }
                return Err(refusal);
            }
        }
        Ok(())
    }

    /// The parameters with this rig, if this board holds what it rectifies to.
    fn params_for(&self, image: &RigImage) -> Result<Params, Refusal> {
        let dims = image.remap().dims();
        self.check_size(dims)?;
        let params = image.params(self.params).map_err(|error| Refusal::Rig(error.into()))?;
        params.check(dims)?;
        Ok(params)
    }

    /// The memory is ready for this rig, and it lies in this slot.
    fn use_rig(&mut self, image: &RigImage, params: Params, slot: Option<Slot>) {
        self.set_params(params);
        self.matcher = None; // its row offset and health history are of the rig before
        self.report.in_use = Some(RigInUse::new(image, slot.map(|slot| slot as u8)));
        self.rig = Some(image.encode(0));
    }

    /// Writes a rig into the flash, if there is one.
    fn keep(&mut self, image: &RigImage) -> Result<Option<Slot>, Refusal> {
        let Some(keeper) = &mut self.keeper else { return Ok(None) };
        let kept = keeper.store_rig(image);
        self.report.slots = keeper.load_rig().slots.map(|slot| slot.map_err(RigFault::from));
        kept.map(Some).map_err(|_| Refusal::NotKept)
    }

    /// The matcher for pairs of this size.
    #[inline(never)] // a new one is on the stack only while it works
    pub fn matcher(&mut self, dims: Dims) -> Result<&mut Matcher, Refusal> {
        self.check_size(dims)?;
        let matcher = match &mut self.matcher {
            Some(matcher) => matcher,
            none => none.insert(Matcher::new(self.params, dims)?),
        };
        if (matcher.params(), matcher.dims()) != (&self.params, dims) {
            matcher.set_params(self.params, dims)?;
        }
        matcher.limits = self.limits.of_rig(self.params.rig.as_ref());
        Ok(matcher)
    }

    /// How pairs of this size are cut into directions; `None` without a rig.
    #[inline(never)] // floats on the stack only while it works
    pub fn directions(&mut self, dims: Dims) -> Option<ObstaclePlan> {
        if let Some((_, plan)) = self.directions.filter(|&(of, _)| of == dims) {
            return Some(plan);
        }
        let plan = self.vehicle.directions().plan(&self.params, dims).ok()?;
        self.directions = Some((dims, plan));
        Some(plan)
    }

    /// The size that the rig in use rectifies to.
    pub fn rig_dims(&self) -> Option<Dims> {
        self.report.in_use.map(|RigInUse { rectified: [width, height], .. }| Dims { width, height })
    }

    /// The size that parameters are checked for; of pairs that a host sends some may still be too
    /// narrow for the disparities.
    fn widest(&self) -> Dims {
        self.rig_dims().unwrap_or(self.board.largest)
    }

    /// Is there a rig, so that distances are known?
    pub fn has_rig(&self) -> bool {
        self.params.rig.is_some()
    }

    /// The size that raw pairs of this size are rectified to.
    pub fn rectified(&self, raw: Dims) -> Result<Dims, Refusal> {
        let RigInUse { raw: needed, rectified: [width, height], .. } =
            self.report.in_use.ok_or(Refusal::NoRig)?;
        let given = [raw.width, raw.height];
        if needed == given {
            Ok(Dims { width, height })
        } else {
            Err(Refusal::RawSize { needed, given })
        }
    }

    /// Can the board hold such a pair?
    fn check_size(&self, dims: Dims) -> Result<(), Refusal> {
        let side = |name: &str, value: u16, high: u16| {
            let fits = (MIN_SIDE..=high).contains(&value);
            if fits {
                Ok(())
            } else {
                Err(out_of_range(name, value.into(), MIN_SIDE.into(), high.into()))
            }
        };
        side("width", dims.width, self.board.largest.width)?;
        side("height", dims.height, linestereo::image::MAX_HEIGHT)?;
        if self.board.fits(dims) {
            return Ok(());
        }
        let pixels = |dims: Dims| u32::from(dims.width) * u32::from(dims.height);
        let name = name("frame");
        Err(Refusal::MemoryTooSmall {
            name,
            needed: pixels(dims),
            given: pixels(self.board.largest),
        })
    }

    /// The number of the next pair: one more than the last one's.
    pub fn next_sequence(&mut self) -> u32 {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        sequence
    }
}

const NO_REGIONS: Regions = Regions { boxes: Vec::new(), only: false };

/// The head of a frame that could not be matched.
pub fn failed_frame(sequence: u32, capture_time_us: u64, dims: Dims, health: Health) -> FrameHead {
    FrameHead::new(sequence, capture_time_us, dims, health, &Counts::default())
}

/// Answer for a pair that cannot be matched.
pub fn refusal(error: PairError) -> Refusal {
    match error {
        PairError::Size(dims) => out_of_range(
            "width",
            dims.width.into(),
            MIN_SIDE.into(),
            linestereo::image::MAX_WIDTH.into(),
        ),
        PairError::NoRoom(error) => error.into(),
    }
}

impl From<NoRoom> for Refusal {
    fn from(error: NoRoom) -> Self {
        let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        match error {
            NoRoom::Small { name: what, needed, given } => Self::MemoryTooSmall {
                name: name(what),
                needed: count(needed),
                given: count(given),
            },
            NoRoom::NothingSeen => Self::Rig(RigFault::View),
        }
    }
}

/// Refusal of a number outside its range.
pub(crate) fn out_of_range(text: &str, value: i64, low: i64, high: i64) -> Refusal {
    Refusal::OutOfRange { name: name(text), value, low, high }
}
