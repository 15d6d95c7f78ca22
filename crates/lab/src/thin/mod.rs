//! Thin things pasted into pairs with truth, and what is said of them.
//!
//! ```text
//! pair      both images as numbers, the truth, where something was pasted
//! walls     drawn backgrounds: blank, textured, striped, wallpaper
//! poles     poles 2 to 14 px wide, plain, striped or textured, upright or leaning, in front
//! refused   what has to be refused: fences, prints, shadows, cables, walls that repeat
//! score     rows of poles, masks, bars that are told, with bars and without
//! ```

mod pair;
mod poles;
mod refused;
mod score;
mod walls;

pub(crate) use pair::{Background, PastedPair};
pub(crate) use poles::composite;
pub(crate) use refused::Refused;
pub(crate) use score::{Judged, Rows, Said, Told, Toll, judge};
