//! The board's light.

use crate::ports;
use embassy_stm32::gpio::{Level, Output};

/// Pins that light it: of all lights that boards with this chip may have.
const PINS: usize = if cfg!(feature = "portenta-h7") { 1 } else { 2 };
/// Level of a pin that lights it.
const LIT: Level = if cfg!(feature = "portenta-h7") { Level::Low } else { Level::High };

/// Those pins.
#[expect(missing_debug_implementations, reason = "the HAL's pins have none")]
pub struct Light(pub [Output<'static>; PINS]);

impl ports::Light for Light {
    fn set(&mut self, is_on: bool) {
        let level = if is_on == (LIT == Level::High) { Level::High } else { Level::Low };
        for pin in &mut self.0 {
            pin.set_level(level);
        }
    }
}
