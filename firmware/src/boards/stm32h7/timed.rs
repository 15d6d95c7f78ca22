//! A trigger that a task fires, while the program matches the pair before.
//!
//! The task runs in the ports' interrupt: it is late by what these take, microseconds, for both
//! sensors alike. The time of a pair is that of its VSYNC in any case.

use crate::camera::{Model as _, Mt9v034, TriggerInput};
use crate::ports::{Cameras, TimedCameras};
use embassy_stm32::gpio::Output;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer, block_for};

/// When to fire next.
static NEXT: Signal<CriticalSectionRawMutex, Instant> = Signal::new();

/// Fires, each time when it is due.
#[embassy_executor::task]
pub async fn fire(mut trigger: Output<'static>) {
    const { assert!(matches!(Mt9v034::TRIGGER, TriggerInput::Pulse { us: 10 })) };
    loop {
        Timer::at(NEXT.wait().await).await;
        trigger.set_high();
        block_for(Duration::from_micros(10));
        trigger.set_low();
    }
}

/// Cameras that are started as a pair, and triggered by the task.
#[derive(Debug)]
pub struct Timed<C>(pub C);

impl<C: Cameras> Cameras for Timed<C> {
    fn shoot(&mut self) -> bool {
        self.shoot_at(0)
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        self.0.follow()
    }

    fn stopped(&mut self) {
        self.0.stopped();
    }

    fn failures(&self) -> [u32; 2] {
        self.0.failures()
    }
}

impl<C: Cameras> TimedCameras for Timed<C> {
    fn shoot_at(&mut self, time_us: u64) -> bool {
        let is_running = self.0.shoot();
        if is_running {
            NEXT.signal(Instant::from_micros(time_us));
        }
        is_running
    }
}
