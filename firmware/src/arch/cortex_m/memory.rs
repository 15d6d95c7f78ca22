//! Copies and fills memory, by the names that the compiler calls them (Run-time ABI for the Arm
//! Architecture, 2024Q3, 5.3.2).
//!
//! Those that come with Rust are compiled for any processor: 2.1 KB and up to 1.2 instructions a
//! byte. These take 0.25 to 0.65, and 228 bytes; the linker prefers them, since Rust's are weak.
//!
//! ```text
//! copy   sixteen bytes a round: by LDM and STM where both addresses are words', else by single
//!        words
//! fill   the first word as it comes, then sixteen bytes a round from a word's address on
//! rest   eight, four, two bytes and one, each by a bit of the length
//! ```
//!
//! # Bounds
//! Words at any address are loaded and stored, which Armv7-M and Armv8-M Mainline allow in normal
//! memory alone. An end in device memory has to begin at a word: from there on every access to it
//! is aligned. The RP2350's USB driver copies packets so, whose buffers begin at 64 bytes.

use core::arch::global_asm;

global_asm!(
    ".syntax unified",
    ".thumb",
    ".macro function name",
    ".global \\name",
    ".type \\name, %function",
    ".thumb_func",
    "\\name:",
    ".endm",
    ".section .text.memory_copy, \"ax\", %progbits",
    ".balign 4",
    "function memcpy",
    "function __aeabi_memcpy",
    "function __aeabi_memcpy4",
    "function __aeabi_memcpy8",
    // r0: to, and the result; r1: from; r2: bytes.
    "mov r12, r0",
    "subs r2, r2, #16",
    "blo 4f",
    "orr r3, r0, r1",
    "lsls r3, r3, #30",
    "bne 3f",
    "push {{r4, r5, r6, lr}}",
    "2:",
    "ldm r1!, {{r3, r4, r5, r6}}",
    "stm r12!, {{r3, r4, r5, r6}}",
    "subs r2, r2, #16",
    "bhs 2b",
    "pop {{r4, r5, r6, lr}}",
    "b 4f",
    "3:",
    "ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "subs r2, r2, #16",
    "bhs 3b",
    "4:",               // fewer than sixteen: the low four bits, with sixteen taken off or not
    "lsls r3, r2, #28", // mostly none
    "it eq",
    "bxeq lr",
    "lsls r3, r2, #29", // carry: eight; negative: four
    "itttt cs",
    "ldrcs r3, [r1], #4",
    "strcs r3, [r12], #4",
    "ldrcs r3, [r1], #4",
    "strcs r3, [r12], #4",
    "itt mi",
    "ldrmi r3, [r1], #4",
    "strmi r3, [r12], #4",
    "lsls r3, r2, #31", // carry: two; negative: one
    "itt cs",
    "ldrhcs r3, [r1], #2",
    "strhcs r3, [r12], #2",
    "itt mi",
    "ldrbmi r3, [r1]",
    "strbmi r3, [r12]",
    "bx lr",
    ".size memcpy, . - memcpy",
    ".section .text.memory_fill, \"ax\", %progbits",
    ".balign 4",
    "function memset", // length and byte the other way round
    "mov r3, r1",
    "mov r1, r2",
    "mov r2, r3",
    "b 1f",
    "function __aeabi_memclr",
    "function __aeabi_memclr4",
    "function __aeabi_memclr8",
    "movs r2, #0",
    "function __aeabi_memset",
    "function __aeabi_memset4",
    "function __aeabi_memset8",
    // r0: to, and the result; r1: bytes; r2: the byte.
    "1:",
    "uxtb r2, r2",
    "orr r2, r2, r2, lsl #8",
    "orr r2, r2, r2, lsl #16",
    "mov r12, r0",
    "subs r1, r1, #16",
    "blo 3f",
    "ands r3, r0, #3",
    "beq 2f",
    "rsb r3, r3, #4",
    "str r2, [r12]",
    "add r12, r12, r3",
    "subs r1, r1, r3",
    "blo 3f",
    "2:",
    "strd r2, r2, [r12], #8",
    "strd r2, r2, [r12], #8",
    "subs r1, r1, #16",
    "bhs 2b",
    "3:", // fewer than sixteen: the low four bits
    "lsls r3, r1, #28",
    "it eq",
    "bxeq lr",
    "lsls r3, r1, #29",
    "itt cs",
    "strcs r2, [r12], #4",
    "strcs r2, [r12], #4",
    "it mi",
    "strmi r2, [r12], #4",
    "lsls r3, r1, #31",
    "it cs",
    "strhcs r2, [r12], #2",
    "it mi",
    "strbmi r2, [r12]",
    "bx lr",
    ".size memset, . - memset",
    ".purgem function",
);
