//! Parts common to boards with an STM32H743 or the Cortex-M7 of an STM32H747.
//!
//! ```text
//! memory    caches, and what must not be cached; which memories have clocks
//! clocks    64 MHz of the chip itself -> 400 MHz, the sensors' clock, 48 MHz for USB; microseconds
//! dcmi      the camera interface and its DMA: rows in a ring, interrupts -> signals of the capture
//!           path
//! camera    two MT9V034 on one bus, their mode, what frames have to be like
//! ports     the host's lines (USB, UART) and the autopilot's UART
//! kept      sectors of the flash that keep the rig and settings
//! reset     why the chip was reset; the independent watchdog
//! light         the board's light
//! bootloader    into the chip's own boot loader, or the board's
//! silicon   which chip it is and how it is set up
//! ```
//! Interrupts, highest priority first: clock (0), camera interface and VSYNC (1), UARTs (4), USB
//! (6), the tasks of the ports (8). The program runs below all of them and sleeps while it waits
//! for rows.
//!
//! **Not yet run on hardware.** Register values are those of RM0433 (STM32H742, 743, 753) and
//! RM0399 (STM32H745, 747, 755, 757), sections named where they are used; what `embassy-stm32` does
//! is left to it.

use crate::ports::Peripherals;
use crate::slot_store::BoardStore;

/// Peripherals of a board with one of these chips, for `live`.
pub type Board<P> = Peripherals<
    clocks::MicrosecondClock,
    ports::HostPort,
    ports::AutopilotPort,
    P,
    BoardStore<kept::KeptFlash>,
    reset::IndependentDog,
    light::Light,
>;

pub mod bootloader;
pub mod camera;
pub mod clocks;
pub mod dcmi;
pub mod kept;
pub mod light;
pub mod memory;
pub mod ports;
pub mod reset;
pub mod silicon;
