//! What rectifying a pair costs with the built-in rigs. Argument: the file for the table.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod taken {
    //! The one workspace.

    use core::cell::UnsafeCell;
    use core::sync::atomic::{AtomicBool, Ordering};
    use linestereo_firmware::programs::rectify::Workspace;

    struct Cell(UnsafeCell<Workspace>);

    // SAFETY: only `take` reaches the content, and hands it out once.
    unsafe impl Sync for Cell {}

    static WORKSPACE: Cell = Cell(UnsafeCell::new(Workspace::new()));
    static TAKEN: AtomicBool = AtomicBool::new(false);

    pub(super) fn take() -> Option<&'static mut Workspace> {
        if TAKEN.swap(true, Ordering::Relaxed) {
            return None;
        }
        // SAFETY: `TAKEN` was false until now, so this is the only reference there will ever be.
        Some(unsafe { &mut *WORKSPACE.0.get() })
    }
}

#[cfg(target_os = "none")]
fn rectify() -> linestereo_firmware::startup::Exit {
    use linestereo_firmware::boards::selected::{self, InstructionClock};
    use linestereo_firmware::programs::rectify::{self, BuiltIn};
    use linestereo_firmware::semihosting::{Arguments, File, Mode};
    use linestereo_firmware::startup::Exit;

    let (arguments, clock) = (Arguments::ask(), InstructionClock::start());
    let Some(workspace) = taken::take() else { return Exit::Usage };
    let Some(Ok(mut table)) = arguments.get(0).map(|name| File::open(name, Mode::Write)) else { return Exit::Usage };
    for &dims in selected::BOARD.sizes {
        for rig in BuiltIn::ALL {
            match rectify::measure(workspace, &clock, rig, dims) {
                Ok(measured) => rectify::line(&mut table, rig, dims, &measured),
                Err(_) => return Exit::Difference,
            }
        }
    }
    Exit::Success
}

linestereo_firmware::program!(rectify);
