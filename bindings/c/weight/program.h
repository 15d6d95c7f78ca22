/* The task of both programs: rectified pairs of at most QVGA, by turns whole and in an area, until
   the power goes; of each one sum over its health, its segments, its points and the depth of a box.
   Cameras and the detector write to `Input` between pairs; settings are those of a calibration. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include <stdint.h>

typedef struct Settings {
    float focal_px, baseline_m, disparity_offset_px, principal_point_px[2];
    int16_t min_disparity;
    uint16_t max_disparity, min_confidence_q16, width, height;
} Settings;

typedef struct Input {
    uint64_t times_us[2];
    uint16_t area[4], box[4];
    uint16_t left_valid[240][2], right_valid[240][2];
    uint8_t left[320 * 240], right[320 * 240];
} Input;

/* Waits for the next pair. */
void next(void);

/* Calls `tell` after each pair, or once, with all bits set, where the settings are refused. */
void program(const Settings *settings, const Input *input);

void tell(uint32_t sum);

#endif
