//! Compares every kernel of this target with its definition, as boards do.

use linestereo_firmware::programs::kernels::{self, Kernels, Rooms};

/// Bits of the kernels that differ, in the order of `Kernels::NAMES`: of the core's, or of those
/// that are wrong.
#[unsafe(no_mangle)]
pub extern "C" fn differing(wrong: bool) -> u32 {
    let (mut rooms, mut differing, mut bit) = (Box::new(Rooms::new()), 0, 1);
    kernels::run(if wrong { &Kernels::WRONG } else { &Kernels::CHOSEN }, &mut rooms, |compared| {
        differing |= if compared.first.is_some() { bit } else { 0 };
        bit <<= 1;
    });
    differing
}

/// Number of kernels.
#[unsafe(no_mangle)]
pub extern "C" fn count() -> usize {
    Kernels::COUNT
}

/// True when the core has the kernels of WebAssembly here.
#[unsafe(no_mangle)]
pub extern "C" fn has_vectors() -> bool {
    linestereo::unstable::KERNELS == "simd128"
}
