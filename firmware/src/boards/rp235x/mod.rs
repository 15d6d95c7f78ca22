//! RP2350: what its boards share.
//!
//! ```text
//! program   what a PIO block does with a camera's wires
//! rows      what the DMA has written -> numbers of rows, and signals
//! bus       I2C whose transactions end, and a bus that is cleared
//! cameras   registers and interrupts of both                                    only on a board, as what follows
//! i2c       registers and pins of `bus`
//! clock     microseconds, and pauses        ending    why the last run ended; watchdog
//! keeper    the rig and settings in the last four sectors of the flash
//! second_core   half of a pair's work
//! silicon   which chip it is and how it is set up
//! uart      the autopilot's port            (the host's is `boards::usb_port`)
//! ```

pub mod bus;
pub mod program;
pub mod rows;

#[cfg(target_os = "none")]
pub mod cameras;
#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod host;
#[cfg(target_os = "none")]
pub mod i2c;
#[cfg(target_os = "none")]
pub mod keeper;
#[cfg(target_os = "none")]
pub mod second_core;
#[cfg(target_os = "none")]
pub mod silicon;
#[cfg(target_os = "none")]
pub mod uart;
#[cfg(target_os = "none")]
pub mod watchdog;
