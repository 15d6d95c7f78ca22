//! Peripherals that QEMU's mps2 machines have in common, all of Arm's CMSDK: APB timer 0 as the clock, UART 0 as the
//! host's port, UART 1 as the autopilot's.

use super::flash_file::FlashFile;
use crate::ports::{ByteSink, ByteSource, Clock, NoWatchdog, PairSource, Peripherals};
use crate::programs::live::Painter;
use crate::rig_store::RigStore;
use crate::semihosting::Arguments;

/// What such a machine gives to `live`: painted pairs, and the file that its argument names in place of flash. `None` when that cannot be used.
pub fn peripherals()
-> Option<Peripherals<InstructionClock, Uart, Uart, impl PairSource, RigStore<FlashFile>, NoWatchdog>> {
    Some(Peripherals {
        clock: InstructionClock::start(),
        host: Uart::start(),
        autopilot: Uart::start_for_autopilot(),
        pairs: Painter::new(super::selected::BOARD.largest),
        flash: Arguments::ask().get(0).map(FlashFile::slots).transpose().ok()?,
        watchdog: NoWatchdog,
        reset: None,
    })
}

/// CMSDK APB timer 0 (Arm DDI 0479D, section 4.1.2): CTRL, VALUE and RELOAD, 25 MHz, counts down.
const TIMER0: *mut u32 = 0x4000_0000 as *mut u32;
const VALUE: usize = 1;
const RELOAD: usize = 2;

/// Counts instructions: with `-icount shift=6` QEMU lets 64 ns pass per instruction, and a tick of the timer is 40 ns.
///
/// On a real board it would count time; QEMU knows no cycles.
#[derive(Debug)]
pub struct InstructionClock(());

impl InstructionClock {
    /// Starts the timer.
    #[must_use]
    pub fn start() -> Self {
        // SAFETY: the registers of a timer that nothing else uses; the address is the same on every mps2 machine.
        unsafe {
            TIMER0.add(RELOAD).write_volatile(u32::MAX);
            TIMER0.add(VALUE).write_volatile(u32::MAX);
            TIMER0.write_volatile(1);
        }
        Self(())
    }
}

impl Clock for InstructionClock {
    const UNIT: &'static str = "instructions";

    #[inline]
    fn now(&self) -> u32 {
        // SAFETY: reading the timer changes nothing.
        !unsafe { TIMER0.add(VALUE).read_volatile() }
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        u64::from(to.wrapping_sub(from)) * 40 / 64
    }

    /// Of the machine: 40 ns a tick.
    fn microseconds(&self, from: u32, to: u32) -> u64 {
        u64::from(to.wrapping_sub(from)) / 25
    }
}

/// CMSDK APB UART 0 and 1 (Arm DDI 0479D, section 4.3.3): DATA, STATE, CTRL, INTSTATUS, BAUDDIV.
const UART0: *mut u32 = 0x4000_4000 as *mut u32;
const UART1: *mut u32 = 0x4000_5000 as *mut u32;
/// The fastest it can do, and 57600 baud of the bus's 25 MHz.
const FASTEST: u32 = 16;
const BAUD_57600: u32 = 434;
const STATE: usize = 1;
const CTRL: usize = 2;
const BAUDDIV: usize = 4;
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 2;

/// A polled serial port. It keeps one received byte: on hardware a host has to wait for answers, QEMU holds further bytes back.
#[derive(Debug)]
pub struct Uart(*mut u32);

impl Uart {
    /// The host's port.
    #[must_use]
    pub fn start() -> Self {
        Self::switch_on(UART0, FASTEST)
    }

    /// The autopilot's port.
    #[must_use]
    pub fn start_for_autopilot() -> Self {
        Self::switch_on(UART1, BAUD_57600)
    }

    fn switch_on(registers: *mut u32, divider: u32) -> Self {
        // SAFETY: the registers of a UART that nothing else uses; their addresses are the same on every mps2 machine.
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

impl ByteSource for Uart {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let mut count = 0;
        for place in bytes {
            if self.state() & RECEIVE_FULL == 0 {
                break;
            }
            // SAFETY: there is a byte, and this port is the only one that takes it.
            *place = unsafe { self.0.read_volatile() } as u8;
            count += 1;
        }
        count
    }
}

impl ByteSink for Uart {
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            while self.state() & TRANSMIT_FULL != 0 {}
            // SAFETY: there is room for a byte.
            unsafe { self.0.write_volatile(byte.into()) };
        }
    }
}
