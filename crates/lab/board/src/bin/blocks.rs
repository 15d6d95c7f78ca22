//! Block matching on the pairs of a file. Arguments: the file of pairs, and the one for the table,
//! which ends with the stack's depth.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn blocks() -> linestereo_boards::Exit {
    use core::fmt::Write as _;
    use linestereo_boards::Exit;
    use linestereo_firmware::boards::selected::InstructionClock;
    use linestereo_firmware::once::Once;
    use linestereo_firmware::semihosting::{Arguments, File, Mode};
    use linestereo_firmware::stack;
    use linestereo_lab_board::Matcher;

    static MATCHER: Once<Matcher> = Once::new(Matcher::new());

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let open = |place, mode| arguments.get(place).and_then(|name| File::open(name, mode).ok());
    let (Some(mut pairs), Some(mut table), Some(matcher)) =
        (open(0, Mode::Read), open(1, Mode::Write), MATCHER.take())
    else {
        return Exit::Usage;
    };
    if matcher.run(&clock, &mut pairs, &mut table).is_err() {
        return Exit::Usage;
    }
    let _ = writeln!(table, "stack\t{}", stack::depth());
    Exit::Success
}

linestereo_firmware::program!(blocks);
