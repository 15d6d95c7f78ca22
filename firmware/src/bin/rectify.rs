//! Cost of rectifying a pair with the built-in rigs. Argument: the file for the table.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn rectify() -> linestereo_boards::Exit {
    use linestereo_boards::Exit;
    use linestereo_firmware::boards::selected::{self, InstructionClock};
    use linestereo_firmware::once::Once;
    use linestereo_firmware::programs::rectify::{self, BuiltIn, RectifyMemory};
    use linestereo_firmware::semihosting::{Arguments, Mode};

    static WORKSPACE: Once<RectifyMemory> = Once::new(RectifyMemory::new());

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let Some(workspace) = WORKSPACE.take() else { return Exit::Usage };
    let Some(mut table) = arguments.open(0, Mode::Write) else { return Exit::Usage };
    for &dims in selected::BOARD.sizes {
        for rig in BuiltIn::ALL {
            match rectify::measure(workspace, &clock, rig, dims) {
                Some(measured) => rectify::line(&mut table, rig, dims, &measured),
                None => return Exit::Difference,
            }
        }
    }
    Exit::Success
}

linestereo_firmware::program!(rectify);
