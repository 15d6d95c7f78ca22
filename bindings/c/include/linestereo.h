/* Sparse stereo depth from line segments and support points: C and C++. Made by cbindgen from
   bindings/c/src; do not edit.

   Memory is the caller's, nothing is allocated, nothing is global: each matcher is used by one
   thread at a time. Left is the reference image; disparity is x_left - x_right; x grows right, y
   down, z forward. Numbers are integers with a fraction: _q6 counts 1/64, _q16 1/65536.

   Every pointer is checked for null and alignment, every length, stride and number for its range:
   LinestereoStatus says what is wrong. What else a pointer points to has to be what its type says;
   memory and images belong to the matcher until their last use. */

#ifndef LINESTEREO_H
#define LINESTEREO_H

#include <stddef.h>
#include <stdint.h>

/* Version of this header and of the library that it is made from. */
#define LINESTEREO_VERSION "0.1.0"
#define LINESTEREO_VERSION_MAJOR 0
#define LINESTEREO_VERSION_MINOR 1
#define LINESTEREO_VERSION_PATCH 0

/* Number of uint64_t of a static that holds a matcher for images of this size, so many segments in
   each image and this cell, up to 6 % more than linestereo_scratch_size says when the program runs:
   static uint64_t memory[LINESTEREO_MEMORY_WORDS(320, 240)]; is 112 KiB. */
#define LINESTEREO_MEMORY_WORDS_FOR(width, height, segments, cell) \
    (((size_t)17160 + (size_t)66 * (width) + (size_t)(width) * (height) / 8 + (size_t)24 * (segments) + \
      (size_t)160 * LINESTEREO_CELLS_(width, height, cell) + (size_t)10 * ((width) / 8) * ((height) / 8)) / 8)
/* The same with the defaults of linestereo_config. */
#define LINESTEREO_MEMORY_WORDS(width, height) LINESTEREO_MEMORY_WORDS_FOR(width, height, 1024, 20)
/* Squares of which one segment each is matched. */
#define LINESTEREO_CELLS_(width, height, cell) \
    (LINESTEREO_SIDES_(width, cell) * LINESTEREO_SIDES_(height, cell) < 4096 ? LINESTEREO_SIDES_(width, cell) * LINESTEREO_SIDES_(height, cell) : 4096)
#define LINESTEREO_SIDES_(side, cell) (((size_t)(side) + (cell) - 1) / (cell))

// Result of a call: 0 when all is well, below 100 an error of the call, from 100 on why an object
// or a pixel has no depth.
enum LinestereoStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // All is well.
  LINESTEREO_STATUS_OK = 0,
  // A pointer that has to point to something is null.
  LINESTEREO_STATUS_NULL = 1,
  // A pointer is not aligned to what it points to; memory needs 8 bytes.
  LINESTEREO_STATUS_MISALIGNED = 2,
  // The memory is smaller than `linestereo_scratch_size` says.
  LINESTEREO_STATUS_MEMORY_TOO_SMALL = 3,
  // There is no matcher, or are no obstacles, at this address: not initialised, or copied from
  // elsewhere.
  LINESTEREO_STATUS_NOT_INITIALISED = 4,
  // The call comes from a callback of the same matcher.
  LINESTEREO_STATUS_BUSY = 5,
  // No pair has been matched yet, or the last images were refused.
  LINESTEREO_STATUS_NO_PAIR = 6,
  // There are not so many segments.
  LINESTEREO_STATUS_NO_SUCH_SEGMENT = 7,
  // More elements than memory can hold.
  LINESTEREO_STATUS_TOO_MANY = 8,
  // The pair was looked at and is not fit to be used: `linestereo_health` says why.
  LINESTEREO_STATUS_PAIR_UNFIT = 9,
  // A size outside 16x16 to 1280x1280.
  LINESTEREO_STATUS_IMAGE_SIZE = 10,
  // A stride shorter than a row.
  LINESTEREO_STATUS_STRIDE = 11,
  // The image ends before its last row does.
  LINESTEREO_STATUS_IMAGE_TOO_SHORT = 12,
  // The number of spans of valid pixels is not that of rows.
  LINESTEREO_STATUS_SPAN_COUNT = 13,
  // A span of valid pixels starts after its end, or ends outside of the image.
  LINESTEREO_STATUS_SPAN = 14,
  // `segments` is outside its range.
  LINESTEREO_STATUS_SEGMENTS = 20,
  // `min_disparity` is outside its range.
  LINESTEREO_STATUS_MIN_DISPARITY = 21,
  // `max_disparity` is outside its range.
  LINESTEREO_STATUS_MAX_DISPARITY = 22,
  // `anchor_gradient` is outside its range.
  LINESTEREO_STATUS_ANCHOR_GRADIENT = 23,
  // `edge_gradient` is outside its range.
  LINESTEREO_STATUS_EDGE_GRADIENT = 24,
  // `min_extent` is outside its range.
  LINESTEREO_STATUS_MIN_EXTENT = 25,
  // `cell` is outside its range.
  LINESTEREO_STATUS_CELL = 26,
  // `reach` is outside its range.
  LINESTEREO_STATUS_REACH = 27,
  // `min_confidence_q16` is outside its range.
  LINESTEREO_STATUS_MIN_CONFIDENCE = 28,
  // `margin_q6` is outside its range.
  LINESTEREO_STATUS_MARGIN = 29,
  // `focal_px` is outside its range.
  LINESTEREO_STATUS_FOCAL = 30,
  // `baseline_m` is outside its range.
  LINESTEREO_STATUS_BASELINE = 31,
  // `disparity_offset_px` is outside its range.
  LINESTEREO_STATUS_OFFSET = 32,
  // `principal_point_px` is outside its range.
  LINESTEREO_STATUS_PRINCIPAL_POINT = 33,
  // There is no rig, and without one no depth in metres.
  LINESTEREO_STATUS_NO_RIG = 34,
  // The depth of this disparity is infinite.
  LINESTEREO_STATUS_INFINITE = 35,
  // There are not so many bars.
  LINESTEREO_STATUS_NO_SUCH_BAR = 36,
  // A region without pixels.
  LINESTEREO_STATUS_REGION_EMPTY = 40,
  // A region outside of the image.
  LINESTEREO_STATUS_REGION_OUTSIDE = 41,
  // A run of a mask is empty, outside of the image, or not behind the run before it.
  LINESTEREO_STATUS_REGION_RUN = 42,
  // There are not so many sectors.
  LINESTEREO_STATUS_NO_SUCH_SECTOR = 50,
  // `yaw_deg` is outside its range.
  LINESTEREO_STATUS_YAW = 51,
  // `sectors` is outside its range.
  LINESTEREO_STATUS_SECTORS = 52,
  // `range_m` is outside its range.
  LINESTEREO_STATUS_SECTOR_RANGE = 53,
  // `heights_m` is outside its range.
  LINESTEREO_STATUS_HEIGHTS = 54,
  // `drop_m` is outside its range.
  LINESTEREO_STATUS_DROP_DEPTH = 55,
  // `error_probability` is outside its range.
  LINESTEREO_STATUS_ERROR_PROBABILITY = 56,
  // A number of the camera's pose is outside its range.
  LINESTEREO_STATUS_CAMERA_POSE = 60,
  // No ground plane is known in the last pair.
  LINESTEREO_STATUS_NO_GROUND = 61,
  // No depth: too few credible hypotheses in the region.
  LINESTEREO_STATUS_LITTLE_SUPPORT = 100,
  // No depth: two surfaces explain the region equally well.
  LINESTEREO_STATUS_TWO_SURFACES = 101,
  // No depth: hypotheses on the outline only.
  LINESTEREO_STATUS_ONLY_OUTLINE = 102,
  // No depth: the pair is not fit to be used.
  LINESTEREO_STATUS_UNHEALTHY_PAIR = 103,
  // No depth: the same pixels in both images.
  LINESTEREO_STATUS_NO_PARALLAX = 104,
  // No depth: the pixel lies outside of the valid image.
  LINESTEREO_STATUS_PIXEL_OUTSIDE = 110,
  // No depth: too close to the border to compare disparities.
  LINESTEREO_STATUS_NEAR_BORDER = 111,
  // No depth: nothing to match around the pixel.
  LINESTEREO_STATUS_NO_TEXTURE = 112,
  // No depth: hidden in the right image, most likely.
  LINESTEREO_STATUS_LEFT_RIGHT = 113,
  // No depth: another disparity matches nearly as well.
  LINESTEREO_STATUS_NOT_UNIQUE = 114,
  // No depth: not credible enough.
  LINESTEREO_STATUS_LOW_CONFIDENCE = 115,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LinestereoStatus LinestereoStatus;
#else
typedef int32_t LinestereoStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The side or sides of a segment whose surface the edge belongs to.
enum LinestereoOwner
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Side of smaller x; above, where |dx| > 4 |dy|.
  LINESTEREO_OWNER_LEFT = 0,
  // Side of larger x; below, where |dx| > 4 |dy|.
  LINESTEREO_OWNER_RIGHT = 1,
  // Both: texture inside a surface.
  LINESTEREO_OWNER_BOTH = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LinestereoOwner LinestereoOwner;
#else
typedef uint16_t LinestereoOwner;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// State of a direction.
enum LinestereoSectorState
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint16_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Not in view of the camera.
  LINESTEREO_SECTOR_STATE_OUTSIDE = 0,
  // In view, but without evidence, or with evidence that is too old.
  LINESTEREO_SECTOR_STATE_UNKNOWN = 1,
  // Surfaces behind the range are seen, and none within it. Obstacles without texture, such as a
  // blank wall, are not detected.
  LINESTEREO_SECTOR_STATE_FREE = 2,
  // An obstacle within the range.
  LINESTEREO_SECTOR_STATE_OBSTACLE = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LinestereoSectorState LinestereoSectorState;
#else
typedef uint16_t LinestereoSectorState;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Faults of a pair, a bit each.
enum LinestereoFault
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The left image is too dark or too bright.
  LINESTEREO_FAULT_LEFT_EXPOSURE = 1,
  // The right image is too dark or too bright.
  LINESTEREO_FAULT_RIGHT_EXPOSURE = 2,
  // Much of the left image is black or white.
  LINESTEREO_FAULT_LEFT_SATURATED = 4,
  // Much of the right image is black or white.
  LINESTEREO_FAULT_RIGHT_SATURATED = 8,
  // The left image is one grey level.
  LINESTEREO_FAULT_LEFT_DEAD = 16,
  // The right image is one grey level.
  LINESTEREO_FAULT_RIGHT_DEAD = 32,
  // The left image has almost no detail.
  LINESTEREO_FAULT_LEFT_COVERED = 64,
  // The right image has almost no detail.
  LINESTEREO_FAULT_RIGHT_COVERED = 128,
  // The left image repeats the one before.
  LINESTEREO_FAULT_LEFT_FROZEN = 256,
  // The right image repeats the one before.
  LINESTEREO_FAULT_RIGHT_FROZEN = 512,
  // Too few pixels of the left image are valid.
  LINESTEREO_FAULT_LEFT_VIEW = 1024,
  // Too few pixels of the right image are valid.
  LINESTEREO_FAULT_RIGHT_VIEW = 2048,
  // One image is much brighter than the other.
  LINESTEREO_FAULT_EXPOSURES_DIFFER = 4096,
  // Captured too far apart in time: the pair is refused.
  LINESTEREO_FAULT_SKEW = 8192,
  // Rows do not match; the matcher corrects it.
  LINESTEREO_FAULT_ROWS_OFF = 16384,
  // The difference of rows changes.
  LINESTEREO_FAULT_ROWS_DRIFT = 32768,
  // The difference of rows varies over the image.
  LINESTEREO_FAULT_ROWS_UNEVEN = 65536,
  // Few of the left segments are matched.
  LINESTEREO_FAULT_FEW_MATCHES = 131072,
  // Several credible matches lie beyond infinity.
  LINESTEREO_FAULT_BEYOND_INFINITY = 262144,
  // Something is nearer than the disparity range allows.
  LINESTEREO_FAULT_RANGE_SMALL = 524288,
  // Most of what is matched has no parallax.
  LINESTEREO_FAULT_NO_PARALLAX = 1048576,
  // Both images show something at the same pixels.
  LINESTEREO_FAULT_SAME_PIXEL = 2097152,
  // The lower part of one image is moved sideways.
  LINESTEREO_FAULT_TORN = 4194304,
  // Rows are further apart than the matcher corrects.
  LINESTEREO_FAULT_ROWS_FAR = 8388608,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum LinestereoFault LinestereoFault;
#else
typedef uint32_t LinestereoFault;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A matcher, in memory of the caller.
typedef struct LinestereoMatcher LinestereoMatcher;

// Parameters of a matcher. Take them from `linestereo_config`, then change what differs.
typedef struct {
  // Width of both images, px; 16 to 1280.
  uint16_t width;
  // Height of both images, px; 16 to 1280.
  uint16_t height;
  // Largest number of segments listed in each image, 1 to 4096: a matter of memory. 1024; for
  // the results of the PC's program 4096, where `LinestereoHealth.is_cut` is 1.
  uint16_t segments;
  // First disparity searched, px; -32 to 0. 0.
  int16_t min_disparity;
  // End of the disparities searched, exclusive, px; 8 to 256 above `min_disparity`, below the
  // width. The nearest depth is focal length times baseline divided by `max_disparity - 1.5`.
  // 64, or what a narrower image allows.
  uint16_t max_disparity;
  // Least grey step times four at which an edge is started; 4 to 1020. 48.
  uint16_t anchor_gradient;
  // Least grey step times four along an edge; 4 to `anchor_gradient`. 20.
  uint16_t edge_gradient;
  // Least extent of a segment, px; 6 to 32. 6.
  uint16_t min_extent;
  // Side of the squares in each of which one segment is matched, px; 8 to 256. 20.
  uint16_t cell;
  // Largest distance from an edge of pixels that get its disparity, px; 1 to 6. 4.
  uint16_t reach;
  // Least probability of points and segments, 1/65536; 10 to 99 percent. 0xe666, which is 90
  // percent.
  uint16_t min_confidence_q16;
  // Largest difference between window and census, 1/64 px; 16 to 1024. 64.
  int16_t margin_q6;
  // Not 0: support points alone, a third of the work. 0.
  uint16_t support_only;
  // Not 0: the principal point is given; else it is the centre of the image. 0.
  uint16_t has_principal_point;
  // Focal length, px; 1 to 100000. 0 without a rig: disparities only. 0.
  float focal_px;
  // Distance of the cameras, m; 0.0001 to 10. Unused without a focal length.
  float baseline_m;
  // Added to every disparity: column of the principal point on the right minus that on the left,
  // px. 0.
  float disparity_offset_px;
  // Column and row of the left principal point, px; -2048 to 2048.
  float principal_point_px[2];
  // Largest time between the captures of a pair, us; beyond it a pair is refused. 1000.
  uint32_t skew_limit_us;
} LinestereoConfig;

// Columns `start` to `end`, exclusive, of a row.
typedef struct {
  // First column, px.
  uint16_t start;
  // Column after the last one, px.
  uint16_t end;
} LinestereoSpan;

// A grey image of 8 bits, row by row from the top. It stays as it is until its results were read.
typedef struct {
  // The first pixel of the first row.
  const uint8_t *pixels;
  // Bytes that may be read from there: `stride * (height - 1) + width` at least.
  size_t bytes;
  // Distance between rows, bytes; the width or more.
  size_t stride;
  // Valid pixels of each row, where a rectified image does not have all; null when it has.
  const LinestereoSpan *valid;
  // Number of these spans: the height, or 0.
  size_t valid_count;
} LinestereoImage;

// Pixels from `left`, `top` to `right`, `bottom`, exclusive, px.
typedef struct {
  // First column.
  uint16_t left;
  // First row.
  uint16_t top;
  // Column after the last one.
  uint16_t right;
  // Row after the last one.
  uint16_t bottom;
} LinestereoArea;

// Levels of one camera's image.
typedef struct {
  // Mean grey level, 0 to 255.
  uint16_t level;
  // Mean grey step between samples of a row, 1/16 grey level.
  uint16_t detail_q4;
  // Samples at 0 to 2, per thousand.
  uint16_t black_permille;
  // Samples at 253 to 255, per thousand.
  uint16_t white_permille;
  // Valid pixels, per thousand.
  uint16_t view_permille;
} LinestereoCamera;

// Faults of a pair, and its counts.
typedef struct {
  // Sum of `LinestereoFault`: faults of this pair or of one shortly before.
  uint32_t faults;
  // The same of this pair alone.
  uint32_t faults_now;
  // 1 when results may be used, 0 when they may be wrong or outdated.
  uint16_t is_fit;
  // 1 when the images were captured too far apart to be matched.
  uint16_t is_refused;
  // Left and right camera.
  LinestereoCamera cameras[2];
  // Row in the right image minus row in the left one, median, 1/256 px.
  int16_t rows_q8;
  // Matches that measured it; 0: not measured.
  uint16_t rows_samples;
  // Segments found in the left image.
  uint16_t segments_found;
  // Segments with a disparity.
  uint16_t segments_matched;
  // 1 when the list of segments was full or the budget of work spent: results are good, but not
  // all that the images have.
  uint16_t is_cut;
  // Bars in front of what is around them.
  uint16_t bars;
} LinestereoHealth;

// A segment of the left image with its disparity.
typedef struct {
  // Columns of both ends, 1/32 px; whole numbers are pixel centres.
  uint16_t x_q5[2];
  // Rows of both ends, 1/32 px.
  uint16_t y_q5[2];
  // Disparity at both ends, 1/64 px.
  int16_t disparity_q6[2];
  // Standard deviation of the disparity, 1/64 px.
  int16_t sigma_q6;
  // Probability that the disparity along the edge is within 1 px, 1/65536.
  uint16_t confidence_q16;
  // Side or sides that own the edge.
  LinestereoOwner owner;
  // Depth at both ends, 1/65536 m; 0 without a rig, INT32_MAX where it is infinite.
  int32_t depth_q16[2];
  // Standard deviation of these, 1/65536 m; 0 without a rig.
  int32_t depth_sigma_q16[2];
} LinestereoSegment;

// A pole, leg or stand of the left image, in front of what is around it.
typedef struct {
  // Columns of both ends of its left edge, top first, 1/32 px; whole numbers are pixel centres.
  uint16_t x_q5[2];
  // Rows of both ends, 1/32 px.
  uint16_t y_q5[2];
  // Width from the left to the right edge, along a row, 1/32 px.
  uint16_t width_q5;
  // Disparity at both ends, 1/64 px.
  int16_t disparity_q6[2];
  // Standard deviation of the disparity, 1/64 px.
  int16_t sigma_q6;
  // Probability that the disparity is within 1 px, 1/65536.
  uint16_t confidence_q16;
  // Depth at both ends, 1/65536 m; 0 without a rig, INT32_MAX where it is infinite.
  int32_t depth_q16[2];
  // Standard deviation of these, 1/65536 m; 0 without a rig.
  int32_t depth_sigma_q16[2];
} LinestereoBar;

// Height and attitude of the left camera above a level ground.
typedef struct {
  // Height above the ground, m; 0.01 to 100, and a quarter of the baseline or more.
  float height_m;
  // How far the optical axis points down, degrees; -80 to 80.
  float pitch_deg;
  // How far the camera is rolled, clockwise as it looks, degrees; -80 to 80.
  float roll_deg;
} LinestereoCameraPose;

// The ground plane of a pair: disparity = down * y + across * x + origin.
typedef struct {
  // Change of the disparity down the rows, 1/65536 px per row.
  int32_t down_q16;
  // Change along the columns, 1/65536 px per column.
  int32_t across_q16;
  // Disparity at the left top pixel, 1/65536 px.
  int32_t origin_q16;
  // The camera above this plane; all 0 without a rig.
  LinestereoCameraPose camera;
} LinestereoGround;

// A pixel of the left image with a disparity.
typedef struct {
  // Column, px.
  uint16_t x;
  // Row, px.
  uint16_t y;
  // Disparity, 1/64 px.
  int16_t disparity_q6;
  // Probability that it is within 1 px, 1/65536.
  uint16_t confidence_q16;
  // Index of its segment; -1: a bar, or a side of a segment that is not listed; -2: a support
  // point.
  int32_t segment;
} LinestereoPoint;

// Called with every point; `context` is what the caller gave.
typedef void (*LinestereoPointCallback)(void *context, const LinestereoPoint *point);

// The depth of an object or of a pixel; where it has none, all numbers but `support` are 0.
typedef struct {
  // Disparity, 1/64 px: of an object at its centre.
  int16_t disparity_q6;
  // Standard deviation of the disparity, 1/64 px.
  int16_t sigma_q6;
  // Probability that the disparity is within 1 px, of an object within 1 px of its range,
  // 1/65536.
  uint16_t confidence_q16;
  // Segments and support points behind an object's depth; 0 of a pixel.
  uint16_t support;
  // Depth, 1/65536 m; 0 without a rig, INT32_MAX where it is infinite.
  int32_t depth_q16;
  // Standard deviation of depth, 1/65536 m; 0 without a rig.
  int32_t depth_sigma_q16;
  // Depth of an object's nearest hypothesis, 1/65536 m; 0 without a rig, and of a pixel.
  int32_t nearest_q16;
} LinestereoDepth;

// Adjacent pixels of one row of a mask.
typedef struct {
  // Label of the object that they belong to.
  uint16_t label;
  // Row, px.
  uint16_t y;
  // Columns, px.
  LinestereoSpan span;
} LinestereoRun;

// Parameters of obstacles by direction. Take them from `linestereo_obstacle_config`, then change
// what differs.
typedef struct {
  // Direction of the optical axis, degrees clockwise from ahead, seen from above; -180 to 180.
  // 0.
  float yaw_deg;
  // Obstacles and drop-offs at this distance or farther are ignored, m; 0.1 to 600. 10.
  float range_m;
  // Lowest and highest height of obstacles, m above the camera; -1000 to 1000. All.
  float heights_m[2];
  // Least depth of a drop-off below the floor, m; 0 to 100; 0 for a vehicle that flies, which
  // has none. 0.05.
  float drop_m;
  // Largest probability that all evidence of an obstacle or a drop-off is wrong; 0.00002 to 0.5.
  // 0.01.
  float error_probability;
  // Sectors of a full turn, 4 to 72. 72, which are 5 degrees each.
  uint16_t sectors;
  // Time for which a state is kept when it is not seen again, ms. 500.
  uint16_t keep_ms;
} LinestereoObstacleConfig;

// Obstacles and drop-offs by direction, kept between pairs. For the functions alone; it stays
// where `linestereo_obstacles_init` found it. No memory has to be freed.
typedef struct {
  // Not for callers.
  uint64_t words[112];
} LinestereoObstacles;

// The nearest obstacle and the nearest drop-off of a direction.
typedef struct {
  // Unknown, free, or an obstacle at `distance_cm`.
  LinestereoSectorState state;
  // Distance of the obstacle along the ground, cm; 1 or more, below the range; 0 without one.
  uint16_t distance_cm;
  // Probability of the obstacle, or that the sector is free, 1/65536; 0 otherwise.
  uint16_t confidence_q16;
  // Distance along the ground to where the floor ends, cm; 1 or more, below the range; 0 where
  // no drop-off is known.
  uint16_t drop_off_cm;
  // Probability of the drop-off, 1/65536; 0 without one.
  uint16_t drop_off_confidence_q16;
  // Time since the obstacle or the free way was seen, ms; 0 otherwise.
  uint32_t age_ms;
  // Time since the drop-off was seen, ms; 0 without one.
  uint32_t drop_off_age_ms;
} LinestereoSector;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The default parameters for images of this size, px.
LinestereoConfig linestereo_config(uint16_t width, uint16_t height);

// Bytes of memory that a matcher with these parameters takes, aligned to 8; 0 when
// `linestereo_init` refuses them. For a static: `LINESTEREO_MEMORY_WORDS`.
size_t linestereo_scratch_size(const LinestereoConfig *config);

// Makes a matcher in this memory, which is its own until its last use, and stays where it is. No
// memory has to be freed.
LinestereoStatus linestereo_init(void *memory, size_t size, const LinestereoConfig *config, LinestereoMatcher **matcher);

// Matches a pair, rectified: a point lies on one row in both images. `times_us` are both times of
// capture, us of one clock, or null. A pair that is not fit to be used is
// `LINESTEREO_STATUS_PAIR_UNFIT`; its health can be asked for as that of any other. After
// images that are refused there is no pair: every question is `LINESTEREO_STATUS_NO_PAIR`.
LinestereoStatus linestereo_run(LinestereoMatcher *matcher,
                                const LinestereoImage *left,
                                const LinestereoImage *right,
                                const uint64_t *times_us);

// The same in and just around these areas of the left image alone: less work.
LinestereoStatus linestereo_run_areas(LinestereoMatcher *matcher,
                                      const LinestereoImage *left,
                                      const LinestereoImage *right,
                                      const uint64_t *times_us,
                                      const LinestereoArea *areas,
                                      size_t count);

// Faults of the last pair, and its counts.
LinestereoStatus linestereo_health(LinestereoMatcher *matcher, LinestereoHealth *health);

// Segment `index` of the last pair, from 0, most confident first.
// `LinestereoHealth.segments_matched` says how many there are.
LinestereoStatus linestereo_segment(LinestereoMatcher *matcher, size_t index, LinestereoSegment *segment);

// Bar `index` of the last pair, from 0, by its first row. `LinestereoHealth.bars` says how many
// there are.
LinestereoStatus linestereo_bar(LinestereoMatcher *matcher, size_t index, LinestereoBar *bar);

// States the camera's pose for the pairs that follow: measured by an IMU before each pair, or
// once, as it is mounted. The ground is looked for there alone, and taken as stated where it is
// not seen. Null, as at first: it is looked for in the images. A refused pose changes nothing.
LinestereoStatus linestereo_expect_ground(LinestereoMatcher *matcher, const LinestereoCameraPose *pose);

// The ground plane of the last pair, found or stated; `LINESTEREO_STATUS_NO_GROUND` where there
// is none, as in a pair that is not fit to be used.
LinestereoStatus linestereo_ground(LinestereoMatcher *matcher, LinestereoGround *ground);

// Calls `each` with every point of the last pair, at most one per pixel: support points, then
// those of bars, then those of segments, most probable first. The callback must return, and not
// call the same matcher.
LinestereoStatus linestereo_points(LinestereoMatcher *matcher, LinestereoPointCallback each, void *context);

// The same points as a list, for languages that have no callbacks: the first `capacity` of them,
// which `points` has room for. `count` becomes the number of all: at most one per pixel.
LinestereoStatus linestereo_point_list(LinestereoMatcher *matcher, LinestereoPoint *points, size_t capacity, size_t *count);

// The depth of what lies in a box of the left image, or from 100 on why there is none.
LinestereoStatus linestereo_box(LinestereoMatcher *matcher, const LinestereoArea *area, LinestereoDepth *depth);

// The same of the runs with this label, sorted by row and column.
LinestereoStatus linestereo_mask(LinestereoMatcher *matcher,
                                 uint16_t label,
                                 const LinestereoRun *runs,
                                 size_t count,
                                 LinestereoDepth *depth);

// The depth of a pixel of the left image, on a segment or not, or from 100 on why there is none.
LinestereoStatus linestereo_pixel(LinestereoMatcher *matcher, uint16_t x, uint16_t y, LinestereoDepth *depth);

// Position in space of what is seen at `x_q5`, `y_q5` (1/32 px) of the left image with this
// disparity (1/64 px): x right, y down, z forward of the left camera, three numbers of 1/65536 m.
LinestereoStatus linestereo_position(LinestereoMatcher *matcher, uint16_t x_q5, uint16_t y_q5, int16_t disparity_q6, int32_t *xyz_q16);

// The default parameters of obstacles by direction.
LinestereoObstacleConfig linestereo_obstacle_config(void);

// Makes obstacles of which nothing is known, for the images and the rig of this matcher, which
// needs one. For other heights: more of them, beside the same matcher.
LinestereoStatus linestereo_obstacles_init(LinestereoObstacles *obstacles,
                                           LinestereoMatcher *matcher,
                                           const LinestereoObstacleConfig *config);

// Takes what the last pair of the matcher shows, once for each pair; `time_us` is its time of
// capture, us of any steady clock. `LINESTEREO_STATUS_PAIR_UNFIT`, also after
// `linestereo_run_areas`, and `LINESTEREO_STATUS_NO_PAIR`: nothing is taken, and what is known
// ages.
LinestereoStatus linestereo_obstacles_update(LinestereoObstacles *obstacles, LinestereoMatcher *matcher, uint64_t time_us);

// The nearest obstacle and the nearest drop-off of a direction, as known at `time_us` of the same
// clock. Sector 0 is ahead of the vehicle, then clockwise, seen from above.
LinestereoStatus linestereo_sector(const LinestereoObstacles *obstacles, size_t index, uint64_t time_us, LinestereoSector *sector);

// A status in words; never null.
const char *linestereo_status_text(int32_t status);

// Name of a fault by its bit, 0 to 23, as in the JSON of the PC's program; null for other bits.
const char *linestereo_fault_name(uint32_t bit);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* LINESTEREO_H */
