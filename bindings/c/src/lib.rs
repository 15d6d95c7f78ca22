//! The core for C and C++: a static library without allocation, globals or panics, in memory of the
//! caller.
//!
//! ```text
//! exports   the functions of linestereo.h: pointers are checked here
//! engine    what they do
//! obstacles obstacles by direction, between pairs
//! types     structures that both sides know
//! status    codes of errors with their texts
//! ```
#![no_std]
#![deny(unsafe_code)]
#![warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod engine;
#[allow(unsafe_code, reason = "pointers of C")]
mod exports;
mod obstacles;
mod status;
mod types;

/// Met by no function of the library: tests look for this name in its machine code. Of its own,
/// because compilers rename the panic handler.
#[inline(never)]
#[allow(unsafe_code, reason = "a name that tests know")]
#[unsafe(no_mangle)]
extern "C" fn linestereo_panic(location: *const u8) -> ! {
    core::hint::black_box(location);
    loop {
        core::hint::spin_loop();
    }
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    linestereo_panic(
        info.location().map_or(core::ptr::null(), |location| core::ptr::from_ref(location).cast()),
    )
}
