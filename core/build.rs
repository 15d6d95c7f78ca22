//! Tells the kernels which instructions the target has: `cfg(dsp)` for Arm's DSP extension. Every
//! thumbv7em has it (Cortex-M4, M7); of thumbv8m.main those that are compiled for a processor with
//! it, as `.cargo/config.toml` does (Cortex-M33 and all above), or with the feature `dsp`.
//! `cfg(armv8m)`: the assembler has to be told which processor it is.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp, armv8m)");
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    // `target_feature = "dsp"` is not visible to stable code; the names of target and processor,
    // and the flags, are.
    let (target, flags) = (of("TARGET"), of("CARGO_ENCODED_RUSTFLAGS"));
    let with_dsp = ["cortex-m33", "cortex-m35p", "cortex-m55", "cortex-m85"];
    let is_asked_for = flags.split('\x1f').any(|flag| {
        with_dsp.iter().any(|name| flag.ends_with(&format!("target-cpu={name}")))
            || flag.contains("target-feature=+dsp")
    });
    let armv8m = target.starts_with("thumbv8m.main");
    if armv8m {
        println!("cargo:rustc-cfg=armv8m");
    }
    if target.starts_with("thumbv7em")
        || armv8m && (is_asked_for || !of("CARGO_FEATURE_DSP").is_empty())
    {
        println!("cargo:rustc-cfg=dsp");
    }
}
