//! Tells the kernels which instructions the target has: `cfg(dsp)` for Arm's DSP extension. Every
//! thumbv7em has it (Cortex-M4, M7); of thumbv8m.main those that are compiled for a processor with
//! it, as `.cargo/config.toml` does (Cortex-M33 and all above), or with the feature `dsp`.
//! `cfg(helium)`: Helium beside it, of Cortex-M55 and M85, or with the feature `helium`.
//! `cfg(armv8m)`: the assembler has to be told which processor it is. `cfg(swar)`: 32 bits without
//! packed instructions, of the families on which four bytes in a word were measured. The build
//! script of `linestereo-rig` reads what is set here.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(dsp, helium, armv8m, swar)");
    // The second line is for build scripts of packages that use this one.
    let set = |cfg: &str| println!("cargo:rustc-cfg={cfg}\ncargo:{cfg}=1");
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    // `target_feature = "dsp"` is not visible to stable code; the names of target and processor,
    // and the flags, are.
    let (target, flags) = (of("TARGET"), of("CARGO_ENCODED_RUSTFLAGS"));
    // A processor has its extensions unless the flags take them away.
    let is_asked_for = |extension: &str, processors: &[&str]| {
        let values = |option: &str| {
            let values = flags.split('\x1f').filter_map(|flag| flag.rsplit_once(option));
            values.map(|(_, value)| value.to_owned()).collect::<Vec<_>>()
        };
        let features = values("target-feature=").join(",");
        let last = features.split(',').rfind(|feature| {
            feature.strip_prefix(['+', '-']).is_some_and(|name| name == extension)
        });
        match last {
            Some(feature) => feature.starts_with('+'),
            None => values("target-cpu=").iter().any(|name| processors.contains(&name.as_str())),
        }
    };
    let with_helium = is_asked_for("mve", &["cortex-m55", "cortex-m85"])
        || !of("CARGO_FEATURE_HELIUM").is_empty();
    let with_dsp = with_helium
        || is_asked_for("dsp", &["cortex-m33", "cortex-m35p"])
        || !of("CARGO_FEATURE_DSP").is_empty();
    let armv8m = target.starts_with("thumbv8m.main");
    if armv8m {
        set("armv8m");
    }
    let is_of = |families: &[&str]| families.iter().any(|family| target.starts_with(family));
    if is_of(&["thumbv7em"]) || armv8m && with_dsp {
        set("dsp");
    } else if is_of(&["riscv32", "thumbv7m", "thumbv8m.main"]) {
        set("swar");
    }
    if armv8m && with_helium {
        set("helium");
    }
}
