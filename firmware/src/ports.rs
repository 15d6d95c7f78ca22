//! Clock, ports, cameras, flash and watchdog as a program sees them. Implemented by the boards, by
//! the PC, and by fakes in tests.

use crate::memory::Memory;
use core::convert::Infallible;
use linestereo::{Cores, Dims};
use linestereo_wire::{CaptureReport, Reset, Silicon};

/// A clock that counts up and wraps.
pub trait Clock {
    /// Unit of [`Clock::elapsed`].
    const UNIT: &'static str;

    /// The count now.
    fn now(&self) -> u32;

    /// Difference of two counts, in [`Clock::UNIT`]. By default a count is one.
    fn elapsed(&self, from: u32, to: u32) -> u64 {
        to.wrapping_sub(from).into()
    }

    /// Microseconds between two counts. By default a count is one.
    fn microseconds(&self, from: u32, to: u32) -> u64 {
        to.wrapping_sub(from).into()
    }
}

/// Counts nothing: where a program runs for its answers alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoClock;

impl Clock for NoClock {
    const UNIT: &'static str = "nothing";

    fn now(&self) -> u32 {
        0
    }
}

/// Where bytes come from: a file, a serial port.
pub trait ByteSource {
    /// Puts bytes that are there at the start of `bytes` and says how many. None are there at the
    /// end of a file, and while a serial port is silent.
    fn read(&mut self, bytes: &mut [u8]) -> usize;

    /// Takes note that the last bytes were a command: there is somebody at the other end.
    fn heard(&mut self) {}
}

/// Bytes of a buffer before a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// That are free.
    pub free: usize,
    /// That it holds when it is empty.
    pub all: usize,
}

/// Where bytes go. Waits as long as they take.
pub trait ByteSink {
    /// Writes all of `bytes`.
    fn write(&mut self, bytes: &[u8]);

    /// Bytes that [`ByteSink::write`] takes now without waiting, and those that it takes at most.
    fn room(&self) -> Room {
        Room { free: usize::MAX, all: usize::MAX }
    }
}

/// Nobody at the other end: what is written goes nowhere.
#[derive(Debug)]
pub struct NoPort;

impl ByteSource for NoPort {
    fn read(&mut self, _: &mut [u8]) -> usize {
        0
    }
}

impl ByteSink for NoPort {
    fn write(&mut self, _: &[u8]) {}
}

/// A port as the function that encoders write packets with; it cannot fail.
pub fn packets(port: &mut impl ByteSink) -> impl FnMut(&[u8]) -> Result<(), Infallible> {
    |packet| {
        port.write(packet);
        Ok(())
    }
}

/// Where pairs come from: a camera, or what stands for one.
pub trait PairSource {
    /// Puts the next pair into the memory's frames, from their starts and without padding, and says
    /// what it is: with the size that the memory's rig rectifies to, rectified, else as it comes.
    /// `None` when the camera delivered no whole pair.
    fn next_pair(
        &mut self,
        memory: &mut impl Memory,
        rectified: Option<Dims>,
    ) -> Option<CapturedPair>;

    /// Size of the images that the cameras deliver; `None` when they come rectified.
    fn raw_dims(&self) -> Option<Dims> {
        None
    }

    /// Time of the clock of its pairs, microseconds; `None` where they carry no times.
    fn clock_us(&self) -> Option<u64> {
        None
    }

    /// Images may be captured so far apart, microseconds, where the scene is known to stand still;
    /// `None`: as the health check says.
    fn still_us(&self) -> Option<u32> {
        None
    }

    /// Rows and frames lost so far; `None` where nothing can be.
    fn losses(&self) -> Option<CaptureReport> {
        None
    }
}

/// The sensors of both cameras, as the source of pairs needs them. `camera::StereoCamera` is what
/// boards have.
pub trait Cameras {
    /// Makes both take a frame, unless they do by themselves. `false` when they cannot.
    fn shoot(&mut self) -> bool;

    /// Frames of both have started, or are not waited for any more: lowers a trigger that is held.
    fn let_go(&mut self) {}

    /// After a pair, or when it is missing: both are exposed alike. From the start of a frame to
    /// the middle of its exposure, left and right, microseconds; `None` when it is not known any
    /// more.
    fn follow(&mut self) -> Option<[i32; 2]>;

    /// A camera has stopped: both are started again before the next frame.
    fn stopped(&mut self);

    /// How often the left and the right sensor did not do what was written to it.
    fn failures(&self) -> [u32; 2] {
        [0; 2]
    }
}

/// Resets the board when the program no longer does its work.
pub trait Watchdog {
    /// The program has done some.
    fn feed(&mut self);
}

/// Nothing resets the board.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoWatchdog;

impl Watchdog for NoWatchdog {
    fn feed(&mut self) {}
}

/// A board's light.
pub trait Light {
    /// Switches it.
    fn set(&mut self, is_on: bool);
}

/// A board without one.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoLight;

impl Light for NoLight {
    fn set(&mut self, _: bool) {}
}

/// A board whose program has one core.
#[derive(Debug)]
pub enum NoSecondCore {}

impl Cores for NoSecondCore {
    fn join(&mut self, _: &mut (dyn FnMut() + Send), _: &mut (dyn FnMut() + Send)) {
        match *self {}
    }
}

/// Peripherals of a board for the program `live`, after a reset.
#[derive(Debug)]
pub struct Peripherals<C, H, A, P, F, W, L, S = NoSecondCore> {
    /// A [`Clock`].
    pub clock: C,
    /// The host's port: a [`ByteSource`] and [`ByteSink`].
    pub host: H,
    /// The autopilot's port: a [`ByteSource`] and [`ByteSink`].
    pub autopilot: A,
    /// The cameras: a [`PairSource`].
    pub pairs: P,
    /// Where the rig and settings are kept: a `slot_store::Keeper`, if there is one.
    pub flash: Option<F>,
    /// A [`Watchdog`].
    pub watchdog: W,
    /// Sleeps until an interrupt has come since the last rest: nobody wants pairs.
    pub rest: fn(),
    /// Why the board was reset, if it knows.
    pub reset: Option<Reset>,
    /// Ends the program for the boot loader's, as soon as what waits for the host is sent; `None`
    /// where there is none.
    pub bootloader: Option<fn() -> !>,
    /// A [`Light`].
    pub light: L,
    /// [`Cores`] to match pairs on, if there are two.
    pub second_core: Option<S>,
}

/// Peripherals of a program without cameras, after the same start as for `live`: clocks, caches,
/// watchdog, the host's port.
#[derive(Debug)]
pub struct BarePeripherals<C, T, H, W> {
    /// A [`Clock`] that counts costs: cycles, or the instructions of an emulator.
    pub counter: C,
    /// A [`Clock`] of time.
    pub clock: T,
    /// The host's port: a [`ByteSource`] and [`ByteSink`].
    pub host: H,
    /// A [`Watchdog`].
    pub watchdog: W,
    /// Sleeps until an interrupt has come since the last rest.
    pub rest: fn(),
    /// Why the board was reset, if it knows.
    pub reset: Option<Reset>,
    /// The chip and how it is set up; `None` on an emulated board.
    pub silicon: Option<Silicon>,
}

/// Start of a frame: free or triggered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameStart {
    /// The sensor: frames of two sensors start at different times, and drift.
    Free,
    /// The sensor's trigger pin.
    Triggered,
}

/// A pair that lies in the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapturedPair {
    /// Size of both images.
    pub dims: Dims,
    /// When the left and the right image were captured, microseconds of one clock, if the cameras'
    /// driver knows: a pair whose images were captured too far apart is not matched.
    pub times_us: Option<[u64; 2]>,
    /// Start of the frames, if the driver knows it: of cameras that run free, the difference of
    /// their times is chance.
    pub frame_start: Option<FrameStart>,
}

impl CapturedPair {
    /// One of which nothing else is known.
    pub const fn of(dims: Dims) -> Self {
        Self { dims, times_us: None, frame_start: None }
    }
}
