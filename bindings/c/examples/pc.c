/* A rectified pair of PGM images -> segments, points, the depth of the middle, health,
   bars, with a rig directions:

       pc left.pgm right.pgm [MAX_DISPARITY [FOCAL_PX BASELINE_M]] */
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

int main(int argc, char **argv) {
    if (argc != 3 && argc != 4 && argc != 6) {
        fprintf(stderr, "pc left.pgm right.pgm [MAX_DISPARITY [FOCAL_PX BASELINE_M]]\n");
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
    LinestereoStatus status = pair_print(write_stdout, files, bytes, &config, malloc);
    if (status != LINESTEREO_STATUS_OK) {
        fprintf(stderr, "%s\n", linestereo_status_text(status));
        return 2;
    }
    return 0;
}
