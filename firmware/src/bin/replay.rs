//! Pairs of a file in, results to a file. Arguments: input, output, table of costs, and if there is
//! one a file in place of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn replay() -> linestereo_boards::Exit {
    use core::fmt::Write as _;
    use linestereo_boards::Exit;
    use linestereo_firmware::boards::{
        self,
        flash_file::FlashFile,
        selected::{self, InstructionClock},
    };
    use linestereo_firmware::programs::replay::{self, Event};
    use linestereo_firmware::semihosting::{Arguments, File, Mode};
    use linestereo_firmware::session::Session;
    use linestereo_firmware::{error, info, stack};

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let Some(memory) = boards::MEMORY.take() else { return Exit::Usage };
    let (Some(input), Some(output), Some(table)) =
        (arguments.get(0), arguments.get(1), arguments.get(2))
    else {
        error!("arguments: input, output, table");
        return Exit::Usage;
    };
    let files = (
        File::open(input, Mode::Read),
        File::open(output, Mode::Write),
        File::open(table, Mode::Write),
    );
    let (Ok(mut input), Ok(mut output), Ok(mut table)) = files else {
        error!("a file cannot be opened");
        return Exit::Usage;
    };
    let Ok(mut flash) = arguments.get(3).map(FlashFile::slots).transpose() else {
        error!("the file in place of flash cannot be used");
        return Exit::Usage;
    };
    let mut session = match &mut flash {
        Some(flash) => Session::with_flash(selected::BOARD, flash, memory),
        None => Session::new(selected::BOARD),
    };
    let report = |event: &Event| match event {
        Event::Matched { sequence, rectification, costs, objects, points } => {
            let _ = write!(table, "pair\t{sequence}\t{rectification}\t{objects}\t{points}");
            for cost in costs {
                let _ = write!(table, "\t{cost}");
            }
            let _ = writeln!(table);
        }
        Event::Refused { sequence, .. } => error!("pair {=u32} cannot be matched", sequence),
    };
    let counters =
        replay::run(memory, &clock, &mut session, &mut input, &mut output, |_, _| (), report);
    let _ = writeln!(
        table,
        "packets\t{}\t{}\t{}",
        counters.good,
        counters.bad(),
        counters.skipped_bytes
    );
    let _ = writeln!(table, "stack\t{}", stack::depth());
    info!("{=u32} commands, {=u32} packets that are none", counters.good, counters.bad());
    Exit::Success
}

linestereo_firmware::program!(replay);
