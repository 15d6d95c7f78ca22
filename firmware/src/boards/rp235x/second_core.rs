//! The second core: does half of a pair's steps, and waits in RAM for the rest of the time.
//!
//! ```text
//! start    core 1 is reset; the boot ROM on it takes its vectors, stack and entry by the queues of
//!          the SIO; it limits its stacks, enables its FPU and clears WORK. All within 10 ms, or it
//!          is held in reset and there is one core.
//! join     core 0: WORK = there, event; here(); until WORK is null: wait for an event
//!          core 1: until WORK is not null: wait for an event; work; WORK = null, event
//! ```
//!
//! # Memory
//! WORK is all that both cores write (the halves of a step share nothing that one of them writes),
//! and no lock is needed: the store of one (release) and the load of the other (acquire) order
//! everything before the one before everything after the other. SRAM has no cache, and DSB lets no
//! event overtake the store. Loads and stores alone are used, so that exclusive accesses need not
//! reach the other core (ACTLR.EXTEXCLALL). An event that comes before its wait is not lost: the
//! event register of each core holds it.
//!
//! # Lifetimes
//! `join` lends core 1 a borrowed closure, and returns when WORK is null again, which core 1 stores
//! after its last use. Nothing unwinds past that: a panic ends the program.
//!
//! # Interrupts
//! All are core 0's. None is enabled in the NVIC of core 1, whose SysTick does not run. Nothing
//! that core 1 calls enters a critical section, which would hold off the interrupts of one core
//! alone.
//!
//! # Flash
//! While core 0 erases or programs, nothing can be read from the flash. It does so between pairs,
//! while core 1 waits in `serve`: code in RAM, a stack in banks of its own, no interrupt.
//!
//! # Failures
//! A panic or a fault of core 1 leaves the same note as one of core 0, and resets both cores
//! (`ending`). So does an overflow of the stack of its work, by PSPLIM; one of its handlers' locks
//! it up, by MSPLIM. A core 1 that hangs leaves core 0 in `join`, where it does not feed the
//! watchdog.
//!
//! # Source
//! RP2350 datasheet: 5.3 (start of core 1), 3.1.5 (queues), 7.4 (PSM); Armv8-M Architecture
//! Reference Manual, DDI 0553 (CPACR, stack limits, events).

use super::clock::time_us;
use crate::stack;
use core::arch::asm;
use core::ops::Range;
use core::ptr;
use core::sync::atomic::{AtomicPtr, Ordering};
use cortex_m::peripheral::SCB;
use embassy_rp::Peri;
use embassy_rp::pac::{PSM, SIO};
use embassy_rp::peripherals::CORE1;
use linestereo::Cores;

/// Core 1 answers each word of its start within microseconds.
const PATIENCE_US: u64 = 10_000;

unsafe extern "C" {
    /// Ends of core 1's stacks; see `pico2.x`.
    static _second_stack_end: u32;
    static _second_program_stack_start: u32;
    static _second_stack_start: u32;
}

/// Half of a step.
struct Work<'w>(&'w mut (dyn FnMut() + Send));

/// The half that core 1 has to do; null when it is done.
static WORK: AtomicPtr<Work<'static>> = AtomicPtr::new(ptr::null_mut());

/// Core 1, which waits for work.
#[derive(Debug)]
pub struct SecondCore(());

impl SecondCore {
    /// Starts core 1, whatever it was doing. `None` when it does not answer; then it is held in
    /// reset.
    pub fn start(_: Peri<'static, CORE1>) -> Option<Self> {
        let until_us = time_us() + PATIENCE_US;
        PSM.frce_off().modify(|w| w.set_proc1(true));
        while !PSM.frce_off().read().proc1() {}
        stack::paint(stack());
        WORK.store(ptr::without_provenance_mut(1), Ordering::Relaxed); // it does not answer yet
        PSM.frce_off().modify(|w| w.set_proc1(false));
        if launch(until_us) && is_in_time(until_us, || WORK.load(Ordering::Acquire).is_null()) {
            return Some(Self(()));
        }
        PSM.frce_off().modify(|w| w.set_proc1(true));
        None
    }
}

impl Cores for SecondCore {
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
        let mut work = Work(there); // lent for this call, whatever the type of WORK says
        WORK.store((&raw mut work).cast(), Ordering::Release);
        send_event();
        here();
        while !WORK.load(Ordering::Acquire).is_null() {
            cortex_m::asm::wfe(); // an interrupt ends it, too
        }
    }
}

/// The stack of core 1's work.
pub(crate) fn stack() -> Range<usize> {
    (&raw const _second_stack_end).addr()..(&raw const _second_program_stack_start).addr()
}

/// Is this core 0?
pub(crate) fn is_first() -> bool {
    SIO.cpuid().read() == 0
}

/// Gives the boot ROM of core 1 what it starts with, word by word, each answered by itself. After a
/// wrong answer it is given the first one again.
fn launch(until_us: u64) -> bool {
    // SAFETY: a read of a register that does not change.
    let vectors = unsafe { (*SCB::PTR).vtor.read() };
    let stack = (&raw const _second_stack_start).addr() as u32;
    let words = [0, 0, 1, vectors, stack, enter as *const () as u32];
    let mut rest = &words[..];
    while let [word, others @ ..] = rest {
        if *word == 0 {
            while SIO.fifo().st().read().vld() {
                let _ = SIO.fifo().rd().read(); // answers to what came before
            }
            send_event();
        }
        SIO.fifo().wr().write_value(*word); // it is empty: the last word was answered
        send_event();
        if !is_in_time(until_us, || SIO.fifo().st().read().vld()) {
            return false;
        }
        rest = if SIO.fifo().rd().read() == *word { others } else { &words };
    }
    true
}

/// Waits for a condition, at most until this time, microseconds. Does it hold?
fn is_in_time(until_us: u64, condition: impl Fn() -> bool) -> bool {
    while time_us() < until_us {
        if condition() {
            return true;
        }
    }
    false
}

/// Wakes both cores, behind all that was stored.
#[inline(always)] // core 1 executes it in RAM
fn send_event() {
    cortex_m::asm::dsb();
    cortex_m::asm::sev();
}

/// First code of core 1: sets its stacks and their limits, and enables the FPU, whose registers any
/// function may use.
extern "C" fn enter() -> ! {
    /// Full access to coprocessors 10 and 11 in CPACR.
    const FPU: u32 = 0b1111 << 20;
    let Range { start, end } = stack();
    // SAFETY: nobody else uses these stacks, what lies on the boot ROM's is never returned to, and
    // the registers are this core's own.
    unsafe {
        asm!(
            "str {fpu}, [{cpacr}]",
            "msr psplim, {start}",
            "msr msplim, {end}",
            "msr psp, {end}",
            "msr control, {use_psp}",
            "dsb",
            "isb",
            "bx {serve}",
            fpu = in(reg) FPU,
            cpacr = in(reg) &raw const (*SCB::PTR).cpacr,
            start = in(reg) start,
            end = in(reg) end,
            use_psp = in(reg) 2,
            serve = in(reg) serve,
            options(noreturn),
        );
    }
}

/// Does what it is given, for ever. In RAM, for the time in which there is no flash.
// SAFETY: the section holds data that are copied to RAM before the program starts.
#[unsafe(link_section = ".data.second_core")]
#[inline(never)]
extern "C" fn serve() -> ! {
    loop {
        WORK.store(ptr::null_mut(), Ordering::Release); // done; the first time, it has started
        send_event();
        let work = loop {
            let work = WORK.load(Ordering::Acquire);
            if !work.is_null() {
                break work;
            }
            cortex_m::asm::wfe();
        };
        // SAFETY: core 0 has put it there, and neither touches it nor lets its borrow end before
        // WORK is null again.
        unsafe { ((*work).0)() };
    }
}
