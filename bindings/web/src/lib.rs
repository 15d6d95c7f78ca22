//! Image files and pixels of a camera -> the grey images of a pair, for the page: the PC program's
//! own conversion, compiled for browsers.
//!
//! ```text
//! room         memory for the bytes that come next
//! add_file, add_pixels   an image of them; twice for two files, once for both side by side
//! pair         two grey images of one size, reduced to a width
//! ```
//!
//! A function that returns `false` has a reason. The module has its own memory: the page drops it
//! with all images, and after a decoder's panic.

mod file;

use linestereo::Dims;
use linestereo_frames::grey::{StoredGray, Values, luma};
use linestereo_frames::{GrayImage, WidthError, area_average, halves};
use std::cell::RefCell;

/// Most bytes of an image, as stored and as decoded, and most pixels: those of `docs/security.md`.
const IMAGE_BYTES: usize = 128 << 20;
const PIXELS: u64 = 1 << 25;

#[derive(Default)]
struct State {
    room: Vec<u8>,
    added: Vec<StoredGray>,
    pair: Option<[GrayImage; 2]>,
    /// Width of the pair before it was reduced, px.
    full_width: u16,
    reason: String,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

fn with<T>(work: impl FnOnce(&mut State) -> T) -> T {
    STATE.with_borrow_mut(work)
}

/// Does work that may be refused.
fn done(work: impl FnOnce(&mut State) -> Result<(), String>) -> bool {
    with(|state| work(state).map_err(|reason| state.reason = reason).is_ok())
}

/// Memory for so many bytes; null for more than are read.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    if bytes > IMAGE_BYTES {
        return core::ptr::null_mut();
    }
    with(|state| {
        state.room.clear();
        state.room.resize(bytes, 0);
        state.room.as_mut_ptr()
    })
}

/// Adds the image file in the room.
#[unsafe(no_mangle)]
pub extern "C" fn add_file() -> bool {
    done(|state| {
        let image = file::read(&core::mem::take(&mut state.room))?;
        state.added.push(image);
        Ok(())
    })
}

/// Adds the pixels in the room, 8-bit red, green, blue and something else each.
#[unsafe(no_mangle)]
pub extern "C" fn add_pixels(width: u32, height: u32) -> bool {
    done(|state| {
        let dims = dims_of(width, height)?;
        let (pixels, _) = state.room.as_chunks::<4>();
        let values: Vec<u8> = pixels
            .iter()
            .map(|&[red, green, blue, _]| luma([red, green, blue].map(u32::from)) as u8)
            .collect();
        if values.len() != usize::from(dims.width) * usize::from(dims.height) {
            return Err("the pixels are not of this size".to_owned());
        }
        state.added.push(StoredGray { dims, values: Values::Eight(values) });
        Ok(())
    })
}

/// Makes a pair of what was added since the last one; a width of 0 reduces nothing. One image is
/// cut in two where that is said, or where it is at least twice as wide as high.
#[unsafe(no_mangle)]
pub extern "C" fn pair(width: u32, holds_both: bool) -> bool {
    done(|state| {
        let added = core::mem::take(&mut state.added);
        let bits = added.iter().map(StoredGray::bits).max().unwrap_or(8);
        let mut grey = added.into_iter().map(|image| image.into_8_bit(bits));
        let [left, right] = match [grey.next(), grey.next()] {
            [Some(left), Some(right)] => [left, right],
            [Some(both), _] if holds_both || both.dims.width / 2 >= both.dims.height => {
                halves(&both)
            }
            [Some(GrayImage { dims, .. }), _] => {
                return Err(format!(
                    "one image of {dims} is no pair; give the other one too, or say that it holds both"
                ));
            }
            _ => return Err("give two images, or one with both side by side".to_owned()),
        };
        if left.dims != right.dims {
            let [left, right] = [left.dims, right.dims];
            return Err(format!(
                "the left image is {left} but the right one is {right}; give two images of one size"
            ));
        }
        state.full_width = left.dims.width;
        let width =
            if width == 0 { left.dims.width } else { u16::try_from(width).unwrap_or(u16::MAX) };
        let reduced = |image| {
            area_average(image, width).map_err(|WidthError { have, asked }| {
            format!("a width of {asked} px is not between 1 and the image's {have}; images are only ever reduced")
        })
        };
        state.pair = Some([reduced(&left)?, reduced(&right)?]);
        Ok(())
    })
}

/// Pixels of the pair's left (0) or right image.
#[unsafe(no_mangle)]
pub extern "C" fn pixels(side: usize) -> *const u8 {
    let image = |state: &State| state.pair.as_ref()?.get(side).map(|image| image.pixels.as_ptr());
    with(|state| image(state)).unwrap_or(core::ptr::null())
}

/// Width of the pair, px.
#[unsafe(no_mangle)]
pub extern "C" fn width() -> u32 {
    with(|state| state.pair.as_ref().map_or(0, |[left, _]| left.dims.width.into()))
}

/// Its width before it was reduced, px.
#[unsafe(no_mangle)]
pub extern "C" fn full_width() -> u32 {
    with(|state| state.full_width.into())
}

/// Height of the pair, px.
#[unsafe(no_mangle)]
pub extern "C" fn height() -> u32 {
    with(|state| state.pair.as_ref().map_or(0, |[left, _]| left.dims.height.into()))
}

/// Text of the last refusal, UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn reason() -> *const u8 {
    with(|state| state.reason.as_ptr())
}

/// Its length.
#[unsafe(no_mangle)]
pub extern "C" fn reason_bytes() -> usize {
    with(|state| state.reason.len())
}

/// Width and height within what is read.
fn dims_of(width: u32, height: u32) -> Result<Dims, String> {
    match (u16::try_from(width), u16::try_from(height)) {
        (Ok(width), Ok(height)) if u64::from(width) * u64::from(height) <= PIXELS => {
            Ok(Dims { width, height })
        }
        _ => {
            Err("an image of more than 33 million pixels is not read; give a smaller one"
                .to_owned())
        }
    }
}
