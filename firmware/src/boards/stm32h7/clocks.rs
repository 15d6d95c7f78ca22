//! Clocks from the chip alone: no crystal is needed, so none can be wrong.
//!
//! ```text
//! HSI 64 MHz / 4 * 50 = 800 MHz   / 2 = 400 MHz core, / 2 = 200 MHz buses and DMA, / 2 = 100 MHz
//!                                 peripherals / 30 = 26.67 MHz for the sensors (MCO1)
//! HSI48                           USB, trimmed by the host's frames
//! TIM5                            microseconds, 64 bits (embassy-time)
//! ```
//! 400 MHz at voltage scale 1 is what every revision of the silicon and every temperature allows;
//! 480 MHz needs revision V and scale 0. The HSI is within 1 % at room temperature: good for UARTs
//! and sensors, not for a wall clock.
//!
//! # Source
//! RM0433, sections 6.6 (supply) and 8.5 (clocks), table 6 of DS12110 (frequencies by scale);
//! RM0399, section 7.5: the Portenta's switching regulator gives 1.8 V to the linear one
//! (MicroPython's `mpconfigboard.h` and OpenMV's `omv_boardconfig.h` say so as well). The supply
//! can be chosen once after power on; a bootloader has chosen the same.

use crate::ports::Clock;
use embassy_stm32::Config;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, HSIPrescaler, Hsi48Config, Pll, PllDiv, PllMul, PllPreDiv,
    PllSource, Sysclk, VoltageScale, mux,
};
use embassy_time::Instant;

/// For `embassy_stm32::init`.
pub fn config() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hsi = Some(HSIPrescaler::DIV1);
    rcc.hsi48 = Some(Hsi48Config { sync_from_usb: true });
    rcc.pll1 = Some(Pll {
        source: PllSource::HSI,
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL50,
        #[cfg(feature = "stm32h743")]
        fracn: None,
        divp: Some(PllDiv::DIV2),
        divq: Some(PllDiv::DIV30),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
    rcc.mux.usbsel = mux::Usbsel::HSI48;
    #[cfg(feature = "portenta-h7")]
    {
        use embassy_stm32::rcc::{SMPSSupplyVoltage, SupplyConfig};
        rcc.supply_config = SupplyConfig::SMPSLDO(SMPSSupplyVoltage::V1_8);
    }
    config
}

/// Runs from the HSI, with the PLLs off, as after a reset: a bootloader may have left a clock that
/// is too fast for the voltage that `init` chooses first, and settings of a PLL that runs are not
/// taken (RM0433, section 8.7.11).
pub fn take_over() {
    use embassy_stm32::pac::RCC;
    RCC.cr().modify(|control| control.set_hsion(true));
    while !RCC.cr().read().hsirdy() {}
    RCC.cfgr().modify(|config| config.set_sw(Sysclk::HSI));
    while RCC.cfgr().read().sws() != Sysclk::HSI {}
    for pll in 0..3 {
        RCC.cr().modify(|control| control.set_pllon(pll, false));
        while RCC.cr().read().pllrdy(pll) {}
    }
}

/// Whose frames trim the HSI48.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameClock {
    /// USB1, which is OTG_HS.
    Usb1 = 0b10,
    /// USB2, which is OTG_FS.
    Usb2 = 0b11,
}

/// Trims the HSI48 by the frames of this USB (RM0433, section 9.8.2, SYNCSRC, which can be written
/// while the trimming is off). The HAL knows only the first.
pub fn follow_usb_frames(source: FrameClock) {
    use embassy_stm32::pac::{CRS, crs::vals::Syncsrc};
    CRS.cr().modify(|control| control.set_cen(false));
    CRS.cfgr().modify(|config| config.set_syncsrc(Syncsrc::from_bits(source as u8)));
    CRS.cr().modify(|control| control.set_cen(true));
}

/// Microseconds since the start.
pub fn now_us() -> u64 {
    Instant::now().as_micros()
}

/// The program's clock.
#[derive(Clone, Copy, Debug)]
pub struct MicrosecondClock;

impl Clock for MicrosecondClock {
    const UNIT: &'static str = "microseconds";

    fn now(&self) -> u32 {
        now_us() as u32
    }
}
