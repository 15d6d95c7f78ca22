//! Damaged pairs: what a lens, a cable, a sensor, a mount or a scene does to a pair, by name and
//! strength, and what is answered of it.
//!
//! ```text
//! damage     the pair before, and every damage of the bench with its family
//! sensor     the same thing at the same pixel of both images; noise; single lines
//! geometry   images that moved: rows, rotation, focal length, shutter, a tear
//! detail     less detail than there was: compression, grey levels, blur, fog
//! texture    repetition painted on objects, at their true disparity
//! score      answers of a damaged pair against the truth, pooled by damage and over all
//! ```

mod damage;
mod detail;
mod geometry;
mod score;
mod sensor;
mod texture;

pub use damage::{Damage, Source};
pub(crate) use damage::{Evidence, Family};
pub(crate) use score::{FaultReport, Tally, is_asked, score};
