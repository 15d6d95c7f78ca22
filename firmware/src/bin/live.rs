//! A board at work: results and commands on the host's port, MAVLink on the autopilot's, pairs from
//! the board's cameras. Emulated boards have UARTs, frames painted in place of cameras, and if they
//! get an argument a file in place of flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn live() -> linestereo_boards::Exit {
    use linestereo::Cores;
    use linestereo_boards::Exit;
    use linestereo_firmware::boards::{self, selected};
    use linestereo_firmware::ports::{Light as _, Peripherals, Watchdog as _};
    use linestereo_firmware::programs::live::{Live, Turn};
    use linestereo_firmware::session::Session;

    let Some(memory) = boards::MEMORY.take() else { return Exit::Usage };
    let Some(board) = selected::peripherals() else { return Exit::Usage };
    let Peripherals {
        clock,
        host,
        autopilot,
        mut pairs,
        mut flash,
        mut watchdog,
        rest,
        reset,
        bootloader,
        mut light,
        mut second_core,
    } = board;
    let mut session = match &mut flash {
        Some(flash) => Session::with_flash(selected::BOARD, flash, memory),
        None => Session::new(selected::BOARD),
    };
    (session.reset, session.has_bootloader) = (reset, bootloader.is_some());
    let mut live = Live::start(session, clock, host).with_autopilot(autopilot);
    loop {
        let cores = second_core.as_mut().map(|cores| cores as &mut dyn Cores);
        let turn = live.turn_with(cores, memory, &mut pairs);
        if turn.is_work() {
            watchdog.feed();
        }
        light.set(live.is_lit());
        match (turn, bootloader) {
            (Turn::Leave, Some(enter)) => enter(),
            (Turn::Idle, _) => rest(),
            _ => {}
        }
    }
}

linestereo_firmware::program!(live);
