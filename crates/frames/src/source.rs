//! Pairs that are in no image files of their own: messages of a recording, frames of a video or a
//! camera.

use crate::error::FrameError;
use crate::grey::StoredGray;
use crate::layout::Layout;
use core::fmt::Debug;
use std::path::Path;

/// Both views of a pair.
#[derive(Clone, Debug)]
pub enum Views<T> {
    /// Side by side in one image.
    Both(T),
    /// The left and the right one.
    Two([T; 2]),
}

/// A pair of a recording or a video. Its images are read when it is loaded.
pub trait PairSource: Debug + Send + Sync {
    /// Kind of pair.
    fn layout(&self) -> Layout;

    /// The files, left first; one that holds both views is given twice.
    fn paths(&self) -> [&Path; 2];

    /// When both images were captured, us, where that is known of each.
    fn times_us(&self) -> Option<[u64; 2]>;

    /// When the left image was captured, ns.
    fn time_ns(&self) -> Option<u64>;

    /// The images.
    ///
    /// # Errors
    /// Where the file ends, is damaged, or holds something else.
    fn grey(&self) -> Result<Views<StoredGray>, FrameError>;
}
