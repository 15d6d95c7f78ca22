//! Cost of block matching on the built-in pairs, or on those of a file, and its bytes. Arguments: the file for the table, and if
//! there is one a file of pairs.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn blocks() -> linestereo_boards::Exit {
    use core::fmt::Write as _;
    use linestereo::Dims;
    use linestereo_boards::Exit;
    use linestereo_firmware::boards::selected::{self, InstructionClock};
    use linestereo_firmware::cases::Case;
    use linestereo_firmware::once::Once;
    use linestereo_firmware::programs::block_kernels::BlockKernels;
    use linestereo_firmware::programs::blocks::{self, METHODS, groups};
    use linestereo_firmware::semihosting::{Arguments, File, Mode};
    use linestereo_firmware::{error, stack};

    const WIDTH: usize = selected::BOARD.largest.width as usize;
    type Workspace = blocks::Workspace<WIDTH, { selected::BOARD.pixels() }, { groups(WIDTH).0 }, { groups(WIDTH).1 }>;
    static WORKSPACE: Once<Workspace> = Once::new(Workspace::new());

    fn measure(
        memory: &mut Workspace,
        clock: &InstructionClock,
        table: &mut File,
        dims: Dims,
        name: impl core::fmt::Display,
    ) -> bool {
        METHODS.iter().all(|(method, matcher, settings)| {
            let measured = memory.measure(clock, dims, *matcher, settings);
            measured.is_ok_and(|measured| {
                blocks::line(table, &name, method, &measured);
                true
            })
        })
    }

    let (arguments, clock) = (Arguments::read(), InstructionClock::start());
    let Some(Ok(mut table)) = arguments.get(0).map(|name| File::open(name, Mode::Write)) else { return Exit::Usage };
    let Ok(mut pairs) = arguments.get(1).map(|name| File::open(name, Mode::Read)).transpose() else {
        return Exit::Usage;
    };
    let Some(memory) = WORKSPACE.take() else { return Exit::Usage };
    let mut all_fit = true;
    match &mut pairs {
        Some(pairs) => {
            let mut number = 0;
            while let Some(dims) = memory.read(pairs) {
                all_fit &= measure(memory, &clock, &mut table, dims, number);
                number += 1;
            }
        }
        None => {
            for case in Case::all(&selected::BOARD).filter(|case| !case.worst_case) {
                let [left, right] = memory.frames();
                case.scene.paint(case.dims, left, right);
                all_fit &= measure(memory, &clock, &mut table, case.dims, case);
            }
        }
    }
    let _ = writeln!(table, "bytes\t{}\t{}\nstack\t{}", Workspace::BYTES[0], Workspace::BYTES[1], stack::depth());
    if let Some(kernel) = BlockKernels::CHOSEN.first_that_differs() {
        error!("{=str} differs from the portable one", kernel);
        return Exit::Difference;
    }
    if all_fit { Exit::Success } else { Exit::Difference }
}

linestereo_firmware::program!(blocks);
