//! The program `live` with a board's memory, a camera and the host's end of its line.

use crate::support::port::Port;
use linestereo::Dims;
use linestereo_firmware::boards::mps2_an386::BoardMemory;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::painter::Painter;
use linestereo_firmware::ports::{ByteSink, ByteSource, CapturedPair, NoPort, PairSource};
use linestereo_firmware::programs::live::{Live, Turn};
use linestereo_firmware::session::Session;
use linestereo_rig::{Calibration, Camera, Lens, RigImage, View};
use linestereo_wire::{CaptureReport, Message, ParamUpdate, Request, RigUpdate};

/// Size of the pairs of these cameras.
pub(crate) const DIMS: Dims = Dims { width: 128, height: 96 };

/// A rig of cameras of this size without distortion, for these disparities.
pub(crate) fn rig(max_disparity: u16) -> Request {
    let camera = || Camera::new(DIMS, [100.0; 2], [63.5, 47.5], 0.0, Lens::NONE).unwrap();
    let pair =
        Calibration::new(camera(), camera(), [1.0, 0.0, 0.0, 0.0], [-0.1, 0.0, 0.0]).unwrap();
    let image = RigImage::new(pair, DIMS, View::default(), (0, max_disparity)).unwrap();
    Request::SetRig(image.encode(0).into_iter().collect())
}

/// Gives a board the numbers of a rig.
pub(crate) fn rig_numbers(rig: RigUpdate) -> Request {
    Request::SetParams(ParamUpdate { rig: Some(rig), ..ParamUpdate::default() })
}

/// A running program. Clones of its port are the same line.
pub(crate) struct Running<'a, S, A = NoPort> {
    pub(crate) port: Port,
    pub(crate) memory: Box<BoardMemory>,
    pub(crate) camera: S,
    pub(crate) live: Live<'a, Port, Port, A>,
}

impl<'a, S: PairSource> Running<'a, S> {
    pub(crate) fn start(session: Session<'a>, port: &Port, camera: S) -> Self {
        let memory = Box::new(BoardMemory::CLEARED);
        Self {
            port: port.clone(),
            memory,
            camera,
            live: Live::start(session, port.clone(), port.clone()),
        }
    }

    pub(crate) fn with_autopilot(self, autopilot: &Port) -> Running<'a, S, Port> {
        let Self { port, memory, camera, live } = self;
        Running { port, memory, camera, live: live.with_autopilot(autopilot.clone()) }
    }
}

impl<S: PairSource, A: ByteSource + ByteSink> Running<'_, S, A> {
    pub(crate) fn turn(&mut self) -> Turn {
        self.live.turn(&mut *self.memory, &mut self.camera)
    }

    pub(crate) fn turns(&mut self, count: usize) {
        for _ in 0..count {
            self.turn();
        }
    }

    /// Messages of so many turns.
    pub(crate) fn messages(&mut self, turns: usize) -> Vec<Message> {
        self.turns(turns);
        self.port.received()
    }

    /// Messages of the turn in which the board gets a command.
    pub(crate) fn ask(&mut self, id: u16, request: Request) -> Vec<Message> {
        self.port.send(id, request);
        self.messages(1)
    }
}

/// A camera that paints pairs of [`DIMS`]. Its script gets the number of the call, from 1, and a
/// function that paints the next pair, and says what the camera delivers.
pub(crate) struct Scripted<F> {
    script: F,
    painter: Painter,
    pub(crate) calls: u32,
    pub(crate) raw_dims: Option<Dims>,
    pub(crate) clock_us: Option<u64>,
    pub(crate) still_us: Option<u32>,
    /// Losses after so many calls.
    pub(crate) losses: fn(u32) -> Option<CaptureReport>,
}

type Paint<'a> = &'a mut dyn FnMut() -> Option<CapturedPair>;

pub(crate) fn scripted<F>(script: F) -> Scripted<F>
where
    F: FnMut(u32, Paint<'_>) -> Option<CapturedPair>,
{
    let (painter, losses) = (Painter::new(DIMS), |_| None);
    Scripted { script, painter, calls: 0, raw_dims: None, clock_us: None, still_us: None, losses }
}

impl<F: FnMut(u32, Paint<'_>) -> Option<CapturedPair>> PairSource for Scripted<F> {
    fn next_pair(
        &mut self,
        memory: &mut impl Memory,
        rectified: Option<Dims>,
    ) -> Option<CapturedPair> {
        self.calls += 1;
        let pair = (self.script)(self.calls, &mut || self.painter.next_pair(memory, rectified))?;
        let dims = self.raw_dims.map_or(pair.dims, |raw| rectified.unwrap_or(raw));
        Some(CapturedPair { dims, ..pair })
    }

    fn raw_dims(&self) -> Option<Dims> {
        self.raw_dims
    }

    fn clock_us(&self) -> Option<u64> {
        self.clock_us
    }

    fn still_us(&self) -> Option<u32> {
        self.still_us
    }

    fn losses(&self) -> Option<CaptureReport> {
        (self.losses)(self.calls)
    }
}
