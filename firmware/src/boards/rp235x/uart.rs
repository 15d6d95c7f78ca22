//! The autopilot's port: a UART at 57600 baud, sent by interrupts out of a buffer that holds more than a second's MAVLink frames at once.

use crate::ports::ByteSink;
use core::fmt;
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt as _, Priority};
use embassy_rp::peripherals::{PIN_0, UART0};
use embassy_rp::uart::{BufferedInterruptHandler, BufferedUartTx, Config};
use embassy_rp::{Peri, bind_interrupts};
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

/// Bytes that wait: several frames of 179 bytes at most.
const WAITING: usize = 1024;

/// UART 0's transmitter.
pub struct Autopilot(BufferedUartTx);

impl fmt::Debug for Autopilot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("UART 0")
    }
}

impl Autopilot {
    /// 57600 baud, 8 bits, no parity, on GP0. At most one.
    pub fn start(uart: Peri<'static, UART0>, pin: Peri<'static, PIN_0>) -> Self {
        static BUFFER: StaticCell<[u8; WAITING]> = StaticCell::new();
        interrupt::UART0_IRQ.set_priority(Priority::P3); // below the cameras
        let mut config = Config::default();
        config.baudrate = 57_600;
        Self(BufferedUartTx::new(uart, Interrupts, pin, BUFFER.init_with(|| [0; WAITING]), config))
    }
}

impl ByteSink for Autopilot {
    fn write(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while !rest.is_empty() {
            let Ok(count) = self.0.blocking_write(rest) else { return };
            rest = rest.get(count..).unwrap_or_default();
        }
    }
}
