//! QEMU's RISC-V machine `virt`: RV32IMAC, as ESP32-C6 and the RP2350's other cores, held to their
//! RAM by `riscv_virt.x`. The kernels hold two or four values in a word.
//!
//! Addresses: QEMU, `hw/riscv/virt.c`.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::RISCV_VIRT;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "riscv-virt"))]
pub use on_board::{InstructionClock, bare, peripherals};

#[cfg(all(target_os = "none", feature = "riscv-virt"))]
mod on_board {
    use crate::boards::emulated::{self, NS_PER_INSTRUCTION, Polled, Port};
    use crate::ports::{Clock, NoPort};
    use riscv::register::mcycle;

    /// Counts instructions: what QEMU calls a cycle is a nanosecond of its virtual time. Its
    /// counter of retired instructions counts the same nanoseconds in QEMU 7.2 and instructions in
    /// later versions.
    #[derive(Debug)]
    pub struct InstructionClock(());

    impl InstructionClock {
        /// The counter always runs.
        pub const fn start() -> Self {
            Self(())
        }
    }

    impl Clock for InstructionClock {
        const UNIT: &'static str = "instructions";

        #[inline]
        fn now(&self) -> u32 {
            (mcycle::read64() / NS_PER_INSTRUCTION) as u32
        }

        fn microseconds(&self, from: u32, to: u32) -> u64 {
            self.elapsed(from, to) * NS_PER_INSTRUCTION / 1000
        }
    }

    /// A serial port as National Semiconductor's NS16550 (PC16550D data sheet): data at 0, line
    /// status at 5. As it is after a reset: QEMU's needs no rate.
    const UART: *mut u8 = core::ptr::without_provenance_mut(0x1000_0000);
    const LINE_STATUS: usize = 5;
    const RECEIVED: u8 = 1;
    const TRANSMIT_EMPTY: u8 = 1 << 5;

    /// The machine's only serial port, polled.
    #[derive(Debug)]
    pub struct Uart(());

    impl Uart {
        fn status(&self) -> u8 {
            // SAFETY: reading the status clears errors alone, which nobody asks for.
            unsafe { UART.add(LINE_STATUS).read_volatile() }
        }
    }

    impl Polled for Uart {
        fn take(&mut self) -> Option<u8> {
            // SAFETY: there is a byte, and this port is the only one that takes it.
            (self.status() & RECEIVED != 0).then(|| unsafe { UART.read_volatile() })
        }

        fn has_room(&mut self) -> bool {
            self.status() & TRANSMIT_EMPTY != 0
        }

        fn put(&mut self, byte: u8) {
            // SAFETY: there is room for a byte.
            unsafe { UART.write_volatile(byte) };
        }
    }

    /// Peripherals for `live`. The machine has no second port.
    pub fn peripherals() -> Option<emulated::Peripherals<InstructionClock, Port<Uart>, NoPort>> {
        emulated::peripherals(InstructionClock::start(), Port(Uart(())), NoPort)
    }

    /// Peripherals of `selftest`.
    pub fn bare() -> Option<emulated::Bare<InstructionClock, Port<Uart>>> {
        Some(emulated::bare(InstructionClock::start, Port(Uart(()))))
    }
}
