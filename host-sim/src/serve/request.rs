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

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It came from a page of another host, or without the token.
    Forbidden,
    Malformed,
    NotFound,
    Method,
    TooSlow,
    BodyTooLarge,
    HeadTooLarge,
    TooMany,
}

impl Refusal {
    /// Status and text.
    pub(super) const fn says(self) -> (&'static str, &'static str) {
        match self {
            Self::Malformed => ("400 Bad Request", "this is no request of the page\n"),
            Self::Forbidden => ("403 Forbidden", "open the whole address that the program printed, with its token\n"),
            Self::NotFound => ("404 Not Found", "there is /, /events and /boxes\n"),
            Self::Method => ("405 Method Not Allowed", "boxes are posted, all else is got\n"),
            Self::TooSlow => ("408 Request Timeout", "the request did not come within 5 s\n"),
            Self::BodyTooLarge => ("413 Content Too Large", "at most 1 KiB is read\n"),
            Self::HeadTooLarge => ("431 Request Header Fields Too Large", "at most 8 KiB are read\n"),
            Self::TooMany => ("503 Service Unavailable", "too many visitors; close another page\n"),
        }
    }
}

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
                    while bytes.len() < head + length {
                        more(stream, &mut bytes, until)?;
                    }
                    return wanted(path, &bytes[head..head + length]);
                }
                Ok(httparse::Status::Partial) if bytes.len() < HEAD_BYTES => more(stream, &mut bytes, until)?,
                Ok(httparse::Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
                    return Err(Refusal::HeadTooLarge);
                }
                Err(_) => return Err(Refusal::Malformed),
            }
        }
    }

    /// The place that an allowed request is for, and the length of its body.
    fn checked(&self, request: &httparse::Request<'_, '_>) -> Result<(Place, usize), Refusal> {
        let field = |name: &str| {
            let mut found = request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
            let first = found.next().map(|field| field.value);
            // Twice is as good as wrong.
            if found.next().is_some() { Err(Refusal::Malformed) } else { Ok(first) }
        };
        let hosts = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        // A page of another name may have had that point here; its scripts are not let in.
        let is_ours = |value: &[u8]| hosts.iter().any(|host| host.as_bytes() == value);
        let is_host = field("host")?.is_some_and(is_ours);
        let is_origin = field("origin")?.is_none_or(|origin| origin.strip_prefix(b"http://").is_some_and(is_ours));
        let (path, query) = request.path.and_then(|path| path.split_once('?')).ok_or(Refusal::Forbidden)?;
        let has_token = query.split('&').any(|pair| pair.strip_prefix("token=") == Some(&self.token));
        if !(is_host && is_origin && has_token) {
            return Err(Refusal::Forbidden);
        }
        let place = Place::of(path).ok_or(Refusal::NotFound)?;
        if request.method != Some(place.method()) {
            return Err(Refusal::Method);
        }
        if field("transfer-encoding")?.is_some() {
            return Err(Refusal::Malformed);
        }
        let length = field("content-length")?.map_or(Some(0), |value| core::str::from_utf8(value).ok()?.parse().ok());
        match length.ok_or(Refusal::Malformed)? {
            length @ 0..=BODY_BYTES => Ok((place, length)),
            _ => Err(Refusal::BodyTooLarge),
        }
    }
}

#[derive(Clone, Copy)]
enum Place {
    Page,
    Events,
    Boxes,
}

impl Place {
    fn of(path: &str) -> Option<Self> {
        match path {
            "/" => Some(Self::Page),
            "/events" => Some(Self::Events),
            "/boxes" => Some(Self::Boxes),
            _ => None,
        }
    }

    const fn method(self) -> &'static str {
        if matches!(self, Self::Boxes) { "POST" } else { "GET" }
    }
}

fn wanted(place: Place, body: &[u8]) -> Result<Wanted, Refusal> {
    match place {
        Place::Page => Ok(Wanted::Page),
        Place::Events => Ok(Wanted::Events),
        Place::Boxes => {
            let boxes: Option<Vec<AskedBox>> = serde_json::from_slice(body).ok();
            let is_box = |[left, top, right, bottom]: &AskedBox| left < right && top < bottom;
            let boxes = boxes.filter(|boxes| boxes.len() <= MAX_REGIONS && boxes.iter().all(is_box));
            boxes.map(Wanted::Boxes).ok_or(Refusal::Malformed)
        }
    }
}

/// Appends what comes next.
fn more(stream: &mut TcpStream, bytes: &mut Vec<u8>, until: Instant) -> Result<(), Refusal> {
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
        return Err(Refusal::TooSlow);
    }
    let mut piece = [0; 1024];
    match stream.read(&mut piece) {
        Ok(0) => Err(Refusal::Malformed),
        Ok(length) => {
            bytes.extend_from_slice(&piece[..length]);
            Ok(())
        }
        Err(error) if error.kind() == ErrorKind::Interrupted => Ok(()),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Err(Refusal::TooSlow),
        Err(_) => Err(Refusal::Malformed),
    }
}
