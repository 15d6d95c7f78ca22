//! The host's two lines and the autopilot's.
//!
//! ```text
//! program -> pipe -> task -> USB packets        program <- pipe <- task <- USB packets
//! program -> pipe -> task -> UART's buffer      program <- pipe <- task <- UART's buffer
//! program -> pipe -> task -> UART's buffer      MAVLink, 57600 baud
//! ```
//! The tasks run in an interrupt that no peripheral uses, below all others and above the program. The program never waits for ever for a task
//! that waits for a host ([`HostLines`]), and not at all for the autopilot's.
//!
//! # Cost
//! 9 KiB of pipes and buffers, 3 KiB of tasks.

use super::clocks::now_us;
use crate::host_lines::{HostLines, Line, Listener};
use crate::ports::ByteSink;
use core::sync::atomic::{AtomicBool, Ordering};
use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_futures::join::join5;
use embassy_stm32::interrupt::{InterruptExt as _, Priority};
use embassy_stm32::pac::interrupt;
use embassy_stm32::usart::{BufferedUart, BufferedUartRx, BufferedUartTx, Config};
use embassy_stm32::usb::{Driver, Instance};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::Timer;
use embassy_usb::class::cdc_acm::{CdcAcmClass, State};
use embassy_usb::{Builder, Config as UsbConfig};
use embedded_io_async::{Read as _, Write as _};
use static_cell::StaticCell;

/// Bytes that wait for the host: some twenty records; and for the program: more than a command.
const OUT: usize = 4096;
const IN: usize = 1024;
type Out = Pipe<CriticalSectionRawMutex, OUT>;
type In = Pipe<CriticalSectionRawMutex, IN>;

static TO_USB: Out = Pipe::new();
static FROM_USB: In = Pipe::new();
static TO_UART: Out = Pipe::new();
static FROM_UART: In = Pipe::new();
static TO_AUTOPILOT: Out = Pipe::new();
/// A program of the host has opened the port (DTR).
static USB_IS_OPEN: AtomicBool = AtomicBool::new(false);

/// How long a record waits for a host that listens, microseconds: more than a full buffer takes on the UART.
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

/// The spawner of the ports' tasks; to be asked for once.
pub fn executor() -> SendSpawner {
    interrupt::CEC.set_priority(Priority::P8);
    EXECUTOR.start(interrupt::CEC)
}

/// Memory of the USB device.
struct UsbMemory {
    config: [u8; 128],
    bos: [u8; 32],
    control: [u8; 64],
}

/// Serves a USB serial port (CDC ACM) with packets of so many bytes, for ever.
pub async fn serve_usb<T: Instance>(driver: Driver<'static, T>, packet: usize) -> ! {
    static MEMORY: StaticCell<UsbMemory> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    let memory = MEMORY.init(UsbMemory { config: [0; 128], bos: [0; 32], control: [0; 64] });
    // "pid.codes test": a product of your own needs a number of its own.
    let mut config = UsbConfig::new(0x1209, 0x0001);
    config.manufacturer = Some("linestereo");
    config.product = Some(crate::boards::selected::BOARD.name);
    let mut builder = Builder::new(driver, config, &mut memory.config, &mut memory.bos, &mut [], &mut memory.control);
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), packet as u16);
    let mut device = builder.build();
    let (mut sender, mut receiver, control) = class.split_with_control();
    let open = async {
        loop {
            control.control_changed().await;
            let is_open = control.dtr();
            if is_open && !USB_IS_OPEN.load(Ordering::Relaxed) {
                TO_USB.clear(); // what was meant for somebody else
            }
            USB_IS_OPEN.store(is_open, Ordering::Relaxed);
        }
    };
    // Never a full packet: none has to be followed by an empty one.
    let (mut out, mut into) = ([0; 511], [0; 512]);
    let send = async {
        loop {
            sender.wait_connection().await;
            loop {
                let count = TO_USB.read(&mut out[..packet - 1]).await;
                if sender.write_packet(&out[..count]).await.is_err() {
                    break;
                }
            }
        }
    };
    let receive = async {
        loop {
            receiver.wait_connection().await;
            while let Ok(count) = receiver.read_packet(&mut into[..packet]).await {
                write_all(&FROM_USB, &into[..count]).await;
            }
        }
    };
    // While the program rests it is woken as often: what it waits for may be time.
    let tick = async {
        loop {
            Timer::after_millis(5).await;
        }
    };
    let (never, ..) = join5(device.run(), open, send, receive, tick).await;
    never
}

async fn write_all<const N: usize>(pipe: &Pipe<CriticalSectionRawMutex, N>, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        let count = pipe.write(bytes).await;
        bytes = bytes.get(count..).unwrap_or_default();
    }
}

/// From the program to a UART.
#[embassy_executor::task(pool_size = 2)]
async fn send_uart(mut uart: BufferedUartTx<'static>, pipe: &'static Out) -> ! {
    let mut bytes = [0; 64];
    loop {
        let count = pipe.read(&mut bytes).await;
        let _ = uart.write_all(&bytes[..count]).await; // a UART cannot fail to send
    }
}

/// From the host's UART to the program.
#[embassy_executor::task]
async fn receive_uart(mut uart: BufferedUartRx<'static>) -> ! {
    let mut bytes = [0; 64];
    loop {
        // What was lost or garbled is a command that the decoder refuses.
        if let Ok(count) = uart.read(&mut bytes).await {
            write_all(&FROM_UART, &bytes[..count]).await;
        }
    }
}

/// A UART's settings: 8 bits, no parity, one stop bit.
fn settings(baud: u32) -> Config {
    let mut config = Config::default();
    config.baudrate = baud;
    config
}

/// Settings of the host's UART.
#[must_use]
pub fn host_settings() -> Config {
    settings(HOST_BAUD)
}

/// Settings of the autopilot's UART.
#[must_use]
pub fn autopilot_settings() -> Config {
    settings(AUTOPILOT_BAUD)
}

/// Buffers of a UART, for its interrupts.
#[expect(missing_debug_implementations, reason = "bytes")]
pub struct UartMemory<const OUT: usize, const IN: usize> {
    /// To be sent.
    pub out: [u8; OUT],
    /// Received.
    pub into: [u8; IN],
}

impl<const OUT: usize, const IN: usize> UartMemory<OUT, IN> {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self { out: [0; OUT], into: [0; IN] }
    }
}

/// The line by USB.
#[derive(Debug)]
pub struct UsbLine(());

impl Line for UsbLine {
    fn listener(&self) -> Listener {
        if USB_IS_OPEN.load(Ordering::Relaxed) { Listener::Somebody } else { Listener::Nobody }
    }

    fn room(&self) -> usize {
        TO_USB.free_capacity()
    }

    fn put(&mut self, bytes: &[u8]) {
        put(&TO_USB, bytes);
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        FROM_USB.try_read(bytes).unwrap_or(0)
    }
}

/// The line by UART: somebody listens as soon as something has come.
#[derive(Debug)]
pub struct UartLine {
    is_heard: bool,
}

impl Line for UartLine {
    fn listener(&self) -> Listener {
        if self.is_heard { Listener::Somebody } else { Listener::Perhaps }
    }

    fn room(&self) -> usize {
        TO_UART.free_capacity()
    }

    fn put(&mut self, bytes: &[u8]) {
        put(&TO_UART, bytes);
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let count = FROM_UART.try_read(bytes).unwrap_or(0);
        self.is_heard |= count > 0;
        count
    }
}

/// A pipe's buffer wraps, so that it may take two pieces.
fn put(pipe: &Out, mut bytes: &[u8]) {
    while let Ok(count @ 1..) = pipe.try_write(bytes) {
        bytes = bytes.get(count..).unwrap_or_default();
    }
}

/// The host's port: the same records on both lines, commands from either.
pub type HostPort = HostLines<UsbLine, UartLine, fn() -> u64>;

/// Starts the UART's tasks; those of USB are the board's.
pub fn host_port(spawner: SendSpawner, uart: BufferedUart<'static>) -> Option<HostPort> {
    let (sender, receiver) = uart.split();
    spawner.spawn(send_uart(sender, &TO_UART).ok()?);
    spawner.spawn(receive_uart(receiver).ok()?);
    Some(HostLines::new(UsbLine(()), UartLine { is_heard: false }, now_us, PATIENCE_US))
}

/// The autopilot's port: what does not fit in its buffer is dropped, a message at a time.
#[derive(Debug)]
pub struct AutopilotPort(());

/// Starts the autopilot's task. What comes from it is not read.
pub fn autopilot_port(spawner: SendSpawner, uart: BufferedUart<'static>) -> Option<AutopilotPort> {
    let (sender, receiver) = uart.split();
    core::mem::forget(receiver);
    spawner.spawn(send_uart(sender, &TO_AUTOPILOT).ok()?);
    Some(AutopilotPort(()))
}

impl ByteSink for AutopilotPort {
    fn write(&mut self, bytes: &[u8]) {
        if TO_AUTOPILOT.free_capacity() >= bytes.len() {
            put(&TO_AUTOPILOT, bytes);
        }
    }
}
