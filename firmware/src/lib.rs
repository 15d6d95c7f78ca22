//! linestereo on a microcontroller board.
//!
//! ```text
//! bin/            one line each: a program on the chosen board
//! programs/       selftest, kernels, bench, blocks, rectify, replay, live: generic over the ports, tested on a PC with fakes
//! session         what a host asked for so far
//! autopilot       obstacles as MAVLink, on a port of their own
//! vehicle         how the cameras sit on a vehicle and what its autopilot wants: chosen before a build
//! camera          image sensors: from a bus and two pins to a running pair
//! capture         bands of rows from two cameras -> whole pairs, or which fault there was
//! ports           what a program needs from a board: pairs, a clock, bytes in and out, a watchdog
//! host_lines      one or two lines to a host, of which either may be deaf
//! painter, cases  built-in frames, drawn by integers alone: no file, no camera
//! boards/         one file per board: name, capacities, what its peripherals are
//! rig_store       the rig in two slots of a flash
//! memory          frames, rectifiers, scratch memory and output, in one static
//! exit            how programs end, as numbers
//! startup, ending, fault, fence, stack, semihosting    only on a board: with arch and boards the only unsafe code
//! arch/           what differs between families of processors
//! ```
//!
//! Everything but the last two lines also compiles on a PC, where the tests and the simulator use it.
#![cfg_attr(not(test), no_std)]
#![deny(missing_debug_implementations)]

pub mod autopilot;
pub mod boards;
pub mod camera;
pub mod capture;
pub mod cases;
pub mod exit;
pub mod host_lines;
pub mod log;
pub mod memory;
pub mod painter;
pub mod ports;
pub mod programs;
pub mod rig_store;
pub mod session;
pub mod vehicle;

#[cfg(target_os = "none")]
mod arch;
#[cfg(target_os = "none")]
pub mod ending;
#[cfg(target_os = "none")]
pub mod fault;
#[cfg(target_os = "none")]
pub mod fence;
#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod semihosting;
#[cfg(target_os = "none")]
pub mod stack;
pub mod startup;
