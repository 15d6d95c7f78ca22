//! Does this board compute what the PC computed, and in how many cycles? A host asks by its port
//! (`linestereo bench-board`).
//!
//! An emulated board without an argument runs every pair, says so by log and ends: exit code 0 if
//! all are equal. With one it serves a host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn selftest() -> linestereo_boards::Exit {
    use linestereo_boards::Exit;
    use linestereo_boards::built_in::digests;
    use linestereo_firmware::boards::{self, selected};
    use linestereo_firmware::ports::Watchdog as _;
    use linestereo_firmware::programs::case_server::CaseServer;

    let Some(memory) = boards::MEMORY.take() else { return Exit::Usage };
    #[cfg(feature = "emulated")]
    if linestereo_firmware::semihosting::Arguments::read().get(0).is_none() {
        return by_log(memory);
    }
    let Some(parts) = selected::bare() else { return Exit::Usage };
    let rest = parts.rest;
    let expected = digests::of(&selected::BOARD);
    let (mut server, mut watchdog) = CaseServer::start(selected::BOARD, expected, parts);
    loop {
        if !server.turn(memory) {
            rest();
        }
        watchdog.feed();
    }
}

#[cfg(all(target_os = "none", feature = "emulated"))]
fn by_log(memory: &mut impl linestereo_firmware::memory::Memory) -> linestereo_boards::Exit {
    use linestereo_boards::Exit;
    use linestereo_boards::built_in::digests;
    use linestereo_firmware::boards::selected::BOARD;
    use linestereo_firmware::programs::selftest;
    use linestereo_firmware::{error, info};

    let all_equal = selftest::run(memory, &BOARD, digests::of(&BOARD), |outcome| {
        let (scene, dims) = (outcome.case.scene.name(), outcome.case.dims);
        let kind = if outcome.case.worst_case { ", worst case" } else { "" };
        match outcome.differs_in() {
            None => info!("{=str} {}{=str}: equal", scene, dims, kind),
            Some(stage) => error!("{=str} {}{=str}: {=str} differs", scene, dims, kind, stage),
        }
    });
    if all_equal { Exit::Success } else { Exit::Difference }
}

linestereo_firmware::program!(selftest);
