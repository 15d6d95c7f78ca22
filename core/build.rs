//! Tells the kernels, here and in `block-matching`, which instructions the target has: `cfg(dsp)` for Arm's DSP extension. Every thumbv7em has it (Cortex-M4, M7); of
//! thumbv8m.main those that are compiled for a processor with it, as `.cargo/config.toml` does (Cortex-M33 and all above).

fn main() {
    println!("cargo:rerun-if-changed=../core/build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp)");
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    // `target_feature = "dsp"` is not visible to stable code; the names of target and processor are.
    let (target, flags) = (of("TARGET"), of("CARGO_ENCODED_RUSTFLAGS"));
    let for_processor = |name: &str| flags.split('\x1f').any(|flag| flag.ends_with(&format!("target-cpu={name}")));
    let with_dsp = ["cortex-m33", "cortex-m35p", "cortex-m55", "cortex-m85"];
    if target.starts_with("thumbv7em")
        || target.starts_with("thumbv8m.main") && with_dsp.iter().any(|name| for_processor(name))
    {
        println!("cargo:rustc-cfg=dsp");
    }
}
