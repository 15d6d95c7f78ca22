//! QEMU's mps3-an547: Arm Cortex-M55 (Corstone-300), with its tightly coupled memories by
//! `mps3_an547.x`.
//!
//! It starts in the secure state and stays there. The kernels are those of Helium, and of Armv8-M's
//! DSP extension. Addresses: Arm's application note AN547; QEMU, `hw/arm/armsse.c` and
//! `hw/arm/mps2-tz.c`.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::MPS3_AN547;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "mps3-an547"))]
pub use super::mps2::{bare, peripherals};
#[cfg(all(target_os = "none", feature = "mps3-an547"))]
pub use on_board::InstructionClock;

/// Addresses of the host's UART and of the autopilot's.
pub const UARTS: [usize; 2] = [0x5930_3000, 0x5930_4000];
/// Of the bus, and of the counter.
pub const MHZ: u32 = 32;

#[cfg(all(target_os = "none", feature = "mps3-an547"))]
mod on_board {
    use super::MHZ;
    use crate::boards::mps2;
    use crate::ports::Clock;

    /// The system counter's control frame: CNTCR, and the low word of CNTCV (Arm SSE-123 technical
    /// reference manual, 101370).
    const COUNTER: *mut u32 = core::ptr::without_provenance_mut(0x5810_0000);
    const VALUE: usize = 2;

    /// Counts instructions, by the system counter: the subsystem has no timer that counts on its
    /// own.
    #[derive(Debug)]
    pub struct InstructionClock(());

    impl InstructionClock {
        /// Starts the counter.
        pub fn start() -> Self {
            // SAFETY: the register of a counter that nothing else uses.
            unsafe { COUNTER.write_volatile(1) };
            Self(())
        }
    }

    impl Clock for InstructionClock {
        const UNIT: &'static str = "instructions";

        #[inline]
        fn now(&self) -> u32 {
            // SAFETY: reading the counter changes nothing.
            unsafe { COUNTER.add(VALUE).read_volatile() }
        }

        fn elapsed(&self, from: u32, to: u32) -> u64 {
            mps2::instructions::<MHZ>(from, to)
        }

        fn microseconds(&self, from: u32, to: u32) -> u64 {
            u64::from(to.wrapping_sub(from)) / u64::from(MHZ)
        }
    }
}
