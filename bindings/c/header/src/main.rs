//! Prints `linestereo.h`, or writes it: `cargo run -p linestereo-c-header -- include/linestereo.h`.

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let config = cbindgen::Config::from_file(library.join("cbindgen.toml"))?;
    let sources = ["exports", "status", "types"].map(|name| library.join("src").join(name).with_extension("rs"));
    let builder = sources.iter().fold(cbindgen::Builder::new(), |builder, source| builder.with_src(source));
    let header = builder.with_config(config).generate()?;
    match std::env::args().nth(1) {
        Some(path) => {
            header.write_to_file(path);
        }
        None => header.write(std::io::stdout()),
    }
    Ok(())
}
