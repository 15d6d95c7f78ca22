//! The functions of `linestereo.h`: pointers become references here, each checked for null and
//! alignment, and memory for its size.
//!
//! The contract of C remains, which no check can see and linestereo.h states for all functions:
//! what is neither null nor misaligned points to what its type says, memory belongs to one matcher
//! alone, and one thread uses it at a time.

use crate::engine::Engine;
use crate::obstacles::Directions;
use crate::status::Status;
use crate::types::{
    Area, Bar, CameraPose, Config, Depth, FAULT_NAMES, Ground, Health, Image, ObstacleConfig,
    Obstacles, Point, Run, Sector, Segment,
};
use core::cell::{Cell, UnsafeCell};
use core::ffi::{c_char, c_void};
use core::mem::MaybeUninit;
use linestereo::objects::Run as CoreRun;
use linestereo::{Area as CoreArea, Gray, MemorySlice, Options, Region, image::Span as CoreSpan};

/// A matcher, in memory of the caller.
pub struct Handle {
    /// Its own address: elsewhere, and in memory that was not initialised, there is another value.
    address: usize,
    /// True while a callback runs.
    is_busy: Cell<bool>,
    engine: UnsafeCell<Engine>,
}

/// A word of memory.
type Word = MaybeUninit<u64>;

/// Words of the matcher itself, before those that are carved.
const HEAD: usize = size_of::<Handle>().div_ceil(size_of::<Word>());
/// Words of the largest object there can be. A power of two less 1: of a larger memory, which there
/// is not, less is used.
const MOST_WORDS: usize = isize::MAX as usize / size_of::<Word>();
const _: () = assert!(align_of::<Handle>() <= align_of::<Word>());

/// Called with every point; `context` is what the caller gave.
pub type PointCallback = Option<unsafe extern "C" fn(context: *mut c_void, point: *const Point)>;

/// Refuses what is null or not aligned to `align`, a power of two. Not inlined: that would be a
/// third of the library's own code.
#[inline(never)]
fn check(address: usize, align: usize) -> Result<(), Status> {
    if address == 0 {
        return Err(Status::Null);
    }
    if address & align.wrapping_sub(1) != 0 { Err(Status::Misaligned) } else { Ok(()) }
}

/// The object at a pointer.
///
/// # Safety
/// It points to a `T` that nobody changes during `'a`, if it is neither null nor misaligned.
unsafe fn read<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    check(pointer.addr(), align_of::<T>())?;
    // SAFETY: checked above; the rest is the caller's.
    Ok(unsafe { &*pointer })
}

/// The `count` elements from a pointer on; null is right for none.
///
/// # Safety
/// As [`read`], for all of them.
unsafe fn list<'a, T>(pointer: *const T, count: usize) -> Result<&'a [T], Status> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer.addr(), align_of::<T>())?;
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(Status::TooMany);
    }
    // SAFETY: neither null nor misaligned, and no larger than an object can be; the rest is the
    // caller's.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Room for a result.
///
/// # Safety
/// There is room for a `T`, which nobody else uses during `'a`, if the pointer is neither null nor
/// misaligned.
unsafe fn room<'a, T>(pointer: *mut T) -> Result<&'a mut MaybeUninit<T>, Status> {
    check(pointer.addr(), align_of::<T>())?;
    // SAFETY: checked above; the rest is the caller's.
    Ok(unsafe { &mut *pointer.cast() })
}

fn status(result: Result<(), Status>) -> Status {
    result.err().unwrap_or(Status::Ok)
}

/// The pointer, if an object was initialised there: such an object holds its own address `offset`
/// bytes behind its start.
///
/// # Safety
/// Where that address is the pointer's, there is a `T`.
unsafe fn initialised<T>(object: *mut T, offset: usize) -> Result<*mut T, Status> {
    if object.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: as this function's; the address is looked at alone, since memory that was not
    // initialised is no `T`.
    let address = *unsafe { read(object.wrapping_byte_add(offset).cast::<usize>())? };
    let is_there = address == object.addr() && object.is_aligned();
    if is_there { Ok(object) } else { Err(Status::NotInitialised) }
}

/// The matcher at a pointer, which is busy from here on.
///
/// # Safety
/// As [`with`].
#[inline(never)]
unsafe fn enter<'a>(matcher: *mut Handle) -> Result<&'a Handle, Status> {
    // SAFETY: as this function's.
    let found = unsafe { &*initialised(matcher, core::mem::offset_of!(Handle, address))? };
    if found.is_busy.replace(true) { Err(Status::Busy) } else { Ok(found) }
}

/// Works with the engine of a matcher, which nobody else does meanwhile: calls of the same matcher
/// from a callback are refused.
///
/// # Safety
/// The pointer is what `linestereo_init` gave, or null; another thread does not use it.
unsafe fn with(
    matcher: *mut Handle,
    work: impl FnOnce(&mut Engine) -> Result<(), Status>,
) -> Status {
    // SAFETY: as this function's.
    let found = match unsafe { enter(matcher) } {
        Ok(found) => found,
        Err(status) => return status,
    };
    // SAFETY: whoever else comes here finds it busy.
    let result = work(unsafe { &mut *found.engine.get() });
    found.is_busy.set(false);
    status(result)
}

/// The same, for a result.
///
/// # Safety
/// As [`with`] and [`room`].
unsafe fn with_room<T>(
    matcher: *mut Handle,
    pointer: *mut T,
    work: impl FnOnce(&mut Engine, &mut MaybeUninit<T>) -> Result<(), Status>,
) -> Status {
    // SAFETY: as this function's.
    match unsafe { room(pointer) } {
        // SAFETY: as this function's.
        Ok(room) => unsafe { with(matcher, |engine| work(engine, room)) },
        Err(status) => status,
    }
}

/// The same, for a depth: its numbers are 0 where there is none, whatever the reason.
///
/// # Safety
/// As [`with_room`].
unsafe fn with_depth(
    matcher: *mut Handle,
    depth: *mut Depth,
    work: impl FnOnce(&mut Engine, &mut Depth) -> Result<(), Status>,
) -> Status {
    // SAFETY: as this function's.
    match unsafe { room(depth) } {
        Ok(room) => {
            let depth = room.write(Depth::NONE);
            // SAFETY: as this function's.
            unsafe { with(matcher, |engine| work(engine, depth)) }
        }
        Err(status) => status,
    }
}

/// A view of an image.
///
/// # Safety
/// As [`read`], for the image, its pixels and its spans, until the next pair was matched.
unsafe fn view(image: *const Image, engine: &Engine) -> Result<Gray<'static>, Status> {
    // SAFETY: as this function's.
    let image = unsafe { read(image)? };
    // SAFETY: as this function's.
    let pixels = unsafe { list(image.pixels, image.bytes)? };
    // SAFETY: as this function's; both structures have the same fields in the layout of C.
    let valid = unsafe { list(image.valid.cast::<CoreSpan>(), image.valid_count)? };
    let view = Gray::new(pixels, engine.dims(), image.stride)?;
    if valid.is_empty() { Ok(view) } else { Ok(view.with_valid(valid)?) }
}

/// The default parameters for images of this size, px.
#[unsafe(no_mangle)]
pub extern "C" fn linestereo_config(width: u16, height: u16) -> Config {
    Config::new(width, height)
}

/// Bytes of memory that a matcher with these parameters takes, aligned to 8; 0 when
/// `linestereo_init` refuses them. For a static: `LINESTEREO_MEMORY_WORDS`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_scratch_size(config: *const Config) -> usize {
    // SAFETY: as this function's.
    let config = unsafe { read(config) };
    config.and_then(Config::words).map_or(0, |words| (HEAD + words) * size_of::<Word>())
}

/// Makes a matcher in this memory, which is its own until its last use, and stays where it is. No
/// memory has to be freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_init(
    memory: *mut c_void,
    size: usize,
    config: *const Config,
    matcher: *mut *mut Handle,
) -> Status {
    let make = || {
        // SAFETY: as this function's.
        let (config, room) = unsafe { (read(config)?, room(matcher)?) };
        // First: linestereo_scratch_size is 0 of what is refused here, and the memory too small for
        // anything.
        let of_core = config.matcher()?;
        let memory: *mut Word = memory.cast();
        check(memory.addr(), align_of::<Word>())?;
        let words = (size / size_of::<Word>()) & MOST_WORDS;
        let rest = words.checked_sub(HEAD).ok_or(Status::MemoryTooSmall)?;
        // SAFETY: there are so many words, aligned, behind the matcher; those that it takes are its
        // own from here on.
        let rest = unsafe { core::slice::from_raw_parts_mut(memory.add(HEAD), rest) };
        let capacity = config.capacity();
        let rest = rest.get_mut(..capacity.words()).ok_or(Status::MemoryTooSmall)?;
        let rest = MemorySlice::new(rest, capacity.segments);
        let engine = UnsafeCell::new(Engine::new(of_core, rest));
        let made: *mut Handle = memory.cast();
        // SAFETY: the first `HEAD` words have room for it, and are aligned.
        unsafe { made.write(Handle { address: made.addr(), is_busy: Cell::new(false), engine }) };
        room.write(made);
        Ok(())
    };
    status(make())
}

/// Matches a pair, rectified: a point lies on one row in both images. `times_us` are both times of
/// capture, us of one clock, or null. A pair that is not fit to be used is
/// `LINESTEREO_STATUS_PAIR_UNFIT`; its health can be asked for as that of any other. After
/// images that are refused there is no pair: every question is `LINESTEREO_STATUS_NO_PAIR`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_run(
    matcher: *mut Handle,
    left: *const Image,
    right: *const Image,
    times_us: *const u64,
) -> Status {
    // SAFETY: as this function's.
    unsafe { run(matcher, left, right, times_us, Ok(None)) }
}

/// The same in and just around these areas of the left image alone: less work.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_run_areas(
    matcher: *mut Handle,
    left: *const Image,
    right: *const Image,
    times_us: *const u64,
    areas: *const Area,
    count: usize,
) -> Status {
    // SAFETY: as this function's; both structures have the same fields in the layout of C.
    let areas = unsafe { list(areas.cast::<CoreArea>(), count) };
    // SAFETY: as this function's.
    unsafe { run(matcher, left, right, times_us, areas.map(Some)) }
}

/// # Safety
/// As [`linestereo_run_areas`].
unsafe fn run(
    matcher: *mut Handle,
    left: *const Image,
    right: *const Image,
    times_us: *const u64,
    areas: Result<Option<&[CoreArea]>, Status>,
) -> Status {
    let work = |engine: &mut Engine| {
        // Of a pair that is refused too: results of the one before would pass for its own.
        engine.forget();
        let times_us = if times_us.is_null() {
            None
        } else {
            // SAFETY: as this function's.
            Some(*unsafe { read(times_us.cast::<[u64; 2]>())? })
        };
        // SAFETY: as this function's.
        let (left, right) = unsafe { (view(left, engine)?, view(right, engine)?) };
        engine.run(left, right, Options { areas: areas?, times_us, ..Options::default() })
    };
    // SAFETY: as this function's.
    unsafe { with(matcher, work) }
}

/// Faults of the last pair, and its counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_health(matcher: *mut Handle, health: *mut Health) -> Status {
    // SAFETY: as this function's.
    unsafe {
        with_room(matcher, health, |engine, room| {
            engine.health().map(|health| _ = room.write(health))
        })
    }
}

/// Segment `index` of the last pair, from 0, most confident first.
/// `LinestereoHealth.segments_matched` says how many there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_segment(
    matcher: *mut Handle,
    index: usize,
    segment: *mut Segment,
) -> Status {
    // SAFETY: as this function's.
    unsafe {
        with_room(matcher, segment, |engine, room| {
            engine.segment(index).map(|found| _ = room.write(found))
        })
    }
}

/// Bar `index` of the last pair, from 0, by its first row. `LinestereoHealth.bars` says how many
/// there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_bar(
    matcher: *mut Handle,
    index: usize,
    bar: *mut Bar,
) -> Status {
    let work = |engine: &mut Engine, room: &mut MaybeUninit<Bar>| {
        room.write(engine.bar(index)?);
        Ok(())
    };
    // SAFETY: as this function's.
    unsafe { with_room(matcher, bar, work) }
}

/// States the camera's pose for the pairs that follow: measured by an IMU before each pair, or
/// once, as it is mounted. The ground is looked for there alone, and taken as stated where it is
/// not seen. Null, as at first: it is looked for in the images. A refused pose changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_expect_ground(
    matcher: *mut Handle,
    pose: *const CameraPose,
) -> Status {
    let work = |engine: &mut Engine| {
        // SAFETY: as this function's.
        let pose = if pose.is_null() { None } else { Some(unsafe { read(pose)? }) };
        engine.expect_ground(pose)
    };
    // SAFETY: as this function's.
    unsafe { with(matcher, work) }
}

/// The ground plane of the last pair, found or stated; `LINESTEREO_STATUS_NO_GROUND` where there
/// is none, as in a pair that is not fit to be used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_ground(matcher: *mut Handle, ground: *mut Ground) -> Status {
    let work = |engine: &mut Engine, room: &mut MaybeUninit<Ground>| {
        room.write(engine.ground()?);
        Ok(())
    };
    // SAFETY: as this function's.
    unsafe { with_room(matcher, ground, work) }
}

/// Calls `each` with every point of the last pair, at most one per pixel: support points, then
/// those of bars, then those of segments, most probable first. The callback must return, and not
/// call the same matcher.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_points(
    matcher: *mut Handle,
    each: PointCallback,
    context: *mut c_void,
) -> Status {
    let Some(each) = each else { return Status::Null };
    // SAFETY: the callback is one of C's with these arguments.
    let tell = |point: Point| unsafe { each(context, &raw const point) };
    // SAFETY: as this function's.
    unsafe { with(matcher, |engine| engine.points(tell)) }
}

/// The same points as a list, for languages that have no callbacks: the first `capacity` of them,
/// which `points` has room for. `count` becomes the number of all: at most one per pixel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_point_list(
    matcher: *mut Handle,
    points: *mut Point,
    capacity: usize,
    count: *mut usize,
) -> Status {
    let work = |engine: &mut Engine, room: &mut MaybeUninit<usize>| {
        // SAFETY: as this function's; they may have any content.
        unsafe { list(points.cast::<MaybeUninit<Point>>(), capacity)? };
        let mut found = 0;
        engine.points(|point| {
            if found < capacity {
                // SAFETY: neither null nor misaligned, and within the room that the caller states.
                unsafe { points.add(found).write(point) };
            }
            found = found.saturating_add(1);
        })?;
        room.write(found);
        Ok(())
    };
    // SAFETY: as this function's.
    unsafe { with_room(matcher, count, work) }
}

/// The depth of what lies in a box of the left image, or from 100 on why there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_box(
    matcher: *mut Handle,
    area: *const Area,
    depth: *mut Depth,
) -> Status {
    let work = |engine: &mut Engine, depth: &mut Depth| {
        // SAFETY: as this function's; both structures have the same fields in the layout of C.
        let area = *unsafe { read(area.cast::<CoreArea>())? };
        engine.object(&Region::boxed(0, area, engine.dims())?, depth)
    };
    // SAFETY: as this function's.
    unsafe { with_depth(matcher, depth, work) }
}

/// The same of the runs with this label, sorted by row and column.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_mask(
    matcher: *mut Handle,
    label: u16,
    runs: *const Run,
    count: usize,
    depth: *mut Depth,
) -> Status {
    let work = |engine: &mut Engine, depth: &mut Depth| {
        // SAFETY: as this function's; both structures have the same fields in the layout of C.
        let runs = unsafe { list(runs.cast::<CoreRun>(), count)? };
        engine.object(&Region::masked(label, runs, engine.dims())?, depth)
    };
    // SAFETY: as this function's.
    unsafe { with_depth(matcher, depth, work) }
}

/// The depth of a pixel of the left image, on a segment or not, or from 100 on why there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_pixel(
    matcher: *mut Handle,
    x: u16,
    y: u16,
    depth: *mut Depth,
) -> Status {
    // SAFETY: as this function's.
    unsafe { with_depth(matcher, depth, |engine, depth| engine.pixel((x, y), depth)) }
}

/// Position in space of what is seen at `x_q5`, `y_q5` (1/32 px) of the left image with this
/// disparity (1/64 px): x right, y down, z forward of the left camera, three numbers of 1/65536 m.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_position(
    matcher: *mut Handle,
    x_q5: u16,
    y_q5: u16,
    disparity_q6: i16,
    xyz_q16: *mut i32,
) -> Status {
    let work = |engine: &mut Engine, room: &mut MaybeUninit<[i32; 3]>| {
        room.write(engine.position(x_q5, y_q5, disparity_q6)?);
        Ok(())
    };
    // SAFETY: as this function's.
    unsafe { with_room(matcher, xyz_q16.cast(), work) }
}

/// The default parameters of obstacles by direction.
#[unsafe(no_mangle)]
pub extern "C" fn linestereo_obstacle_config() -> ObstacleConfig {
    ObstacleConfig::new()
}

/// Makes obstacles of which nothing is known, for the images and the rig of this matcher, which
/// needs one. For other heights: more of them, beside the same matcher.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_obstacles_init(
    obstacles: *mut Obstacles,
    matcher: *mut Handle,
    config: *const ObstacleConfig,
) -> Status {
    let work = |engine: &mut Engine, room: &mut MaybeUninit<Directions>| {
        // SAFETY: as this function's.
        let config = unsafe { read(config)? };
        room.write(Directions::new(obstacles.addr(), config, engine)?);
        Ok(())
    };
    if let Err(status) = check(obstacles.addr(), align_of::<Obstacles>()) {
        return status;
    }
    // SAFETY: as this function's; the content is no larger.
    unsafe { with_room(matcher, obstacles.cast(), work) }
}

/// Takes what the last pair of the matcher shows, once for each pair; `time_us` is its time of
/// capture, us of any steady clock. `LINESTEREO_STATUS_PAIR_UNFIT`, also after
/// `linestereo_run_areas`, and `LINESTEREO_STATUS_NO_PAIR`: nothing is taken, and what is known
/// ages.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_obstacles_update(
    obstacles: *mut Obstacles,
    matcher: *mut Handle,
    time_us: u64,
) -> Status {
    // SAFETY: as this function's.
    match unsafe { directions(obstacles) } {
        // SAFETY: as this function's.
        Ok(directions) => unsafe { with(matcher, |engine| directions.update(engine, time_us)) },
        Err(status) => status,
    }
}

/// The nearest obstacle and the nearest drop-off of a direction, as known at `time_us` of the same
/// clock. Sector 0 is ahead of the vehicle, then clockwise, seen from above.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn linestereo_sector(
    obstacles: *const Obstacles,
    index: usize,
    time_us: u64,
    sector: *mut Sector,
) -> Status {
    // SAFETY: as this function's.
    let find = || unsafe {
        let (directions, room) = (directions(obstacles.cast_mut())?, room(sector)?);
        room.write(directions.sector(index, time_us)?);
        Ok(())
    };
    status(find())
}

/// The content of obstacles, which `linestereo_obstacles_init` wrote.
///
/// # Safety
/// As [`read`]; nobody else uses them during `'a`.
unsafe fn directions<'a>(obstacles: *mut Obstacles) -> Result<&'a mut Directions, Status> {
    let address = core::mem::offset_of!(Directions, address);
    // SAFETY: as this function's.
    unsafe { Ok(&mut *initialised(obstacles.cast::<Directions>(), address)?) }
}

/// A status in words; never null.
#[unsafe(no_mangle)]
pub extern "C" fn linestereo_status_text(status: i32) -> *const c_char {
    Status::text(status).unwrap_or(c"no status of linestereo").as_ptr()
}

/// Name of a fault by its bit, 0 to 23, as in the JSON of the PC's program; null for other bits.
#[unsafe(no_mangle)]
pub extern "C" fn linestereo_fault_name(bit: u32) -> *const c_char {
    FAULT_NAMES.get(bit as usize).map_or(core::ptr::null(), |name| name.as_ptr().cast())
}
