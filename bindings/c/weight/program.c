/* The task by the library. */
#include "program.h"
#include "linestereo.h"

static uint64_t memory[LINESTEREO_MEMORY_WORDS_FOR(320, 240, 640, 20)];

static void add_point(void *context, const LinestereoPoint *point) {
    uint32_t *total = context;
    *total += point->x + point->y + (uint32_t)point->disparity_q6 + point->confidence_q16 + (uint32_t)point->segment;
}

static uint32_t sum_of_health(const LinestereoHealth *health) {
    uint32_t total = health->faults + health->faults_now + health->is_fit + health->is_refused;
    for (int camera = 0; camera < 2; camera++) {
        const LinestereoCamera *of = &health->cameras[camera];
        total += of->level + of->detail_q4 + of->black_permille + of->white_permille + of->view_permille;
    }
    total += (uint32_t)health->rows_q8 + health->rows_samples;
    total += health->segments_found + health->segments_matched + health->is_cut;
    return total + health->bars;
}

static uint32_t sum_of_segment(const LinestereoSegment *segment) {
    uint32_t total = (uint32_t)segment->sigma_q6 + segment->confidence_q16 + segment->owner;
    for (int end = 0; end < 2; end++) {
        total += segment->x_q5[end] + segment->y_q5[end] + (uint32_t)segment->disparity_q6[end];
        total += (uint32_t)segment->depth_q16[end] + (uint32_t)segment->depth_sigma_q16[end];
    }
    return total;
}

static uint32_t sum(LinestereoMatcher *matcher, const Input *input) {
    LinestereoHealth health;
    linestereo_health(matcher, &health);
    uint32_t total = sum_of_health(&health);
    LinestereoSegment segment;
    for (size_t index = 0; linestereo_segment(matcher, index, &segment) == LINESTEREO_STATUS_OK; index++) {
        total += sum_of_segment(&segment);
    }
    linestereo_points(matcher, add_point, &total);
    LinestereoArea box = {input->box[0], input->box[1], input->box[2], input->box[3]};
    LinestereoDepth depth;
    LinestereoStatus status = linestereo_box(matcher, &box, &depth);
    if (status != LINESTEREO_STATUS_OK) return total + (uint32_t)status;
    total += (uint32_t)depth.disparity_q6 + (uint32_t)depth.sigma_q6 + depth.confidence_q16 + depth.support;
    return total + (uint32_t)depth.depth_q16 + (uint32_t)depth.depth_sigma_q16 + (uint32_t)depth.nearest_q16;
}

void program(const Settings *settings, const Input *input) {
    LinestereoConfig config = linestereo_config(settings->width, settings->height);
    config.segments = 640;
    config.min_disparity = settings->min_disparity, config.max_disparity = settings->max_disparity;
    config.min_confidence_q16 = settings->min_confidence_q16;
    config.focal_px = settings->focal_px, config.baseline_m = settings->baseline_m;
    config.disparity_offset_px = settings->disparity_offset_px;
    config.has_principal_point = 1;
    config.principal_point_px[0] = settings->principal_point_px[0], config.principal_point_px[1] = settings->principal_point_px[1];
    LinestereoMatcher *matcher;
    LinestereoStatus status = linestereo_init(memory, sizeof memory, &config, &matcher);
    if (status != LINESTEREO_STATUS_OK) {
        tell(UINT32_MAX);
        return;
    }
    LinestereoImage left = {input->left, sizeof input->left, config.width, (const LinestereoSpan *)input->left_valid, config.height};
    LinestereoImage right = {input->right, sizeof input->right, config.width, (const LinestereoSpan *)input->right_valid, config.height};
    for (int is_whole = 1;; is_whole = !is_whole) {
        next();
        LinestereoArea area = {input->area[0], input->area[1], input->area[2], input->area[3]};
        if (is_whole) {
            status = linestereo_run(matcher, &left, &right, input->times_us);
        } else {
            status = linestereo_run_areas(matcher, &left, &right, input->times_us, &area, 1);
        }
        tell(status == LINESTEREO_STATUS_OK || status == LINESTEREO_STATUS_PAIR_UNFIT ? sum(matcher, input) : 0);
    }
}
