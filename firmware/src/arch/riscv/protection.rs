//! Physical memory protection: an entry may forbid every access, in machine mode too when it is
//! locked, and wins over those with higher numbers. Memory in no entry is allowed (RISC-V
//! privileged architecture, 1.12, section 3.7.1).

use crate::arch;
use crate::fence::Fence;
use riscv::register::{
    pmpaddr0, pmpaddr1, pmpaddr2, pmpaddr3, pmpaddr4, pmpaddr5, pmpaddr6, pmpaddr7, pmpcfg0,
    pmpcfg1,
};

/// The entry of the guard, and the first one for fences.
const GUARD: usize = 0;
const FIRST_FENCE: usize = 1;
const ENTRIES: usize = 8;
/// Locked, a power of two at its multiple, no access.
const LOCKED_NO_ACCESS: usize = 1 << 7 | 3 << 3;

/// Forbids the memory below the stack.
pub(crate) fn guard() {
    let below = arch::guard();
    forbid(GUARD, below.start, below.len());
}

/// Forbids the fences, each at a multiple of its size; `false` where there are fewer entries.
/// Processors have none, 16 or 64 of them, RP2350 eight; where there are none the guard's is not
/// kept.
pub fn forbid_fences(fences: &[&Fence]) -> bool {
    const { assert!(Fence::BYTES.is_power_of_two()) };
    if pmpcfg0::read().bits & 0xff != LOCKED_NO_ACCESS || FIRST_FENCE + fences.len() > ENTRIES {
        return false;
    }
    for (entry, &fence) in (FIRST_FENCE..).zip(fences) {
        forbid(entry, (&raw const *fence).addr(), Fence::BYTES);
    }
    true
}

/// No access to `bytes`, a power of two to which `start` is aligned.
fn forbid(entry: usize, start: usize, bytes: usize) {
    // In words; ones from the lowest bit on are the number of bytes.
    let address = (start >> 2) | ((bytes >> 3) - 1);
    // SAFETY: nothing else writes these entries, and nothing but what is forbidden lies there.
    unsafe {
        match entry {
            0 => pmpaddr0::write(address),
            1 => pmpaddr1::write(address),
            2 => pmpaddr2::write(address),
            3 => pmpaddr3::write(address),
            4 => pmpaddr4::write(address),
            5 => pmpaddr5::write(address),
            6 => pmpaddr6::write(address),
            _ => pmpaddr7::write(address),
        }
        let bits = LOCKED_NO_ACCESS << (8 * (entry % 4));
        if entry < 4 {
            pmpcfg0::write(pmpcfg0::read().bits | bits)
        } else {
            pmpcfg1::write(pmpcfg1::read().bits | bits)
        }
    }
}
