/* A pair to its segments, points, health and the depth of a box, all added up: what a program for a board that calls the library weighs. */
#include "linestereo.h"

static uint64_t memory[160 * 1024 / 8];

static void add_point(void *sum, const LinestereoPoint *point) { *(uint32_t *)sum += (uint32_t)(point->disparity_q6 + point->x); }

uint32_t weigh(const uint8_t *left, const uint8_t *right, float focal_px, float baseline_m) {
    LinestereoConfig config = linestereo_config(320, 240);
    config.focal_px = focal_px;
    config.baseline_m = baseline_m;
    LinestereoMatcher *matcher;
    if (linestereo_init(memory, sizeof memory, &config, &matcher) != LINESTEREO_STATUS_OK) return 0;
    LinestereoImage images[2] = {{left, 320 * 240, 320, 0, 0}, {right, 320 * 240, 320, 0, 0}};
    LinestereoHealth health;
    if (linestereo_run(matcher, &images[0], &images[1], 0) != LINESTEREO_STATUS_OK) return 0;
    if (linestereo_health(matcher, &health) != LINESTEREO_STATUS_OK) return 0;
    uint32_t sum = health.faults;
    for (size_t i = 0; i < health.segments_matched; i++) {
        LinestereoSegment segment;
        if (linestereo_segment(matcher, i, &segment) != LINESTEREO_STATUS_OK) return 0;
        sum += segment.confidence_q16;
        for (int end = 0; end < 2; end++) {
            sum += (uint32_t)(segment.x_q5[end] + segment.y_q5[end] + segment.disparity_q6[end] + segment.depth_q16[0]);
        }
    }
    linestereo_points(matcher, add_point, &sum);
    LinestereoArea area = {80, 60, 240, 180};
    LinestereoDepth depth;
    if (linestereo_box(matcher, &area, &depth) == LINESTEREO_STATUS_OK) sum += (uint32_t)depth.disparity_q6;
    return sum;
}
