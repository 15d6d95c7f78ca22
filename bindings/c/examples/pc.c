/* A rectified pair of PGM images -> segments, points, the depth of the middle, health,
   the ground, bars, with a rig directions:

       pc left.pgm right.pgm [MAX_DISPARITY [FOCAL_PX BASELINE_M [HEIGHT_M PITCH_DEG ROLL_DEG]]] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "pair.h"

static uint8_t *file_read(const char *path, size_t *bytes) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0) return NULL;
    long end = ftell(file);
    rewind(file);
    uint8_t *content = end < 0 ? NULL : malloc((size_t)end + 1);
    *bytes = content ? fread(content, 1, (size_t)end, file) : 0;
    fclose(file);
    return content;
}

static void write_stdout(const char *text, size_t length) { fwrite(text, 1, length, stdout); }

/* A number that may be negative; other text is no number, which is refused. */
static float angle_read(const char *text) {
    char *end;
    float value = strtof(text, &end);
    return *text && !*end ? value : NAN;
}

int main(int argc, char **argv) {
    if (argc != 3 && argc != 4 && argc != 6 && argc != 9) {
        fprintf(stderr, "pc left.pgm right.pgm [MAX_DISPARITY [FOCAL_PX BASELINE_M "
                        "[HEIGHT_M PITCH_DEG ROLL_DEG]]]\n");
        return 2;
    }
    const uint8_t *files[2];
    size_t bytes[2];
    for (int i = 0; i < 2; i++) {
        if (!(files[i] = file_read(argv[1 + i], &bytes[i]))) {
            fprintf(stderr, "%s cannot be read\n", argv[1 + i]);
            return 2;
        }
    }
    LinestereoConfig config = linestereo_config(0, 0);
    if (argc > 3) config.max_disparity = (uint16_t)strtoul(argv[3], NULL, 10);
    if (argc > 5) config.focal_px = number_read(argv[4]), config.baseline_m = number_read(argv[5]);
    LinestereoCameraPose pose, *stated = NULL;
    if (argc > 8) {
        pose.height_m = number_read(argv[6]);
        pose.pitch_deg = angle_read(argv[7]), pose.roll_deg = angle_read(argv[8]);
        stated = &pose;
    }
    LinestereoStatus status = pair_print(write_stdout, files, bytes, &config, stated, malloc);
    if (status != LINESTEREO_STATUS_OK) {
        fprintf(stderr, "%s\n", linestereo_status_text(status));
        return 2;
    }
    return 0;
}
