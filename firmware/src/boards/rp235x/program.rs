//! Programs of the state machines of a PIO block for a camera's wires.
//!
//! In: four data wires, PCLKO, LVLD and FVLD of one HM01B0 on pins that follow each other
//! ([`Wire`]). Out: of every row its pixels and, behind them, how many nibbles it had; a flag when
//! a frame starts and one when it ends.
//!
//! ```text
//! rows    idle   wait for a falling edge of PCLKO; LVLD low: idle
//!         first  count = 0
//!         nibble take D3 .. D0 (the lower half of a pixel comes first: HM01B0's OSC_CLK_DIV,
//!             bit 4, is 0), count one more
//!                wait for the next falling edge of PCLKO; LVLD high: nibble
//!                behind the row: a word with the count, as `!count`; idle
//! frames  wait for FVLD high: flag "start";  wait for FVLD low: flag "end"
//! ```
//! A row that is shorter or longer than it should be puts the word with the count in another slot
//! or another count in it, so that the row is known to be bad however late anybody looks at it
//! ([`nibbles`]). LVLD is looked at where the pixels are: at the falling edge of PCLKO.
//!
//! # Bounds
//! Sampled 3 cycles or less after the edge is seen (2 more cycles: the synchroniser); data stay for
//! half a period of PCLKO, 12 cycles at 6 MHz and 150 MHz.
//!
//! # Source
//! RP2350 datasheet, 11.4 (instruction set), 11.5.4 (autopush), 11.5.6 (input synchronisers).
//! `firmware/tests/pio.rs` runs these words.

/// A camera's wires, counted from its first pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Wire {
    /// D0, the first of four.
    Data = 0,
    /// PCLKO: data are valid at its falling edge.
    PixelClock = 4,
    /// LVLD: high while pixels of a row are sent.
    LineValid = 5,
    /// FVLD: high during a frame.
    FrameValid = 6,
}

impl Wire {
    /// Wires of a camera.
    pub const COUNT: u8 = 7;
}

/// A program in a PIO block's memory; addresses are relative to its start.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// Its instructions.
    pub words: &'static [u16],
    /// Where it starts, and goes on after its last instruction.
    pub wrap_target: u8,
}

/// Takes the rows of one camera. LVLD is its pin for `jmp pin`; it shifts to the right and pushes
/// every 32 bits.
pub const ROWS: Program = Program { words: &ROW_WORDS, wrap_target: IDLE };

const FIRST: u8 = 0;
const NIBBLE: u8 = 1;
const NEXT: u8 = 3;
const IDLE: u8 = 7;

const ROW_WORDS: [u16; 10] = [
    mov_x_not_null(),             // first:  count = 0
    in_pins(4),                   // nibble: four bits
    jmp_x_dec(NEXT), //         one more; never zero, goes on to the next instruction either way
    wait(true, Wire::PixelClock), // next:
    wait(false, Wire::PixelClock),
    jmp_pin(NIBBLE),              //         the row goes on
    in_x(32),                     //         its count
    wait(true, Wire::PixelClock), // idle:
    wait(false, Wire::PixelClock),
    jmp_pin(FIRST),
];

/// Says when frames of one camera start and end. On state machine 1 the flags are 0 and 1, on state
/// machine 3 they are 2 and 3.
pub const FRAMES: Program = Program { words: &FRAME_WORDS, wrap_target: 0 };

const FRAME_WORDS: [u16; 4] =
    [wait(true, Wire::FrameValid), irq_relative(3), wait(false, Wire::FrameValid), irq_relative(0)];

/// Nibbles of a row, by the word behind it.
pub const fn nibbles(word: u32) -> u32 {
    !word
}

/// 11.4.2, condition 110.
const fn jmp_pin(to: u8) -> u16 {
    0b110 << 5 | to as u16
}

/// 11.4.2, condition 010.
const fn jmp_x_dec(to: u8) -> u16 {
    0b010 << 5 | to as u16
}

/// 11.4.3, source 01: a pin counted from the first one.
const fn wait(is_high: bool, wire: Wire) -> u16 {
    0b001 << 13 | (is_high as u16) << 7 | 0b01 << 5 | wire as u16
}

/// 11.4.4, source 000.
const fn in_pins(bits: u16) -> u16 {
    0b010 << 13 | bits & 31
}

/// 11.4.4, source 001; 32 bits are written as 0.
const fn in_x(bits: u16) -> u16 {
    0b010 << 13 | 0b001 << 5 | bits & 31
}

/// 11.4.10: to X (001), inverted (01), from NULL (011).
const fn mov_x_not_null() -> u16 {
    0b101 << 13 | 0b001 << 5 | 0b01 << 3 | 0b011
}

/// 11.4.11, index mode 10: the number of the state machine is added to the lower two bits.
const fn irq_relative(flag: u16) -> u16 {
    0b110 << 13 | 0b10 << 3 | flag
}
