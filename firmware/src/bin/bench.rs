//! Cost of each stage on the built-in frames. Argument: the file for the table.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn bench() -> linestereo_boards::Exit {
    use core::fmt::Write as _;
    use linestereo::{Matcher, Options};
    use linestereo_boards::Exit;
    use linestereo_boards::built_in::Case;
    use linestereo_firmware::boards::{
        self,
        selected::{self, InstructionClock},
    };
    use linestereo_firmware::memory::Memory as _;
    use linestereo_firmware::programs::{bench, selftest};
    use linestereo_firmware::semihosting::{Arguments, Mode};
    use linestereo_firmware::stack;

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let Some(memory) = boards::MEMORY.take() else { return Exit::Usage };
    let Some(mut table) = arguments.open(0, Mode::Write) else { return Exit::Usage };
    for case in Case::all(&selected::BOARD) {
        let [left, right] = memory.frames();
        case.scene.paint(case.dims, left, right);
        let Ok(mut matcher) = Matcher::new(case.params(), case.dims) else { continue };
        if let Ok((costs, matched)) =
            bench::measure(memory, &clock, &mut matcher, Options::default())
        {
            bench::line(&mut table, case, &costs, matched.counts());
            let Some(view) = selftest::view(&case) else { continue };
            let [see, send, bytes] = bench::measure_autopilot(&matched, &clock, &view);
            let _ = writeln!(table, "autopilot\t{case}\t{see}\t{send}\t{bytes}");
        }
    }
    let _ = writeln!(table, "stack\t{}", stack::depth());
    Exit::Success
}

linestereo_firmware::program!(bench);
