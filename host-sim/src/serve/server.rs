//! Connections: one thread takes them, each is answered on its own.

use super::AskedBox;
use super::request::{Door, Refusal, TOO_MANY, Wanted};
use super::visitors::{Next, Queue, Visitors};
use anyhow::{Context, Result, anyhow};
use core::fmt::Write as _;
use core::net::Ipv4Addr;
use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use core::time::Duration;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Instant;

const MOST_CONNECTIONS: usize = 24;
/// A visitor who takes nothing for so long is let go.
const TAKES_WITHIN: Duration = Duration::from_secs(10);
/// A visitor hears something this often, and is missed when gone.
const BEAT: Duration = Duration::from_secs(5);
/// From one look for a connection to the next; it is how long a page waits at most.
const LOOK: Duration = Duration::from_millis(10);
/// Bytes that are read of what was refused.
const UNREAD_BYTES: u64 = 1 << 16;
/// At the end the last events have so long to be sent.
const FAREWELL: Duration = Duration::from_millis(500);

/// An event by its name, and its data: one line.
pub type Event = (&'static str, String);

/// A page that is served until this is dropped.
pub struct Server {
    shared: Arc<Shared>,
    acceptor: Option<JoinHandle<()>>,
}

struct Shared {
    door: Door,
    page: String,
    /// The only scripts and styles that run are those marked by it.
    nonce: String,
    visitors: Visitors,
    boxes: Mutex<Vec<AskedBox>>,
    connections: AtomicUsize,
    is_over: AtomicBool,
}

impl Server {
    /// Listens on this port of 127.0.0.1, a free one for 0. `page` makes the page, whose scripts
    /// and styles are marked by the word it is given.
    pub fn start(port: u16, page: impl FnOnce(&str) -> String) -> Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| {
            anyhow!("cannot listen on 127.0.0.1:{port}: {error}; give another --port, or 0 for one that is free")
        })?;
        listener.set_nonblocking(true)?;
        let nonce = secret()?;
        let shared = Arc::new(Shared {
            door: Door { port: listener.local_addr()?.port(), token: secret()? },
            page: page(&nonce),
            nonce,
            visitors: Visitors::default(),
            boxes: Mutex::default(),
            connections: AtomicUsize::new(0),
            is_over: AtomicBool::new(false),
        });
        let of_thread = Arc::clone(&shared);
        let acceptor = thread::Builder::new().spawn(move || accept(&listener, &of_thread))?;
        Ok(Self { shared, acceptor: Some(acceptor) })
    }

    pub fn address(&self) -> String {
        let Door { port, token } = &self.shared.door;
        format!("http://127.0.0.1:{port}/?token={token}")
    }

    /// Sends events that belong together; who comes later is sent the last ones of each group.
    pub fn send(&self, group: &'static str, events: &[Event]) {
        let mut text = String::with_capacity(events.iter().map(|(_, data)| data.len() + 32).sum());
        for (name, data) in events {
            let _ = write!(text, "event: {name}\ndata: {}\n\n", data.trim_end());
        }
        self.shared.visitors.send(group, &text.into());
    }

    /// Boxes that visitors want the depths of; the last list counts, whoever sent it.
    pub fn boxes(&self) -> Vec<AskedBox> {
        self.shared.boxes.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.visitors.end();
        let begin = Instant::now();
        while !self.shared.visitors.is_empty() && begin.elapsed() < FAREWELL {
            thread::sleep(LOOK);
        }
        self.shared.is_over.store(true, Ordering::Relaxed);
        if let Some(acceptor) = self.acceptor.take() {
            let _ = acceptor.join(); // it has nothing to say
        }
    }
}

/// 128 random bits, hexadecimal.
fn secret() -> Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .context("the system gives no random numbers for the page's secret token")?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    while !shared.is_over.load(Ordering::Relaxed) {
        let Ok((mut stream, _)) = listener.accept() else {
            thread::sleep(LOOK);
            continue;
        };
        if set_up(&stream).is_err() {
            continue; // gone already
        }
        if shared.connections.load(Ordering::Relaxed) == MOST_CONNECTIONS {
            let (status, text) = TOO_MANY;
            let _ = respond(&mut stream, status, "text/plain", "", text); // to nobody, at worst
            continue;
        }
        shared.connections.fetch_add(1, Ordering::Relaxed);
        let of_thread = Arc::clone(shared);
        let answering = thread::Builder::new().spawn(move || {
            let _ = answer(&mut stream, &of_thread); // who has gone needs no answer
            of_thread.connections.fetch_sub(1, Ordering::Relaxed);
        });
        if answering.is_err() {
            shared.connections.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

fn set_up(stream: &TcpStream) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_write_timeout(Some(TAKES_WITHIN))?;
    stream.set_nodelay(true)
}

fn answer(stream: &mut TcpStream, shared: &Shared) -> io::Result<()> {
    match shared.door.admit(stream) {
        Ok(Wanted::Page) => {
            let nonce = &shared.nonce;
            let policy = format!(
                "Content-Security-Policy: default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; \
                 connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
            );
            respond(stream, "200 OK", "text/html", &policy, &shared.page)
        }
        Ok(Wanted::Boxes(boxes)) => {
            *shared.boxes.lock().unwrap_or_else(PoisonError::into_inner) = boxes;
            respond(stream, "200 OK", "text/plain", "", "")
        }
        Ok(Wanted::Events) => match shared.visitors.enter() {
            Some(queue) => {
                let outcome = head(stream, "200 OK", "text/event-stream", "")
                    .and_then(|()| tell(stream, &queue));
                shared.visitors.leave(&queue);
                outcome
            }
            None => refuse(stream, TOO_MANY),
        },
        Err(refusal) => refuse(stream, refusal),
    }
}

/// Sends events until there are no more, or the visitor has gone.
fn tell(stream: &mut TcpStream, queue: &Queue) -> io::Result<()> {
    loop {
        match queue.next(BEAT) {
            Next::Text(text, 0) => stream.write_all(text.as_bytes())?,
            Next::Text(text, dropped) => {
                write!(stream, "event: dropped\ndata: {dropped}\n\n{text}")?
            }
            Next::Silence => stream.write_all(b":\n\n")?,
            Next::End => return Ok(()),
        }
    }
}

fn refuse(stream: &mut TcpStream, (status, text): Refusal) -> io::Result<()> {
    respond(stream, status, "text/plain", "", text)?;
    // What is left unread would have the other end see a reset before the answer.
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_secs(1)))?;
    io::copy(&mut Read::take(stream, UNREAD_BYTES), &mut io::sink()).map(drop)
}

fn respond(
    stream: &mut TcpStream,
    status: &str,
    kind: &str,
    fields: &str,
    text: &str,
) -> io::Result<()> {
    head(stream, status, kind, &format!("{fields}Content-Length: {}\r\n", text.len()))?;
    stream.write_all(text.as_bytes())
}

fn head(stream: &mut TcpStream, status: &str, kind: &str, fields: &str) -> io::Result<()> {
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\n{fields}Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\n\
         X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n\r\n"
    )
}
