//! The autopilot's port: a UART at 57600 baud, sent by interrupts out of a buffer that holds
//! several MAVLink frames, received into one.

use crate::ports::{ByteSink, ByteSource};
use core::task::Poll;
use embassy_futures::poll_once;
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt as _, Priority};
use embassy_rp::peripherals::{PIN_0, PIN_1, UART0};
use embassy_rp::uart::{BufferedInterruptHandler, BufferedUart, Config};
use embassy_rp::{Peri, bind_interrupts, pac};
use embedded_io_async::Read as _;
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

/// Bytes that wait to be sent: several frames of 179 bytes at most; and those received between two
/// turns of the program.
const WAITING: usize = 1024;

/// UART 0.
#[expect(missing_debug_implementations, reason = "the HAL's driver has none")]
pub struct Autopilot(BufferedUart);

impl Autopilot {
    /// 57600 baud, 8 bits, no parity: out on GP0, in on GP1. At most one.
    pub fn start(
        uart: Peri<'static, UART0>,
        out: Peri<'static, PIN_0>,
        into: Peri<'static, PIN_1>,
    ) -> Self {
        static OUT: StaticCell<[u8; WAITING]> = StaticCell::new();
        static IN: StaticCell<[u8; WAITING]> = StaticCell::new();
        interrupt::UART0_IRQ.set_priority(Priority::P3); // below the cameras
        let mut config = Config::default();
        config.baudrate = 57_600;
        let (sent, received) = (OUT.init_with(|| [0; WAITING]), IN.init_with(|| [0; WAITING]));
        let port = BufferedUart::new(uart, out, into, Interrupts, sent, received, config);
        // Nothing need be connected, and the HAL has taken the pull off.
        pac::PADS_BANK0.gpio(1).modify(|w| w.set_pue(true));
        Self(port)
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

impl ByteSource for Autopilot {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        // Lost or garbled bytes are a frame that the receiver refuses. The HAL tells of them before
        // it takes more, and what came after them may wait.
        (0..2)
            .find_map(|_| match poll_once(self.0.read(bytes)) {
                Poll::Ready(Ok(count)) => Some(count),
                Poll::Ready(Err(_)) => None,
                Poll::Pending => Some(0),
            })
            .unwrap_or(0)
    }
}
