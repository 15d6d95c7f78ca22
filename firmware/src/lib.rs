//! linestereo on a microcontroller board.
//!
//! ```text
//! bin/            a few lines each: a program on the chosen board
//! programs/       selftest, kernels, bench, rectify, replay, live: generic over the ports, tested
//!                 on a PC with fakes
//! boards/         one file per board: its memory, what its peripherals are
//! session         commands of a host so far, and their answers
//! autopilot       obstacles as MAVLink, on a port of their own
//! painter         the built-in scenes in place of cameras
//! camera          image sensors: from a bus and two pins to a running pair
//! capture         bands of rows from two cameras -> whole pairs, or which fault there was
//! host_lines      one or two lines to a host, of which either may be deaf
//! indicator       codes of a board's light
//! clock_sync      the board's time in another clock
//! ports           what a program needs from a board: pairs, a clock, bytes in and out, a watchdog
//! slot_store      the rig and settings in two slots of a flash each
//! settings        settings as numbered values and as an image
//! memory          frames, rectifiers, the core's memory and output
//! vehicle         how the cameras sit on a vehicle and what its autopilot wants: chosen before a
//!                 build
//! fence, once     memory that kernels must not touch; what a static hands out once
//! startup, fault, ending, semihosting, arch, stack    from the reset to the program's end, only on a board
//! ```
//!
//! A module knows those below it alone: programs know no board, boards no program. Everything but
//! the last line also compiles on a PC, for tests; unsafe code is there, in `once` and in `boards`.
#![cfg_attr(not(test), no_std)]
#![deny(missing_debug_implementations)]

pub mod autopilot;
pub mod boards;
pub mod camera;
pub mod capture;
pub mod clock_sync;
pub mod fence;
pub mod host_lines;
pub mod indicator;
pub mod log;
pub mod memory;
pub mod once;
pub mod painter;
pub mod ports;
pub mod programs;
pub mod session;
pub mod settings;
pub mod slot_store;
pub mod startup;
pub mod vehicle;

#[cfg(target_os = "none")]
pub mod arch;
#[cfg(target_os = "none")]
pub mod ending;
#[cfg(target_os = "none")]
mod fault;
#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod semihosting;
#[cfg(target_os = "none")]
pub mod stack;
