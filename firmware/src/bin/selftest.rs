//! Does this board compute what the PC computed? Exit code 0 if so.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
fn selftest() -> linestereo_boards::Exit {
    use linestereo_boards::Exit;
    use linestereo_firmware::boards::{self, selected};
    use linestereo_firmware::programs::{expected, selftest};
    use linestereo_firmware::{error, info};

    let Some(memory) = boards::MEMORY.take() else { return Exit::Usage };
    let all_equal = selftest::run(memory, &selected::BOARD, expected::of(&selected::BOARD), |outcome| {
        let (scene, width, height) = (outcome.case.scene.name(), outcome.case.dims.width, outcome.case.dims.height);
        let kind = if outcome.case.worst_case { ", worst case" } else { "" };
        match outcome.differs_in() {
            None => info!("{=str} {=u16}x{=u16}{=str}: equal", scene, width, height, kind),
            Some(stage) => {
                error!("{=str} {=u16}x{=u16}{=str}: {=str} differs", scene, width, height, kind, stage)
            }
        }
    });
    if all_equal { Exit::Success } else { Exit::Difference }
}

linestereo_firmware::program!(selftest);
