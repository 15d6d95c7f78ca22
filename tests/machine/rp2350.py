"""The board of docs/boards/pico2.md: an RP2350 and two HM01B0 on PIO block 0, with a host on USB and an autopilot on UART 0.

    python3 rp2350.py IMAGE SCENARIO.json RESULT.json

In it: what of the boot ROM the image calls, clocks and ticks by the registers that were written, pads and functions of pins, resets, both I2C,
PIO, DMA (`rp2350.c`), core 1 (`rp2350_core1.py`), TIMER0, SysTick, USB down to packets (`rp2350_usb.py`), UART 0 byte by byte, flash with XIP off while it is written, watchdog.
Not in it: wires' levels and edges, QMI timing and the XIP cache, RUN pin, power, RP2350's errata but E5, security attribution.

Scenario: until_us; host: [[us, hex]]; faults: [[camera, frame, short|few|stuck]]; flash: hex of its last four sectors or absent; erase_us;
hard_fault_us, dead_us (no camera sends from then on) or absent; resets: how often a reset may start it again; core1: "absent", it never answers;
core1_fault_us, core1_overflow_us, core1_dead_us (it hangs until the next reset): in the next work that core 1 does, or absent. Result: `execute`, and `report`.
"""
import ctypes, json, os, random, sys
from unicorn import UC_HOOK_CODE, UC_PROT_ALL, UC_PROT_NONE
from unicorn.arm_const import UC_ARM_REG_PC, UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2
from unicorn.unicorn_py3.unicorn import uclib
from cortex_m import Shared, execute
from cortex_m33 import CortexM33
from rp2350_core1 import FIFO_RD, FIFO_ST, PROC1, SLICE_US, Core1
from hm01b0 import I2c, Sensor, WIDTH, frame_bytes
from rp2350_usb import Rp2350Usb

FLASH, MHZ, CRYSTAL_MHZ = (0x10000000, 0x400000), 150.0, 12
SRAM, SRAM_BYTES, ROM = 0x20000000, 0x82000, 0x8000
CLOCKS, RESETS, IO, PADS, POWMAN, TICKS, BOOTRAM = 0x40010000, 0x40020000, 0x40028000, 0x40038000, 0x40100000, 0x40108000, 0x400E0000
QMI, PSM, WATCHDOG, SIO, UART0, TIMER0 = 0x400D0000, 0x40018000, 0x400D8000, 0xD0000000, 0x40070000, 0x400B0000
TRIGGER, MCLK, FIRST_PINS, BUSES = 20, 21, (2, 9), ((16, 17), (18, 19))
PIO_IRQ, DMA_IRQ, UART_IRQ, TIMER_IRQ = 16, 11, 33, 0
bit = lambda value, at: value >> at & 1

# Enters XIP: a store to QMI, as the boot ROM's own ends with. Literal at 8.
ENTER_XIP = bytes.fromhex("0148002101607047") + QMI.to_bytes(4, "little")


class Frame(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int64) for name in ("start", "rows", "row", "margin", "odd_row", "odd_halves", "is_stuck")]


class Uart:
    """A PL011's transmitter: its queue of 32, and the interrupt when it falls through its level."""

    def __init__(self, core):
        self.core, self.sent, self.times = core, bytearray(), []
        self.restart()

    def restart(self):
        self.registers, self.queue, self.raw = {}, 0, 0

    def byte_us(self):
        divisor = self.registers.get(0x24, 1) + self.registers.get(0x28, 0) / 64
        return 10 * 16 * divisor / MHZ

    def signal(self):
        if self.raw & self.registers.get(0x38, 0):
            self.core.raise_interrupt(UART_IRQ)

    def read(self, at):
        flags = (self.queue >= 32) << 5 | (self.queue == 0) << 7 | 1 << 4 | (self.queue > 0) << 3
        return {0x18: flags, 0x3C: self.raw, 0x40: self.raw & self.registers.get(0x38, 0)}.get(at, self.registers.get(at, 0))

    def write(self, at, value):
        self.registers[at] = value
        if at == 0x44:
            self.raw &= ~value
        elif at == 0x00 and bit(self.registers.get(0x30, 0), 8) and self.queue < 32:
            self.sent.append(value & 255)
            self.times.append(round(self.core.now))
            self.queue += 1
            if self.queue == 1:
                self.core.at(self.core.now + self.byte_us(), self._next)

    def _next(self):
        self.queue -= 1
        if self.queue == (4, 8, 16, 24, 28)[self.registers.get(0x34, 0x12) & 7]:
            self.raw |= 1 << 5
            self.signal()
        if self.queue:
            self.core.at(self.core.now + self.byte_us(), self._next)


class Rom:
    """The boot ROM: a table of functions, and those that write the flash."""
    NAMES = ["IF", "EX", "RE", "RP", "FC", "CX"]

    def __init__(self, board):
        self.board, uc = board, board.core.uc
        uc.mem_map(0, ROM)
        uc.mem_write(0x13, b"\x02")  # the version of stepping A2
        uc.mem_write(0x16, (0x101).to_bytes(2, "little"))
        for at in range(0x100, 0x100 + 16 * (len(self.NAMES) + 1), 16):
            uc.mem_write(at, b"\x70\x47")  # BX LR
            uc.hook_add(UC_HOOK_CODE, self._call, None, at, at)

    def _call(self, uc, at, *_):
        board, (a, b, c) = self.board, (uc.reg_read(r) for r in (UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2))
        if at == 0x100:
            name = (a & 0xFFFF).to_bytes(2, "little").decode("latin-1")
            if name not in self.NAMES:
                board.core._end("function %s of the boot ROM" % name)
                return
            uc.reg_write(UC_ARM_REG_R0, 0x111 + 16 * self.NAMES.index(name))
            return
        name = self.NAMES[(at - 0x110) // 16]
        if name == "EX":
            board.set_xip(False)
        elif name in ("RE", "RP") and board.has_xip:
            board.core._end("flash written while code runs from it")
        elif name == "RE":
            uc.mem_write(FLASH[0] + a, b"\xff" * b)
            board.core.wait(board.erase_us * b / 4096)
            board.erases += 1
        elif name == "RP":
            old, new = uc.mem_read(FLASH[0] + a, c), uc.mem_read(b, c)
            uc.mem_write(FLASH[0] + a, bytes(x & y for x, y in zip(old, new)))
            board.core.wait(700 * c / 256)


class Board:
    KEPT_FLASH, KEPT_BYTES = FLASH[0] + FLASH[1] - 0x4000, 0x4000

    def __init__(self, image, scenario):
        source = open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "rp2350.c")).read()
        self.core = core = CortexM33(image, FLASH, [], MHZ, source)
        self.sram = Shared(SRAM_BYTES)
        self.sram.map(core.uc, SRAM)
        core.uc.mem_write(SRAM, random.Random(1).randbytes(SRAM_BYTES))  # memory holds anything when power comes
        for start, data in core.segments:
            if start >= SRAM:
                core.uc.mem_write(start, data)
        self.faults = {(camera, frame): kind for camera, frame, kind in scenario.get("faults", [])}
        self.erase_us = scenario.get("erase_us", 45e3)
        self.chip = core.compiled
        self._connect()
        self.rom, self.sensors = Rom(self), (Sensor(False), Sensor(True))
        self.buses = [I2c(core, {0x24: sensor}) for sensor in self.sensors]
        self.usb, self.autopilot = Rp2350Usb(core, self.chip.rp2350_dpram()), Uart(core)
        self.host = self.usb.host
        self.parts = {0x40090000: self.buses[0], 0x40098000: self.buses[1], 0x50110000: self.usb, UART0: self.autopilot}
        self.triggers, self.erases, self.longest_unfed, self.reason, self.bites = 0, 0, 0.0, 0, 0
        self.core1 = Core1(self, image, scenario)
        self.sram.map(self.core1.uc, SRAM)
        self.core1_faults = {"core1_fault_us": self.core1.raise_fault, "core1_overflow_us": self.core1.fill_stack, "core1_dead_us": self.core1.die}
        self.scenario = scenario
        self.commands, self.dead_us = scenario.get("host", []), scenario.get("dead_us", float("inf"))
        self._reset()

    def _connect(self):
        chip, u32, pointer = self.chip, ctypes.c_uint32, ctypes.c_void_p
        chip.rp2350_dpram.restype, chip.rp2350_sleep.restype, chip.rp2350_sleep.argtypes = pointer, ctypes.c_double, [ctypes.c_double]
        chip.rp2350_timer.argtypes, chip.rp2350_clock.argtypes = [ctypes.c_double], [ctypes.c_int64]
        chip.rp2350_cycle.restype = ctypes.c_int64
        chip.rp2350_frame.argtypes = [ctypes.c_int, u32, ctypes.c_char_p, ctypes.POINTER(Frame)]
        self.calls = ctypes.CFUNCTYPE(u32, u32)(self._guarded(self.read)), ctypes.CFUNCTYPE(None, u32, u32, u32)(self._guarded(self.write))
        read, write = (ctypes.cast(call, pointer) for call in self.calls)
        chip.rp2350_setup(ctypes.byref(self.core.clock), ctypes.c_double(MHZ), pointer(self.sram.at), read, write)
        address = lambda function: ctypes.cast(function, pointer)
        for start, size in ((0x40000000, 0x20000000), (SIO, 0x1000)):
            uclib.uc_mmio_map(self.core.uc._uch, ctypes.c_uint64(start), ctypes.c_uint64(size), address(chip.rp2350_read), pointer(start),
                              address(chip.rp2350_write), pointer(start))
        self.core.clock.work, self.core.clock.due = address(chip.rp2350_work).value, 0.0
        self.core.sleep_until = self.sleep

    def sleep(self, until):
        """While core 0 sleeps: to a time, us, or to an interrupt, or to what core 1 sends."""
        if self.core1.is_awake and self.core1.is_alive:
            until = min(until, self.core.now + SLICE_US)
            self.core1.follow(until)
            if self.core.event:
                until = min(until, max(self.core.now, self.core1.now))
        return self.chip.rp2350_sleep(until)

    def _guarded(self, call):
        def guarded(*arguments):
            try:
                return call(*arguments)
            except Exception as error:
                self.core._end("%s%s: %r" % (call.__name__, tuple(map(hex, arguments)), error))
                return 0

        return guarded

    def _reset(self):
        self.chip.rp2350_reset()
        for part in self.parts.values():
            part.restart()
        self.registers, self.has_xip, self.last_feed, self.alarm = {}, True, None, 0
        self.registers[RESETS], self.ticking, self.feeds = 0x1FFFFFFF, None, 0
        for time, data in self.commands:
            if time > self.core.now:
                self.core.at(time, lambda data=data: self.host.send(bytes.fromhex(data)))
        for name, call in self.core1_faults.items():
            if self.scenario.get(name, 0) > self.core.now:
                self.core.at(self.scenario[name], lambda call=call: self.core1.at_work(call))
        for pin in range(48):
            self.registers[PADS + 4 + 4 * pin], self.registers[IO + 8 * pin + 4] = 0x116, 31

    def restart(self):
        """After a reset that the program or the watchdog asked for: scratch registers stay."""
        scratch = {at: value for at, value in self.registers.items() if WATCHDOG + 0x0C <= at < WATCHDOG + 0x2C}
        self.core.reset()
        self.core1.is_alive = True
        self.core1.boot()
        self._reset()
        self.registers.update(scratch)
        self.reason, self.bites = self.bites, 0
        for sensor in self.sensors:
            sensor.is_sending = False

    def levels(self):
        for line, number in ((1, PIO_IRQ), (2, DMA_IRQ)):
            if self.chip.rp2350_high() & line:
                self.core.raise_interrupt(number)
        self.usb.signal()
        self.autopilot.signal()

    def edges(self):
        self.core1.follow(self.core.now)
        risen = self.chip.rp2350_risen()
        for line, number in ((1, PIO_IRQ), (2, DMA_IRQ)):
            if risen & line:
                self.core.raise_interrupt(number)
        refused = ctypes.c_uint32.in_dll(self.chip, "unknown_at").value
        if refused and not self.core.ending:
            self.core.ending = "%#x at %#x is not in the model" % (ctypes.c_uint32.in_dll(self.chip, "unknown").value, refused)

    def report(self):
        number = lambda name: ctypes.c_uint32.in_dll(self.chip, name).value
        return {"regions": list(self.core.regions.values()), "dma": [number("dma_low"), number("dma_high")],
                "pio_executed": number("pio_executed"), "sys_mhz": self.sys_mhz(), "mclk_mhz": self.mclk_mhz(), "core1": self.core1.report(),
                "autopilot_baud": 10e6 / self.autopilot.byte_us(), **self.host.report()}

    # Pins and clocks.

    def pad(self, pin):
        """Its pad, or none while it is isolated."""
        value = self.registers[PADS + 4 + 4 * pin]
        return None if bit(value, 8) else value

    def function(self, pin):
        return self.registers[IO + 8 * pin + 4] & 31 if self.pad(pin) is not None else None

    def inputs(self):
        return sum(1 << pin for pin in range(32) if self.pad(pin) is not None and bit(self.pad(pin), 6))

    def output(self, pin):
        """Level that the processor drives there; None: nothing."""
        out, enable = self.registers.get(SIO + 0x10, 0), self.registers.get(SIO + 0x30, 0)
        return bit(out, pin) if self.function(pin) == 5 and bit(enable, pin) and not bit(self.pad(pin), 7) else None

    def gpio_in(self):
        levels = sum(1 << pin for bus in BUSES for pin in bus if self.output(pin) != 0)
        return levels & self.inputs()

    def pll_mhz(self, base):
        control, power, post = (self.registers.get(base + at, 0) for at in (0, 4, 12))
        if bit(power, 0) or bit(power, 3) or bit(power, 5) or not post >> 16 & 7:
            return 0
        return CRYSTAL_MHZ / (control & 63) * self.registers.get(base + 8, 0) / (post >> 16 & 7) / (post >> 12 & 7)

    def sys_mhz(self):
        control, divider = self.registers.get(CLOCKS + 0x3C, 0), self.registers.get(CLOCKS + 0x40, 0x10000)
        return self.pll_mhz(0x40050000) / (divider / 0x10000) if control & 0xE1 == 1 else None

    def mclk_mhz(self):
        """The crystal by GPOUT0, where its pin has this function."""
        control, divider = self.registers.get(CLOCKS, 0), self.registers.get(CLOCKS + 4, 0x10000)
        is_on = bit(control, 11) and control >> 5 & 15 == 6 and self.function(MCLK) == 9 and not bit(self.pad(MCLK), 7)
        return CRYSTAL_MHZ / (divider / 0x10000) if is_on else 0

    # Cameras.

    def set_trigger(self, before):
        level = self.output(TRIGGER)
        if level and not before:
            self.triggers += 1
            for sensor in self.sensors:
                self.play(sensor)

    def play(self, sensor):
        """One frame after the other while the trigger is high."""
        pins = range(FIRST_PINS[sensor.is_right], FIRST_PINS[sensor.is_right] + 7)
        is_wired = self.mclk_mhz() and all(self.function(pin) == 6 for pin in pins)
        if self.core.now > self.dead_us or sensor.is_sending or not sensor.is_triggered() or not is_wired:
            return
        pixel_us = sensor.pixel_divider() / self.mclk_mhz()
        period = round(pixel_us / 2 * MHZ)  # PCLKO: two a pixel
        self.chip.rp2350_clock(period)
        pixels = sensor.word(0x0342)
        fault = self.faults.get((("left", "right")[sensor.is_right], sensor.frame))
        start_us = self.core.now + sensor.word(0x0202) * pixels * pixel_us
        start = int(start_us * MHZ) // period + 1
        frame = Frame(start, 243 if fault == "few" else 244, 2 * pixels, 8, 77 if fault == "short" else -1, 600, fault == "stuck")
        self.chip.rp2350_frame(sensor.is_right, FIRST_PINS[sensor.is_right], frame_bytes(sensor.is_right, sensor.frame), ctypes.byref(frame))
        sensor.frame += 1
        sensor.is_sending = True

        def end():
            sensor.is_sending = False
            if self.output(TRIGGER):
                self.play(sensor)

        self.core.at(start_us + sensor.word(0x0340) * pixels * pixel_us, end)

    # Registers that rp2350.c does not have.

    def read(self, at):
        if SIO + FIFO_ST <= at <= SIO + FIFO_RD:
            return self.core1.read_queue(at - SIO, 0)
        if at >= SIO:
            return {SIO: 0, SIO + 4: self.gpio_in()}.get(at, self.registers.get(at, 0))
        block, at = at & ~0x7FFF, at & ~0x3000
        if block in self.parts:
            return self.parts[block].read(at & 0xFFF)
        value, get = self.registers.get(at, 0), lambda other: self.registers.get(other, 0)
        special = {
            CLOCKS + 0x38: lambda: 1 << (get(CLOCKS + 0x30) & 3), CLOCKS + 0x44: lambda: 1 << (get(CLOCKS + 0x3C) & 1),
            RESETS + 8: lambda: ~get(RESETS) & 0x1FFFFFFF, 0x4001800C: lambda: 0x1FFFFFF,
            0x40048004: lambda: (get(0x40048000) >> 12 & 0xFFF == 0xFAB) << 31,
            0x40050000: lambda: value | (get(0x40050004) & 0x21 == 0) << 31, 0x40058000: lambda: value | (get(0x40058004) & 0x21 == 0) << 31,
            POWMAN + 0x2C: lambda: 1 << 16, POWMAN + 0x0C: lambda: 0xB0,
            WATCHDOG + 8: lambda: self.reason,
        }
        if at in special:
            return special[at]()
        if BOOTRAM <= at < BOOTRAM + 256:
            return int.from_bytes(ENTER_XIP.ljust(256, b"\0")[at - BOOTRAM:at - BOOTRAM + 4], "little")
        if 0x40130000 <= at < 0x40138000:
            return 0x1234 + (at & 0xFFF)
        return value

    def write(self, at, value, size):
        if 0x50100000 <= at < 0x50100100:
            return self.usb.touched(at - 0x50100000)
        if size < 4:
            raise ValueError("a narrow write")
        if at >= SIO:
            return self.write_sio(at, value)
        operation, block, at = at >> 12 & 3, at & ~0x7FFF, at & ~0x3000
        if operation:
            old = self.read(at)
            value = {1: old ^ value, 2: old | value, 3: old & ~value}[operation]
        if block in self.parts:
            return self.parts[block].write(at & 0xFFF, value)
        if block == POWMAN and value >> 16 != 0x5AFE:
            raise ValueError("no password")
        before, self.registers[at] = self.registers.get(at, 0), value
        if at == RESETS:
            for base, line in ((0x40090000, 4), (0x40098000, 5)):
                if bit(value, line) and not bit(before, line):
                    self.parts[base].restart()
        elif block == TICKS and self.ticking is None and self.registers.get(TICKS + 0x18, 0) & 1:
            if self.registers.get(CLOCKS + 0x30, 0) & 3 != 2 or self.registers.get(TICKS + 0x1C) != CRYSTAL_MHZ:
                raise ValueError("TIMER0 does not count microseconds")
            self.ticking = self.core.now
            self.chip.rp2350_timer(self.ticking)
        elif block in (PADS, IO):
            self.chip.rp2350_pads(self.inputs())
        elif block == WATCHDOG:
            self.write_watchdog(at, value)
        elif at == PSM + 4 and bit(before, PROC1) and not bit(value, PROC1):
            self.core1.boot()
        elif at == PSM + 4 and bit(value, PROC1):
            self.core1.is_awake = self.core1.is_launched = False
        elif block == QMI:
            self.set_xip(True)
        elif block == TIMER0 and at & 0xFFF == 0x10:
            self.set_alarm(value)

    def write_sio(self, at, value):
        if SIO + FIFO_ST <= at <= SIO + FIFO_RD:
            return self.core1.write_queue(at - SIO, value, 1)
        register, before = at, self.output(TRIGGER)
        if 0x10 <= at & 0xFFF < 0x50:
            group = 0x10 if at & 0xFFF < 0x30 else 0x30
            register, operation = SIO + group + (at & 4), ((at & 0xFFF) - group) >> 3
            old = self.registers.get(register, 0)
            value = (value, old | value, old & ~value, old ^ value)[operation]
        self.registers[register] = value
        self.set_trigger(before)

    def set_alarm(self, value):
        self.alarm += 1
        order, wait = self.alarm, (value - int(self.core.now - (self.ticking or 0))) & 0xFFFFFFFF

        def ring():
            if self.alarm == order and self.registers.get(TIMER0 + 0x40, 0) & 1:
                self.core.raise_interrupt(TIMER_IRQ)

        self.core.at(self.core.now + wait, ring)

    def is_held(self, processor):
        """In reset, by the power-on state machine."""
        return bit(self.registers.get(PSM + 4, 0), processor)

    def write_watchdog(self, at, value):
        if at == WATCHDOG and bit(value, 31):
            self.bites = 2  # by the program
            self.core._end("reset")
        if at == WATCHDOG + 4 or at == WATCHDOG and bit(value, 30):
            if self.last_feed is not None:
                self.longest_unfed = max(self.longest_unfed, self.core.now - self.last_feed)
            self.last_feed = self.core.now
            self.feeds += 1
            feeds, load = self.feeds, self.registers.get(WATCHDOG + 4, 0)

            def bite():
                if self.feeds == feeds and bit(self.registers.get(WATCHDOG, 0), 30):
                    self.bites = 1  # by its timer
                    self.core._end("reset")

            if at == WATCHDOG + 4:
                self.core.at(self.core.now + load, bite)

    def set_xip(self, is_on):
        """Without it nothing can be read from the flash: what tries ends the run."""
        self.has_xip = is_on
        for core in (self.core, self.core1):
            core.uc.mem_protect(*FLASH, UC_PROT_ALL if is_on else UC_PROT_NONE)
        if not is_on and self.core1.is_in_flash():
            self.core._end("the flash is written while core 1 runs from it")


def main(image, scenario, result):
    scenario = json.load(open(scenario))
    execute(Board(image, scenario), scenario, result)


if __name__ == "__main__":
    main(*sys.argv[1:4])
