//! Tells the kernels which instructions the target has: `cfg(dsp)` for the Armv7E-M DSP extension, as in core/build.rs.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp)");
    // `target_feature = "dsp"` is not visible to stable code; the target's name is.
    if std::env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv7em")) {
        println!("cargo:rustc-cfg=dsp");
    }
}
