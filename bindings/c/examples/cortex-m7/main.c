/* The same as pc.c on a Cortex-M7 without a C library, emulated by QEMU (mps2-an500), which gives
   it arguments and files by semihosting. On a board images come from cameras, and `memory` is all
   that linestereo needs. */
#include "../pair.h"

/* QVGA: both images and their heads, and a matcher for them. */
static uint8_t files[2][320 * 240 + 64];
static uint64_t memory[LINESTEREO_MEMORY_WORDS(320, 240)];

static void *memory_of(size_t size) { return size <= sizeof memory ? memory : 0; }

/* Semihosting for A32 and T32, Arm 100863. */
enum { OPEN = 0x01, CLOSE = 0x02, WRITE = 0x05, READ = 0x06, COMMAND_LINE = 0x15, EXIT = 0x20 };

static int host_call(int operation, const void *arguments) {
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = arguments;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static size_t length_of(const char *text) {
    size_t length = 0;
    while (text[length]) length++;
    return length;
}

static int host_open(const char *path, uintptr_t mode) {
    uintptr_t arguments[] = {(uintptr_t)path, mode, length_of(path)};
    return host_call(OPEN, arguments);
}

static int output;
static char buffer[4096];
static size_t filled;

static void flush(void) {
    uintptr_t arguments[] = {(uintptr_t)output, (uintptr_t)buffer, filled};
    host_call(WRITE, arguments);
    filled = 0;
}

static void write_output(const char *text, size_t length) {
    while (length--) {
        buffer[filled++] = *text++;
        if (filled == sizeof buffer) flush();
    }
}

static void leave(int code) {
    uintptr_t arguments[] = {0x20026 /* ADP_Stopped_ApplicationExit */, (uintptr_t)code};
    host_call(EXIT, arguments);
    for (;;) {}
}

/* The next word of the command line. */
static char *word(char **rest) {
    while (**rest == ' ') ++*rest;
    char *start = *rest;
    while (**rest && **rest != ' ') ++*rest;
    if (**rest) *(*rest)++ = 0;
    return start;
}

/* Not part of `reset`, which would save registers of the FPU before that is on. */
__attribute__((noinline)) static void run(void) {
    static char line[512];
    uintptr_t command_line[] = {(uintptr_t)line, sizeof line};
    host_call(COMMAND_LINE, command_line);
    char *rest = line;
    word(&rest); /* the program */
    const uint8_t *images[2];
    size_t bytes[2];
    for (int i = 0; i < 2; i++) {
        int handle = host_open(word(&rest), 1 /* rb */);
        if (handle < 0) leave(2);
        uintptr_t arguments[] = {(uintptr_t)handle, (uintptr_t)files[i], sizeof files[i]};
        bytes[i] = sizeof files[i] - (size_t)host_call(READ, arguments);
        images[i] = files[i];
        host_call(CLOSE, arguments);
    }
    output = host_open(":tt", 4 /* w */);
    LinestereoConfig config = linestereo_config(0, 0);
    char *disparities = word(&rest), *focal = word(&rest), *baseline = word(&rest);
    if (*disparities) config.max_disparity = (uint16_t)(int32_t)number_read(disparities);
    if (*focal) config.focal_px = number_read(focal), config.baseline_m = number_read(baseline);
    LinestereoStatus status = pair_print(write_output, images, bytes, &config, 0, memory_of);
    if (status != LINESTEREO_STATUS_OK) {
        text_print(write_output, linestereo_status_text(status));
        text_print(write_output, "\n");
    }
    flush();
    leave(status == LINESTEREO_STATUS_OK ? 0 : 2);
}

/* Start: the FPU on, cleared variables. QEMU has loaded those with a value. */
extern uint32_t bss_start[], bss_end[], stack_end[];

void reset(void);

void reset(void) {
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20; /* CPACR: coprocessors 10 and 11 */
    __asm__ volatile("dsb\nisb");
    for (uint32_t *word = bss_start; word < bss_end; word++) *word = 0;
    run();
}

static void fault(void) { leave(3); }

__attribute__((section(".vectors"), used)) static const void *const vectors[] = {
    stack_end, (void *)reset, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault,
};
