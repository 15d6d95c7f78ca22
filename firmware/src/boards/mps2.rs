//! Peripherals that QEMU's mps2 and mps3 machines have, all of Arm's CMSDK: an APB timer as the
//! clock, UART 0 as the host's port, UART 1 as the autopilot's. Where they lie and how fast they
//! tick is in the board's file.

use super::emulated::{self, NS_PER_INSTRUCTION, Polled, Port};
use super::selected::{InstructionClock, MHZ, UARTS};
use crate::ports::Clock;
use core::ptr;

/// CMSDK APB timer (Arm DDI 0479D, section 4.1.2): CTRL, VALUE and RELOAD; counts down.
const VALUE: usize = 1;
const RELOAD: usize = 2;

/// Counts instructions: a tick of the timer at `ADDRESS` is `1 / MHZ` microseconds.
#[derive(Debug)]
pub struct Timer<const ADDRESS: usize, const MHZ: u32>(());

impl<const ADDRESS: usize, const MHZ: u32> Timer<ADDRESS, MHZ> {
    const REGISTERS: *mut u32 = ptr::without_provenance_mut(ADDRESS);

    /// Starts the timer.
    pub fn start() -> Self {
        // SAFETY: the registers of a timer that nothing else uses, at the address that the board's
        // file gives.
        unsafe {
            Self::REGISTERS.add(RELOAD).write_volatile(u32::MAX);
            Self::REGISTERS.add(VALUE).write_volatile(u32::MAX);
            Self::REGISTERS.write_volatile(1);
        }
        Self(())
    }
}

impl<const ADDRESS: usize, const MHZ: u32> Clock for Timer<ADDRESS, MHZ> {
    const UNIT: &'static str = "instructions";

    #[inline]
    fn now(&self) -> u32 {
        // SAFETY: reading the timer changes nothing.
        !unsafe { Self::REGISTERS.add(VALUE).read_volatile() }
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        instructions::<MHZ>(from, to)
    }

    fn microseconds(&self, from: u32, to: u32) -> u64 {
        u64::from(to.wrapping_sub(from)) / u64::from(MHZ)
    }
}

/// Instructions between two counts of a clock of so many MHz. The fraction is in its lowest terms,
/// so that the rates here divide by a power of two: a division that is called may be counted where
/// the compiler puts it, behind the next look at the clock.
pub(super) fn instructions<const MHZ: u32>(from: u32, to: u32) -> u64 {
    const fn common(a: u64, b: u64) -> u64 {
        if b == 0 { a } else { common(b, a % b) }
    }
    let (above, below) = const {
        let ns = MHZ as u64 * NS_PER_INSTRUCTION;
        let (above, below) = (1000 / common(1000, ns), ns / common(1000, ns));
        assert!(below.is_power_of_two());
        (above, below)
    };
    u64::from(to.wrapping_sub(from)) * above / below
}

/// CMSDK APB UART (Arm DDI 0479D, section 4.3.3): DATA, STATE, CTRL, INTSTATUS, BAUDDIV.
const STATE: usize = 1;
const CTRL: usize = 2;
const BAUDDIV: usize = 4;
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 2;
/// The fastest it can do.
const FASTEST: u32 = 16;

/// A polled serial port. It keeps one received byte: on hardware a host has to wait for answers,
/// QEMU holds further bytes back.
#[derive(Debug)]
pub struct Uart(*mut u32);

impl Uart {
    /// The host's port and the autopilot's, the latter at 57600 baud.
    fn start() -> [Port<Self>; 2] {
        let [host, autopilot] = UARTS.map(ptr::without_provenance_mut);
        [Self::switch_on(host, FASTEST), Self::switch_on(autopilot, MHZ * 1_000_000 / 57_600)]
            .map(Port)
    }

    fn switch_on(registers: *mut u32, divider: u32) -> Self {
        // SAFETY: the registers of a UART that nothing else uses, at the address that the board's
        // file gives.
        unsafe {
            registers.add(BAUDDIV).write_volatile(divider);
            registers.add(CTRL).write_volatile(0b11);
        }
        Self(registers)
    }

    fn state(&self) -> u32 {
        // SAFETY: reading the state changes nothing.
        unsafe { self.0.add(STATE).read_volatile() }
    }
}

impl Polled for Uart {
    fn take(&mut self) -> Option<u8> {
        // SAFETY: there is a byte, and this port is the only one that takes it.
        (self.state() & RECEIVE_FULL != 0).then(|| unsafe { self.0.read_volatile() } as u8)
    }

    fn has_room(&mut self) -> bool {
        self.state() & TRANSMIT_FULL == 0
    }

    fn put(&mut self, byte: u8) {
        // SAFETY: there is room for a byte.
        unsafe { self.0.write_volatile(byte.into()) };
    }
}

/// Peripherals for `live`.
pub fn peripherals() -> Option<emulated::Peripherals<InstructionClock, Port<Uart>, Port<Uart>>> {
    let [host, autopilot] = Uart::start();
    emulated::peripherals(InstructionClock::start(), host, autopilot)
}

/// Peripherals of `selftest`.
pub fn bare() -> Option<emulated::Bare<InstructionClock, Port<Uart>>> {
    let [host, _] = Uart::start();
    Some(emulated::bare(InstructionClock::start, host))
}

/// Where mps2-an386 and mps2-an500 have them: the clock is timer 0, the UARTs are the host's and
/// the autopilot's, all at 25 MHz.
pub mod usual {
    /// The clock.
    pub type InstructionClock = super::Timer<0x4000_0000, MHZ>;
    /// Addresses of both UARTs.
    pub const UARTS: [usize; 2] = [0x4000_4000, 0x4000_5000];
    /// Of the bus.
    pub const MHZ: u32 = 25;
}
