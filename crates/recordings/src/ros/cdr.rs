//! Common Data Representation: four bytes that tell the byte order, then each value at a multiple
//! of its size. Read in both byte orders, written little endian.
//!
//! # Source
//! OMG CDR 1.1 (`PLAIN_CDR`), as ROS 2 writes it, by the crate `cdr-encoding`.

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::{from_bytes, to_writer};
use serde::{Deserialize, Serialize};
use std::io;

/// Reads a message; `None` where it ends early or is encoded in another way.
pub fn read<'a, T: Deserialize<'a>>(message: &'a [u8]) -> Option<T> {
    let read = match message.split_first_chunk()? {
        ([0, 0, _, _], values) => from_bytes::<_, BigEndian>(values),
        ([0, 1, _, _], values) => from_bytes::<_, LittleEndian>(values),
        _ => return None,
    };
    read.ok().map(|(message, _)| message)
}

/// The bytes of a message.
pub fn write(message: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut bytes = vec![0, 1, 0, 0];
    to_writer::<_, LittleEndian, _>(&mut bytes, message).map_err(io::Error::other)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_at_multiples_of_their_size() {
        let values = ("ab".to_owned(), [1.0], 7_u8, 9_u32, vec![1_u8, 2]);
        let expected = [
            &[0, 1, 0, 0][..],
            &[3, 0, 0, 0, b'a', b'b', 0, 0],
            &1_f64.to_le_bytes(),
            &[7, 0, 0, 0, 9, 0, 0, 0, 2, 0, 0, 0, 1, 2],
        ];
        let bytes = write(&values).unwrap();
        assert_eq!(bytes, expected.concat());
        assert_eq!(read(&bytes), Some(values));
        assert_eq!(read::<(String, [f64; 1], u8, u32, Vec<u8>)>(&bytes[..bytes.len() - 1]), None);
    }

    #[test]
    fn the_other_byte_order_is_read_too() {
        let bytes = [0, 0, 0, 0, 0, 0, 1, 2, 0xff, 0xff, 0xff, 0xfe];
        assert_eq!(read(&bytes), Some((258_u32, -2)));
        assert_eq!(read::<()>(&[0, 7, 0, 0]), None);
    }
}
