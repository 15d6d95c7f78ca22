//! Do the kernels of this board equal the portable ones, and are its copies and fills of memory
//! right? Exit code 0 if so.
//!
//! Control, as argument: `beyond` compares a kernel that reads a byte too far.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn kernels() -> linestereo_boards::Exit {
    use linestereo_boards::Exit;
    use linestereo_firmware::once::Once;
    use linestereo_firmware::programs::kernels::{self, Kernels, Rooms};
    use linestereo_firmware::semihosting::Arguments;
    use linestereo_firmware::{arch, error, info};

    static ROOMS: Once<Rooms> = Once::new(Rooms::new());

    /// As the portable one, but for a byte too many.
    fn beyond(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
        // SAFETY: not safe: the byte behind the row, as a wrong kernel might read it.
        unsafe { row.as_ptr().add(row.len()).read_volatile() };
        linestereo::unstable::kernel::portable::gradient_row(above, row, below, out);
    }

    let arguments = Arguments::read();
    let kernels = match arguments.get(0) {
        None => Kernels::CHOSEN,
        Some(b"beyond") => Kernels { gradient_row: beyond, ..Kernels::CHOSEN },
        Some(_) => return Exit::Usage,
    };
    let Some(rooms) = ROOMS.take().filter(|rooms| arch::forbid_fences(&rooms.fences())) else {
        return Exit::Usage;
    };
    let report = |compared: &kernels::Compared| match compared.first {
        None => {
            info!("{=str}: {=u32} comparisons, all equal", compared.kernel, compared.comparisons)
        }
        Some(at) => error!(
            "{=str} differs: length {=usize}, count {=usize}, stride {=usize}, alignments {=[u8; 4]}",
            compared.kernel, at.length, at.count, at.stride, at.alignments
        ),
    };
    let are_equal = [kernels::run(&kernels, rooms, report), kernels::run_memory(rooms, report)];
    if are_equal == [true; 2] { Exit::Success } else { Exit::Difference }
}

linestereo_firmware::program!(kernels);
