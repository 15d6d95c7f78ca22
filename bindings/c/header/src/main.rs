//! Prints `linestereo.h`, or writes it: `cargo run -p linestereo-c-header -- include/linestereo.h`.

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut config = cbindgen::Config::from_file(library.join("cbindgen.toml"))?;
    config.after_includes =
        config.after_includes.map(|text| versioned(&text, env!("CARGO_PKG_VERSION")));
    let sources = ["exports", "status", "types"]
        .map(|name| library.join("src").join(name).with_extension("rs"));
    let builder =
        sources.iter().fold(cbindgen::Builder::new(), |builder, source| builder.with_src(source));
    let header = builder.with_config(config).generate()?;
    match std::env::args().nth(1) {
        Some(path) => {
            header.write_to_file(path);
        }
        None => header.write(std::io::stdout()),
    }
    Ok(())
}

/// The macros with the numbers of this version, which is the library's.
fn versioned(text: &str, version: &str) -> String {
    let mut numbers = version.split('.');
    let places = ["@MAJOR@", "@MINOR@", "@PATCH@"];
    let text = text.replace("@VERSION@", version);
    places.into_iter().fold(text, |text, place| text.replace(place, numbers.next().unwrap_or("0")))
}
