//! A board at work: results and commands on UART 0, MAVLink for an autopilot on UART 1, frames painted in place of a camera. Argument, if any: a file in place of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn live() -> linestereo_firmware::startup::Exit {
    use linestereo_firmware::boards::{SELECTED, flash_file::FlashFile, mps2};
    use linestereo_firmware::programs::live::{Live, Painter};
    use linestereo_firmware::semihosting::Arguments;
    use linestereo_firmware::session::Session;
    use linestereo_firmware::{memory, startup::Exit};

    let arguments = Arguments::ask();
    let Some(memory) = memory::take() else { return Exit::Usage };
    let Ok(mut flash) = arguments.get(0).map(FlashFile::slots).transpose() else { return Exit::Usage };
    let session = match &mut flash {
        Some(flash) => Session::with_flash(SELECTED, flash, memory),
        None => Session::new(SELECTED),
    };
    let mut camera = Painter::new(SELECTED.largest);
    let mut live = Live::start(session, mps2::InstructionClock::start(), mps2::Uart::start())
        .with_autopilot(mps2::Uart::start_for_autopilot());
    loop {
        live.turn(memory, &mut camera);
    }
}

linestereo_firmware::program!(live);
