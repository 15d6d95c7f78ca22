//! Where the bytes come from, and where commands go.
//!
//! In: a path, an address or the name of a serial port. Out: bytes, silence, or the end; every
//! failure names the port.

use anyhow::{Context, Result, anyhow, bail};
use core::time::Duration;
use linestereo_frames::untrusted;
use linestereo_wire::{Command, DELIMITER, MAX_COMMAND, encode};
use serialport::SerialPort;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;

/// A live port is silent for at most this long before the caller may do something else.
const PATIENCE: Duration = Duration::from_millis(100);
/// A connection has to be there within this time.
const CONNECT: Duration = Duration::from_secs(5);

/// Which live port.
#[derive(Clone, Debug, clap::Args)]
pub struct PortArgs {
    /// Connect to a port, such as QEMU's UART.
    #[arg(long, value_name = "HOST:PORT")]
    pub tcp: Option<String>,
    /// Open a serial port: 8 data bits, no parity, 1 stop bit.
    #[arg(long, value_name = "PORT")]
    pub serial: Option<String>,
    /// Speed of the serial port; one over USB has none.
    #[arg(long, value_name = "N", default_value_t = 115_200, conflicts_with = "tcp")]
    pub baud: u32,
}

impl PortArgs {
    /// The port, or in its place a file of recorded bytes.
    pub fn open_or(&self, file: Option<&Path>) -> Result<Port> {
        file.map_or_else(|| self.open(), Port::file)
    }

    pub fn open(&self) -> Result<Port> {
        match (&self.tcp, &self.serial) {
            (Some(address), _) => Port::tcp(address),
            (_, Some(name)) => Port::serial(name, self.baud),
            _ => bail!("no port is named; give --tcp or --serial"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    Bytes(usize),
    Silence,
    /// The file is read; a live port has no such end.
    End,
}

pub struct Port {
    name: String,
    line: Line,
}

enum Line {
    File(Box<dyn Read>),
    Tcp(TcpStream),
    Serial(Box<dyn SerialPort>),
}

impl Port {
    /// A file of recorded bytes; `-` is stdin.
    pub fn file(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        if path == Path::new("-") {
            return Ok(Self { name: "stdin".to_owned(), line: Line::File(Box::new(io::stdin())) });
        }
        if path.is_dir() {
            return Err(unreadable(&name, &ErrorKind::IsADirectory.into()));
        }
        let file = untrusted::opened(path).map_err(|error| unreadable(&name, &error))?;
        Ok(Self { name, line: Line::File(Box::new(file)) })
    }

    pub fn tcp(address: &str) -> Result<Self> {
        let cannot = |error: io::Error| {
            anyhow!("cannot connect to {address}: {error}; is something listening there?")
        };
        let addresses = address.to_socket_addrs().map_err(|error| {
            anyhow!("cannot resolve {address}: {error}; give HOST:PORT, as in localhost:4444")
        })?;
        let mut outcome = Err(ErrorKind::AddrNotAvailable.into());
        for candidate in addresses {
            outcome = TcpStream::connect_timeout(&candidate, CONNECT);
            if outcome.is_ok() {
                break;
            }
        }
        let stream = outcome.map_err(cannot)?;
        stream
            .set_read_timeout(Some(PATIENCE))
            .and_then(|()| stream.set_nodelay(true))
            .map_err(cannot)?;
        stream.set_write_timeout(Some(CONNECT)).map_err(cannot)?;
        Ok(Self { name: address.to_owned(), line: Line::Tcp(stream) })
    }

    pub fn serial(name: &str, baud: u32) -> Result<Self> {
        let mut port = serialport::new(name, baud).timeout(PATIENCE).open().map_err(|error| {
            anyhow!("cannot open the serial port {name}: {error}; check that the board is plugged in and no other program has it")
        })?;
        // A port over USB is closed to a board until this line says otherwise; on others it may be
        // missing.
        let _ = port.write_data_terminal_ready(true);
        Ok(Self { name: name.to_owned(), line: Line::Serial(port) })
    }

    /// Waits a little for bytes.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<Received> {
        let (outcome, is_file) = match &mut self.line {
            Line::File(file) => (file.read(buffer), true),
            Line::Tcp(stream) => (stream.read(buffer), false),
            Line::Serial(port) => (port.read(buffer), false),
        };
        match outcome {
            Ok(0) if is_file => Ok(Received::End),
            Ok(0) => Err(self.gone(None)),
            Ok(length) => Ok(Received::Bytes(length)),
            Err(error) => match error.kind() {
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => {
                    Ok(Received::Silence)
                }
                _ if is_file => Err(unreadable(&self.name, &error)),
                _ => Err(self.gone(Some(&error))),
            },
        }
    }

    /// Sends a command. The delimiter before it ends whatever noise came first.
    pub fn send(&mut self, command: &Command) -> Result<()> {
        let mut packet = [DELIMITER; 1 + MAX_COMMAND];
        let length = encode(command, &mut packet[1..])?.len();
        self.write(&packet[..=length])
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        let outcome = match &mut self.line {
            Line::File(_) => {
                bail!("{} is a file, which takes no commands; use --tcp or --serial", self.name)
            }
            Line::Tcp(stream) => stream.write_all(bytes),
            Line::Serial(port) => port.write_all(bytes),
        };
        outcome.map_err(|error| self.gone(Some(&error))).context("a command was not sent")
    }

    fn gone(&self, error: Option<&io::Error>) -> anyhow::Error {
        let why = error.map_or(String::new(), |error| format!(" ({error})"));
        match self.line {
            Line::Serial(_) => {
                anyhow!(
                    "the serial port {} vanished{why}; plug the board in and start again",
                    self.name
                )
            }
            _ => anyhow!(
                "the connection to {} was closed{why}; start the board again, or stop sooner with --count",
                self.name
            ),
        }
    }
}

fn unreadable(name: &str, error: &io::Error) -> anyhow::Error {
    anyhow!("cannot read {name}: {error}; give a file of recorded bytes")
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use serialport::TTYPort;

    /// Not from outside: a child process would inherit the other end and keep it open.
    #[test]
    fn a_serial_port_is_silent_gives_bytes_and_vanishes() {
        let (mut board, slave) = TTYPort::pair().unwrap();
        let name = slave.name().unwrap();
        drop(slave);
        let mut port = Port::serial(&name, 115_200).unwrap();
        let mut buffer = [0; 16];
        assert_eq!(port.read(&mut buffer).unwrap(), Received::Silence);
        board.write_all(b"abc").unwrap();
        assert_eq!(port.read(&mut buffer).unwrap(), Received::Bytes(3));
        port.write(b"de").unwrap();
        let mut sent = [0; 2];
        board.read_exact(&mut sent).unwrap();
        assert_eq!(&sent, b"de");
        drop(board);
        let error = port.read(&mut buffer).unwrap_err().to_string();
        assert!(error.starts_with(&format!("the serial port {name} vanished")), "{error}");
        let error = format!("{:#}", port.write(b"x").unwrap_err());
        assert!(error.contains(&format!("the serial port {name} vanished")), "{error}");
    }
}
