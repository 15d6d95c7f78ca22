//! The host's port: USB, served by an executor in interrupts of the lowest priority, so that the
//! program stays a plain loop.

use super::clock::time_us;
use crate::boards::usb_port::{self, UsbPort};
use core::fmt::Write as _;
use embassy_executor::InterruptExecutor;
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt as _, Priority};
use embassy_rp::otp;
use embassy_rp::peripherals::USB;
use embassy_rp::usb::{Driver, InterruptHandler};
use embassy_rp::{Peri, bind_interrupts};
use heapless::String;
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => InterruptHandler<USB>;
});

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// An interrupt that no peripheral has.
#[interrupt]
unsafe fn SWI_IRQ_0() {
    // SAFETY: the handler of the interrupt that `start` gives to the executor.
    unsafe { EXECUTOR.on_interrupt() }
}

#[embassy_executor::task]
async fn serve(driver: Driver<'static, USB>, product: &'static str) {
    static SERIAL: StaticCell<String<16>> = StaticCell::new();
    let serial = SERIAL.init(String::new());
    let _ = write!(serial, "{:016X}", otp::get_chipid().unwrap_or(0)); // fits
    usb_port::run::<64, _>(driver, product, serial).await;
}

/// Starts the port. At most once.
pub fn start(usb: Peri<'static, USB>, product: &'static str) -> UsbPort {
    interrupt::SWI_IRQ_0.set_priority(Priority::P3);
    interrupt::USBCTRL_IRQ.set_priority(Priority::P3);
    let driver = Driver::new(usb, Interrupts);
    if let Ok(task) = serve(driver, product) {
        EXECUTOR.start(interrupt::SWI_IRQ_0).spawn(task);
    }
    usb_port::port(time_us)
}
