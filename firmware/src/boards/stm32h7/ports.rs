//! The host's two lines and the autopilot's.
//!
//! ```text
//! program -> pipe -> task -> USB packets        program <- pipe <- task <- USB packets      ([`usb_port`])
//! program -> pipe -> task -> UART's buffer      program <- pipe <- task <- UART's buffer
//! program -> pipe -> task -> UART's buffer      program <- UART's buffer      MAVLink, 57600 baud
//! ```
//! The tasks run in an interrupt that no peripheral uses, below all others and above the program.
//! The program never waits for ever for a task that waits for a host ([`HostLine`]), and not at all
//! for the autopilot's.
//!
//! # Cost
//! 15 KiB of pipes and buffers with those of USB.

use super::clocks::now_us;
use crate::boards::pipes::{Pipe, put, put_all};
use crate::boards::usb_port::{self, UsbLine};
use crate::host_lines::{HostLine, HostLines, Line, Listener};
use crate::ports::{ByteSink, ByteSource, Room};
use core::task::Poll;
use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_futures::poll_once;
use embassy_stm32::Peri;
use embassy_stm32::gpio::Pull;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::interrupt::{InterruptExt as _, Priority};
use embassy_stm32::pac::interrupt;
use embassy_stm32::usart::{
    BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config, Instance,
    RxPin, TxPin,
};
use embassy_time::Timer;
use embedded_io_async::{Read as _, Write as _};
use static_cell::StaticCell;

/// Bytes that wait for the host's end of its UART: the records of a frame; for the autopilot's; and
/// for the program: more than a command.
const OUT: usize = 8192;
const AUTOPILOT_OUT: usize = 1024;
const IN: usize = 1024;
/// Bytes that the autopilot sends between two turns of the program: 57600 baud for 0.2 s.
const AUTOPILOT_IN: usize = 1024;

static TO_UART: Pipe<OUT> = Pipe::new();
static FROM_UART: Pipe<IN> = Pipe::new();
static TO_AUTOPILOT: Pipe<AUTOPILOT_OUT> = Pipe::new();

/// How long a record waits for a host at the UART, microseconds: more than a full buffer takes on
/// the UART.
const PATIENCE_US: u64 = 100_000;
/// Baud rate of the host's UART.
const HOST_BAUD: u32 = 921_600;
/// Baud rate of the autopilot's.
const AUTOPILOT_BAUD: u32 = 57_600;

/// Runs the tasks.
static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// The interrupt of a peripheral that is not used: HDMI-CEC.
#[interrupt]
unsafe fn CEC() {
    // SAFETY: this is its interrupt, which `start` enables.
    unsafe { EXECUTOR.on_interrupt() }
}

/// The spawner of the ports' tasks, and the priorities of the interrupts of UARTs and USB: to be
/// asked for once, before these start.
pub fn executor(uarts: [interrupt; 2], usb: interrupt) -> Option<SendSpawner> {
    for uart in uarts {
        uart.set_priority(Priority::P4);
    }
    usb.set_priority(Priority::P6);
    interrupt::CEC.set_priority(Priority::P8);
    let spawner = EXECUTOR.start(interrupt::CEC);
    spawner.spawn(tick().ok()?);
    Some(spawner)
}

/// Wakes a program that rests: what it waits for may be time.
#[embassy_executor::task]
async fn tick() -> ! {
    loop {
        Timer::after_millis(5).await;
    }
}

/// Bytes of one write to a UART: fewer than its buffer, which is empty before.
const CHUNK: usize = 64;

#[embassy_executor::task]
async fn send_to_host(uart: BufferedUartTx<'static>) -> ! {
    send_uart(uart, &TO_UART).await
}

#[embassy_executor::task]
async fn send_to_autopilot(uart: BufferedUartTx<'static>) -> ! {
    send_uart(uart, &TO_AUTOPILOT).await
}

/// From the program to a UART.
///
/// embassy-stm32 0.6 waits for ever in a write for which its buffer lacks room: it registers no
/// waker there. So every write finds it empty.
async fn send_uart<const BYTES: usize>(
    mut uart: BufferedUartTx<'static>,
    pipe: &'static Pipe<BYTES>,
) -> ! {
    let mut bytes = [0; CHUNK];
    loop {
        let count = pipe.read(&mut bytes).await;
        // A UART cannot fail to send.
        let _ = uart.write_all(bytes.get(..count).unwrap_or_default()).await;
        let _ = uart.flush().await;
    }
}

/// From the host's UART to the program.
#[embassy_executor::task]
async fn receive_uart(mut uart: BufferedUartRx<'static>) -> ! {
    let mut bytes = [0; 64];
    loop {
        // Lost or garbled bytes are a command that the decoder refuses.
        if let Ok(count) = uart.read(&mut bytes).await {
            put_all(&FROM_UART, bytes.get(..count).unwrap_or_default()).await;
        }
    }
}

/// The line by UART: somebody listens as soon as a command has come. Single bytes also come of a
/// plug.
#[derive(Debug)]
pub struct UartLine {
    is_heard: bool,
}

impl Line for UartLine {
    fn listener(&self) -> Listener {
        if self.is_heard { Listener::Somebody } else { Listener::Perhaps }
    }

    fn room(&self) -> Room {
        Room { free: TO_UART.free_capacity(), all: OUT }
    }

    fn put(&mut self, bytes: &[u8]) {
        put(&TO_UART, bytes);
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        FROM_UART.try_read(bytes).unwrap_or(0)
    }

    fn heard(&mut self) {
        self.is_heard = true;
    }
}

/// The host's port: the same records on both lines, commands from either.
pub type HostPort = HostLines<UsbLine, UartLine, fn() -> u64>;

/// Starts the UART and its tasks, pins: its input, its output. Those of USB are the board's.
pub fn host_port<T: Instance>(
    spawner: SendSpawner,
    uart: Peri<'static, T>,
    (receive, transmit): (Peri<'static, impl RxPin<T>>, Peri<'static, impl TxPin<T>>),
    interrupts: impl Binding<T::Interrupt, BufferedInterruptHandler<T>> + 'static,
) -> Option<HostPort> {
    static OUT: StaticCell<[u8; 256]> = StaticCell::new();
    static IN: StaticCell<[u8; 256]> = StaticCell::new();
    let (out, into) = (OUT.init([0; 256]), IN.init([0; 256]));
    let uart =
        BufferedUart::new(uart, receive, transmit, out, into, interrupts, settings(HOST_BAUD))
            .ok()?;
    let (sender, receiver) = uart.split();
    spawner.spawn(send_to_host(sender).ok()?);
    spawner.spawn(receive_uart(receiver).ok()?);
    let line = UartLine { is_heard: false };
    Some(HostLines::new(usb_port::port(now_us), HostLine::new(line, now_us, PATIENCE_US)))
}

/// The autopilot's port: what does not fit in its buffer is dropped, a message at a time.
#[expect(missing_debug_implementations, reason = "the HAL's receiver has none")]
pub struct AutopilotPort(BufferedUartRx<'static>);

/// Starts the UART and its task, pins: its input, its output.
pub fn autopilot_port<T: Instance>(
    spawner: SendSpawner,
    uart: Peri<'static, T>,
    (receive, transmit): (Peri<'static, impl RxPin<T>>, Peri<'static, impl TxPin<T>>),
    interrupts: impl Binding<T::Interrupt, BufferedInterruptHandler<T>> + 'static,
) -> Option<AutopilotPort> {
    static OUT: StaticCell<[u8; 512]> = StaticCell::new();
    static IN: StaticCell<[u8; AUTOPILOT_IN]> = StaticCell::new();
    let (out, into) = (OUT.init([0; 512]), IN.init_with(|| [0; AUTOPILOT_IN]));
    let uart =
        BufferedUart::new(uart, receive, transmit, out, into, interrupts, settings(AUTOPILOT_BAUD))
            .ok()?;
    let (sender, receiver) = uart.split();
    spawner.spawn(send_to_autopilot(sender).ok()?);
    Some(AutopilotPort(receiver))
}

impl ByteSink for AutopilotPort {
    fn write(&mut self, bytes: &[u8]) {
        if TO_AUTOPILOT.free_capacity() >= bytes.len() {
            put(&TO_AUTOPILOT, bytes);
        }
    }
}

impl ByteSource for AutopilotPort {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        // Lost or garbled bytes are a frame that the receiver refuses.
        if let Poll::Ready(Ok(count)) = poll_once(self.0.read(bytes)) { count } else { 0 }
    }
}

/// A UART's settings: 8 bits, no parity, one stop bit.
fn settings(baud: u32) -> Config {
    let mut config = Config::default();
    config.baudrate = baud;
    config.rx_pull = Pull::Up; // nobody there: silence, not noise
    config
}
