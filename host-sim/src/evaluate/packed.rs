//! Lists of floats in JSON that gives back the same bits: parts of a large evaluation are merged exactly.
//!
//! Decimal numbers need not come back as they went; a list is its floats' bytes, little endian, in base64. For `#[serde(with = "packed")]`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Deserializer, Serializer, de::Error};

/// Values that are stored as a fixed number of floats.
pub(super) trait Floats<const N: usize>: Copy {
    fn to_floats(self) -> [f32; N];
    fn from_floats(floats: [f32; N]) -> Self;
}

impl Floats<1> for f32 {
    fn to_floats(self) -> [f32; 1] {
        [self]
    }

    fn from_floats([value]: [f32; 1]) -> Self {
        value
    }
}

pub(super) fn serialize<T: Floats<N>, const N: usize, S: Serializer>(
    list: &[T],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&packed(list.iter().flat_map(|item| item.to_floats())))
}

pub(super) fn deserialize<'de, T: Floats<N>, const N: usize, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    let values = unpacked(&String::deserialize(deserializer)?).map_err(D::Error::custom)?;
    let (items, rest) = values.as_chunks::<N>();
    if !rest.is_empty() {
        return Err(D::Error::custom("half a pair of numbers"));
    }
    Ok(items.iter().map(|&floats| T::from_floats(floats)).collect())
}

pub(super) fn packed(values: impl IntoIterator<Item = f32>) -> String {
    STANDARD.encode(values.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
}

pub(super) fn unpacked(text: &str) -> Result<Vec<f32>, &'static str> {
    let bytes = STANDARD.decode(text).map_err(|_| "a list of numbers is no base64")?;
    let (numbers, rest) = bytes.as_chunks::<4>();
    if !rest.is_empty() {
        return Err("a list of numbers ends inside one");
    }
    Ok(numbers.iter().map(|&number| f32::from_le_bytes(number)).collect())
}

/// A float as its bits.
pub(super) mod bits {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::evaluate) fn serialize<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
        value.map(f64::to_bits).serialize(serializer)
    }

    pub(in crate::evaluate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<f64>, D::Error> {
        Ok(Option::<u64>::deserialize(deserializer)?.map(f64::from_bits))
    }
}
