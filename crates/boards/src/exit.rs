//! How programs end, in numbers that a simulator and a host understand.

/// How a program ends; the number is the exit code of the simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Exit {
    /// All is well.
    Success = 0,
    /// A result is not what it should be.
    Difference = 1,
    /// The command line or a file cannot be used.
    Usage = 2,
    /// The code panicked.
    Panic = 101,
    /// The processor refused an instruction or an address.
    Fault = 102,
    /// The stack grew out of its memory.
    StackOverflow = 103,
}

impl Exit {
    /// Every way to end.
    pub const ALL: [Self; 6] = [
        Self::Success,
        Self::Difference,
        Self::Usage,
        Self::Panic,
        Self::Fault,
        Self::StackOverflow,
    ];

    /// Meaning of this exit code.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Success => "all is well",
            Self::Difference => "a result is not what it should be",
            Self::Usage => "its command line or a file cannot be used",
            Self::Panic => "it panicked",
            Self::Fault => "the processor refused an instruction or an address",
            Self::StackOverflow => "the stack grew out of its memory",
        }
    }
}
