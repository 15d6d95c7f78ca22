//! Messages of ROS 2 into a file that players seek in.

use ::mcap::WriteOptions;
use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{McapError, McapResult};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A file that is written, from its first byte to its last: it goes to pipes too.
pub struct Writer<W: Write>(::mcap::Writer<NoSeek<W>>);

impl<W: Write> Writer<W> {
    /// A file for ROS 2, written by this program.
    pub fn new(out: W, library: &str) -> io::Result<Self> {
        let options = WriteOptions::new()
            .compression(None)
            .profile("ros2")
            .library(library)
            .disable_seeking(true);
        done(options.create(NoSeek::new(out))).map(Self)
    }

    /// The number of a topic whose messages are of this type, defined by a text of `ros2msg`.
    pub fn channel(&mut self, topic: &str, name: &str, definition: &str) -> io::Result<u16> {
        let schema = done(self.0.add_schema(name, "ros2msg", definition.as_bytes()))?;
        done(self.0.add_channel(schema, topic, "cdr", &BTreeMap::new()))
    }

    /// A message of a topic, recorded when it was made, ns.
    pub fn message(&mut self, channel_id: u16, time: u64, data: &[u8]) -> io::Result<()> {
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        done(self.0.write_to_known_channel(&header, data))
    }

    /// Closes the file.
    pub fn finish(mut self) -> io::Result<W> {
        done(self.0.finish())?;
        Ok(self.0.into_inner().into_inner())
    }
}

fn done<T>(outcome: McapResult<T>) -> io::Result<T> {
    outcome.map_err(|error| match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    })
}
