//! Every fault on purpose. Argument: its name. The tests look at the exit codes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn faults() -> linestereo_boards::Exit {
    use core::hint::black_box;
    use linestereo_boards::Exit;
    use linestereo_firmware::semihosting::Arguments;
    use linestereo_firmware::stack;

    /// Calls itself until the stack is full, in steps of `BYTES`.
    #[inline(never)]
    fn fill<const BYTES: usize>(depth: u32) -> u32 {
        let memory = black_box([depth as u8; BYTES]);
        if depth == 0 {
            0
        } else {
            fill::<BYTES>(depth - 1).wrapping_add(memory[depth as usize % BYTES].into())
        }
    }

    let arguments = Arguments::read();
    match arguments.get(0) {
        None => return Exit::Success,
        Some(b"panic") => panic!("as asked"),
        Some(b"stack") => {
            black_box(fill::<64>(black_box(1_000_000)));
        }
        // Steps over any guard of a few kilobytes.
        Some(b"large-stack") => {
            black_box(fill::<100_000>(black_box(10)));
        }
        // SAFETY: not safe: nothing lies there, which is the point.
        Some(b"bus") => unsafe {
            black_box(core::ptr::with_exposed_provenance::<u32>(0xf000_0000).read_volatile());
        },
        // SAFETY: not safe: below the RAM, as a lost pointer might point.
        Some(b"guard") => unsafe {
            core::ptr::with_exposed_provenance_mut::<u32>(stack::bottom() - 16).write_volatile(1);
        },
        // SAFETY: not safe: no instruction, which is the point.
        Some(b"undefined") => unsafe {
            #[cfg(target_arch = "arm")]
            core::arch::asm!("udf #0");
            #[cfg(target_arch = "riscv32")]
            core::arch::asm!("unimp");
        },
        // SAFETY: not safe: between both stacks, as a handler that takes too much would.
        #[cfg(all(target_arch = "arm", not(armv8m)))]
        Some(b"between") => unsafe {
            core::ptr::with_exposed_provenance_mut::<u32>(stack::top() + 16).write_volatile(1);
        },
        // SAFETY: the handler below is called.
        #[cfg(target_arch = "arm")]
        Some(b"handler") => unsafe { core::arch::asm!("svc #0") },
        Some(_) => return Exit::Usage,
    }
    Exit::Success
}

/// A handler that fails.
#[cfg(all(target_os = "none", target_arch = "arm"))]
#[cortex_m_rt::exception]
fn SVCall() {
    // SAFETY: not safe: nothing lies there, which is the point.
    unsafe {
        core::hint::black_box(
            core::ptr::with_exposed_provenance::<u32>(0xf000_0000).read_volatile(),
        );
    }
}

linestereo_firmware::program!(faults);
