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

pub use pair::{Background, PastedPair, Pole};
pub use poles::composite;
pub use refused::Refused;
pub use score::{Judged, Rows, Said, Told, Toll, judge};
