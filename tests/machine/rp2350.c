/* The parts of an RP2350 in which a run spends its time: PIO block 0, the DMA behind it, the wires
   of two cameras, TIMER0's count and the USB controller's memory. Compiled behind the clock of
   cortex_m.py; all other registers are rp2350.py's.

   What is executed is the PIO's instruction memory as the image has written it, a cycle of 150 MHz
   after the other, with two cycles of synchronisers before the pins. Not in it: OUT, PULL,
   side-set, delays, IRQ that waits, clock dividers: each ends the run (`unknown`). A DMA transfer
   takes no time. RP2350 datasheet: 11.4, 11.5, 11.7 (PIO), 12.6 (DMA). */
enum { PIO0 = 0x50200000, DMA = 0x50000000, TIMER0 = 0x400B0000, DPRAM = 0x50100000, SRAM = 0x20000000, SRAM_BYTES = 0x82000 };
enum { MACHINES = 4, CHANNELS = 16, WIDTH = 324, HEIGHT = 244 };

struct machine { uint32_t divider, control, shift, pins, x, y, isr, count, fifo[8], level; uint8_t pc; };
struct channel { uint32_t read, write, count, reload, control, busy; };
/* A frame of a camera, in periods of its pixel clock; stuck: FVLD stays low. */
struct frame { int64_t start, rows, row, margin, odd_row, odd_halves, is_stuck; };

static struct clock *now;
static double mhz, timer_start;
static uint8_t *sram, dpram[0x1000], pixels[2][HEIGHT][WIDTH];
static uint32_t (*other_read)(uint32_t);
static void (*other_write)(uint32_t, uint32_t, uint32_t);
static uint16_t memory[32];
static struct machine machines[MACHINES];
static struct channel channels[CHANNELS];
static struct frame frames[2];
static uint32_t enabled, flags, stall_flags, irq1_enable, bypass, dma_raw, dma_enable[4];
static uint32_t first_pin[2], visible, level, late[2], risen, high;
static int64_t cycle, period;

/* What the model cannot do, or hardware would not: the first of it. */
uint32_t unknown, unknown_at;
/* Words that the DMA has written, lowest and highest address. */
uint32_t dma_low, dma_high, pio_executed;
static void refuse(uint32_t at, uint32_t value) {
    if (!unknown_at) unknown_at = at, unknown = value;
    now->stop = 0;
}

void rp2350_setup(struct clock *clock, double cycles_a_us, uint8_t *memory_of_chip, void *read, void *write) {
    now = clock, mhz = cycles_a_us, sram = memory_of_chip, other_read = read, other_write = write;
}

void rp2350_reset(void) {
    memset(machines, 0, sizeof machines), memset(channels, 0, sizeof channels), memset(dpram, 0, sizeof dpram), memset(memory, 0, sizeof memory);
    enabled = flags = stall_flags = irq1_enable = bypass = dma_raw = risen = high = level = visible = 0;
    memset(dma_enable, 0, sizeof dma_enable);
    frames[0].start = frames[1].start = -1;
    timer_start = -1, dma_low = ~0u, dma_high = 0;
}

void rp2350_timer(double start) { timer_start = start; }
void rp2350_pads(uint32_t mask) { visible = mask; }
uint8_t *rp2350_dpram(void) { return dpram; }
int64_t rp2350_cycle(void) { return cycle; }

/* A camera whose pixel clock runs with so many cycles a period; 0 stops both. */
void rp2350_clock(int64_t cycles) { period = cycles; }
void rp2350_frame(int camera, uint32_t pin, const uint8_t *bytes, struct frame *frame) {
    first_pin[camera] = pin, frames[camera] = *frame;
    memcpy(pixels[camera], bytes, sizeof pixels[camera]);
}

/* Wires. */

static uint32_t wires_of(int camera, int64_t at) {
    struct frame *f = &frames[camera];
    const uint32_t line_valid = 1 << 5, frame_valid = f->is_stuck ? 0 : 1 << 6;
    if (f->start < 0 || at < f->start) return 0;
    int64_t n = at - f->start - f->margin, y = n / f->row, x = n % f->row;
    if (n < 0) return frame_valid;
    if (y >= f->rows) return n < f->rows * f->row + f->margin ? frame_valid : 0;
    if (x >= (y == f->odd_row ? f->odd_halves : 2 * WIDTH)) return frame_valid;
    uint32_t pixel = pixels[camera][y][x / 2 % WIDTH];
    return frame_valid | line_valid | (x & 1 ? pixel >> 4 : pixel & 15);
}

/* Periods from `at` on in which no data wire changes. */
static int64_t quiet_of(int camera, int64_t at) {
    struct frame *f = &frames[camera];
    if (f->start < 0) return INT32_MAX;
    if (at < f->start) return f->start - at;
    int64_t n = at - f->start - f->margin, y = n / f->row, x = n % f->row;
    if (n < 0) return -n;
    if (y >= f->rows) return n < f->rows * f->row + f->margin ? f->rows * f->row + f->margin - n : INT32_MAX;
    return x < (y == f->odd_row ? f->odd_halves : 2 * WIDTH) ? 0 : f->row - x;
}

/* DMA. */

static void dma_write(uint32_t at, uint32_t value);
static uint32_t pop(int n) {
    struct machine *m = &machines[n];
    uint32_t value = m->fifo[0];
    if (!m->level) return refuse(PIO0 + 0x20 + 4 * n, 0), 0;
    memmove(m->fifo, m->fifo + 1, sizeof m->fifo - 4), m->level--;
    return value;
}

static int is_asked(uint32_t source) {
    if (source == 63) return 1;
    if (source >= 4 && source < 8) return machines[source - 4].level > 0;
    return refuse(DMA, source), 0;
}

static uint32_t moved(uint32_t address, uint32_t control, int is_write) {
    uint32_t next = address + (control >> (is_write ? 6 : 4) & 1 ? 4 : 0), size = control >> 8 & 15;
    if (!size || (control >> 12 & 1) != is_write) return next;
    uint32_t mask = (1u << size) - 1;
    return (address & ~mask) | (next & mask);
}

static void start_channel(int n) {
    if (channels[n].control & 1) channels[n].count = channels[n].reload, channels[n].busy = 1;
}

static int turn_channel(int n) {
    struct channel *c = &channels[n];
    if (!c->busy || !(c->control & 1) || !is_asked(c->control >> 17 & 63)) return 0;
    if (c->count) {
        uint32_t value, from = c->read, to = c->write;
        if ((c->control >> 2 & 3) != 2 || from & 3 || to & 3) return refuse(DMA + 0x40 * n, c->control), c->busy = 0;
        c->read = moved(from, c->control, 0), c->write = moved(to, c->control, 1), c->count--;
        if (from >= SRAM && from < SRAM + SRAM_BYTES) memcpy(&value, sram + (from - SRAM), 4);
        else if (from >= PIO0 + 0x20 && from < PIO0 + 0x30) value = pop((from - PIO0 - 0x20) / 4);
        else return refuse(DMA, from), c->busy = 0;
        if (to >= SRAM && to < SRAM + SRAM_BYTES) {
            memcpy(sram + (to - SRAM), &value, 4);
            dma_low = to < dma_low ? to : dma_low, dma_high = to + 4 > dma_high ? to + 4 : dma_high;
        } else if (to >= DMA && to < DMA + 0x400) dma_write(to, value);
        else return refuse(DMA, to), c->busy = 0;
    }
    if (!c->count) {
        c->busy = 0;
        if (!(c->control >> 23 & 1)) dma_raw |= 1u << n;
        if ((c->control >> 13 & 15) != (uint32_t)n) start_channel(c->control >> 13 & 15);
    }
    return 1;
}

static void lines(void) {
    uint32_t is = (irq1_enable & flags << 8 ? 1 : 0) | (dma_raw & dma_enable[1] ? 2 : 0);
    if (is & ~high) risen |= is & ~high, now->stop = 0;
    high = is;
}

static void turn_dma(void) {
    for (int n = 0, left = 100; n < CHANNELS && left; n++)
        while (turn_channel(n) && left--) n = 0;
    lines();
}

static void abort_channels(uint32_t mask) {
    for (int n = 0; n < CHANNELS; n++)
        if (mask >> n & 1) {
            /* RP2350-E5: one that is enabled may start again, or what it chains to. */
            if (channels[n].control & 1 || (channels[n].control >> 13 & 15) != (uint32_t)n) refuse(DMA + 0x464, channels[n].control);
            channels[n].busy = channels[n].count = 0;
        }
}

static uint32_t *dma_register(struct channel *c, uint32_t offset) {
    static const char order[] = "RWTCCRWTCTRWCWTR";
    switch (order[offset / 4 & 15]) {
    case 'R': return &c->read;
    case 'W': return &c->write;
    case 'T': return &c->count;
    default: return &c->control;
    }
}

static uint32_t dma_read(uint32_t at) {
    uint32_t offset = at - DMA;
    if (offset < 0x400) {
        struct channel *c = &channels[offset / 0x40];
        uint32_t *word = dma_register(c, offset);
        return *word | (word == &c->control ? c->busy << 26 : 0);
    }
    if (offset < 0x440) return (uint32_t[]){dma_raw, dma_enable[offset >> 4 & 3], 0, dma_raw & dma_enable[offset >> 4 & 3]}[offset / 4 & 3];
    return 0;
}

static void dma_write(uint32_t at, uint32_t value) {
    uint32_t offset = at - DMA;
    if (offset < 0x400) {
        struct channel *c = &channels[offset / 0x40];
        uint32_t *word = dma_register(c, offset);
        if (word == &c->count) c->reload = value;
        else *word = value;
        if ((offset & 12) == 12 && value) start_channel(offset / 0x40);
    } else if (offset < 0x440) {
        if ((offset & 12) == 4) dma_enable[offset >> 4 & 3] = value;
        if ((offset & 12) == 12 || (offset & 12) == 0) dma_raw &= ~value;
    } else if (offset == 0x464) abort_channels(value);
    else refuse(at, value);
}

/* PIO. */

static uint32_t seen_by(const struct machine *m) {
    uint32_t base = m->pins >> 15 & 31, count = m->shift & 31, all = base ? late[1] >> base | late[1] << (32 - base) : late[1];
    return count ? all & ((1u << count) - 1) : all;
}

static int shift_in(int n, struct machine *m, uint32_t value, uint32_t bits) {
    uint32_t threshold = m->shift >> 20 & 31, size = m->shift >> 31 ? 8 : 4;
    int pushes = m->shift >> 16 & 1 && m->count + bits >= (threshold ? threshold : 32);
    if (pushes && m->level >= size) return stall_flags |= 1u << n, 0;
    if (bits == 32) m->isr = value;
    else if (m->shift >> 18 & 1) m->isr = m->isr >> bits | value << (32 - bits);
    else m->isr = m->isr << bits | (value & ((1u << bits) - 1));
    m->count = m->count + bits > 32 ? 32 : m->count + bits;
    if (pushes) m->fifo[m->level++] = m->isr, m->isr = m->count = 0, turn_dma();
    return 1;
}

static int is_met(struct machine *m, uint32_t condition) {
    switch (condition) {
    case 0: return 1;
    case 1: return !m->x;
    case 2: return m->x-- != 0;
    case 3: return !m->y;
    case 4: return m->y-- != 0;
    case 5: return m->x != m->y;
    default: return late[1] >> (m->control >> 24 & 31) & 1;
    }
}

/* Executes an instruction; 0: it waits. */
static int execute(int n, struct machine *m, uint16_t word, uint8_t next) {
    uint32_t high3 = word >> 5 & 7, low = word & 31, value;
    if (word >> 8 & 31) return refuse(PIO0 + 0x48 + 4 * m->pc, word), 0;
    switch (word >> 13) {
    case 0:
        if (high3 == 7) break;
        m->pc = is_met(m, high3) ? low : next;
        return 1;
    case 1:
        if ((high3 & 3) > 1) break;
        value = (high3 & 3 ? seen_by(m) : late[1]) >> low & 1;
        if (value != high3 >> 2) return 0;
        m->pc = next;
        return 1;
    case 2:
        if (high3 > 3) break;
        value = (uint32_t[]){seen_by(m), m->x, m->y, 0}[high3];
        if (!shift_in(n, m, value, low ? low : 32)) return 0;
        m->pc = next;
        return 1;
    case 5:
        if (high3 < 1 || high3 > 2 || low >> 3 > 1 || (low & 7) > 3) break;
        value = (uint32_t[]){seen_by(m), m->x, m->y, 0}[low & 7];
        *(high3 == 1 ? &m->x : &m->y) = low >> 3 ? ~value : value;
        m->pc = next;
        return 1;
    case 6:
        if (high3 & 1 || high3 >> 2 || (low >> 3 & 1)) break;
        value = 1u << (low >> 4 ? (low & 4) | ((low + n) & 3) : low & 7);
        flags = high3 >> 1 ? flags & ~value : flags | value;
        m->pc = next;
        return lines(), 1;
    case 7:
        if (high3 != 1 && high3 != 2) break;
        *(high3 == 1 ? &m->x : &m->y) = low;
        m->pc = next;
        return 1;
    }
    return refuse(PIO0 + 0x48 + 4 * m->pc, word), 0;
}

static void step(uint32_t wires) {
    for (int n = 0; n < MACHINES; n++)
        if (enabled >> n & 1) {
            struct machine *m = &machines[n];
            uint8_t next = m->pc == (m->control >> 12 & 31) ? m->control >> 7 & 31 : (m->pc + 1) & 31;
            pio_executed += execute(n, m, memory[m->pc], next);
        }
    late[1] = late[0], late[0] = wires, cycle++;
}

/* Runs to a cycle, or to the one in which an interrupt is asked for. */
static void run(int64_t until) {
    static struct machine before[MACHINES];
    static int64_t since;
    if (!period || !enabled) {
        cycle = until > cycle ? until : cycle;
        return;
    }
    while (cycle < until && !risen) {
        int64_t at = cycle / period;
        if (cycle % period == 0) {
            /* Nothing has changed in a whole period, and nothing will: many at once. */
            int64_t quiet = quiet_of(0, at), other = quiet_of(1, at), whole = (until - cycle) / period;
            quiet = other < quiet ? other : quiet;
            if (quiet > 1 && since == at - 1 && !memcmp(before, machines, sizeof before)) cycle += (quiet - 1 < whole ? quiet - 1 : whole) * period;
            at = cycle / period;
            if (cycle >= until) return;
            level = wires_of(0, at) << first_pin[0] | wires_of(1, at) << first_pin[1];
            memcpy(before, machines, sizeof before), since = quiet_of(0, at) > 1 && quiet_of(1, at) > 1 ? at : -1;
        }
        uint32_t clocks = 1u << (first_pin[0] + 4) | 1u << (first_pin[1] + 4);
        step((cycle % period < period / 2 ? level | clocks : level) & visible);
    }
}

static uint32_t pio_read(uint32_t at) {
    uint32_t offset = at - PIO0, value = 0;
    if (offset == 0) return enabled;
    if (offset == 4) {
        for (int n = 0; n < MACHINES; n++)
            value |= (machines[n].level == (machines[n].shift >> 31 ? 8 : 4)) << n | (machines[n].level == 0) << (8 + n) | 1 << (24 + n);
        return value;
    }
    if (offset == 8) return stall_flags;
    if (offset >= 0x20 && offset < 0x30) return pop((offset - 0x20) / 4);
    if (offset == 0x30) return flags;
    if (offset == 0x38) return bypass;
    if (offset >= 0x48 && offset < 0xC8) return memory[(offset - 0x48) / 4];
    if (offset >= 0xC8 && offset < 0x128) {
        struct machine *m = &machines[(offset - 0xC8) / 24];
        return (uint32_t[]){m->divider, m->control, m->shift, m->pc, memory[m->pc], m->pins}[(offset - 0xC8) / 4 % 6];
    }
    if (offset == 0x17C) return irq1_enable;
    if (offset == 0x184) return irq1_enable & flags << 8;
    return 0;
}

static void pio_write(uint32_t at, uint32_t value) {
    uint32_t offset = at - PIO0;
    if (offset == 0) {
        enabled = value & 15;
        for (int n = 0; n < MACHINES; n++)
            if (value >> (4 + n) & 1) machines[n].isr = machines[n].count = 0;
    } else if (offset == 8) stall_flags &= ~value;
    else if (offset == 0x30) flags &= ~value;
    else if (offset == 0x38) bypass = value; /* the synchronisers stay in the model: as if 0, which is checked */
    else if (offset >= 0x48 && offset < 0xC8) memory[(offset - 0x48) / 4] = value;
    else if (offset >= 0xC8 && offset < 0x128) {
        int n = (offset - 0xC8) / 24;
        struct machine *m = &machines[n];
        switch ((offset - 0xC8) / 4 % 6) {
        case 0:
            m->divider = value;
            if (value != 1 << 16) refuse(at, value);
            break;
        case 1: m->control = value; break;
        case 2:
            if ((m->shift ^ value) >> 30) m->level = 0;
            m->shift = value;
            break;
        case 4: execute(n, m, value, m->pc); break;
        case 5: m->pins = value; break;
        }
    } else if (offset == 0x17C) irq1_enable = value;
    else if (value) refuse(at, value);
    if (bypass) refuse(at, bypass);
}

/* What cortex_m.py calls. */

/* Called for blocks of code: at most a microsecond late. */
void rp2350_work(void) {
    run(now->now * mhz);
    now->due = now->now + 1;
}

/* While the processor sleeps: to a time, us, or that of an interrupt. */
double rp2350_sleep(double until) {
    run(until * mhz);
    return risen && cycle / mhz < until ? cycle / mhz : until;
}

/* Interrupts that were asked for since the last call: 1 PIO, 2 DMA. */
uint32_t rp2350_risen(void) {
    uint32_t all = risen;
    risen = 0;
    return all;
}
uint32_t rp2350_high(void) { return high; }

static int is_dma(uint32_t at) { return at >> 16 == DMA >> 16; }
static int is_pio(uint32_t at) { return at >> 16 == PIO0 >> 16; }

static uint32_t read_word(uint32_t at) {
    if (is_dma(at) || is_pio(at)) {
        run(now->now * mhz);
        return is_dma(at) ? dma_read(at & ~0x3000) : pio_read(at & ~0x3000);
    }
    if (at == TIMER0 + 0x24 || at == TIMER0 + 0x28) {
        now->now += 0.03; /* four cycles on the bus */
        uint64_t us = timer_start < 0 ? 0 : now->now - timer_start;
        return at == TIMER0 + 0x24 ? us >> 32 : us;
    }
    return other_read(at);
}

uint64_t rp2350_read(void *uc, uint64_t offset, uint32_t size, void *base) {
    uint32_t at = (uint32_t)(uintptr_t)base + offset, value;
    if (at >= DPRAM && at < DPRAM + sizeof dpram) memcpy(&value, dpram + ((at - DPRAM) & ~3), 4);
    else value = read_word(at & ~3);
    return (uint64_t)(value >> (at & 3) * 8) & (size < 4 ? (1u << size * 8) - 1 : ~0u);
}

void rp2350_write(void *uc, uint64_t offset, uint32_t size, uint64_t value, void *base) {
    uint32_t at = (uint32_t)(uintptr_t)base + offset;
    if (at >= DPRAM && at < DPRAM + sizeof dpram) {
        memcpy(dpram + (at - DPRAM), &value, size);
        if (at < DPRAM + 0x100) other_write(at, value, size);
    } else if (is_dma(at) || is_pio(at)) {
        run(now->now * mhz);
        uint32_t to = at & ~0x3000, old = at >> 12 & 3 ? (is_dma(at) ? dma_read(to) : pio_read(to)) : 0;
        value = (uint32_t[]){value, old ^ value, old | value, old & ~value}[at >> 12 & 3];
        (is_dma(at) ? dma_write : pio_write)(to, value);
        turn_dma();
    } else other_write(at, value, size);
}
