/* A pair of PGM images in memory -> its results as text. Needs no C library: the same on a PC and
   on a board. */
#ifndef PAIR_H
#define PAIR_H

#include "linestereo.h"

/* Takes text; the examples write it to stdout. */
typedef void (*Write)(const char *text, size_t length);

/* Grey pixels of a binary PGM (P5, 8 bits); 0 when it is none. */
static int pgm_read(const uint8_t *file, size_t bytes, uint16_t *width, uint16_t *height, LinestereoImage *image) {
    uint32_t numbers[3] = {0, 0, 0};
    size_t at = 2;
    if (bytes < 2 || file[0] != 'P' || file[1] != '5') return 0;
    for (int i = 0; i < 3; i++) {
        while (at < bytes && (file[at] == ' ' || file[at] == '\n' || file[at] == '\r' || file[at] == '\t')) at++;
        if (at < bytes && file[at] == '#') {
            while (at < bytes && file[at] != '\n') at++;
            i--;
            continue;
        }
        if (at >= bytes || file[at] < '0' || file[at] > '9') return 0;
        while (at < bytes && file[at] >= '0' && file[at] <= '9') {
            if (numbers[i] > 65535) return 0;
            numbers[i] = numbers[i] * 10 + (uint32_t)(file[at++] - '0');
        }
    }
    if (at >= bytes || numbers[0] > 65535 || numbers[1] > 65535 || numbers[2] != 255) return 0;
    at++; /* the one white space before the pixels */
    *width = (uint16_t)numbers[0];
    *height = (uint16_t)numbers[1];
    image->pixels = file + at;
    image->bytes = bytes - at;
    image->stride = numbers[0];
    image->valid = 0;
    image->valid_count = 0;
    return 1;
}

/* A number such as 451.5; both of its parts are exact in single precision, so it is what strtof
   gives. -1, which is refused, for other text: 0,06 is not 6. */
static float number_read(const char *text) {
    uint32_t digits = 0, scale = 1;
    int is_fraction = 0;
    if (!*text) return -1;
    for (; *text; text++) {
        if (*text == '.' && !is_fraction) {
            is_fraction = 1;
        } else if (*text < '0' || *text > '9') {
            return -1;
        } else if (digits < 1000000) {
            digits = digits * 10 + (uint32_t)(*text - '0');
            if (is_fraction) scale *= 10;
        } else if (!is_fraction) {
            return -1;
        }
    }
    return (float)digits / (float)scale;
}

static void text_print(Write write, const char *text) {
    size_t length = 0;
    while (text[length]) length++;
    write(text, length);
}

/* `value / 2^fraction_bits` rounded to so many decimals, without zeros at the end. */
static void decimal_print(Write write, int32_t value, unsigned fraction_bits, unsigned decimals) {
    char text[32];
    size_t start = sizeof text;
    uint64_t scaled = value < 0 ? (uint64_t)(-(int64_t)value) : (uint64_t)value;
    for (unsigned i = 0; i < decimals; i++) scaled *= 10;
    scaled = (scaled + (fraction_bits ? (uint64_t)1 << (fraction_bits - 1) : 0)) >> fraction_bits;
    int is_zero = scaled == 0, is_tail = 1;
    for (unsigned i = 0; i < decimals || scaled || i == decimals; i++) {
        if (i == decimals && start < sizeof text) text[--start] = '.';
        char digit = (char)('0' + scaled % 10);
        scaled /= 10;
        is_tail = is_tail && i < decimals && digit == '0';
        if (!is_tail) text[--start] = digit;
    }
    if (value < 0 && !is_zero) text[--start] = '-';
    write(text + start, sizeof text - start);
}

/* Metres, or nothing without a rig and for what is infinitely far. */
static void metres_print(Write write, int has_rig, int32_t depth_q16) {
    text_print(write, ",");
    if (has_rig && depth_q16 != INT32_MAX) decimal_print(write, depth_q16, 16, 5);
}

static void point_print(void *context, const LinestereoPoint *point) {
    Write write = *(Write *)context;
    decimal_print(write, point->x, 0, 0);
    text_print(write, ",");
    decimal_print(write, point->y, 0, 0);
    text_print(write, ",");
    decimal_print(write, point->disparity_q6, 6, 6);
    text_print(write, ",");
    decimal_print(write, point->confidence_q16, 16, 5);
    text_print(write, "\n");
}

/* As `linestereo run --csv -` of the PC's program. */
static void segment_print(Write write, size_t id, int has_rig, const LinestereoSegment *segment) {
    static const char *const owners[] = {"left", "right", "both"};
    decimal_print(write, (int32_t)id, 0, 0);
    for (int end = 0; end < 2; end++) {
        text_print(write, ",");
        decimal_print(write, segment->x_q5[end], 5, 5);
        text_print(write, ",");
        decimal_print(write, segment->y_q5[end], 5, 5);
    }
    for (int end = 0; end < 2; end++) {
        text_print(write, ",");
        decimal_print(write, segment->disparity_q6[end], 6, 6);
    }
    text_print(write, ",");
    decimal_print(write, segment->sigma_q6, 6, 6);
    text_print(write, ",");
    decimal_print(write, segment->confidence_q16, 16, 5);
    text_print(write, ",");
    text_print(write, owners[segment->owner]);
    for (int end = 0; end < 2; end++) metres_print(write, has_rig, segment->depth_q16[end]);
    for (int end = 0; end < 2; end++) metres_print(write, has_rig, segment->depth_sigma_q16[end]);
    text_print(write, "\n");
}

static void bar_print(Write write, int has_rig, const LinestereoBar *bar) {
    for (int end = 0; end < 2; end++) {
        decimal_print(write, bar->x_q5[end], 5, 5);
        text_print(write, ",");
        decimal_print(write, bar->y_q5[end], 5, 5);
        text_print(write, ",");
    }
    decimal_print(write, bar->width_q5, 5, 5);
    for (int end = 0; end < 2; end++) {
        text_print(write, ",");
        decimal_print(write, bar->disparity_q6[end], 6, 6);
    }
    text_print(write, ",");
    decimal_print(write, bar->sigma_q6, 6, 6);
    text_print(write, ",");
    decimal_print(write, bar->confidence_q16, 16, 5);
    for (int end = 0; end < 2; end++) metres_print(write, has_rig, bar->depth_q16[end]);
    for (int end = 0; end < 2; end++) metres_print(write, has_rig, bar->depth_sigma_q16[end]);
    text_print(write, "\n");
}

/* What the last pair shows in each direction in view. A robot keeps the obstacles from pair to
   pair, with the times of capture. */
static LinestereoStatus sectors_print(Write write, LinestereoMatcher *matcher) {
    static const char *const states[] = {"outside", "unknown", "free", "obstacle"};
    static LinestereoObstacles obstacles;
    LinestereoObstacleConfig config = linestereo_obstacle_config();
    LinestereoStatus status = linestereo_obstacles_init(&obstacles, matcher, &config);
    if (status != LINESTEREO_STATUS_OK) return status;
    status = linestereo_obstacles_update(&obstacles, matcher, 0);
    if (status != LINESTEREO_STATUS_OK && status != LINESTEREO_STATUS_PAIR_UNFIT) return status;

    text_print(write, "sector,state,distance_cm,confidence,drop_off_cm,drop_off_confidence\n");
    for (size_t index = 0; index < config.sectors; index++) {
        LinestereoSector sector;
        if ((status = linestereo_sector(&obstacles, index, 0, &sector)) != LINESTEREO_STATUS_OK) return status;
        if (sector.state == LINESTEREO_SECTOR_STATE_OUTSIDE) continue;
        decimal_print(write, (int32_t)index, 0, 0);
        text_print(write, ",");
        text_print(write, states[sector.state]);
        text_print(write, ",");
        decimal_print(write, sector.distance_cm, 0, 0);
        text_print(write, ",");
        decimal_print(write, sector.confidence_q16, 16, 5);
        text_print(write, ",");
        decimal_print(write, sector.drop_off_cm, 0, 0);
        text_print(write, ",");
        decimal_print(write, sector.drop_off_confidence_q16, 16, 5);
        text_print(write, "\n");
    }
    return LINESTEREO_STATUS_OK;
}

/* The ground plane of the last pair: 1/65536 px per row, per column, and at the first pixel. */
static LinestereoStatus ground_print(Write write, LinestereoMatcher *matcher) {
    LinestereoGround ground;
    LinestereoStatus status = linestereo_ground(matcher, &ground);
    if (status == LINESTEREO_STATUS_NO_GROUND) return LINESTEREO_STATUS_OK;
    if (status != LINESTEREO_STATUS_OK) return status;
    text_print(write, "ground: ");
    decimal_print(write, ground.down_q16, 0, 0);
    text_print(write, ",");
    decimal_print(write, ground.across_q16, 0, 0);
    text_print(write, ",");
    decimal_print(write, ground.origin_q16, 0, 0);
    text_print(write, "\n");
    return LINESTEREO_STATUS_OK;
}

/* The last pair: segments, points, the depth of its middle, health, the ground, bars, with a rig
   directions. */
static LinestereoStatus results_print(Write write, LinestereoMatcher *matcher, const LinestereoConfig *config) {
    int has_rig = config->focal_px != 0;
    LinestereoHealth health;
    LinestereoStatus status = linestereo_health(matcher, &health);
    if (status != LINESTEREO_STATUS_OK) return status;

    text_print(write, "id,x0,y0,x1,y1,disparity0_px,disparity1_px,sigma_px,confidence,owner,depth0_m,depth1_m,depth0_sigma_m,depth1_sigma_m\n");
    for (size_t id = 0; id < health.segments_matched; id++) {
        LinestereoSegment segment;
        if ((status = linestereo_segment(matcher, id, &segment)) != LINESTEREO_STATUS_OK) return status;
        segment_print(write, id, has_rig, &segment);
    }

    text_print(write, "x,y,disparity_px,confidence\n");
    if ((status = linestereo_points(matcher, point_print, &write)) != LINESTEREO_STATUS_OK) return status;

    LinestereoArea middle = {config->width / 4, config->height / 4, config->width / 4 * 3, config->height / 4 * 3};
    LinestereoDepth depth;
    status = linestereo_box(matcher, &middle, &depth);
    text_print(write, "middle: ");
    if (status == LINESTEREO_STATUS_OK) {
        decimal_print(write, depth.disparity_q6, 6, 6);
        text_print(write, " +- ");
        decimal_print(write, depth.sigma_q6, 6, 6);
        text_print(write, " px");
        metres_print(write, has_rig, depth.depth_q16);
        metres_print(write, has_rig, depth.nearest_q16);
    } else if (status >= 100) {
        text_print(write, linestereo_status_text(status));
    } else {
        return status;
    }

    text_print(write, "\nhealth: ");
    for (uint32_t bit = 0, is_first = 1; linestereo_fault_name(bit); bit++) {
        if (health.faults & (uint32_t)1 << bit) {
            if (!is_first) text_print(write, "+");
            text_print(write, linestereo_fault_name(bit));
            is_first = 0;
        }
    }
    text_print(write, health.faults ? "" : "good");
    text_print(write, health.is_fit ? ", fit\n" : ", not fit\n");
    if ((status = ground_print(write, matcher)) != LINESTEREO_STATUS_OK) return status;

    text_print(write, "x0,y0,x1,y1,width_px,disparity0_px,disparity1_px,sigma_px,confidence,"
                      "depth0_m,depth1_m,depth0_sigma_m,depth1_sigma_m\n");
    for (size_t index = 0; index < health.bars; index++) {
        LinestereoBar bar;
        if ((status = linestereo_bar(matcher, index, &bar)) != LINESTEREO_STATUS_OK) return status;
        bar_print(write, has_rig, &bar);
    }
    return has_rig ? sectors_print(write, matcher) : LINESTEREO_STATUS_OK;
}

/* Two files, the arguments of the programs -> their text. The pose may be null. */
static LinestereoStatus pair_print(Write write, const uint8_t *const files[2],
                                   const size_t bytes[2], LinestereoConfig *config,
                                   const LinestereoCameraPose *pose,
                                   void *(*memory_of)(size_t size)) {
    LinestereoImage images[2];
    uint16_t width, height;
    for (int i = 0; i < 2; i++) {
        if (!pgm_read(files[i], bytes[i], &width, &height, &images[i])) return LINESTEREO_STATUS_IMAGE_TOO_SHORT;
        if (i == 0) config->width = width, config->height = height;
        if (width != config->width || height != config->height) return LINESTEREO_STATUS_IMAGE_SIZE;
    }
    size_t size = linestereo_scratch_size(config);
    LinestereoMatcher *matcher;
    LinestereoStatus status = linestereo_init(memory_of(size), size, config, &matcher);
    if (status == LINESTEREO_STATUS_OK) status = linestereo_expect_ground(matcher, pose);
    if (status == LINESTEREO_STATUS_OK) status = linestereo_run(matcher, &images[0], &images[1], 0);
    /* Of a pair that is not fit to be used the health says why. */
    if (status != LINESTEREO_STATUS_OK && status != LINESTEREO_STATUS_PAIR_UNFIT) return status;
    return results_print(write, matcher, config);
}

#endif
