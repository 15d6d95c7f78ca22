//! Damaged records: every one is named and counted, none becomes another record, and the next good
//! one is received.

use crate::support::*;
use linestereo_wire::*;

/// A packet of three segments, another, and what the decoder must not take them for.
fn example() -> (Message, Message, Vec<u8>, Vec<u8>) {
    let mut random = Random(11);
    let list = (0..3).map(|_| any_match(&mut random)).collect();
    let first = Message::Segments(Segments { sequence: 77, first: 16, list });
    let second = Message::Frame(head(78, 3));
    let (first_packet, second_packet) = (packet(&first), packet(&second));
    (first, second, first_packet, second_packet)
}

/// The packet with one bit of it flipped.
fn flipped(good: &[u8], bit: usize) -> Vec<u8> {
    let mut damaged = good.to_vec();
    damaged[bit / 8] ^= 1 << (bit % 8);
    damaged
}

#[test]
fn a_flipped_bit_costs_its_packet_and_no_other() {
    let mut random = Random(12);
    let full: heapless::Vec<_, SEGMENTS_PER_PACKET> =
        (0..SEGMENTS_PER_PACKET).map(|_| any_match(&mut random)).collect();
    let mut messages = messages();
    messages.push(Message::Segments(Segments { sequence: 1, first: 0, list: full }));
    let next = Message::Frame(head(1, 0));
    let next_packet = packet(&next);
    for message in messages {
        let good = packet(&message);
        for bit in 0..8 * (good.len() - 1) {
            let damaged = [flipped(&good, bit), next_packet.clone()].concat();
            let (results, counters) = decode::<Message>(&damaged);
            let (last, before) = results.split_last().unwrap();
            assert_eq!(last, &Ok(next.clone()), "bit {bit} of {message:?}");
            assert!(before.iter().all(Result::is_err), "bit {bit} of {message:?}: {before:?}");
            let empty = u64::from(damaged[0] == DELIMITER)
                + damaged.windows(2).filter(|pair| *pair == [0, 0]).count() as u64;
            assert_eq!(
                (counters.good, counters.skipped_bytes + empty),
                (1, good.len() as u64),
                "bit {bit} of {message:?}"
            );
            assert_eq!(counters.bad() as usize, before.len());
        }
        // A damaged delimiter joins two packets: both are lost, the third is received.
        for bit in 8 * (good.len() - 1)..8 * good.len() {
            let damaged = [&flipped(&good, bit)[..], &next_packet, &next_packet].concat();
            let (results, counters) = decode::<Message>(&damaged);
            assert!(matches!(&results[..], [Err(_), Ok(last)] if *last == next), "{results:?}");
            assert_eq!((counters.good, counters.bad()), (1, 1));
        }
    }
    for command in commands() {
        let good = packet(&command);
        for bit in 0..8 * (good.len() - 1) {
            let results = decode::<Command>(&flipped(&good, bit)).0;
            assert!(results.iter().all(Result::is_err), "bit {bit} of {command:?}");
        }
    }
}

#[test]
fn a_packet_cut_anywhere_is_one_error() {
    let (_, second, first, next) = example();
    for length in 1..first.len() - 1 {
        for missing_at_start in [false, true] {
            let piece = if missing_at_start {
                &first[first.len() - 1 - length..first.len() - 1]
            } else {
                &first[..length]
            };
            let stream = [piece, &[DELIMITER], &next].concat();
            let (results, counters) = decode::<Message>(&stream);
            assert!(
                matches!(&results[..], [Err(_), Ok(good)] if *good == second),
                "{length}: {results:?}"
            );
            assert_eq!(
                (counters.good, counters.bad(), counters.skipped_bytes),
                (1, 1, length as u64 + 1)
            );

            // Without a delimiter it takes the next packet with it, never the one after.
            let (results, _) = decode::<Message>(&[piece, &next, &next].concat());
            assert!(
                matches!(&results[..], [Err(_), Ok(good)] if *good == second),
                "{length}: {results:?}"
            );
        }
    }
}

#[test]
fn an_end_in_the_middle_of_a_packet_is_counted() {
    let (first, _, bytes, _) = example();
    for length in 0..bytes.len() {
        let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
        assert!(bytes[..length].iter().all(|&byte| decoder.push(byte).is_none()));
        let expected = (length > 0).then_some(DecodeError::Cobs);
        assert_eq!(decoder.finish(), expected, "{length}");
        assert_eq!(decoder.finish(), None, "it is counted once");
        assert_eq!(
            (decoder.counters().cobs, decoder.counters().skipped_bytes),
            (u32::from(length > 0), length as u64)
        );
        let results: Vec<_> = bytes.iter().filter_map(|&byte| decoder.push(byte)).collect();
        assert_eq!(results, [Ok(first.clone())], "the decoder starts afresh");
    }
}

#[test]
fn garbage_eats_only_what_shares_its_delimiter() {
    let mut random = Random(13);
    let mut stream = Vec::new();
    let mut sent = Vec::new();
    let mut expected = Vec::new();
    let mut garbage_bytes = 0;
    while garbage_bytes < 100_000 {
        let clean_end = stream.last().is_none_or(|&byte| byte == DELIMITER);
        for place in 0..1 + random.below(3) {
            let list = (0..random.below(SEGMENTS_PER_PACKET + 1)).map(|_| any_match(&mut random));
            let list = list.collect();
            let message =
                Message::Segments(Segments { sequence: sent.len() as u32, first: 0, list });
            if clean_end || place > 0 {
                expected.push(message.clone());
            }
            stream.extend(packet(&message));
            sent.push(message);
        }
        for _ in 0..random.below(1200) {
            stream.push(random.byte());
            garbage_bytes += 1;
        }
    }
    let (results, counters) = decode::<Message>(&stream);
    let received: Vec<Message> = results.iter().filter_map(|result| result.clone().ok()).collect();
    assert!(expected.len() > 100 && expected.len() + 100 < sent.len(), "both cases occur");
    assert_eq!(received, expected);
    assert_eq!(counters.good as usize, expected.len());
    assert_eq!(counters.bad() as usize, results.len() - expected.len());
    assert!(
        counters.checksum > 0 && counters.cobs > 0 && counters.too_long > 0,
        "every kind occurs: {counters:?}"
    );
}

#[test]
fn constant_lines_are_no_records() {
    let (first, _, bytes, _) = example();
    let zeros = [&[0; 100_000][..], &bytes].concat();
    let (results, counters) = decode::<Message>(&zeros);
    assert_eq!((results, counters.bad(), counters.skipped_bytes), (vec![Ok(first.clone())], 0, 0));

    for constant in [0xff, 0x01, 0x55] {
        let stream = [&[constant; 100_000][..], &[DELIMITER], &bytes].concat();
        let (results, counters) = decode::<Message>(&stream);
        assert_eq!(results, [Err(DecodeError::TooLong), Ok(first.clone())], "{constant}");
        assert_eq!((counters.too_long, counters.bad(), counters.skipped_bytes), (1, 1, 100_001));
    }
    let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
    assert!((0..100_000).all(|_| decoder.push(0xff).is_none()));
    assert_eq!(decoder.finish(), Some(DecodeError::TooLong));
}

/// COBS and a right checksum around any payload.
fn enclose(payload: &[u8]) -> Vec<u8> {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload);
    let whole = [payload, &crc.to_le_bytes()].concat();
    let mut bytes = vec![0; cobs::max_encoding_length(whole.len())];
    let length = cobs::encode(&whole, &mut bytes);
    bytes.truncate(length);
    bytes.push(DELIMITER);
    bytes
}

#[test]
fn another_version_is_named() {
    let (first, _, bytes, _) = example();
    for found in (0..=u8::MAX).filter(|&found| found != VERSION) {
        for rest in [&[][..], &[1, 2, 3], &[0; 300]] {
            let stream = [enclose(&[&[found][..], rest].concat()), bytes.clone()].concat();
            let (results, counters) = decode::<Message>(&stream);
            assert_eq!(results, [Err(DecodeError::Version { found }), Ok(first.clone())]);
            assert_eq!((counters.other_version, counters.bad()), (1, 1));
        }
    }
    let text = |found| DecodeError::Version { found }.to_string();
    assert_eq!(
        text(1),
        "the packet goes from a board and has version 1, this program has version 8"
    );
}

#[test]
fn an_echo_is_no_answer() {
    for command in commands() {
        let results = decode::<Message>(&packet(&command)).0;
        assert_eq!(results, [Err(DecodeError::Version { found: VERSION | 0x80 })]);
    }
    for message in messages() {
        let results = decode::<Command>(&packet(&message)).0;
        assert_eq!(results, [Err(DecodeError::Version { found: VERSION })]);
    }
}

#[test]
fn whole_packets_without_a_record_are_malformed() {
    let (first, _, bytes, _) = example();
    let mut long_list = vec![VERSION, 2, 1, 0, SEGMENTS_PER_PACKET as u8 + 1];
    long_list.extend([0; 15 * (SEGMENTS_PER_PACKET + 1)]);
    let cases: [&[u8]; 10] = [
        &[],
        &[VERSION],
        &[VERSION, 4],                                     // no such message
        &[VERSION, 3, 1, 2],                               // no such outcome
        &[VERSION, 3, 1, 0, 0],                            // one byte too many
        &[VERSION, 0, 1, 0xff, 1, 1, 1],                   // a name that is not UTF-8
        &[VERSION, 0, 33, 1, 1, 1],                        // a name longer than the packet
        &[VERSION, 3, 0xff, 0xff, 0x7f, 0],                // a number that does not fit 16 bits
        &[VERSION, 2, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 3], // no such owner
        &long_list,
    ];
    for payload in cases {
        let stream = [enclose(payload), bytes.clone()].concat();
        let (results, counters) = decode::<Message>(&stream);
        assert_eq!(results, [Err(DecodeError::Malformed), Ok(first.clone())], "{payload:?}");
        assert_eq!((counters.malformed, counters.bad()), (1, 1));
    }
}

#[test]
fn a_decoder_with_too_little_memory_says_so() {
    let (_, _, bytes, _) = example();
    let mut decoder: Decoder<Message, 32> = Decoder::new();
    let results: Vec<_> = [&bytes[..], &packet(&commands()[0])]
        .concat()
        .iter()
        .filter_map(|&b| decoder.push(b))
        .collect();
    assert_eq!(
        results,
        [Err(DecodeError::TooLong), Err(DecodeError::Version { found: VERSION | 0x80 })]
    );
}
