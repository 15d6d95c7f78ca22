//! Public entry points of core, rig and wire as exported functions, and a panic handler that calls
//! a function which does not exist.
//!
//! `tests/tests/no_panic.rs` builds this and checks that no exported `proof_*` function can reach
//! the handler.
#![no_std]

/// The README's firmware: boards' compilers read it here.
#[allow(unused_attributes, reason = "elsewhere it is a crate of its own")]
#[path = "../../../docs/firmware-example/src/lib.rs"]
pub mod firmware;

use core::panic::PanicInfo;
use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::health::{HealthFlags, HealthLimits, HealthMonitor, PairHealth};
use linestereo::image::{Span, ViewError};
use linestereo::objects::{LabelRows, RegionError, Run};
use linestereo::obstacles::{ObstacleError, ObstacleParams, ObstaclePlan, Obstacles, Sector};
use linestereo::params::{ParamError, RigError};
use linestereo::results::{Counts, Match, PixelDepth, PixelRejection, Point, Rejection};
use linestereo::units::{Depth, Disparity};
use linestereo::unstable::StageDigests;
use linestereo::{Area, Capacity, Dims, Gray, Matched, Matcher, NoDepth, ObjectDepth, Options, Params, Region, Rig, RunError};
use linestereo_rig::{
    Band, Calibration, CalibrationError, Camera, CameraError, CameraSide, Lens, Mesh, MeshError, Rectification,
    RectifyError, Remap, RigImage, RigImageError, RowError, View, mesh_nodes,
};
use linestereo_wire::{
    Command, DecodeError, Decoder, EncodeError, FrameHead, MAX_COMMAND, MAX_PACKET, Message, ObjectRecord, ParamUpdate,
    PointStream, Refusal, SendError, Setting, encode, send_frame, send_objects, send_sectors,
};

const QVGA: Dims = Dims { width: 320, height: 240 };
/// Capacities of a QVGA board; the code is the same for all.
type BoardMemory = linestereo::Memory<{ Capacity::new(QVGA).words() }>;

unsafe extern "C" {
    /// Defined nowhere: what refers to it may panic. Takes the location, or the compiler would drop
    /// it from the machine code.
    fn panic_is_reachable(location: *const u8) -> !;
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let location = info.location().map_or(core::ptr::null(), |location| core::ptr::from_ref(location).cast());
    // SAFETY: never runs, this library is not linked into anything.
    unsafe { panic_is_reachable(location) }
}

/// The detector's own test: this one does reach the handler.
#[unsafe(no_mangle)]
pub fn control_index(list: &[u8], index: usize) -> u8 {
    list[index]
}

#[unsafe(no_mangle)]
pub fn proof_view(pixels: &[u8], dims: Dims, stride: usize) -> Result<Gray<'_>, ViewError> {
    Gray::new(pixels, dims, stride)
}

#[unsafe(no_mangle)]
pub fn proof_row(image: Gray<'_>, y: usize) -> Option<&[u8]> {
    image.row(y)
}

#[unsafe(no_mangle)]
pub fn proof_rig(focal_px: f32, baseline_m: f32, offset_px: f32) -> Result<Rig, RigError> {
    Rig::new(focal_px, baseline_m, offset_px)
}

#[unsafe(no_mangle)]
pub fn proof_depth(rig: &Rig, disparity: Disparity, sigma: Disparity) -> (Depth, Depth) {
    (rig.depth(disparity), rig.depth_sigma(disparity, sigma))
}

#[unsafe(no_mangle)]
pub fn proof_interval(rig: &Rig, disparity: Disparity, nearer: Depth, farther: Depth) -> (Disparity, Disparity) {
    rig.disparity_interval(disparity, nearer, farther)
}

#[unsafe(no_mangle)]
pub fn proof_pose(matcher: &mut Matcher, pose: CameraPose, rig: &Rig) -> Option<CameraPose> {
    let plane = GroundPlane::of_pose(pose, rig, matcher.dims()).ok();
    matcher.expect_ground(plane);
    CameraPose::of_plane(plane?, rig, matcher.dims())
}

#[unsafe(no_mangle)]
pub fn proof_check(params: &Params, dims: Dims) -> Result<(), ParamError> {
    params.check(dims)
}

#[unsafe(no_mangle)]
pub fn proof_matcher(params: &Params, dims: Dims) -> Result<Matcher, ParamError> {
    Matcher::new(*params, dims)
}

#[unsafe(no_mangle)]
pub fn proof_params(matcher: &mut Matcher, params: &Params, dims: Dims) -> Result<(), ParamError> {
    matcher.set_params(*params, dims)
}

#[unsafe(no_mangle)]
pub fn proof_run<'a>(
    matcher: &mut Matcher,
    memory: &'a mut BoardMemory,
    [left, right]: [Gray<'a>; 2],
) -> Result<Matched<'a>, RunError> {
    matcher.run(memory, left, right)
}

#[unsafe(no_mangle)]
pub fn proof_run_with<'a>(
    matcher: &mut Matcher,
    memory: &'a mut BoardMemory,
    [left, right]: [Gray<'a>; 2],
    areas: Option<&[Area]>,
    times_us: Option<[u64; 2]>,
    digests: &mut StageDigests,
) -> Result<Matched<'a>, RunError> {
    matcher.run_with(memory, left, right, Options { areas, times_us, observer: Some(digests) })
}

#[unsafe(no_mangle)]
pub fn proof_points(matched: &mut Matched<'_>, each: fn(Point)) -> usize {
    matched.points().for_each(each);
    for point in matched.points() {
        each(point);
    }
    matched.support_points().for_each(each);
    matched.segments().len() + matched.candidates().len()
}

#[unsafe(no_mangle)]
pub fn proof_valid<'a>(image: Gray<'a>, usable: &'a [Span]) -> Result<Gray<'a>, ViewError> {
    image.with_valid(usable)
}

#[unsafe(no_mangle)]
pub fn proof_pixel(
    matched: &mut Matched<'_>,
    pixel: (u16, u16),
    region: &Region<'_>,
) -> [Result<PixelDepth, PixelRejection>; 2] {
    [matched.pixel(pixel), matched.pixel_of(pixel, region)]
}

#[unsafe(no_mangle)]
pub fn proof_object(
    matched: &mut Matched<'_>,
    region: &Region<'_>,
) -> Result<ObjectDepth, NoDepth> {
    matched.object(region)
}

#[unsafe(no_mangle)]
pub fn proof_regions<'a>(label: u16, area: Area, runs: &'a [Run], dims: Dims) -> [Result<Region<'a>, RegionError>; 2] {
    [Region::boxed(label, area, dims), Region::masked(label, runs, dims)]
}

#[unsafe(no_mangle)]
pub fn proof_contains(region: &Region<'_>, x: i32, y: i32) -> bool {
    region.contains(x, y)
}

#[unsafe(no_mangle)]
pub fn proof_label_rows(rows: &mut LabelRows<'_>, row: &[u16]) -> (Option<u16>, u32) {
    rows.push(row);
    (rows.labels().last(), rows.dropped())
}

#[unsafe(no_mangle)]
pub fn proof_counts(counts: &Counts, reason: Rejection) -> u16 {
    counts.rejected(reason)
}

type BoardMesh = Mesh<{ mesh_nodes(QVGA) }, 240>;

#[unsafe(no_mangle)]
pub fn proof_camera(
    dims: Dims,
    focal: [f64; 2],
    centre: [f64; 2],
    skew: f64,
    lens: Lens,
) -> Result<Camera, CameraError> {
    Camera::new(dims, focal, centre, skew, lens)
}

#[unsafe(no_mangle)]
pub fn proof_rays(camera: &Camera, ray: [f64; 3], raw: [f64; 2]) -> (Option<[f64; 2]>, Option<[f64; 2]>) {
    (camera.project(ray), camera.unproject(raw))
}

#[unsafe(no_mangle)]
pub fn proof_calibration(
    left: Camera,
    right: Camera,
    rotation: [f64; 4],
    translation: [f64; 3],
) -> Result<Calibration, CalibrationError> {
    Calibration::new(left, right, rotation, translation)
}

#[unsafe(no_mangle)]
pub fn proof_rectify(rig: &Calibration, dims: Dims, view: View) -> Result<Rectification, RectifyError> {
    rig.rectify(dims, view)
}

#[unsafe(no_mangle)]
pub fn proof_rectify_as(
    rig: &Calibration,
    dims: Dims,
    rotations: [[[f64; 3]; 3]; 2],
    focal: f64,
    centre: [f64; 2],
) -> Result<Rectification, RectifyError> {
    rig.rectify_as(dims, rotations, focal, centre)
}

#[unsafe(no_mangle)]
pub fn proof_positions(
    rectification: &Rectification,
    eye: CameraSide,
    position: [f64; 2],
) -> (Option<[f64; 2]>, Option<[f64; 2]>) {
    (rectification.source(eye, position), rectification.rectified(eye, position))
}

#[unsafe(no_mangle)]
pub fn proof_remap(rectification: &Rectification) -> Remap {
    rectification.remap()
}

#[unsafe(no_mangle)]
pub fn proof_mesh(mesh: &mut BoardMesh, remap: &Remap, eye: CameraSide) -> Result<(), MeshError> {
    mesh.build(remap, eye)
}

#[unsafe(no_mangle)]
pub fn proof_mesh_source(mesh: &BoardMesh, x: u16, y: u16) -> (Option<[i32; 2]>, usize, f32) {
    (mesh.source(x, y), mesh.spans().len() + mesh.band_bytes(), mesh.error())
}

#[unsafe(no_mangle)]
pub fn proof_push(
    band: &mut Band<10240>,
    mesh: &BoardMesh,
    raw_row: &[u8],
    frame: &mut [u8],
) -> Result<core::ops::Range<u16>, RowError> {
    band.push(mesh, raw_row, frame)
}

#[unsafe(no_mangle)]
pub fn proof_health(
    monitor: &mut HealthMonitor,
    limits: &HealthLimits,
    images: [Gray<'_>; 2],
    times_us: Option<[u64; 2]>,
    matched: &Matched<'_>,
) -> PairHealth {
    let [left, right] = images;
    let mut health = monitor.check_images(limits, left, right, times_us);
    monitor.check_matches(limits, images, &matched.findings(), &mut health);
    health
}

#[unsafe(no_mangle)]
pub fn proof_obstacle_plan(
    wanted: &ObstacleParams,
    params: &Params,
    dims: Dims,
) -> Result<ObstaclePlan, ObstacleError> {
    wanted.plan(params, dims)
}

#[unsafe(no_mangle)]
pub fn proof_obstacles(
    obstacles: &mut Obstacles,
    plan: &ObstaclePlan,
    matches: &[Match],
    points: &[Point],
    health: HealthFlags,
    time_us: u64,
) -> usize {
    obstacles.update(plan, matches, points.iter().copied(), health, time_us);
    obstacles.sectors(plan, time_us).filter(|sector| matches!(sector, Sector::Obstacle { .. })).count()
}

#[unsafe(no_mangle)]
pub fn proof_rig_image(bytes: &[u8]) -> Result<RigImage, RigImageError> {
    RigImage::decode(bytes)
}

#[unsafe(no_mangle)]
pub fn proof_rig_params(image: &RigImage, params: Params) -> Result<Params, RigImageError> {
    image.params(params)
}

#[unsafe(no_mangle)]
pub fn proof_rig_bytes(image: &RigImage, sequence: u32) -> [u8; RigImage::BYTES] {
    image.encode(sequence)
}

/// All that a board does with a rig's bytes before its first row.
#[unsafe(no_mangle)]
pub fn proof_rig_meshes(meshes: &mut [BoardMesh; 2], bytes: &[u8]) -> bool {
    let Ok(image) = RigImage::decode(bytes) else { return false };
    let [left, right] = meshes;
    left.build(image.remap(), CameraSide::Left).is_ok() && right.build(image.remap(), CameraSide::Right).is_ok()
}

#[unsafe(no_mangle)]
pub fn proof_valid_spans<'a>(mesh: &BoardMesh, memory: &'a mut [Span]) -> &'a [Span] {
    mesh.valid(memory)
}

#[unsafe(no_mangle)]
pub fn proof_message(decoder: &mut Decoder<Message, MAX_PACKET>, byte: u8) -> Option<Result<Message, DecodeError>> {
    decoder.push(byte)
}

#[unsafe(no_mangle)]
pub fn proof_command(decoder: &mut Decoder<Command, MAX_COMMAND>, byte: u8) -> Option<Result<Command, DecodeError>> {
    decoder.push(byte)
}

#[unsafe(no_mangle)]
pub fn proof_end(
    messages: &mut Decoder<Message, MAX_PACKET>,
    commands: &mut Decoder<Command, MAX_COMMAND>,
) -> [Option<DecodeError>; 2] {
    [messages.finish(), commands.finish()]
}

#[unsafe(no_mangle)]
pub fn proof_update(update: &ParamUpdate, params: Params, dims: Dims) -> Result<Params, Refusal> {
    update.checked(params, dims)
}

#[unsafe(no_mangle)]
pub fn proof_setting(number: u8, value: f32) -> Result<(), Refusal> {
    Setting::check(number, value)
}

#[unsafe(no_mangle)]
pub fn proof_packet<'a>(message: &Message, buffer: &'a mut [u8]) -> Result<&'a [u8], EncodeError> {
    encode(message, buffer)
}

#[unsafe(no_mangle)]
pub fn proof_command_packet<'a>(command: &Command, buffer: &'a mut [u8]) -> Result<&'a [u8], EncodeError> {
    encode(command, buffer)
}

type Write = fn(&[u8]) -> Result<(), ()>;

#[unsafe(no_mangle)]
pub fn proof_send(
    head: &FrameHead,
    matches: &[Match],
    points: &[Point],
    objects: &[ObjectRecord],
    (plan, obstacles): (&ObstaclePlan, &Obstacles),
    mut write: Write,
) -> Result<(), SendError<()>> {
    send_frame(head, matches, &mut write)?;
    let mut stream = PointStream::new(head.sequence);
    points.iter().try_for_each(|point| stream.push(point, &mut write))?;
    stream.finish(&mut write)?;
    send_objects(head.sequence, objects, &mut write)?;
    send_sectors(head.sequence, plan, obstacles, 0, &mut write)
}

#[unsafe(no_mangle)]
pub fn proof_record(object: &ObjectRecord) -> Result<ObjectDepth, NoDepth> {
    object.depth()
}
