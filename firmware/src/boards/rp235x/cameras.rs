//! Two HM01B0 on a PIO block: state machines, DMA channels and interrupts of both, and their rings.
//!
//! ```text
//! state machine 0, 2   rows of the left and the right camera -> queue of 8 words
//! state machine 1, 3   start and end of their frames -> flags 0, 1 and 2, 3
//! DMA channel 0, 2     a row out of the queue to its slot; interrupt; starts the next one:
//! DMA channel 1, 3     the address of the next slot out of a table that wraps -> channel 0, 2
//! PIO0_IRQ_1, DMA_IRQ_1   both the same, of one priority: rows.rs says what it means
//! ```
//! Everything is decided in `rows.rs`; here registers are read and written. Not yet run on
//! hardware.
//!
//! # Cost
//! 2 x 42 KiB of rings and 2 x 512 bytes of tables; an interrupt every 63 us while both cameras
//! send.
//!
//! # Source
//! RP2350 datasheet: 11.7 (PIO registers), 12.6.3 (aliases, chaining), 12.6.8 (abort), 12.6.10 (DMA
//! registers), RP2350-E5 (an aborted channel has to be disabled before, and what chains to it).

use super::clock::time_us;
use super::program::{self, Program, Wire};
use super::rows::{BORDER, FRAME_ROWS, RING_ROWS, RowCounter, SLOT_WORDS, Seen};
use crate::capture::{RowRing, Signal};
use crate::memory::of;
use core::cell::{RefCell, UnsafeCell};
use core::mem;
use core::ptr;
use core::sync::atomic::{AtomicU8, Ordering, fence};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt as _, Priority};
use embassy_rp::pac::dma::regs::CtrlTrig;
use embassy_rp::pac::dma::vals::{DataSize, TreqSel};
use embassy_rp::pac::{DMA, PIO0};
use embassy_rp::peripherals::PIO0;
use embassy_rp::pio::program::{ArrayVec, PioVersion, Program as Assembled, SideSet, Wrap};
use embassy_rp::pio::{
    Common, Config, FifoJoin, InterruptHandler, LoadedProgram, Pin, Pio, ShiftConfig,
    ShiftDirection, StateMachine,
};
use embassy_rp::{Peri, bind_interrupts};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use linestereo_rig::CameraSide;

bind_interrupts!(struct Interrupts {
    // `Pio::new` asks for it and enables it; it never comes, because nothing is a source of it
    // (INTE of IRQ 0 stays 0).
    PIO0_IRQ_0 => InterruptHandler<PIO0>;
});

/// A camera's pins, in the order of [`Wire`].
pub type Pins = [Pin<'static, PIO0>; Wire::COUNT as usize];

/// Memory that the DMA writes, or reads.
#[repr(C, align(512))]
struct Shared<T>(UnsafeCell<T>);

// SAFETY: it is only ever reached through pointers, by this file and the DMA.
unsafe impl<T> Sync for Shared<T> {}

type Ring = [[u32; SLOT_WORDS]; RING_ROWS];
/// Addresses of the slots of a ring. Aligned to its own size, as a table that wraps has to be.
type Table = [u32; RING_ROWS];

static RINGS: [Shared<Ring>; 2] =
    [const { Shared(UnsafeCell::new([[0; SLOT_WORDS]; RING_ROWS])) }; 2];
static TABLES: [Shared<Table>; 2] = [const { Shared(UnsafeCell::new([0; RING_ROWS])) }; 2];
const _: () = assert!(align_of::<Shared<Table>>() == size_of::<Table>());

static COUNTERS: Mutex<CriticalSectionRawMutex, RefCell<[RowCounter; 2]>> =
    Mutex::new(RefCell::new([const { RowCounter::new() }; 2]));
/// Where the program for rows lies in the PIO's memory.
static ORIGIN: AtomicU8 = AtomicU8::new(0);

/// The part of the hardware that one camera has.
#[derive(Clone, Copy)]
struct Channel {
    /// State machine, and DMA channel, of rows; the ones of frames and addresses are the next ones.
    number: usize,
}

const CHANNELS: [Channel; 2] = [Channel { number: 0 }, Channel { number: 2 }];

impl Channel {
    fn of(eye: CameraSide) -> Self {
        let [left, right] = CHANNELS;
        if eye == CameraSide::Left { left } else { right }
    }

    const fn slot(self, slot: u32) -> *mut [u32; SLOT_WORDS] {
        let [left, right] = &RINGS;
        let ring = if self.number == 0 { left } else { right };
        ring.0.get().cast::<[u32; SLOT_WORDS]>().wrapping_add(slot as usize % RING_ROWS)
    }

    const fn table(self) -> *mut u32 {
        let [left, right] = &TABLES;
        let table = if self.number == 0 { left } else { right };
        table.0.get().cast()
    }

    fn write_table(self) {
        for slot in 0..RING_ROWS {
            // SAFETY: inside the table, which the DMA does not read yet.
            unsafe { self.table().add(slot).write(self.slot(slot as u32).addr() as u32) };
        }
        fence(Ordering::SeqCst);
    }

    /// Place in the table that is read next.
    fn next_slot(self) -> u32 {
        let address = DMA.ch(self.number + 1).read_addr().read();
        address.wrapping_sub(self.table().addr() as u32) / 4 % RING_ROWS as u32
    }

    /// Nothing of a row has come that is not complete, and nothing is on its way.
    fn is_at_rest(self) -> bool {
        let is_idle = PIO0.sm(self.number).addr().read().addr()
            >= ORIGIN.load(Ordering::Relaxed) + program::ROWS.wrap_target;
        let is_empty = PIO0.fstat().read().rxempty() & 1 << self.number != 0;
        is_idle && is_empty && DMA.ch(self.number).trans_count().read().count() == SLOT_WORDS as u32
    }

    /// Rows go to this slot and the next ones from now on, whatever was going on.
    fn restart(self, slot: u32) {
        let (rows, addresses) = (DMA.ch(self.number), DMA.ch(self.number + 1));
        let running = 1 << self.number;
        PIO0.ctrl().modify(|w| w.set_sm_enable(w.sm_enable() & !running));
        // RP2350-E5: neither may start again, and neither may start another one: 0 would chain both
        // to the left camera's channel 0.
        rows.al1_ctrl().write_value(disabled(self.number).0);
        addresses.al1_ctrl().write_value(disabled(self.number + 1).0);
        DMA.chan_abort().write(|w| w.set_chan_abort(0b11 << self.number));
        while DMA.chan_abort().read().chan_abort() & 0b11 << self.number != 0 {}

        // Both changes of the join empty the queue (11.7, SHIFTCTRL).
        PIO0.sm(self.number).shiftctrl().modify(|w| w.set_fjoin_rx(false));
        PIO0.sm(self.number).shiftctrl().modify(|w| w.set_fjoin_rx(true));
        PIO0.fdebug().write(|w| w.set_rxstall(running));
        PIO0.ctrl().modify(|w| w.set_sm_restart(running));
        let idle = ORIGIN.load(Ordering::Relaxed) + program::ROWS.wrap_target;
        PIO0.sm(self.number).instr().write(|w| w.set_instr(idle.into())); // JMP, always
        DMA.ints(1).write_value(u32::from(running)); // of a row that is complete, and counted

        rows.read_addr().write_value(PIO0.rxf(self.number).as_ptr().addr() as u32);
        rows.trans_count().write(|w| w.set_count(SLOT_WORDS as u32));
        rows.al1_ctrl().write_value(self.rows_control().0);
        addresses
            .read_addr()
            .write_value(self.table().wrapping_add(slot as usize % RING_ROWS).addr() as u32);
        addresses.write_addr().write_value(rows.al2_write_addr_trig().as_ptr().addr() as u32);
        addresses.trans_count().write(|w| w.set_count(1));
        addresses.ctrl_trig().write_value(self.addresses_control()); // and both run
        PIO0.ctrl().modify(|w| w.set_sm_enable(w.sm_enable() | running));
    }

    fn rows_control(self) -> CtrlTrig {
        let mut control = CtrlTrig::default();
        control.set_en(true);
        control.set_high_priority(true);
        control.set_data_size(DataSize::SIZE_WORD);
        control.set_incr_write(true);
        control.set_chain_to(self.number as u8 + 1);
        control.set_treq_sel(if self.number == 0 { TreqSel::PIO0_RX0 } else { TreqSel::PIO0_RX2 });
        control
    }

    fn addresses_control(self) -> CtrlTrig {
        let mut control = CtrlTrig::default();
        control.set_en(true);
        control.set_high_priority(true);
        control.set_data_size(DataSize::SIZE_WORD);
        control.set_incr_read(true);
        control.set_ring_size(size_of::<Table>().trailing_zeros() as u8);
        control.set_chain_to(self.number as u8 + 1); // itself: nothing
        control.set_treq_sel(TreqSel::PERMANENT);
        control.set_irq_quiet(true);
        control
    }

    /// The next event, if there is one.
    fn look(self) -> Option<Seen> {
        let (rows, flags) = (1 << self.number, 0b11 << self.number);
        let ended = DMA.ints(1).read() & rows;
        DMA.ints(1).write_value(ended); // one that ends now is told by the next interrupt
        let is_row = ended != 0;
        let flags = PIO0.irq().read().irq() & flags;
        PIO0.irq().write(|w| w.set_irq(flags));
        let is_ended = flags & 0b10 << self.number != 0;
        if !is_row && flags == 0 {
            return None;
        }
        if is_ended {
            // The last row may still be on its way, for some cycles.
            let _ = (0..100).find(|_| self.is_at_rest());
        }
        Some(Seen {
            is_started: flags & 0b01 << self.number != 0,
            is_ended,
            is_overrun: PIO0.fdebug().read().rxstall() & 1 << self.number != 0,
            next_slot: self.next_slot(),
            is_begun: is_ended && !self.is_at_rest(),
            time_us: time_us(),
        })
    }

    fn serve(self, counter: &mut RowCounter) {
        let Some(seen) = self.look() else { return };
        // SAFETY: a word of the ring, of a row that is complete; the DMA is elsewhere, or the row
        // is not used.
        let length_word =
            |slot| unsafe { (&raw const (*self.slot(slot))[SLOT_WORDS - 1]).read_volatile() };
        if let Some(slot) = counter.take(FRAME_ROWS as u32, &seen, length_word) {
            self.restart(slot);
        }
    }
}

/// Control of a channel that does nothing, and starts nothing when it is aborted: it chains to
/// itself.
fn disabled(channel: usize) -> CtrlTrig {
    let mut control = CtrlTrig::default();
    control.set_chain_to(channel as u8);
    control
}

fn serve() {
    COUNTERS.lock(|counters| {
        let mut counters = counters.borrow_mut();
        for (channel, counter) in CHANNELS.into_iter().zip(counters.iter_mut()) {
            channel.serve(counter);
        }
    });
}

#[interrupt]
fn PIO0_IRQ_1() {
    serve();
}

#[interrupt]
fn DMA_IRQ_1() {
    serve();
}

/// The PIO block and what its four state machines are.
#[expect(missing_debug_implementations, reason = "the HAL's state machines have none")]
pub struct Block {
    common: Common<'static, PIO0>,
    machines: (
        StateMachine<'static, PIO0, 0>,
        StateMachine<'static, PIO0, 1>,
        StateMachine<'static, PIO0, 2>,
        StateMachine<'static, PIO0, 3>,
    ),
}

impl Block {
    /// PIO block 0.
    pub fn new(pio: Peri<'static, PIO0>) -> Self {
        let Pio { common, sm0, sm1, sm2, sm3, .. } = Pio::new(pio, Interrupts);
        Self { common, machines: (sm0, sm1, sm2, sm3) }
    }

    /// For making a camera's pins.
    pub fn common(&mut self) -> &mut Common<'static, PIO0> {
        &mut self.common
    }

    /// Starts both cameras' hardware: the left and the right ring.
    pub fn start(self, pins: [Pins; 2]) -> [CameraRing; 2] {
        let Self {
            mut common,
            machines: (mut left_rows, mut left_frames, mut right_rows, mut right_frames),
        } = self;
        let rows = common.load_program(&assembled(&program::ROWS));
        let frames = common.load_program(&assembled(&program::FRAMES));
        ORIGIN.store(rows.origin, Ordering::Relaxed);
        let [left, right] = &pins;
        left_rows.set_config(&config(&rows, left));
        right_rows.set_config(&config(&rows, right));
        left_frames.set_config(&config(&frames, left));
        right_frames.set_config(&config(&frames, right));

        DMA.inte(1).write_value(CHANNELS.iter().map(|channel| 1 << channel.number).sum());
        PIO0.irqs(1).inte().write(|w| {
            w.set_sm0(true);
            w.set_sm1(true);
            w.set_sm2(true);
            w.set_sm3(true);
        });
        for channel in CHANNELS {
            channel.write_table();
            channel.restart(0);
        }
        left_frames.set_enable(true);
        right_frames.set_enable(true);
        for interrupt in [interrupt::PIO0_IRQ_1, interrupt::DMA_IRQ_1] {
            interrupt.set_priority(Priority::P1); // above USB and UART
            // SAFETY: both handlers stand above, and nothing else masks by them.
            unsafe { interrupt.enable() };
        }
        // They run until the next reset; dropped they would stop.
        mem::forget((common, left_rows, left_frames, right_rows, right_frames, pins));
        CameraSide::BOTH.map(|eye| CameraRing { eye })
    }
}

/// A program as embassy-rp loads it, to wherever there is room.
fn assembled(program: &Program) -> Assembled<32> {
    Assembled {
        code: program.words.iter().copied().collect::<ArrayVec<u16, 32>>(),
        origin: None,
        wrap: Wrap { source: program.words.len() as u8 - 1, target: program.wrap_target },
        side_set: SideSet::default(),
        version: PioVersion::V0,
    }
}

fn config(program: &LoadedProgram<'static, PIO0>, pins: &Pins) -> Config<'static, PIO0> {
    let mut config = Config::default();
    config.use_program(program, &[]);
    config.set_in_pins(&pins.each_ref());
    config.set_jmp_pin(&pins[Wire::LineValid as usize]);
    config.shift_in =
        ShiftConfig { threshold: 32, direction: ShiftDirection::Right, auto_fill: true };
    config.fifo_join = FifoJoin::RxOnly;
    config
}

/// The ring of one camera.
#[derive(Debug)]
pub struct CameraRing {
    eye: CameraSide,
}

impl RowRing for CameraRing {
    fn rows(&self) -> u32 {
        RING_ROWS as u32
    }

    fn next_signal(&mut self) -> Option<Signal> {
        COUNTERS.lock(|counters| of(self.eye, &mut counters.borrow_mut()).next_signal())
    }

    fn written(&self) -> u32 {
        let next_slot = || Channel::of(self.eye).next_slot();
        COUNTERS.lock(|counters| of(self.eye, &mut counters.borrow_mut()).written(next_slot()))
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        let pixels = Channel::of(self.eye).slot(row).cast::<u8>().wrapping_add(BORDER as usize);
        let count = into.len().min(4 * (SLOT_WORDS - 1) - BORDER as usize);
        fence(Ordering::SeqCst);
        // SAFETY: inside one slot of the ring. The DMA may be writing there; the capture asks
        // `written` afterwards and then does not use it.
        unsafe { ptr::copy_nonoverlapping(pixels, into.as_mut_ptr(), count) };
        fence(Ordering::SeqCst);
    }

    fn now_us(&self) -> u64 {
        time_us()
    }

    /// An interrupt that came since it was looked is an event too: it does not sleep then. SysTick
    /// ends every sleep.
    fn rest(&self) {
        cortex_m::asm::wfe();
    }
}
