//! Pairs of a file on one core, and on two. Arguments: input, as of the program replay, table.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn cores() -> linestereo_boards::Exit {
    use core::fmt::Write as _;
    use linestereo_boards::{Board, Exit};
    use linestereo_firmware::boards::selected::{self, InstructionClock};
    use linestereo_firmware::once::Once;
    use linestereo_firmware::ports::NoPort;
    use linestereo_firmware::programs::cores::{self, CoreCosts};
    use linestereo_firmware::programs::replay;
    use linestereo_firmware::semihosting::{Arguments, Mode};
    use linestereo_firmware::session::Session;

    const BOARD: Board = Board { two_cores: true, ..selected::BOARD };
    type Memory = linestereo_firmware::board_memory!(BOARD);
    static MEMORY: Once<Memory> = Once::new(Memory::CLEARED);

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let Some(memory) = MEMORY.take() else { return Exit::Usage };
    let (Some(mut input), Some(mut table)) =
        (arguments.open(0, Mode::Read), arguments.open(1, Mode::Write))
    else {
        return Exit::Usage;
    };
    let compare = |memory: &mut Memory, matcher: &_| {
        if let Ok(CoreCosts { one, busier, joins }) = cores::compare(memory, &clock, matcher) {
            let _ = writeln!(table, "cores\t{one}\t{busier}\t{joins}");
        }
    };
    let mut session = Session::new(BOARD);
    replay::run(memory, &clock, &mut session, &mut input, &mut NoPort, compare, |_| ());
    Exit::Success
}

linestereo_firmware::program!(cores);
