//! Peripherals that all emulated machines give to the program `live`, beside a clock and ports of
//! their own.

use super::flash_file::FlashFile;
use crate::painter::Painter;
use crate::ports::{self, BarePeripherals, ByteSink, ByteSource, NoLight, NoWatchdog};
use crate::semihosting::Arguments;
use crate::slot_store::BoardStore;

/// Frames painted in place of cameras, a file of the PC in place of flash.
pub type Peripherals<C, H, A> =
    ports::Peripherals<C, H, A, Painter, BoardStore<FlashFile>, NoWatchdog, NoLight>;

/// Around a clock, the host's port and the autopilot's. The program's argument names the file in
/// place of flash; `None` when that cannot be used.
pub fn peripherals<C, H, A>(clock: C, host: H, autopilot: A) -> Option<Peripherals<C, H, A>> {
    Some(Peripherals {
        clock,
        host,
        autopilot,
        pairs: Painter::new(super::selected::BOARD.largest),
        flash: Arguments::read().get(0).map(FlashFile::slots).transpose().ok()?,
        watchdog: NoWatchdog,
        rest: || {}, // no interrupt is enabled that would end it
        reset: None,
        bootloader: None,
        light: NoLight,
        second_core: None,
    })
}

/// Peripherals without cameras and flash.
pub type Bare<C, H> = BarePeripherals<C, C, H, NoWatchdog>;

/// Around what starts a handle of the clock, and the host's port.
pub fn bare<C, H>(start: impl Fn() -> C, host: H) -> Bare<C, H> {
    BarePeripherals {
        counter: start(),
        clock: start(),
        host,
        watchdog: NoWatchdog,
        rest: || {},
        reset: None,
        silicon: None,
    }
}

/// A serial port that is polled for bytes and room.
pub trait Polled {
    /// A byte that has come.
    fn take(&mut self) -> Option<u8>;

    /// Is there room for a byte?
    fn has_room(&mut self) -> bool;

    /// Sends a byte; there is room for it.
    fn put(&mut self, byte: u8);
}

/// A polled port as programs use it.
#[derive(Debug)]
pub struct Port<P>(pub P);

impl<P: Polled> ByteSource for Port<P> {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let mut count = 0;
        for (slot, byte) in bytes.iter_mut().zip(core::iter::from_fn(|| self.0.take())) {
            *slot = byte;
            count += 1;
        }
        count
    }
}

impl<P: Polled> ByteSink for Port<P> {
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            while !self.0.has_room() {}
            self.0.put(byte);
        }
    }
}

/// Virtual nanoseconds that QEMU lets pass per instruction, with `-icount shift=6`. It knows no
/// cycles: on a real board these clocks would count time.
pub const NS_PER_INSTRUCTION: u64 = 64;
