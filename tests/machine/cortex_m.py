"""A Cortex-M by Unicorn 2.1.4: memory, time by instructions, NVIC, SysTick, exceptions entered and left by hand, events, a run and its report.

Not in it: caches, bus contention, wait states, priority grouping, lazy FPU state; the MPU is each processor's own (`cortex_m7.py`, `cortex_m33.py`).
Time is an estimate, `mhz` instructions a microsecond; sleep (WFE, WFI) jumps to the next event.
"""
import ctypes, heapq, json, os, struct, subprocess, tempfile
from unicorn import UC_ARCH_ARM, UC_HOOK_BLOCK, UC_HOOK_CODE, UC_HOOK_INTR, UC_HOOK_MEM_UNMAPPED, UC_MODE_MCLASS, UC_MODE_THUMB, UC_PROT_ALL, Uc, UcError
from unicorn.arm_const import *
from unicorn.unicorn_py3.unicorn import uclib

IT_BITS = 0x0600FC00
SYSTICK = -1
LOW = [UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR]
FLOATS = [UC_ARM_REG_S0 + i for i in range(16)] + [UC_ARM_REG_FPSCR]

# Called for every block of code: in C, because it is most of the time that a run takes.
HOOK = """
#include <stdint.h>
#include <string.h>
struct block { uint16_t bytes, instructions; };
struct clock {
    double now, stop, step, due;
    int (*end)(void *), (*read)(void *, uint64_t, void *, uint64_t);
    void (*work)(void);
    uint8_t *covered;
    struct block *blocks;
    uint64_t first, bytes, executed;
};
static uint16_t instructions(void *uc, struct clock *c, uint64_t at, uint32_t size) {
    struct block *b = at - c->first < c->bytes ? &c->blocks[(at - c->first) / 2] : 0;
    if (b && b->bytes == size) return b->instructions;
    uint16_t word, count = 0;
    for (uint32_t done = 0; done < size && !c->read(uc, at + done, &word, 2); done += word >> 11 > 28 ? 4 : 2) count++;
    if (b) *b = (struct block){size, count}, memset(c->covered + (at - c->first), 1, size);
    return count;
}
void on_block(void *uc, uint64_t at, uint32_t size, struct clock *c) {
    uint16_t count = instructions(uc, c, at, size);
    c->now += count * c->step, c->executed += count;
    if (c->now >= c->due) c->work();
    if (c->now >= c->stop) c->end(uc);
}
"""


class Clock(ctypes.Structure):
    _fields_ = [("now", ctypes.c_double), ("stop", ctypes.c_double), ("step", ctypes.c_double), ("due", ctypes.c_double),
                ("end", ctypes.c_void_p), ("read", ctypes.c_void_p), ("work", ctypes.c_void_p), ("covered", ctypes.c_void_p),
                ("blocks", ctypes.c_void_p), ("first", ctypes.c_uint64), ("bytes", ctypes.c_uint64), ("executed", ctypes.c_uint64)]


class Registers:
    """Registers that are read or written together, in this order: one by one they take half of a run's time."""

    def __init__(self, uc, names):
        self.uc, self.count = uc, len(names)
        self.names, self.values = (ctypes.c_int * self.count)(*names), (ctypes.c_uint32 * self.count)()
        self.places = (ctypes.c_void_p * self.count)(*(ctypes.addressof(self.values) + 4 * i for i in range(self.count)))

    def read(self):
        uclib.uc_reg_read_batch(self.uc._uch, self.names, self.places, self.count)
        return self.values[:]

    def write(self, *values):
        self.values[:] = values
        uclib.uc_reg_write_batch(self.uc._uch, self.names, self.places, self.count)


class Shared:
    """Memory that the processors of a chip share."""

    def __init__(self, size):
        self.size, self.buffer = size, ctypes.create_string_buffer(size + 0x1000)
        self.at = ctypes.addressof(self.buffer) + 0xFFF & ~0xFFF

    def map(self, uc, start):
        uc.mem_map_ptr(start, self.size, UC_PROT_ALL, self.at)


def load(path):
    """Segments (address, bytes), functions {address: (bytes, name)} and all symbols {name: address} of an ELF file."""
    d = open(path, "rb").read()
    u32 = lambda at: struct.unpack_from("<I", d, at)[0]
    u16 = lambda at: struct.unpack_from("<H", d, at)[0]
    segments = [struct.unpack_from("<8I", d, u32(28) + i * u16(42)) for i in range(u16(44))]
    segments = [(s[3], d[s[1]:s[1] + s[4]]) for s in segments if s[0] == 1 and s[4]]
    sections = [struct.unpack_from("<10I", d, u32(32) + i * u16(46)) for i in range(u16(48))]
    functions, symbols = {}, {}
    for s in (s for s in sections if s[1] == 2):
        names = sections[s[6]][4]
        for at in range(s[4], s[4] + s[5], 16):
            name, value, size, info = struct.unpack_from("<IIIB", d, at)
            symbol = d[names + name:d.index(b"\0", names + name)].decode()
            symbols[symbol] = value
            if size and info & 15 == 2:
                functions[value & ~1] = (size, symbol)
    return segments, functions, symbols


class Core:
    """A chip's processor: `MODEL` of Unicorn, what some registers always `READ`, CONTROL while floats are in use."""
    MODEL, READ, FLOATS_IN_USE = None, {}, 4

    def __init__(self, path, flash, ram, mhz, chip_sources="", first=None):
        """An image, its flash (address, bytes), RAM [(address, bytes)]; C code of the chip, for what is called too often for Python; the
        chip's first processor, whose flash and C code a second one has."""
        self.segments, self.functions, self.symbols = load(path)
        self.flash, self.flash_bytes, self.mhz = *flash, mhz
        self.entry = min(start for start, _ in self.segments)  # behind a bootloader it is not where the flash begins
        self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(self.MODEL)
        self.flash_memory = first.flash_memory if first else Shared(self.flash_bytes)
        self.flash_memory.map(self.uc, self.flash)
        for start, size in ram:
            self.uc.mem_map(start, size)
        if not first:
            self.uc.mem_write(self.flash, b"\xff" * self.flash_bytes)
            for start, data in self.segments:
                self.uc.mem_write(start, data)
        self.state = Registers(self.uc, [UC_ARM_REG_PC, UC_ARM_REG_XPSR, UC_ARM_REG_PRIMASK, UC_ARM_REG_FAULTMASK])
        self.entered = Registers(self.uc, LOW + [UC_ARM_REG_PC, UC_ARM_REG_XPSR, UC_ARM_REG_CONTROL, UC_ARM_REG_IPSR, UC_ARM_REG_SP, UC_ARM_REG_MSP])
        self.floats = Registers(self.uc, FLOATS)
        self.entering = Registers(self.uc, [UC_ARM_REG_SP, UC_ARM_REG_IPSR, UC_ARM_REG_CONTROL, UC_ARM_REG_LR, UC_ARM_REG_PC])
        self.leaving = Registers(self.uc, [UC_ARM_REG_MSP, UC_ARM_REG_PSP, UC_ARM_REG_CONTROL])
        self.left = Registers(self.uc, [UC_ARM_REG_IPSR, UC_ARM_REG_CONTROL] + LOW + [UC_ARM_REG_SP, UC_ARM_REG_APSR, UC_ARM_REG_PC])
        self.registers, self.bytewise = {}, set()
        self.uc.mmio_map(0xE0000000, 0x100000, self._read, 0xE0000000, self._write, 0xE0000000)
        if first:
            self.compiled, self.covered, self.blocks = first.compiled, first.covered, first.blocks
        else:
            self._compile(chip_sources)
        self._hooks()
        self.events, self.order, self.sleep_until, self.other = [], 0, None, first
        self.longest_handler_stack, self.interrupts, self.ending = 0, {}, None
        self.reset()

    def serve(self, read, write, bytewise):
        """`read(address)` and `write(address, value)` of the chip serve words of 0x40000000 .. 0x60000000; narrow writes to `bytewise` as they are."""
        self.chip_read, self.chip_write, self.bytewise = read, write, bytewise
        self.uc.mmio_map(0x40000000, 0x20000000, self._read, 0x40000000, self._write, 0x40000000)

    def _compile(self, chip_sources):
        folder = tempfile.mkdtemp()
        source, library = os.path.join(folder, "hook.c"), os.path.join(folder, "hook.so")
        open(source, "w").write(HOOK + chip_sources)
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", library, source], check=True)
        self.compiled = ctypes.CDLL(library)
        self.covered = ctypes.create_string_buffer(self.flash_bytes)
        self.blocks = ctypes.create_string_buffer(2 * self.flash_bytes)

    def _hooks(self):
        end, read = (ctypes.cast(call, ctypes.c_void_p).value for call in (uclib.uc_emu_stop, uclib.uc_mem_read))
        self.clock = Clock(0.0, 0.0, 1 / self.mhz, float("inf"), end, read, None, ctypes.addressof(self.covered),
                           ctypes.addressof(self.blocks), self.flash, self.flash_bytes, 0)
        uclib.uc_hook_add(self.uc._uch, ctypes.byref(ctypes.c_size_t()), UC_HOOK_BLOCK, ctypes.cast(self.compiled.on_block, ctypes.c_void_p),
                          ctypes.byref(self.clock), ctypes.c_uint64(1), ctypes.c_uint64(0))
        self.uc.hook_add(UC_HOOK_INTR, self._on_interrupt)
        self.uc.hook_add(UC_HOOK_MEM_UNMAPPED, self._on_unmapped)
        for start, data in self.segments:
            self._hook_hints(start, data)

    def _hook_hints(self, start, code):
        for at in range(0, len(code) - 1, 2):
            hint = {0x20: self._on_sleep, 0x30: self._on_sleep, 0x40: self._on_event}.get(code[at])  # WFE, WFI, SEV
            if hint and code[at + 1] == 0xBF:  # data that looks so is never executed
                self.uc.hook_add(UC_HOOK_CODE, hint, None, start + at, start + at)

    def reset(self):
        """Power stays: RAM keeps what it holds."""
        self.enabled, self.pending, self.active, self.frames = {SYSTICK}, set(), [], []
        self.registers.clear()
        self.registers[0xE000ED08] = self.entry
        self.regions, self.event, self.ending, self.forced, self.ticks = {}, False, None, None, 0
        self.unlocked, self.counts_from = False, self.now  # of the DWT
        self.events.clear()
        sp, pc = struct.unpack("<2I", self.uc.mem_read(self.entry, 8))
        for register in (UC_ARM_REG_CONTROL, UC_ARM_REG_IPSR, UC_ARM_REG_PRIMASK, UC_ARM_REG_FAULTMASK):
            self.uc.reg_write(register, 0)
        self.uc.reg_write(UC_ARM_REG_MSP, sp)
        self.uc.reg_write(UC_ARM_REG_SP, sp)
        self.uc.reg_write(UC_ARM_REG_PC, pc)
        self.stack_top = sp

    @property
    def now(self):
        return self.clock.now

    def wait(self, us):
        self.clock.now += us

    def at(self, time, call):
        self.order += 1
        heapq.heappush(self.events, (time, self.order, call))
        self.clock.stop = min(self.clock.stop, time)

    def raise_interrupt(self, number):
        self.pending.add(number)
        self.clock.stop = 0

    def raise_level(self, number):
        """Of a peripheral that asks as long as something is to be done: not while its own handler runs, at whose end it is asked again."""
        if number not in self.active:
            self.raise_interrupt(number)

    def raise_fault(self):
        self.forced = -13
        self.clock.stop = 0

    def escalate(self, number):
        """Makes a HardFault of an exception that Unicorn has found, if that is known of it."""
        return False

    def raise_overflow(self):
        """A write below the stack, which the MPU forbids: DACCVIOL with its address, escalated."""
        self.registers[0xE000ED28], self.registers[0xE000ED2C] = 1 << 7 | 1 << 1, 1 << 30  # CFSR, HFSR
        self.registers[0xE000ED34] = self.symbols["_stack_end"] - 16  # MMFAR
        self.raise_fault()

    def where(self, address):
        address &= ~1
        return next((name for start, (size, name) in self.functions.items() if start <= address < start + size), hex(address))

    def stack(self, ends=("_stack_end", "_program_stack_start")):
        """Bytes of the program's stack that were used, and bytes of all: what is no longer the paint of `stack::paint` was."""
        start, end = (self.symbols[name] for name in ends)
        paint, words = (0x5AC45AC4).to_bytes(4, "little"), bytes(self.uc.mem_read(start, end - start))
        return next((end - start - at for at in range(0, len(words), 4) if words[at:at + 4] != paint), 0), end - start

    def coverage(self):
        """Of each function its name and a digit for every two bytes: 1 where they were executed."""
        covered = self.covered.raw.translate(bytes([48, 49]) + bytes(254))
        return [(name, covered[start - self.flash:start - self.flash + size:2].decode()) for start, (size, name) in sorted(self.functions.items())]

    # Memory-mapped registers.

    def _read(self, _, offset, size, base):
        address = base + offset
        word = self._system_read(address & ~3) if base == 0xE0000000 else self.chip_read(address & ~3)
        return (word >> ((address & 3) * 8)) & ((1 << size * 8) - 1)

    def _write(self, _, offset, size, value, base):
        address, word = base + offset, (base + offset) & ~3
        if size < 4 and word not in self.bytewise:
            shift = (address & 3) * 8
            mask = ((1 << size * 8) - 1) << shift
            value = (self.registers.get(word, 0) & ~mask) | (value << shift)
        (self._system_write if base == 0xE0000000 else self.chip_write)(word, value & 0xFFFFFFFF)

    def _system_read(self, at):
        mask = lambda numbers, first: sum(1 << (n - first) for n in numbers if first <= n < first + 32)
        if 0xE000E100 <= at < 0xE000E120 or 0xE000E180 <= at < 0xE000E1A0:
            return mask(self.enabled, (at & 0x1F) * 8)
        if 0xE000E200 <= at < 0xE000E220:
            return mask(self.pending, (at & 0x1F) * 8)
        if at == 0xE000ED04:
            return (self.active[-1] + 16 if self.active else 0) | (len(self.active) < 2) << 11
        if at == 0xE0001004:  # DWT_CYCCNT
            return self._cycles()
        return self.READ.get(at, self.registers.get(at, 0))

    def _cycles(self):
        counts = self.registers.get(0xE000EDFC, 0) >> 24 & self.registers.get(0xE0001000, 0) & 1  # DEMCR, DWT_CTRL
        return int((self.now - self.counts_from) * self.mhz) & 0xFFFFFFFF if counts else 0

    def _system_write(self, at, value):
        if at == 0xE0001FB0:  # DWT_LAR
            self.unlocked = value == 0xC5ACCE55
        elif 0xE0001000 <= at < 0xE0002000 and not self.unlocked:
            return
        elif at == 0xE0001004:
            self.counts_from = self.now - value / self.mhz
        if at in (0xE000ED28, 0xE000ED2C):  # CFSR, HFSR: what is written as 1 is cleared
            value = self.registers.get(at, 0) & ~value
        self.registers[at] = value
        numbers = {(at & 0x1F) * 8 + i for i in range(32) if value >> i & 1}
        if 0xE000E100 <= at < 0xE000E120:
            self.enabled |= numbers
        elif 0xE000E180 <= at < 0xE000E1A0:
            self.enabled -= numbers
        elif 0xE000E200 <= at < 0xE000E220:
            self.pending |= numbers
        elif 0xE000E280 <= at < 0xE000E2A0:
            self.pending -= numbers
        elif at == 0xE000EF00:
            self.pending.add(value & 0x1FF)
        elif 0xE000ED90 <= at < 0xE000EDC8:
            self.protect(at, value)
        elif at == 0xE000E010:
            self._start_ticks(value)
        elif at == 0xE000ED0C and value >> 2 & 1:
            self._end("reset")
        self.clock.stop = 0

    def _start_ticks(self, control):
        """SysTick, by the processor's clock."""
        self.ticks += 1
        period, order = (self.registers.get(0xE000E014, 0) + 1) / self.mhz, self.ticks

        def tick():
            if self.ticks == order:
                if control & 2:
                    self.raise_interrupt(SYSTICK)
                self.at(self.now + period, tick)

        if control & 1:
            self.at(self.now + period, tick)

    def _end(self, why):
        self.ending = why
        self.uc.emu_stop()

    # Exceptions.

    def _on_interrupt(self, uc, number, _):
        self.number = number
        uc.emu_stop()

    def _on_sleep(self, uc, *_):
        self.sleeping = True
        uc.emu_stop()

    def _on_event(self, *_):
        self.event = True
        if self.other:
            self.other.take_event(self.now)

    def take_event(self, time):
        """Another processor has sent an event."""
        self.event = True

    def _on_unmapped(self, uc, access, address, size, *_):
        self.fault = "access to %#x" % address
        return False

    def _priority(self, number):
        if number == SYSTICK:
            return self.registers.get(0xE000ED20, 0) >> 24
        return self.registers.get(0xE000E400 + (number & ~3), 0) >> ((number & 3) * 8) & 0xFF

    def _next(self):
        ready = [(self._priority(n), n) for n in self.pending & self.enabled if n not in self.active]
        best = min(ready, default=None)
        running = min((self._priority(n) if n >= SYSTICK else -1 for n in self.active), default=256)
        return best[1] if best and best[0] < running else None

    def enter(self, number):
        """Enters an interrupt, or with a negative number the exception 16 + number. Where it begins."""
        uc = self.uc
        *low, pc, status, control, exception, sp, msp = self.entered.read()
        thread = exception & 0x1FF == 0
        floats, own_stack = control >> 2 & 1, thread and control >> 1 & 1
        frame = (sp - (0x68 if floats else 0x20)) & ~7
        words = struct.pack("<8I", *low, pc, (status & ~0x200) | 1 << 24 | (sp >> 2 & 1) << 9)
        if floats:
            words += struct.pack("<18I", *self.floats.read(), 0)
        uc.mem_write(frame, words)
        self.active.append(number)
        self.frames.append((thread, own_stack, floats))
        link = 0xFFFFFFE1 | (0 if floats else 0x10) | thread << 3 | (4 if own_stack else 0)
        handler, = struct.unpack("<I", uc.mem_read(self.registers[0xE000ED08] + 4 * (16 + number), 4))
        self.entering.write(frame, number + 16, control & ~(14 if own_stack else 12), link, handler | 1)
        self.interrupts[number] = self.interrupts.get(number, 0) + 1
        if own_stack or not thread:
            self.longest_handler_stack = max(self.longest_handler_stack, self.stack_top - (msp if own_stack else frame))
        return handler

    def _leave(self):
        (thread, own_stack, floats), _ = self.frames.pop(), self.active.pop()
        *stacks, control = self.leaving.read()
        sp, count = stacks[own_stack], 26 if floats else 8
        words = struct.unpack("<%dI" % count, self.uc.mem_read(sp, 4 * count))
        if thread:
            control = (control & ~14) | (2 if own_stack else 0)
        if floats:
            self.floats.write(*words[8:25])
            control |= self.FLOATS_IN_USE
        sp += 4 * count + (4 if words[7] >> 9 & 1 else 0)
        self.left.write(0 if thread else self.active[-1] + 16, control, *words[:6], sp, words[7] & 0xF80F0000, words[6] | 1)

    # Running.

    def run(self, limit, levels, edges=lambda: None):
        """Until a time, us, or what ends it: `ending` says what. `levels` is called when an exception is left: those that are high ask again;
        `edges` whenever the processor has stopped."""
        uc = self.uc
        while self.now < limit and not self.ending:
            while self.events and self.events[0][0] <= self.now:
                heapq.heappop(self.events)[2]()
            edges()
            pc, status, *masks = self.state.read()
            number, count = self.forced or (None if any(masks) else self._next()), 0
            if number is not None and status & IT_BITS:
                number, count = None, 1  # Unicorn cannot come back into an IT block: a step, and again
            if number is not None:
                self.pending.discard(number)
                self.forced = None
                pc = self.enter(number)
                self.event = True
            self.clock.stop = min(self.events[0][0] if self.events else limit, limit)
            if self.pending & self.enabled:
                self.clock.stop = min(self.clock.stop, self.now + 2.0)  # masked, or of lower priority
            self.number, self.sleeping, self.fault = None, False, None
            try:
                uc.emu_start(pc | 1, 0xFFFFFFFE, 0, count)
            except UcError as error:
                if uc.reg_read(UC_ARM_REG_PC) >= 0xFFFFFF00:
                    self.number = 8
                else:
                    self.ending = "%s in %s" % (self.fault or error, self.where(uc.reg_read(UC_ARM_REG_PC)))
                    return
            if self.number == 8:
                self._leave()
                self.event = True
                levels()
            elif self.number is not None and not self.escalate(self.number):
                self.ending = "exception %d in %s, stack pointer %#x" % (self.number, self.where(uc.reg_read(UC_ARM_REG_PC)), uc.reg_read(UC_ARM_REG_SP))
            elif self.sleeping:
                uc.reg_write(UC_ARM_REG_PC, (uc.reg_read(UC_ARM_REG_PC) + 2) | 1)
                self._sleep(limit, edges)

    def _sleep(self, limit, edges):
        if self.event:
            self.event = False
            return
        while not self.pending & self.enabled and not self.forced and not self.event:
            if not self.events or self.now > limit:
                self.clock.now = max(self.now, limit)
                return
            time = self.events[0][0]
            reached = self.sleep_until(time) if self.sleep_until else time
            self.clock.now = max(self.now, reached)
            if reached < time:
                edges()
            else:
                heapq.heappop(self.events)[2]()
        self.event = False


def execute(board, scenario, result):
    """Runs a board's scenario and writes what is known of every board, and `board.report()`."""
    core = board.core
    if scenario.get("flash"):
        core.uc.mem_write(board.KEPT_FLASH, bytes.fromhex(scenario["flash"]))
    faults, resets = {"hard_fault_us": core.raise_fault, "overflow_us": core.raise_overflow}, []
    while True:
        for name, raise_it in faults.items():
            if scenario.get(name, 0) > core.now:
                core.at(scenario[name], raise_it)
        for time in scenario.get("resets_us", []):
            if time > core.now:
                core.at(time, lambda: core._end("reset"))
        core.run(scenario["until_us"], board.levels, board.edges)
        if core.ending != "reset" or len(resets) >= scenario.get("resets", 0):
            break
        resets.append(round(core.now))
        board.restart()
    json.dump({
        "ending": core.ending, "at": core.where(core.uc.reg_read(UC_ARM_REG_PC)), "us": core.now, "resets_us": resets,
        "host": bytes(board.host.sent).hex(), "host_us": board.host.times,
        "autopilot": bytes(board.autopilot.sent).hex(), "autopilot_us": board.autopilot.times,
        "triggers": board.triggers, "erases": board.erases, "longest_unfed_us": board.longest_unfed,
        "stack": core.stack(), "handler_stack": core.longest_handler_stack, "code": core.coverage(),
        "flash": bytes(core.uc.mem_read(board.KEPT_FLASH, board.KEPT_BYTES)).hex(), **board.report(),
    }, open(result, "w"))
