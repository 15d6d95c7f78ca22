//! `cargo xtask silicon`: numbers of real boards, as `linestereo bench-board` wrote them and their
//! owners sent them.

use anyhow::{Context, Result, bail};
use linestereo_sim::board::numbers::BoardNumbers;
use std::path::Path;

/// One file a board; nothing here writes them.
const FOLDER: &str = "xtask/silicon";

/// Prints all.
pub(crate) fn run(top: &Path) -> Result<()> {
    let all = read(&top.join(FOLDER))?;
    if all.is_empty() {
        println!("{FOLDER} holds no file: nobody has sent one yet (linestereo bench-board --help)");
    }
    for (name, numbers) in all {
        println!("{name}\n{}", numbers.table());
    }
    Ok(())
}

/// Cycles per instruction of each, a line a file.
pub(crate) fn summarize(top: &Path) -> Result<()> {
    for (name, numbers) in read(&top.join(FOLDER))? {
        if let Some(ratio) = numbers.cycles_per_instruction {
            println!(
                "{name}: {:.2} cycles per instruction, assumed {:?}",
                ratio.median, ratio.assumed
            );
        }
    }
    Ok(())
}

/// Every file of a folder, by name.
fn read(folder: &Path) -> Result<Vec<(String, BoardNumbers)>> {
    let mut all = Vec::new();
    for entry in
        std::fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?
    {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let numbers = BoardNumbers::parse(&std::fs::read_to_string(&path)?)
                .with_context(|| format!("{name} is no file of linestereo bench-board"))?;
            if numbers.unit != "cycles" {
                bail!(
                    "{name} holds {} of an emulated board, which are in xtask/board-numbers.toml",
                    numbers.unit
                );
            }
            all.push((name, numbers));
        }
    }
    all.sort_by(|(a, _), (b, _)| a.cmp(b));
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(unit: &str) -> String {
        format!(
            "board = \"b\"\nprocessor = \"p\"\nfirmware = \"1\"\nunit = \"{unit}\"\nequal = true\n[pairs.one]\n\
             total = 3\ntime_us = 1\nsegments = 2\ndigests = [\"00000000\"]\n[pairs.one.by_stage]\nrows = 3\n"
        )
    }

    #[test]
    fn files_are_read_by_name_and_what_is_none_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("README.md", "no numbers");
        assert_eq!(read(folder.path()).unwrap().len(), 0);
        write("b.toml", &numbers("cycles"));
        write("a.toml", &numbers("cycles"));
        let names: Vec<String> =
            read(folder.path()).unwrap().into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["a.toml", "b.toml"]);
        write("c.toml", &numbers("instructions"));
        assert!(
            read(folder.path())
                .unwrap_err()
                .to_string()
                .starts_with("c.toml holds instructions of an emulated")
        );
        write("a.toml", "board = 3");
        std::fs::remove_file(folder.path().join("c.toml")).unwrap();
        assert!(read(folder.path()).unwrap_err().to_string().starts_with("a.toml is no file of"));
    }

    #[test]
    fn the_files_that_are_there_can_be_read() {
        let top = linestereo_sim::board::top().unwrap();
        assert!(read(&top.join(FOLDER)).is_ok());
        assert!(top.join(FOLDER).join("README.md").is_file());
    }
}
