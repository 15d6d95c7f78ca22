//! Pipes between the program and the tasks of its ports. A pipe's buffer wraps, so that it takes
//! bytes in two pieces.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;

/// A pipe between the program and tasks in interrupts.
pub type Pipe<const N: usize> = embassy_sync::pipe::Pipe<CriticalSectionRawMutex, N>;

/// Puts in bytes for which there is room; of more, those that fit.
pub fn put<const N: usize>(pipe: &Pipe<N>, mut bytes: &[u8]) {
    while let Ok(count @ 1..) = pipe.try_write(bytes) {
        bytes = bytes.get(count..).unwrap_or_default();
    }
}

/// Puts in all bytes, and waits for the program where there is no room.
pub async fn put_all<const N: usize>(pipe: &Pipe<N>, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        let count = pipe.write(bytes).await;
        bytes = bytes.get(count..).unwrap_or_default();
    }
}
