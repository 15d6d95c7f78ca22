/* What no caller may do is refused with a status: ends with 0, or with the line of the first check
   that fails. */
#include <stdlib.h>
#include <string.h>

#include "linestereo.h"

#define CHECK(is_true) \
    if (!(is_true)) return __LINE__ > 250 ? 250 : __LINE__
#define REFUSED(call, code) CHECK((call) == LINESTEREO_STATUS_##code)

enum { WIDTH = 64, HEIGHT = 48 };
static uint8_t pixels[2][WIDTH * HEIGHT];

typedef struct {
    LinestereoMatcher *matcher;
    LinestereoStatus inside;
    size_t points;
} Seen;

static void call_again(void *context, const LinestereoPoint *point) {
    Seen *seen = (Seen *)context;
    LinestereoHealth health;
    seen->points += point->x < WIDTH;
    seen->inside = linestereo_health(seen->matcher, &health);
}

int main(void) {
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH, y = i / WIDTH;
        pixels[0][i] = (uint8_t)(((x * x / 40 + y / 9) % 2 ? 190 : 60) + (x * 7 + y * 13) % 9);
        pixels[1][i] = (uint8_t)((((x + 5) * (x + 5) / 40 + y / 9) % 2 ? 190 : 60) + ((x + 5) * 7 + y * 13) % 9);
    }
    LinestereoConfig config = linestereo_config(WIDTH, HEIGHT);
    CHECK(config.max_disparity == WIDTH - 1 && linestereo_config(320, 240).max_disparity == 64);
    config.max_disparity = 32;

    /* Sizes: the macro has room for every matcher, and wastes little. */
    static const uint16_t sizes[][4] = {{16, 16, 1, 8}, {64, 48, 64, 20}, {160, 120, 1024, 20}, {320, 240, 1024, 20}, {320, 240, 640, 8},
                                        {333, 251, 1024, 20}, {640, 480, 4096, 20}, {752, 480, 2048, 256}, {1280, 1280, 4096, 8}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        LinestereoConfig sized = linestereo_config(sizes[i][0], sizes[i][1]);
        sized.segments = sizes[i][2], sized.cell = sizes[i][3];
        size_t needed = linestereo_scratch_size(&sized);
        size_t given = 8 * LINESTEREO_MEMORY_WORDS_FOR(sizes[i][0], sizes[i][1], sizes[i][2], sizes[i][3]);
        CHECK(needed > 0 && needed <= given && given <= needed + needed / 16 + 2048);
    }
    CHECK(LINESTEREO_MEMORY_WORDS(320, 240) == LINESTEREO_MEMORY_WORDS_FOR(320, 240, 1024, 20));
    CHECK(LINESTEREO_VERSION[0] == '0' + LINESTEREO_VERSION_MAJOR && LINESTEREO_VERSION[2] == '0' + LINESTEREO_VERSION_MINOR);

    /* Parameters. */
    LinestereoMatcher *matcher = 0;
    size_t size = linestereo_scratch_size(&config);
    char *memory = (char *)malloc(size + 8);
    CHECK(size > 0 && memory && linestereo_scratch_size(0) == 0);
    LinestereoConfig bad = config;
    bad.width = 15;
    REFUSED(linestereo_init(memory, size, &bad, &matcher), IMAGE_SIZE);
    CHECK(linestereo_scratch_size(&bad) == 0);
    bad = config, bad.max_disparity = 64;
    REFUSED(linestereo_init(memory, size, &bad, &matcher), MAX_DISPARITY);
    bad = config, bad.segments = 0;
    REFUSED(linestereo_init(memory, size, &bad, &matcher), SEGMENTS);
    bad = config, bad.focal_px = -1;
    REFUSED(linestereo_init(memory, size, &bad, &matcher), FOCAL);
    bad = config, bad.focal_px = 100, bad.baseline_m = 0.0f / config.focal_px;
    REFUSED(linestereo_init(memory, size, &bad, &matcher), BASELINE);
    bad = config, bad.focal_px = 100, bad.baseline_m = 60.0f; /* millimetres taken for metres */
    REFUSED(linestereo_init(memory, size, &bad, &matcher), BASELINE);
    bad = config, bad.min_confidence_q16 = 0;
    REFUSED(linestereo_init(memory, size, &bad, &matcher), MIN_CONFIDENCE);

    /* Memory. */
    REFUSED(linestereo_init(0, size, &config, &matcher), NULL);
    REFUSED(linestereo_init(memory, size, 0, &matcher), NULL);
    REFUSED(linestereo_init(memory, size, &config, 0), NULL);
    REFUSED(linestereo_init(memory + 4, size, &config, &matcher), MISALIGNED);
    REFUSED(linestereo_init(memory, size - 1, &config, &matcher), MEMORY_TOO_SMALL);
    CHECK(matcher == 0);
    LinestereoHealth health;
    memset(memory, 0xa5, size + 8);
    REFUSED(linestereo_health((LinestereoMatcher *)memory, &health), NOT_INITIALISED);
    REFUSED(linestereo_health(0, &health), NULL);
    REFUSED(linestereo_health((LinestereoMatcher *)(memory + 1), &health), MISALIGNED);
    REFUSED(linestereo_init(memory, size, &config, &matcher), OK);
    for (int i = 0; i < 8; i++) CHECK(memory[size + i] == (char)0xa5);
    char *copy = (char *)malloc(size);
    CHECK(copy);
    memcpy(copy, memory, size);
    REFUSED(linestereo_health((LinestereoMatcher *)copy, &health), NOT_INITIALISED);

    /* Images. */
    LinestereoSegment segment;
    LinestereoBar bar;
    Seen seen = {matcher, LINESTEREO_STATUS_OK, 0};
    REFUSED(linestereo_health(matcher, &health), NO_PAIR);
    REFUSED(linestereo_segment(matcher, 0, &segment), NO_PAIR);
    REFUSED(linestereo_bar(matcher, 0, &bar), NO_PAIR);
    REFUSED(linestereo_points(matcher, call_again, &seen), NO_PAIR);
    LinestereoImage left = {pixels[0], sizeof pixels[0], WIDTH, 0, 0}, right = left, wrong = left;
    right.pixels = pixels[1];
    REFUSED(linestereo_run(matcher, &left, 0, 0), NULL);
    wrong.stride = WIDTH - 1;
    REFUSED(linestereo_run(matcher, &left, &wrong, 0), STRIDE);
    wrong = left, wrong.stride = (size_t)-1;
    REFUSED(linestereo_run(matcher, &left, &wrong, 0), IMAGE_TOO_SHORT);
    wrong = left, wrong.bytes -= 1;
    REFUSED(linestereo_run(matcher, &wrong, &right, 0), IMAGE_TOO_SHORT);
    wrong = left, wrong.bytes = (size_t)-1;
    REFUSED(linestereo_run(matcher, &wrong, &right, 0), TOO_MANY);
    wrong = left, wrong.pixels = 0;
    REFUSED(linestereo_run(matcher, &wrong, &right, 0), NULL);
    LinestereoSpan spans[HEIGHT];
    for (int y = 0; y < HEIGHT; y++) spans[y].start = 0, spans[y].end = WIDTH;
    wrong = left, wrong.valid = spans, wrong.valid_count = HEIGHT - 1;
    REFUSED(linestereo_run(matcher, &wrong, &right, 0), SPAN_COUNT);
    wrong.valid_count = HEIGHT, spans[9].end = WIDTH + 1;
    REFUSED(linestereo_run(matcher, &wrong, &right, 0), SPAN);
    spans[9].end = WIDTH;
    REFUSED(linestereo_run(matcher, &wrong, &right, 0), OK);
    REFUSED(linestereo_run_areas(matcher, &left, &right, 0, 0, 1), NULL);
    /* Results of the pair before would pass for those of one that was refused. */
    REFUSED(linestereo_health(matcher, &health), NO_PAIR);
    REFUSED(linestereo_run(matcher, &left, &right, 0), PAIR_UNFIT); /* frozen */
    REFUSED(linestereo_health(matcher, &health), OK);
    REFUSED(linestereo_run(matcher, &left, 0, 0), NULL);
    REFUSED(linestereo_health(matcher, &health), NO_PAIR);

    /* Results; of another matcher, which has not seen these images: they would be frozen. */
    REFUSED(linestereo_init(memory, size, &config, &matcher), OK);
    REFUSED(linestereo_run(matcher, &left, &right, 0), OK);
    REFUSED(linestereo_health(matcher, 0), NULL);
    REFUSED(linestereo_health(matcher, &health), OK);
    CHECK(health.segments_matched > 0 && health.is_fit);
    REFUSED(linestereo_segment(matcher, health.segments_matched, &segment), NO_SUCH_SEGMENT);
    REFUSED(linestereo_segment(matcher, (size_t)-1, &segment), NO_SUCH_SEGMENT);
    REFUSED(linestereo_segment(matcher, 0, &segment), OK);
    CHECK(segment.depth_q16[0] == 0);
    REFUSED(linestereo_bar(matcher, 0, 0), NULL);
    REFUSED(linestereo_bar(matcher, health.bars, &bar), NO_SUCH_BAR);
    REFUSED(linestereo_bar(matcher, (size_t)-1, &bar), NO_SUCH_BAR);
    REFUSED(linestereo_points(matcher, 0, 0), NULL);
    REFUSED(linestereo_points(matcher, call_again, &seen), OK);
    CHECK(seen.points > 100 && seen.inside == LINESTEREO_STATUS_BUSY);
    LinestereoPoint listed[9] = {{0, 0, 0, 0, 0}};
    size_t count = 0;
    REFUSED(linestereo_point_list(matcher, listed, 8, 0), NULL);
    REFUSED(linestereo_point_list(matcher, 0, 8, &count), NULL);
    REFUSED(linestereo_point_list(matcher, listed, (size_t)-1, &count), TOO_MANY);
    REFUSED(linestereo_point_list(matcher, 0, 0, &count), OK);
    CHECK(count == seen.points);
    REFUSED(linestereo_point_list(matcher, listed, 8, &count), OK);
    CHECK(count == seen.points && listed[7].confidence_q16 > 0 && listed[8].confidence_q16 == 0);
    LinestereoDepth depth;
    const LinestereoDepth none = {0, 0, 0, 0, 0, 0, 0};
    LinestereoArea area = {9, 9, 9, 20};
    REFUSED(linestereo_box(matcher, &area, &depth), REGION_EMPTY);
    area.left = 500, area.right = 600;
    REFUSED(linestereo_box(matcher, &area, &depth), REGION_OUTSIDE);
    LinestereoRun runs[2] = {{1, 20, {10, 50}}, {1, 20, {40, 60}}};
    REFUSED(linestereo_mask(matcher, 1, runs, 2, &depth), REGION_RUN);
    REFUSED(linestereo_mask(matcher, 1, 0, 0, &depth), REGION_EMPTY);
    /* No number of a depth before stays. */
    memset(&depth, 0xa5, sizeof depth);
    REFUSED(linestereo_box(matcher, &area, &depth), REGION_OUTSIDE);
    CHECK(memcmp(&depth, &none, sizeof depth) == 0);
    memset(&depth, 0xa5, sizeof depth);
    REFUSED(linestereo_pixel(matcher, WIDTH, 3, &depth), PIXEL_OUTSIDE);
    CHECK(memcmp(&depth, &none, sizeof depth) == 0);
    int32_t xyz[3];
    REFUSED(linestereo_position(matcher, 0, 0, 64, xyz), NO_RIG);
    LinestereoObstacleConfig wanted = linestereo_obstacle_config(), odd = wanted;
    LinestereoObstacles obstacles, moved;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &wanted), NO_RIG);
    uint64_t times_us[2] = {0, 5000};
    REFUSED(linestereo_run(matcher, &left, &right, times_us), PAIR_UNFIT);
    REFUSED(linestereo_run_areas(matcher, &left, &right, times_us, &area, 0), PAIR_UNFIT);
    REFUSED(linestereo_health(matcher, &health), OK);
    CHECK(health.is_refused && !health.is_fit && (health.faults & LINESTEREO_FAULT_SKEW));
    area.left = 8, area.top = 8, area.right = 56, area.bottom = 40;
    REFUSED(linestereo_box(matcher, &area, &depth), UNHEALTHY_PAIR);
    CHECK(strcmp(linestereo_fault_name(13), "skew") == 0 && linestereo_fault_name(24) == 0);

    /* A rig: 100 px * 0.1 m / 5 px. */
    config.focal_px = 100, config.baseline_m = 0.1f;
    REFUSED(linestereo_init(memory, size, &config, &matcher), OK);
    REFUSED(linestereo_run(matcher, &left, &right, 0), OK);
    REFUSED(linestereo_box(matcher, &area, &depth), OK);
    CHECK(depth.depth_q16 > 2 * 65536 - 3000 && depth.depth_q16 < 2 * 65536 + 3000);
    REFUSED(linestereo_position(matcher, 32 * 32, 24 * 32, 5 * 64, xyz), OK);
    CHECK(xyz[2] == 2 * 65536 && xyz[0] > 0 && xyz[0] < 1000);
    REFUSED(linestereo_position(matcher, 0, 0, 0, xyz), INFINITE);

    /* The ground: a wall has none, but one that is stated is taken. 0.1 m / 0.5 m px per row. */
    LinestereoCameraPose pose = {0.5f, 10, -5}, off = pose;
    LinestereoGround ground;
    REFUSED(linestereo_ground(matcher, &ground), NO_GROUND);
    REFUSED(linestereo_ground(matcher, 0), NULL);
    REFUSED(linestereo_expect_ground(0, &pose), NULL);
    LinestereoCameraPose *apart = (LinestereoCameraPose *)((char *)&pose + 1);
    REFUSED(linestereo_expect_ground(matcher, apart), MISALIGNED);
    REFUSED(linestereo_init(memory, size, &config, &matcher), OK); /* or images are frozen */
    REFUSED(linestereo_expect_ground(matcher, &pose), OK);
    off.height_m = 0.02f; /* a fifth of the baseline */
    REFUSED(linestereo_expect_ground(matcher, &off), CAMERA_POSE);
    off = pose, off.pitch_deg = 81;
    REFUSED(linestereo_expect_ground(matcher, &off), CAMERA_POSE);
    off = pose, off.roll_deg = -81;
    REFUSED(linestereo_expect_ground(matcher, &off), CAMERA_POSE);
    const char *text = linestereo_status_text(LINESTEREO_STATUS_CAMERA_POSE);
    CHECK(strstr(text, "roll_deg outside -80 to 80"));
    REFUSED(linestereo_run(matcher, &left, &right, 0), OK);
    REFUSED(linestereo_ground(matcher, &ground), OK);
    CHECK(ground.down_q16 > 12700 && ground.down_q16 < 13000 && ground.across_q16 < -1000);
    CHECK(ground.camera.height_m > 0.499f && ground.camera.height_m < 0.501f);
    CHECK(ground.camera.pitch_deg > 9.8f && ground.camera.pitch_deg < 10.2f);
    CHECK(ground.camera.roll_deg > -5.2f && ground.camera.roll_deg < -4.8f);
    REFUSED(linestereo_expect_ground(matcher, 0), OK);
    REFUSED(linestereo_init(memory, size, &config, &matcher), OK);
    REFUSED(linestereo_ground(matcher, &ground), NO_PAIR);
    REFUSED(linestereo_run(matcher, &left, &right, 0), OK);

    /* Directions. */
    CHECK(wanted.sectors == 72 && wanted.keep_ms == 500 && wanted.range_m == 10 && wanted.yaw_deg == 0);
    LinestereoSector sector;
    memset(&obstacles, 0xa5, sizeof obstacles);
    REFUSED(linestereo_sector(&obstacles, 0, 0, &sector), NOT_INITIALISED);
    REFUSED(linestereo_obstacles_update(&obstacles, matcher, 0), NOT_INITIALISED);
    REFUSED(linestereo_obstacles_init(0, matcher, &wanted), NULL);
    REFUSED(linestereo_obstacles_init((LinestereoObstacles *)(memory + 4), matcher, &wanted), MISALIGNED);
    REFUSED(linestereo_obstacles_init(&obstacles, 0, &wanted), NULL);
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, 0), NULL);
    odd.sectors = 300;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), SECTORS);
    odd.sectors = 73;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), SECTORS);
    odd = wanted, odd.yaw_deg = 181;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), YAW);
    odd = wanted, odd.range_m = 0;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), SECTOR_RANGE);
    odd = wanted, odd.heights_m[0] = -2000;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), HEIGHTS);
    odd = wanted, odd.heights_m[1] = odd.heights_m[0] - 1;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), HEIGHTS);
    odd = wanted, odd.drop_m = -1;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), DROP_DEPTH);
    odd = wanted, odd.error_probability = 1;
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &odd), ERROR_PROBABILITY);
    REFUSED(linestereo_obstacles_init(&obstacles, matcher, &wanted), OK);
    REFUSED(linestereo_sector(&obstacles, 72, 0, &sector), NO_SUCH_SECTOR);
    REFUSED(linestereo_sector(&obstacles, (size_t)-1, 0, &sector), NO_SUCH_SECTOR);
    REFUSED(linestereo_sector(&obstacles, 0, 0, 0), NULL);
    REFUSED(linestereo_sector(0, 0, 0, &sector), NULL);
    REFUSED(linestereo_sector(&obstacles, 0, 0, &sector), OK);
    CHECK(sector.state == LINESTEREO_SECTOR_STATE_UNKNOWN);
    REFUSED(linestereo_obstacles_update(&obstacles, matcher, 1000000), OK);
    REFUSED(linestereo_sector(&obstacles, 0, 1200000, &sector), OK);
    CHECK(sector.state == LINESTEREO_SECTOR_STATE_OBSTACLE && sector.distance_cm > 190 && sector.distance_cm < 210);
    CHECK(sector.age_ms == 200 && sector.confidence_q16 > 64000 && sector.drop_off_cm == 0);
    REFUSED(linestereo_sector(&obstacles, 0, 1600000, &sector), OK);
    CHECK(sector.state == LINESTEREO_SECTOR_STATE_UNKNOWN && sector.distance_cm == 0);
    REFUSED(linestereo_sector(&obstacles, 36, 1200000, &sector), OK);
    CHECK(sector.state == LINESTEREO_SECTOR_STATE_OUTSIDE);
    moved = obstacles;
    REFUSED(linestereo_sector(&moved, 0, 0, &sector), NOT_INITIALISED);
    REFUSED(linestereo_run(matcher, &left, &right, times_us), PAIR_UNFIT);
    REFUSED(linestereo_obstacles_update(&obstacles, matcher, 1100000), PAIR_UNFIT);
    REFUSED(linestereo_run(matcher, &left, 0, 0), NULL);
    REFUSED(linestereo_obstacles_update(&obstacles, matcher, 1100000), NO_PAIR);
    REFUSED(linestereo_init(memory, size, &config, &matcher), OK);
    REFUSED(linestereo_obstacles_update(&obstacles, matcher, 1100000), NO_PAIR);
    REFUSED(linestereo_sector(&obstacles, 0, 1200000, &sector), OK);
    CHECK(sector.state == LINESTEREO_SECTOR_STATE_OBSTACLE); /* as it was */
    REFUSED(linestereo_run_areas(matcher, &left, &right, 0, &area, 1), OK);
    REFUSED(linestereo_obstacles_update(&obstacles, matcher, 1150000), PAIR_UNFIT); /* the rest is not seen */
    free(memory);
    free(copy);
    return 0;
}
