//! Tells the kernels which instructions the target has: `cfg(dsp)` for Arm's DSP extension. Every
//! thumbv7em has it (Cortex-M4, M7); of thumbv8m.main those that are compiled for a processor with
//! it, as `.cargo/config.toml` does (Cortex-M33 and all above), or with the feature `dsp`.
//! `cfg(helium)`: Helium beside it, of Cortex-M55 and M85, or with the feature `helium`.
//! `cfg(armv8m)`: the assembler has to be told which processor it is. `cfg(swar)`: 32 bits, and no
//! packed instructions.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp, helium, armv8m, swar)");
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    // `target_feature = "dsp"` is not visible to stable code; the names of target and processor,
    // and the flags, are.
    let (target, flags) = (of("TARGET"), of("CARGO_ENCODED_RUSTFLAGS"));
    let is_asked_for = |extension: &str, processors: &[&str]| {
        flags.split('\x1f').any(|flag| {
            processors.iter().any(|name| flag.ends_with(&format!("target-cpu={name}")))
                || flag.contains(&format!("target-feature=+{extension}"))
        })
    };
    let with_helium = is_asked_for("mve", &["cortex-m55", "cortex-m85"])
        || !of("CARGO_FEATURE_HELIUM").is_empty();
    let with_dsp = with_helium
        || is_asked_for("dsp", &["cortex-m33", "cortex-m35p"])
        || !of("CARGO_FEATURE_DSP").is_empty();
    let armv8m = target.starts_with("thumbv8m.main");
    if armv8m {
        println!("cargo:rustc-cfg=armv8m");
    }
    if target.starts_with("thumbv7em") || armv8m && with_dsp {
        println!("cargo:rustc-cfg=dsp");
    }
    if armv8m && with_helium {
        println!("cargo:rustc-cfg=helium");
    }
    if target.starts_with("riscv32") {
        println!("cargo:rustc-cfg=swar");
    }
}
