//! The host's port over USB: a serial port (CDC ACM) of any USB peripheral that embassy-usb drives.
//!
//! ```text
//! program  <- pipes ->  run: a future of the board's executor, in interrupts
//! nobody has opened the port (DTR)   what is written is dropped
//! somebody has                       [`HostLine`] waits for room, but not for ever
//! ```
//! Not yet run on hardware.
//!
//! # Cost
//! 4 KiB for results, 1 KiB for commands, 0.4 KiB and two packets of descriptors and buffers.

use super::pipes::{Pipe, put, put_all};
use crate::host_lines::{HostLine, Line, Listener};
use crate::ports::Room;
use core::sync::atomic::{AtomicBool, Ordering};
use embassy_futures::join::join4;
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::driver::Driver;
use embassy_usb::{Builder, Config};
use static_cell::StaticCell;

/// Vendor and product that anybody may use for such ports, told apart by their texts (V-USB's
/// `USB-IDs-for-free.txt`).
const IDS: (u16, u16) = (0x16c0, 0x27dd);
/// Bytes of results that wait: several frames of records.
const RESULTS: usize = 4096;
/// Longest wait for room, microseconds.
const PATIENCE_US: u64 = 100_000;

static TO_HOST: Pipe<RESULTS> = Pipe::new();
static FROM_HOST: Pipe<1024> = Pipe::new();
/// Has a host opened the port (DTR)?
static IS_OPEN: AtomicBool = AtomicBool::new(false);

/// Memory of embassy-usb.
struct Memory<'a> {
    configuration: [u8; 128],
    bos: [u8; 16],
    control: [u8; 64],
    class: State<'a>,
}

/// Serves the port for ever, with packets of so many bytes: 64 at full speed, 512 at high speed. At
/// most one. By the chip's serial number a host tells two boards apart.
pub async fn run<const PACKET: usize, D: Driver<'static>>(
    driver: D,
    product: &'static str,
    serial: &'static str,
) {
    static MEMORY: StaticCell<Memory<'static>> = StaticCell::new();
    let memory = MEMORY.init_with(|| Memory {
        configuration: [0; 128],
        bos: [0; 16],
        control: [0; 64],
        class: State::new(),
    });
    let mut config = Config::new(IDS.0, IDS.1);
    config.manufacturer = Some("linestereo");
    config.product = Some(product);
    config.serial_number = Some(serial);
    config.composite_with_iads = false;
    config.device_class = 2; // one function: a communications device
    config.device_sub_class = 0;
    config.device_protocol = 0;
    let mut builder = Builder::new(
        driver,
        config,
        &mut memory.configuration,
        &mut memory.bos,
        &mut [],
        &mut memory.control,
    );
    let class = CdcAcmClass::new(&mut builder, &mut memory.class, PACKET as u16);
    let mut device = builder.build();
    let (mut sender, mut receiver, control) = class.split_with_control();
    let (send, receive) = (send::<PACKET, D>(&mut sender), receive::<PACKET, D>(&mut receiver));
    join4(device.run(), send, receive, watch(&control)).await;
}

async fn send<'d, const PACKET: usize, D: Driver<'d>>(sender: &mut Sender<'d, D>) {
    let mut packet = [0; PACKET];
    loop {
        sender.wait_connection().await;
        loop {
            let count = TO_HOST.read(&mut packet).await;
            let sent = sender.write_packet(packet.get(..count).unwrap_or_default()).await;
            // A full packet with nothing behind it has to be followed by an empty one, else the
            // host waits for more.
            let is_end = count == PACKET && TO_HOST.is_empty();
            if sent.is_err() || is_end && sender.write_packet(&[]).await.is_err() {
                break;
            }
        }
    }
}

async fn receive<'d, const PACKET: usize, D: Driver<'d>>(receiver: &mut Receiver<'d, D>) {
    let mut packet = [0; PACKET];
    loop {
        receiver.wait_connection().await;
        while let Ok(count) = receiver.read_packet(&mut packet).await {
            // A host that is faster than the program waits.
            put_all(&FROM_HOST, packet.get(..count).unwrap_or_default()).await;
        }
    }
}

/// Follows whether the port is open. What a host did not fetch is not for the next one.
async fn watch(control: &ControlChanged<'_>) {
    loop {
        control.control_changed().await;
        let is_open = control.dtr();
        if is_open != IS_OPEN.load(Ordering::Relaxed) {
            TO_HOST.clear();
            IS_OPEN.store(is_open, Ordering::Relaxed);
        }
    }
}

/// The program's end of the port.
pub type UsbPort = HostLine<UsbLine, fn() -> u64>;

/// The program's end of the port, with this clock.
pub const fn port(now_us: fn() -> u64) -> UsbPort {
    HostLine::new(UsbLine(()), now_us, PATIENCE_US)
}

/// The port as a line. There is one.
#[derive(Debug)]
pub struct UsbLine(());

impl Line for UsbLine {
    fn listener(&self) -> Listener {
        if IS_OPEN.load(Ordering::Relaxed) { Listener::Somebody } else { Listener::Nobody }
    }

    fn room(&self) -> Room {
        Room { free: TO_HOST.free_capacity(), all: RESULTS }
    }

    fn put(&mut self, bytes: &[u8]) {
        put(&TO_HOST, bytes);
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        FROM_HOST.try_read(bytes).unwrap_or(0)
    }
}
