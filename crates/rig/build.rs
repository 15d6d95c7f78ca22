//! `cfg(dsp)` and `cfg(armv8m)` where the core has them, as its build script says.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp, armv8m)");
    for (of_core, cfg) in [("DEP_LINESTEREO_DSP", "dsp"), ("DEP_LINESTEREO_ARMV8M", "armv8m")] {
        if std::env::var_os(of_core).is_some() {
            println!("cargo:rustc-cfg={cfg}");
        }
    }
}
