//! Cost of the depth of a pixel on the built-in pairs, and its bytes. Argument: the file for the
//! table.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn pixels() -> linestereo_boards::Exit {
    use linestereo_boards::Exit;
    use linestereo_boards::built_in::Case;
    use linestereo_firmware::boards::{
        self,
        selected::{self, InstructionClock},
    };
    use linestereo_firmware::programs::pixels;
    use linestereo_firmware::semihosting::{Arguments, Mode};

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let Some(memory) = boards::MEMORY.take() else { return Exit::Usage };
    let Some(mut table) = arguments.open(0, Mode::Write) else { return Exit::Usage };
    for case in Case::all(&selected::BOARD) {
        match pixels::measure(memory, &clock, &case) {
            Ok(measured) => pixels::line(&mut table, &case, &measured),
            Err(_) => return Exit::Difference,
        }
    }
    Exit::Success
}

linestereo_firmware::program!(pixels);
