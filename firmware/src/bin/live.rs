//! A board at work: results and commands on UART 0, frames painted in place of a camera.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn live() -> linestereo_firmware::startup::Exit {
    use linestereo_firmware::boards::{SELECTED, mps2};
    use linestereo_firmware::programs::live::{Live, Painter};
    use linestereo_firmware::session::Session;
    use linestereo_firmware::{memory, startup::Exit};

    let Some(memory) = memory::take() else { return Exit::Usage };
    let mut camera = Painter::new(SELECTED.largest);
    let mut live = Live::start(Session::new(SELECTED), mps2::InstructionClock::start(), mps2::Uart::start());
    loop {
        live.turn(memory, &mut camera);
    }
}

linestereo_firmware::program!(live);
