//! Common Data Representation: four bytes that tell the byte order, then each value at a multiple of its size.
//!
//! # Source
//! OMG CDR 1.1 (`PLAIN_CDR`), as ROS 2 writes it. Read in both byte orders, written little endian.

/// Bytes before the first value.
const HEAD: [u8; 4] = [0, LITTLE_ENDIAN, 0, 0];
const LITTLE_ENDIAN: u8 = 1;

/// Values of a message that was received; `None` where it ends early.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    /// Behind the head.
    bytes: &'a [u8],
    at: usize,
    is_little: bool,
}

impl<'a> Reader<'a> {
    /// `None` where it is encoded in another way.
    #[must_use]
    pub fn new(message: &'a [u8]) -> Option<Self> {
        let (head, bytes) = message.split_at_checked(HEAD.len())?;
        (head[0] == 0 && head[1] <= LITTLE_ENDIAN).then_some(Self { bytes, at: 0, is_little: head[1] == LITTLE_ENDIAN })
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.bytes.get(self.at..)?.get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// Bytes of a number, the least significant one first.
    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.at = self.at.checked_next_multiple_of(N)?;
        let mut bytes: [u8; N] = self.take(N)?.try_into().ok()?;
        if !self.is_little {
            bytes.reverse();
        }
        Some(bytes)
    }

    /// A byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.number().map(u8::from_le_bytes)
    }

    /// A number of 32 bits.
    pub fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    /// A signed number of 32 bits.
    pub fn i32(&mut self) -> Option<i32> {
        self.number().map(i32::from_le_bytes)
    }

    /// A number of double precision.
    pub fn f64(&mut self) -> Option<f64> {
        self.number().map(f64::from_le_bytes)
    }

    /// So many of them.
    pub fn f64s<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64()?;
        }
        Some(values)
    }

    /// A list of bytes.
    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let count = self.u32()?;
        self.take(usize::try_from(count).ok()?)
    }

    /// A text, which ends in a zero.
    pub fn text(&mut self) -> Option<&'a str> {
        let bytes = self.bytes()?;
        core::str::from_utf8(bytes.strip_suffix(&[0]).unwrap_or(bytes)).ok()
    }
}

/// A message that is sent.
#[derive(Clone, Debug)]
pub struct Writer(Vec<u8>);

impl Default for Writer {
    fn default() -> Self {
        Self(HEAD.to_vec())
    }
}

impl Writer {
    /// Its bytes.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        self.0
    }

    fn number<const N: usize>(&mut self, bytes: [u8; N]) {
        let length = (self.0.len() - HEAD.len()).next_multiple_of(N) + HEAD.len();
        self.0.resize(length, 0);
        self.0.extend(bytes);
    }

    /// A byte, or a truth value.
    pub fn u8(&mut self, value: u8) {
        self.number([value]);
    }

    /// A number of 32 bits.
    pub fn u32(&mut self, value: u32) {
        self.number(value.to_le_bytes());
    }

    /// A signed number of 32 bits.
    pub fn i32(&mut self, value: i32) {
        self.number(value.to_le_bytes());
    }

    /// Numbers of single precision.
    pub fn f32s(&mut self, values: &[f32]) {
        values.iter().for_each(|value| self.number(value.to_le_bytes()));
    }

    /// Numbers of double precision.
    pub fn f64s(&mut self, values: &[f64]) {
        values.iter().for_each(|value| self.number(value.to_le_bytes()));
    }

    /// Length of a list.
    pub fn count(&mut self, count: usize) {
        self.u32(count as u32);
    }

    /// A list of bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len());
        self.0.extend(bytes);
    }

    /// A text.
    pub fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_at_multiples_of_their_size() {
        let mut writer = Writer::default();
        writer.text("ab");
        writer.f64s(&[1.0]);
        writer.u8(7);
        writer.u32(9);
        writer.bytes(&[1, 2]);
        let bytes = writer.finish();
        let expected = [
            &[0, 1, 0, 0][..],
            &[3, 0, 0, 0, b'a', b'b', 0, 0],
            &1_f64.to_le_bytes(),
            &[7, 0, 0, 0, 9, 0, 0, 0, 2, 0, 0, 0, 1, 2],
        ];
        assert_eq!(bytes, expected.concat());
        let mut reader = Reader::new(&bytes).unwrap();
        assert_eq!((reader.text(), reader.f64(), reader.u8()), (Some("ab"), Some(1.0), Some(7)));
        assert_eq!((reader.u32(), reader.bytes(), reader.u8()), (Some(9), Some(&[1, 2][..]), None));
    }

    #[test]
    fn the_other_byte_order_is_read_too() {
        let bytes = [0, 0, 0, 0, 0, 0, 1, 2, 0xff, 0xff, 0xff, 0xfe];
        let mut reader = Reader::new(&bytes).unwrap();
        assert_eq!((reader.u32(), reader.i32()), (Some(258), Some(-2)));
        assert!(Reader::new(&[0, 7, 0, 0]).is_none());
    }
}
