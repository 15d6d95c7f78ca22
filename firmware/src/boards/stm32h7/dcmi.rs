//! The camera interface (DCMI) and its DMA: rows in a ring, interrupts -> signals.
//!
//! ```text
//! DCMI -> DMA1 stream 0, circular, words -> ring in SRAM of domain 2
//! VSYNC pin rises (EXTI)   a frame starts: its time          DCMI itself tells only of ends
//! LINE                     a row ends: once the interface's buffer is empty, how far has the DMA
//!                          come, if the next one has not begun?
//! VSYNC                    a frame ends
//! OVR, DMA error           bytes are lost
//! Bands asks for it        DCMI and DMA start anew; DCMI waits for the next frame
//! ```
//! The HAL's driver takes one frame at a time and no position, so its pins, clocks and addresses
//! are used and the registers are written here.
//!
//! # Bounds
//! The interrupt looks at the DMA's position between two rows, 3 us with an MT9V034; one that is
//! late leaves the row to the next, and may be late by any number of rows that the ring holds.
//! Frames are a millisecond apart.
//!
//! # Source
//! RM0433: sections 16 (DMA: 16.3.8 circular mode, 16.5.5 S0CR), 17.3 (DMAMUX request 75), 20
//! (EXTI), 29 (DCMI: 29.6 interrupts, 29.7 registers); RM0399 has the same peripherals. Edges and
//! levels: those with which OpenMV (`mt9v0xx.c`, `sensor.c`) takes frames of an MT9V034 with an
//! STM32H743.

use super::clocks::now_us;
use crate::boards::selected::ROW;
use crate::capture::{Bands, Dma, Events, RingLayout, Signal, Stream};
use core::cell::{RefCell, UnsafeCell};
use embassy_stm32::dcmi::{
    D0Pin, D1Pin, D2Pin, D3Pin, D4Pin, D5Pin, D6Pin, D7Pin, HSyncPin, PixClkPin, VSyncPin,
};
use embassy_stm32::gpio::{AfType, Flex, Pull};
use embassy_stm32::interrupt::{InterruptExt as _, Priority};
use embassy_stm32::pac;
use embassy_stm32::pac::dma::vals::{Dir, Dmdis, Pl, Size};
use embassy_stm32::pac::interrupt;
use embassy_stm32::{Peri, peripherals, rcc};
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use heapless::Vec;

const LAYOUT: RingLayout = ROW.layout();
/// Bytes of the ring.
const RING_BYTES: usize = LAYOUT.bytes() as usize;
const _: () = assert!(LAYOUT.row_bytes.is_multiple_of(4), "the DMA moves words");
const _: () = assert!(RING_BYTES / 4 <= u16::MAX as usize, "the DMA counts words in 16 bits");
/// Signals that wait for the program: four frames of a signal every eight rows.
const QUEUE: usize = 128;
/// Request of the DCMI (RM0433, table 121).
const DCMI_REQUEST: u8 = 75;
/// Of DMA1.
const STREAM: usize = 0;

/// Written by the DMA, read by [`DcmiStream`].
#[repr(C, align(32))]
struct Ring(UnsafeCell<[u8; RING_BYTES]>);

// SAFETY: only read, through raw pointers, by copies whose result is not used when the DMA was
// there meanwhile.
unsafe impl Sync for Ring {}

// SAFETY: the section is not initialised, and every pattern of bits is a byte.
#[unsafe(link_section = ".rings")]
static RING: Ring = Ring(UnsafeCell::new([0; RING_BYTES]));

/// Empty until the stream is started. A list, because the bytes of an `Option` that is `None` are
/// not all zero, and would lie in flash.
static STATE: CriticalSectionMutex<RefCell<Vec<State, 1>>> =
    CriticalSectionMutex::new(RefCell::new(Vec::new()));

struct State {
    bands: Bands<QUEUE>,
    /// Line of the VSYNC pin's external interrupt.
    vsync_line: usize,
}

type Camera = peripherals::DCMI;

/// The rows of the camera interface.
#[derive(Debug)]
pub struct DcmiStream(());

impl DcmiStream {
    /// Takes the interface, its DMA stream, and eleven pins that are the interface's by the HAL's
    /// tables: data 0 to 7; VSYNC, HSYNC and pixel clock. Takes frames from now on: pixels at
    /// falling edges of the clock, while VSYNC and HSYNC are high. `None` when it was started
    /// before, or VSYNC is a pin below 5, which has an interrupt of its own.
    #[expect(clippy::type_complexity, reason = "eleven pins, each of a type of its own")]
    pub fn start(
        _: (Peri<'static, Camera>, Peri<'static, peripherals::DMA1_CH0>),
        (d0, d1, d2, d3, d4, d5, d6, d7): (
            Peri<'static, impl D0Pin<Camera>>,
            Peri<'static, impl D1Pin<Camera>>,
            Peri<'static, impl D2Pin<Camera>>,
            Peri<'static, impl D3Pin<Camera>>,
            Peri<'static, impl D4Pin<Camera>>,
            Peri<'static, impl D5Pin<Camera>>,
            Peri<'static, impl D6Pin<Camera>>,
            Peri<'static, impl D7Pin<Camera>>,
        ),
        (vsync, hsync, clock): (
            Peri<'static, impl VSyncPin<Camera>>,
            Peri<'static, impl HSyncPin<Camera>>,
            Peri<'static, impl PixClkPin<Camera>>,
        ),
    ) -> Option<Self> {
        let (port, pin) = (vsync.port(), vsync.pin());
        if pin < 5 {
            return None;
        }
        let vsync_line = usize::from(pin);
        let is_first = STATE.lock(|state| {
            state.borrow_mut().push(State { bands: Bands::new(LAYOUT), vsync_line }).is_ok()
        });
        if !is_first {
            return None;
        }
        macro_rules! pins {
            ($($pin:ident)*) => { [$(($pin.af_num(), Flex::new($pin))),*] };
        }
        for (function, mut pin) in pins!(d0 d1 d2 d3 d4 d5 d6 d7 vsync hsync clock) {
            // No sensor: no frame, no row, no pixel, instead of noise that keeps the interrupts
            // busy.
            pin.set_as_af_unchecked(function, AfType::input(Pull::Down));
            core::mem::forget(pin); // stays so
        }
        rcc::enable_and_reset::<Camera>();
        pac::DMAMUX1.ccr(STREAM).write(|mux| mux.set_dmareq_id(DCMI_REQUEST));
        cortex_m::interrupt::free(|_| {
            pac::SYSCFG
                .exticr(vsync_line / 4)
                .modify(|config| config.set_exti(vsync_line % 4, port));
            pac::EXTI.rtsr(0).modify(|lines| lines.set_line(vsync_line, true));
            pac::EXTI.imr(0).modify(|lines| lines.set_line(vsync_line, true));
        });
        start_anew();
        for interrupt in [interrupt::DCMI, vsync_interrupt(vsync_line)] {
            interrupt.set_priority(Priority::P1);
            // SAFETY: the handlers below are ready, and no critical section relies on these
            // interrupts being off.
            unsafe { interrupt.enable() };
        }
        Some(Self(()))
    }
}

impl Stream for DcmiStream {
    fn rows(&self) -> u32 {
        LAYOUT.rows
    }

    fn next_signal(&mut self) -> Option<Signal> {
        STATE.lock(|state| state.borrow_mut().first_mut()?.bands.next_signal())
    }

    fn written(&self) -> u32 {
        let written = |state: &State| state.bands.written(offset());
        STATE.lock(|state| state.borrow().first().map_or(0, written))
    }

    fn is_in_frame(&self) -> bool {
        STATE.lock(|state| state.borrow().first().is_some_and(|state| state.bands.is_in_frame()))
    }

    fn copy(&self, row: u32, from: usize, into: &mut [u8]) {
        let row_bytes = LAYOUT.row_bytes as usize;
        let count = into.len().min(row_bytes.saturating_sub(from));
        let start = (row % LAYOUT.rows) as usize * row_bytes + from;
        // The row is complete in memory before it is read: this memory is not cached.
        cortex_m::asm::dmb();
        // SAFETY: the bytes lie in the ring, because rows of the layout fit in it. The DMA may
        // write there meanwhile; then the caller learns from `written` that the copy is of no use.
        unsafe {
            RING.0.get().cast::<u8>().add(start).copy_to_nonoverlapping(into.as_mut_ptr(), count)
        };
        cortex_m::asm::dmb();
    }

    fn now_us(&self) -> u64 {
        now_us()
    }

    /// Until the next interrupt: if one came since the last call, not at all. A task of the ports
    /// wakes every 5 ms.
    fn rest(&self) {
        cortex_m::asm::wfe();
    }
}

fn vsync_interrupt(line: usize) -> interrupt {
    if line < 10 { interrupt::EXTI9_5 } else { interrupt::EXTI15_10 }
}

/// The byte of the ring that the DMA writes next.
fn offset() -> u32 {
    let left = u32::from(pac::DMA1.st(STREAM).ndtr().read().ndt()) * 4;
    LAYOUT.bytes().saturating_sub(left) % LAYOUT.bytes()
}

/// Sets the DMA to the start of the ring and lets the interface wait for the next frame.
fn start_anew() {
    // The rest of its buffer goes as well.
    pac::RCC.ahb2rstr().modify(|reset| reset.set_dcmirst(true));
    pac::RCC.ahb2rstr().modify(|reset| reset.set_dcmirst(false));
    let stream = pac::DMA1.st(STREAM);
    stream.cr().modify(|config| config.set_en(false));
    while stream.cr().read().en() {}
    clear_dma_flags();
    stream.par().write_value(pac::DCMI.dr().as_ptr().addr() as u32);
    stream.m0ar().write_value(RING.0.get().addr() as u32);
    stream.ndtr().write(|count| count.set_ndt((RING_BYTES / 4) as u16));
    stream.fcr().write(|fifo| fifo.set_dmdis(Dmdis::ENABLED)); // direct mode: no word waits inside
    stream.cr().write(|config| {
        config.set_dir(Dir::PERIPHERAL_TO_MEMORY);
        config.set_circ(true);
        config.set_minc(true);
        config.set_psize(Size::BITS32);
        config.set_msize(Size::BITS32);
        config.set_pl(Pl::VERY_HIGH);
        config.set_en(true);
    });
    let dcmi = pac::DCMI;
    dcmi.cr().write(|control| {
        control.set_pckpol(false); // falling edges
        control.set_vspol(false); // low: no frame
        control.set_hspol(false); // low: no row
    });
    dcmi.ier().write(|enable| {
        enable.set_line_ie(true);
        enable.set_vsync_ie(true);
        enable.set_ovr_ie(true);
    });
    dcmi.cr().modify(|control| control.set_enable(true));
    dcmi.cr().modify(|control| control.set_capture(true)); // continuous: CM = 0
}

fn clear_dma_flags() {
    pac::DMA1.ifcr(STREAM / 4).write(|flags| {
        let stream = STREAM % 4;
        flags.set_tcif(stream, true);
        flags.set_htif(stream, true);
        flags.set_teif(stream, true);
        flags.set_dmeif(stream, true);
        flags.set_feif(stream, true);
    });
}

/// Serves all pending causes of the interrupts, in the order in which they arose.
fn serve() {
    let now_us = now_us();
    STATE.lock(|state| {
        let mut state = state.borrow_mut();
        let Some(State { bands, vsync_line }) = state.first_mut() else { return };
        let vsync_line = *vsync_line;
        let events = pac::DCMI.ris().read();
        pac::DCMI.icr().write(|clear| {
            clear.set_line_isc(events.line_ris());
            clear.set_vsync_isc(events.vsync_ris());
            clear.set_ovr_isc(events.ovr_ris());
        });
        let has_started = pac::EXTI.pr(0).read().line(vsync_line);
        if has_started {
            pac::EXTI.pr(0).write(|lines| lines.set_line(vsync_line, true));
        }
        let dma = pac::DMA1.isr(STREAM / 4).read();
        let is_lost = events.ovr_ris() || dma.teif(STREAM % 4) || dma.dmeif(STREAM % 4);
        empty_buffer();
        let offset = offset();
        let is_settled = pac::DCMI.sr().read().hsync(); // still between two rows after the look
        let (row_ended, frame_ended) = (events.line_ris() && is_settled, events.vsync_ris());
        let events = Events { has_started, row_ended, frame_ended, is_lost };
        if bands.serve(events, offset, now_us) == Dma::Restart {
            start_anew();
        }
    });
}

/// Waits until the interface has given the row's last words to the DMA: some bus cycles. A DMA that
/// does not take them is an overrun soon.
fn empty_buffer() {
    for _ in 0..100 {
        if !pac::DCMI.sr().read().fne() {
            return;
        }
    }
}

#[interrupt]
fn DCMI() {
    serve();
}

#[interrupt]
fn EXTI9_5() {
    serve();
}

#[interrupt]
fn EXTI15_10() {
    serve();
}
