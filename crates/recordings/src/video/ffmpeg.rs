//! The system's ffmpeg as a child process, for videos that are coded and for cameras.
//!
//! ```text
//! packets   a file is read through once without being decoded: times of its frames, and so their
//!           number
//! decode    grey of 8 bits as Y4M over a pipe, every frame once
//! ```
//!
//! The child opens plain files alone, no addresses, and containers of a list, none of which names
//! other files. It has no terminal, its time for each frame is limited, of what it says the end is
//! kept, and it is ended and waited for with its [`Decoder`]. Each pipe is read by a thread, so
//! that a silent one can be left.
//!
//! Frames are numbered anew (`setpts=N`) and written at the rate of these numbers: the way of every
//! version to have each of them once. The option for it was `-vsync` before version 5.1 and is
//! `-fps_mode` since; version 9 knows the former no more.

use super::y4m::Header;
use super::{Luma, MOST_FRAMES, Source, VideoFault};
use core::time::Duration;
use linestereo_frames::untrusted::{self, PIXELS};
use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Longest time in which nothing comes.
const SILENCE: Duration = Duration::from_secs(15);
/// Between two looks at whether somebody wants an end.
const TICK: Duration = Duration::from_millis(50);
/// Time in which a program that has written everything ends.
const END: Duration = Duration::from_secs(2);
/// Bytes of ffmpeg's messages that are kept, and most letters of them in an error.
const SAID_BYTES: usize = 4096;
const TOLD: usize = 200;
/// Endings of JPEG files one behind the other, whose times ffmpeg would make up.
const RAW: [&str; 2] = ["mjpeg", "mjpg"];
/// Most bytes of a line about a packet.
const PACKET_BYTES: u64 = 1024;
/// Decoders get no frames of more pixels, containers are these, files are files.
const READ: [&str; 6] = [
    "-protocol_whitelist", "file", "-format_whitelist", "mov,matroska,webm,avi,mjpeg",
    "-max_pixels", PIXELS_TEXT,
];
const PIXELS_TEXT: &str = "33554432";
const _: () = assert!(PIXELS == 33_554_432);

/// True when somebody wants an end.
pub type Stop = fn() -> bool;

/// A camera that gives both views in one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Camera {
    /// Its device.
    pub device: PathBuf,
    /// Size of its images, both views, px.
    pub size: Option<[u16; 2]>,
    /// Frames a second.
    pub rate: Option<u16>,
    /// Name of the format in which it sends them.
    pub format: Option<String>,
}

/// A child that writes to a pipe; ended with this.
struct Program {
    child: Child,
    said: Arc<Mutex<VecDeque<u8>>>,
    listener: JoinHandle<()>,
}

impl Program {
    fn start(args: Vec<OsString>) -> Result<(Self, ChildStdout), VideoFault> {
        let mut command = Command::new("ffmpeg");
        command.args(["-nostdin", "-hide_banner", "-loglevel", "error"]).args(args);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // Ctrl-C is for this program, which ends the child when it has kept what is done.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(VideoFault::NoFfmpeg)?;
        let (out, errors) = (child.stdout.take(), child.stderr.take());
        let said = Arc::new(Mutex::new(VecDeque::new()));
        let heard = Arc::clone(&said);
        let listener = thread::spawn(move || {
            let mut buffer = [0; 1024];
            let mut errors = errors;
            while let Some(count @ 1..) =
                errors.as_mut().and_then(|errors| errors.read(&mut buffer).ok())
            {
                let mut kept = heard.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend(&buffer[..count]);
                let beyond = kept.len().saturating_sub(SAID_BYTES);
                kept.drain(..beyond);
            }
        });
        let program = Self { child, said, listener };
        match out {
            Some(out) => Ok((program, out)),
            None => Err(VideoFault::Output("it has no output")),
        }
    }

    /// Waits a moment for its end; its last line of errors, empty where it had none and succeeded.
    fn end(&mut self) -> String {
        let start = Instant::now();
        let mut status = None;
        while start.elapsed() < END && !(status.is_some() && self.listener.is_finished()) {
            status = status.or_else(|| self.child.try_wait().ok().flatten());
            thread::sleep(Duration::from_millis(2));
        }
        let said = self.said();
        match status {
            Some(status) if said.is_empty() && !status.success() => status.to_string(),
            _ => said,
        }
    }

    /// The last line that it said so far.
    fn said(&self) -> String {
        let bytes: Vec<u8> =
            self.said.lock().unwrap_or_else(PoisonError::into_inner).iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes);
        let line = text.lines().rev().map(str::trim).find(|line| !line.is_empty()).unwrap_or("");
        // `[matroska,webm @ 0x55d4f3d94b40]`: the place in its memory tells nobody anything.
        let line = match line.split_once(" @ 0x") {
            Some((before, behind)) => {
                format!("{before}{}", behind.trim_start_matches(|c: char| c.is_ascii_hexdigit()))
            }
            None => line.to_owned(),
        };
        line.chars().take(TOLD).collect()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill(); // it may have ended by itself
        let _ = self.child.wait();
    }
}

/// The next one; nothing where there will be none.
fn next<T>(from: &Receiver<T>, stop: Stop) -> Result<Option<T>, VideoFault> {
    let start = Instant::now();
    loop {
        match from.recv_timeout(TICK) {
            Ok(item) => return Ok(Some(item)),
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
            Err(RecvTimeoutError::Timeout) if stop() => return Err(VideoFault::Interrupted),
            Err(RecvTimeoutError::Timeout) if start.elapsed() > SILENCE => {
                return Err(VideoFault::Silent(SILENCE.as_secs()));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// A path that is no option and no address.
fn as_file(path: &Path) -> OsString {
    let mut name = OsString::from("file:");
    name.push(path);
    name
}

fn words<'a>(words: impl IntoIterator<Item = &'a str>) -> Vec<OsString> {
    words.into_iter().map(OsString::from).collect()
}

/// Times of the frames of a file behind the first one, ns, where all are known; their number; what
/// ffmpeg said.
fn packets(
    mut args: Vec<OsString>,
    stop: Stop,
) -> Result<(Option<Vec<u64>>, usize, String), VideoFault> {
    args.extend(words([
        "-c", "copy", "-copyinkf", "-flush_packets", "1", "-f", "framecrc", "pipe:1",
    ]));
    let (mut program, out) = Program::start(args)?;
    let (to, from) = sync_channel(1024);
    thread::spawn(move || {
        let mut out = BufReader::new(out);
        loop {
            let mut line = Vec::new();
            let read = (&mut out).take(PACKET_BYTES).read_until(b'\n', &mut line);
            if !matches!(read, Ok(1..)) || to.send(line).is_err() {
                break;
            }
        }
    });
    let (mut times, mut count, mut tick) = (Some(Vec::new()), 0, None);
    while let Some(line) = next(&from, stop)? {
        let line = core::str::from_utf8(&line).ok().and_then(|line| line.strip_suffix('\n'));
        let line = line.ok_or(VideoFault::Output("no list of packets"))?;
        if let Some(about) = line.strip_prefix('#') {
            tick = tick.or_else(|| tick_of(about));
            continue;
        }
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        if fields.len() < 6 || fields[0] != "0" {
            return Err(VideoFault::Output("no list of packets"));
        }
        if count == MOST_FRAMES {
            return Err(VideoFault::TooMany);
        }
        count += 1;
        // When it is shown, else when it is decoded.
        let time = fields[2].parse().or_else(|_| fields[1].parse::<i64>()).ok();
        times = times.zip(time).map(|(mut times, time)| {
            times.push(time);
            times
        });
    }
    let said = program.end();
    if count == 0 {
        return Err(VideoFault::Ffmpeg(said));
    }
    Ok((times.zip(tick).and_then(|(times, tick)| in_order(times, tick)), count, said))
}

/// `tb 0: 1/90000`: a tick of the times, s.
fn tick_of(about: &str) -> Option<[u32; 2]> {
    let (ticks, second) = about.strip_prefix("tb 0:")?.trim().split_once('/')?;
    Some([ticks.parse().ok()?, second.parse().ok().filter(|&second| second > 0)?])
}

/// Times as they are shown, ns behind the first one.
fn in_order(mut times: Vec<i64>, [ticks, second]: [u32; 2]) -> Option<Vec<u64>> {
    times.sort_unstable();
    let first = *times.first()?;
    let ns = |time: i64| {
        (i128::from(time) - i128::from(first)) * i128::from(ticks) * 1_000_000_000
            / i128::from(second)
    };
    times.iter().map(|&time| u64::try_from(ns(time)).ok()).collect()
}

/// A frame from the pipe with the time when it came, ns.
type Frame = (Luma, Option<u64>);

/// Y4M from the pipe, until nobody wants more.
fn read(out: ChildStdout, to: &SyncSender<Result<Frame, VideoFault>>) {
    let mut out = BufReader::with_capacity(1 << 16, out);
    let header = match Header::read(&mut out) {
        Ok(header) => header,
        // It said why, and wrote nothing.
        Err(_) if out.fill_buf().is_ok_and(<[u8]>::is_empty) => return,
        Err(VideoFault::Size(sides)) => return drop(to.send(Err(VideoFault::Size(sides)))),
        Err(_) => return drop(to.send(Err(VideoFault::Output("no Y4M")))),
    };
    for index in 0.. {
        let frame = match header.frame(&mut out, index) {
            Ok(None) | Err(VideoFault::Read(_)) => return, // a frame that is cut off is none
            Ok(Some(luma)) => {
                let now = SystemTime::now().duration_since(UNIX_EPOCH).ok();
                Ok((luma, now.and_then(|now| u64::try_from(now.as_nanos()).ok())))
            }
            Err(_) => Err(VideoFault::Output("no frame of Y4M")),
        };
        let is_over = frame.is_err();
        if to.send(frame).is_err() || is_over {
            return;
        }
    }
}

/// A video or camera that is decoded.
pub(super) struct Decoder {
    args: Vec<OsString>,
    /// Number of frames of a file, and their times.
    count: Option<usize>,
    times: Option<Vec<u64>>,
    stop: Stop,
    running: Option<(Program, Receiver<Result<Frame, VideoFault>>)>,
    /// Number of the next frame from the pipe.
    next: usize,
    last: Option<(usize, Luma, Option<u64>)>,
    /// Frames there were, where no more come.
    ended: Option<usize>,
    said: String,
}

impl Decoder {
    /// Counts the frames of a file and starts to decode it.
    pub(super) fn open(path: &Path, stop: Stop) -> Result<Self, VideoFault> {
        drop(untrusted::open(path, u64::MAX)?); // what is missing, or no file, is said as of others
        let is_raw = super::ending(path).is_some_and(|ending| RAW.contains(&&*ending));
        let mut input = words(READ);
        input.extend(words(if is_raw { &["-f", "mjpeg"][..] } else { &[] }.iter().copied()));
        input.extend(["-i".into(), as_file(path), "-map".into(), "0:V:0".into()]);
        let (times, count, said) = packets(input.clone(), stop)?;
        Self::new(input, Some(count), times.filter(|_| !is_raw), said, stop)
    }

    pub(super) fn camera(camera: &Camera, stop: Stop) -> Result<Self, VideoFault> {
        there_is(&camera.device)?;
        let mut input = words(["-f", "v4l2"]);
        let given = [
            ("-input_format", camera.format.clone()),
            ("-video_size", camera.size.map(|[width, height]| format!("{width}x{height}"))),
            ("-framerate", camera.rate.map(|rate| rate.to_string())),
        ];
        for (name, value) in given {
            input.extend(value.into_iter().flat_map(|value| [OsString::from(name), value.into()]));
        }
        input.extend([OsString::from("-i"), camera.device.clone().into()]);
        Self::new(input, None, None, String::new(), stop)
    }

    fn new(
        mut args: Vec<OsString>,
        count: Option<usize>,
        times: Option<Vec<u64>>,
        said: String,
        stop: Stop,
    ) -> Result<Self, VideoFault> {
        args.extend(words(["-vf", "settb=1/25,setpts=N", "-r", "25"]));
        args.extend(words(["-sws_flags", "bicubic+accurate_rnd+bitexact", "-pix_fmt", "gray"]));
        args.extend(words(["-flush_packets", "1", "-f", "yuv4mpegpipe", "pipe:1"]));
        let mut decoder = Self {
            args,
            count,
            times,
            stop,
            running: None,
            next: 0,
            last: None,
            ended: None,
            said,
        };
        decoder.start()?;
        decoder.frame(0)?;
        Ok(decoder)
    }

    fn start(&mut self) -> Result<(), VideoFault> {
        self.running = None; // ends the one before
        let (program, out) = Program::start(self.args.clone())?;
        let (to, from) = sync_channel(1);
        thread::spawn(move || read(out, &to));
        self.running = Some((program, from));
        self.next = 0;
        Ok(())
    }

    /// The next frame from the pipe.
    fn take(&mut self) -> Result<(), VideoFault> {
        let Some((program, from)) = &mut self.running else {
            return Err(VideoFault::EndsEarly(self.next, self.said.clone()));
        };
        match next(from, self.stop)? {
            Some(Ok((luma, time_ns))) => {
                self.last = Some((self.next, luma, time_ns));
                self.next += 1;
                Ok(())
            }
            Some(Err(fault)) => Err(fault),
            None => {
                self.said = program.end();
                let (frames, said) = (self.next, self.said.clone());
                Err(if frames == 0 {
                    VideoFault::Ffmpeg(said)
                } else {
                    VideoFault::EndsEarly(frames, said)
                })
            }
        }
    }
}

impl Source for Decoder {
    fn frames(&self) -> Option<usize> {
        self.count
    }

    fn time_ns(&self, index: usize) -> Option<u64> {
        match &self.times {
            Some(times) => times.get(index).copied(),
            None => self.last.as_ref().filter(|last| self.count.is_none() && last.0 == index)?.2,
        }
    }

    fn frame(&mut self, index: usize) -> Result<Luma, VideoFault> {
        loop {
            if let Some((at, luma, _)) = &self.last
                && *at == index
            {
                return Ok(luma.clone());
            }
            if let Some(frames) = self.ended
                && index >= frames
            {
                return Err(VideoFault::EndsEarly(frames, self.said.clone()));
            }
            if (self.stop)() {
                return Err(VideoFault::Interrupted);
            }
            if index < self.next {
                self.start()?;
            }
            if let Err(fault) = self.take() {
                // Whatever it is, nothing comes behind it.
                self.ended = Some(self.next);
                self.running = None;
                return Err(fault);
            }
        }
    }

    fn ended(&self) -> Option<usize> {
        self.ended
    }

    fn note(&self) -> Option<String> {
        let now = || self.running.as_ref().map_or(String::new(), |(program, _)| program.said());
        let said = if self.said.is_empty() { now() } else { self.said.clone() };
        (!said.is_empty()).then(|| format!("ffmpeg says: {said}"))
    }
}

/// Refuses what is no camera before it is asked for images.
fn there_is(device: &Path) -> Result<(), VideoFault> {
    let fault = |what: String| Err(VideoFault::Camera(what));
    if !cfg!(target_os = "linux") {
        return fault(
            "cameras are read by V4L2, which Linux has; record a video with another program and give that".into(),
        );
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        match std::fs::metadata(device) {
            Err(error) => {
                return fault(format!(
                    "there is no camera ({error}); plug it in, or give another: v4l2-ctl --list-devices"
                ));
            }
            Ok(about) if !about.file_type().is_char_device() => {
                return fault("it is no camera; give its device, such as /dev/video0: v4l2-ctl --list-devices".into());
            }
            Ok(_) => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_the_order_in_which_frames_are_shown() {
        assert_eq!(
            in_order(vec![0, 2048, 1024, 512], [1, 15_360]),
            Some(vec![0, 33_333_333, 66_666_666, 133_333_333])
        );
        assert_eq!(in_order(vec![i64::MIN, i64::MAX], [u32::MAX, 1]), None);
        assert_eq!(
            (tick_of("tb 0: 1/1000"), tick_of("tb 0: 1/0"), tick_of("tb 1: 1/9")),
            (Some([1, 1000]), None, None)
        );
    }
}
