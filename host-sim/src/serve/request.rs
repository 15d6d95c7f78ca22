//! One request of HTTP, read within its bounds and checked: who may ask, and for what.

use super::AskedBox;
use core::time::Duration;
use linestereo_wire::MAX_REGIONS;
use std::io::{ErrorKind, Read};
use std::net::TcpStream;
use std::time::Instant;

/// Most bytes of a head and of a body.
const HEAD_BYTES: usize = 8 << 10;
const BODY_BYTES: usize = 1 << 10;
const MOST_FIELDS: usize = 64;
/// A request has to be there within this time.
const WITHIN: Duration = Duration::from_secs(5);

/// Conditions of entry: port and token.
pub(super) struct Door {
    pub(super) port: u16,
    /// Secret of the address that was printed, hexadecimal.
    pub(super) token: String,
}

/// A request that was let in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Page,
    Events,
    /// The depths of these boxes, in this and all later pairs.
    Boxes(Vec<AskedBox>),
}

/// Status and text of a refused request.
pub(super) type Refusal = (&'static str, &'static str);

const MALFORMED: Refusal = ("400 Bad Request", "this is no request of the page\n");
/// It came from a page of another host, or without the token.
const FORBIDDEN: Refusal =
    ("403 Forbidden", "open the whole address that the program printed, with its token\n");
const NOT_FOUND: Refusal = ("404 Not Found", "the paths are /, /events and /boxes\n");
const METHOD: Refusal = ("405 Method Not Allowed", "use POST for /boxes and GET for all else\n");
const TOO_SLOW: Refusal = ("408 Request Timeout", "the request did not come within 5 s\n");
const BODY_TOO_LARGE: Refusal = ("413 Content Too Large", "at most 1 KiB is read\n");
const HEAD_TOO_LARGE: Refusal = ("431 Request Header Fields Too Large", "at most 8 KiB are read\n");
pub(super) const TOO_MANY: Refusal =
    ("503 Service Unavailable", "too many visitors; close another page\n");

impl Door {
    /// Reads a request, and decides.
    pub(super) fn admit(&self, stream: &mut TcpStream) -> Result<Wanted, Refusal> {
        let until = Instant::now() + WITHIN;
        let mut bytes = Vec::new();
        loop {
            let mut fields = [httparse::EMPTY_HEADER; MOST_FIELDS];
            let mut request = httparse::Request::new(&mut fields);
            match request.parse(&bytes) {
                Ok(httparse::Status::Complete(head)) => {
                    let (path, length) = self.checked(&request)?;
                    if let Some(body) = bytes.get(head..head + length) {
                        return wanted(path, body);
                    }
                }
                Ok(httparse::Status::Partial) if bytes.len() < HEAD_BYTES => {}
                Ok(httparse::Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
                    return Err(HEAD_TOO_LARGE);
                }
                Err(_) => return Err(MALFORMED),
            }
            more(stream, &mut bytes, until)?;
        }
    }

    /// The path of an allowed request, and the length of its body.
    fn checked<'a>(
        &self,
        request: &httparse::Request<'_, 'a>,
    ) -> Result<(&'a str, usize), Refusal> {
        let field = |name: &str| {
            let mut found =
                request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
            let first = found.next().map(|field| field.value);
            // Twice is as good as wrong.
            if found.next().is_some() { Err(MALFORMED) } else { Ok(first) }
        };
        let hosts = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        // A page of another name may have had that point here; its scripts are not let in.
        let is_ours = |value: &[u8]| hosts.iter().any(|host| host.as_bytes() == value);
        let is_host = field("host")?.is_some_and(is_ours);
        let is_origin = field("origin")?
            .is_none_or(|origin| origin.strip_prefix(b"http://").is_some_and(is_ours));
        let (path, query) = request.path.and_then(|path| path.split_once('?')).ok_or(FORBIDDEN)?;
        let has_token =
            query.split('&').any(|pair| pair.strip_prefix("token=") == Some(&self.token));
        if !(is_host && is_origin && has_token) {
            return Err(FORBIDDEN);
        }
        match (path, request.method) {
            ("/" | "/events", Some("GET")) | ("/boxes", Some("POST")) => {}
            ("/" | "/events" | "/boxes", _) => return Err(METHOD),
            _ => return Err(NOT_FOUND),
        }
        if field("transfer-encoding")?.is_some() {
            return Err(MALFORMED);
        }
        let length = field("content-length")?
            .map_or(Some(0), |value| core::str::from_utf8(value).ok()?.parse().ok());
        match length.ok_or(MALFORMED)? {
            length @ 0..=BODY_BYTES => Ok((path, length)),
            _ => Err(BODY_TOO_LARGE),
        }
    }
}

fn wanted(path: &str, body: &[u8]) -> Result<Wanted, Refusal> {
    match path {
        "/" => Ok(Wanted::Page),
        "/events" => Ok(Wanted::Events),
        _ => {
            let boxes: Option<Vec<AskedBox>> = serde_json::from_slice(body).ok();
            let is_box = |[left, top, right, bottom]: &AskedBox| left < right && top < bottom;
            let boxes =
                boxes.filter(|boxes| boxes.len() <= MAX_REGIONS && boxes.iter().all(is_box));
            boxes.map(Wanted::Boxes).ok_or(MALFORMED)
        }
    }
}

/// Appends what comes next.
fn more(stream: &mut TcpStream, bytes: &mut Vec<u8>, until: Instant) -> Result<(), Refusal> {
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
        return Err(TOO_SLOW);
    }
    let mut piece = [0; 1024];
    match stream.read(&mut piece) {
        Ok(0) => Err(MALFORMED),
        Ok(length) => {
            bytes.extend_from_slice(&piece[..length]);
            Ok(())
        }
        Err(error) if error.kind() == ErrorKind::Interrupted => Ok(()),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
            Err(TOO_SLOW)
        }
        Err(_) => Err(MALFORMED),
    }
}
