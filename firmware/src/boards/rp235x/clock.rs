//! TIMER0 as the board's clock: 64 bits of microseconds since the reset (RP2350 datasheet, 12.8),
//! and what wakes a sleeping program.

use crate::ports::Clock;
use cortex_m::peripheral::SYST;
use cortex_m_rt::exception;
use embassy_rp::pac::TIMER0;
use embedded_hal::delay::DelayNs;

/// Microseconds since the reset.
pub fn time_us() -> u64 {
    loop {
        let high = TIMER0.timerawh().read();
        let low = TIMER0.timerawl().read();
        if TIMER0.timerawh().read() == high {
            return u64::from(high) << 32 | u64::from(low);
        }
    }
}

/// The lower half of it, as a program's clock. It wraps after 71 minutes.
#[derive(Clone, Copy, Debug)]
pub struct Micros(());

impl Micros {
    /// From now on SysTick also wakes a sleeping program every millisecond, of this frequency of
    /// the processor, Hz.
    pub fn start(mut systick: SYST, frequency: u32) -> Self {
        systick.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
        systick.set_reload(frequency / 1000 - 1);
        systick.clear_current();
        systick.enable_interrupt();
        systick.enable_counter();
        Self(())
    }
}

/// Wakes, that is all: what waits looks at the clock.
#[exception]
fn SysTick() {}

impl Clock for Micros {
    const UNIT: &'static str = "microseconds";

    fn now(&self) -> u32 {
        TIMER0.timerawl().read()
    }
}

/// Pauses by the same clock, rounded up to microseconds.
#[derive(Clone, Copy, Debug)]
pub struct Pause;

impl DelayNs for Pause {
    fn delay_ns(&mut self, ns: u32) {
        self.delay_us(ns.div_ceil(1000));
    }

    fn delay_us(&mut self, us: u32) {
        let until_us = time_us() + u64::from(us) + 1; // the first one has begun already
        while time_us() < until_us {}
    }
}
