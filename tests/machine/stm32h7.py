"""The boards of docs/boards/stm32h743.md and portenta-h7.md: an STM32H743 whose DCMI two MT9V034 share, and an STM32H747 to which a joiner gives
the rows of both as one; a host on a UART or on USB, an autopilot on another UART.

    python3 stm32h7.py IMAGE SCENARIO.json RESULT.json

In it: clocks, I2C and its errors, trigger and camera select, EXTI, DCMI, DMA1 into a ring, TIM5, both UARTs paced byte by byte, USB down to packets
(`otg.py`), bank 2 of the flash and its errors, watchdog feeds, regions of the MPU. Not in it: caches, MPU faults, the bus fault of a word of flash that
cannot be corrected, ADC, option bytes; of the Portenta its bootloader, power controller, what USB's PHY does beyond its power and pins, second core and
the joiner's own behaviour.

Scenario: board: a key of WIRINGS; until_us; port: uart, or usb, to which a host is plugged; host: [[us, hex, or an act of a USB host]];
autopilot: [[us, hex]]; autopilot_clock_us: what its clock is ahead, by which it answers TIMESYNC, or absent;
faults: [[camera, frame, short|few|overrun|blind|none]]; pictures: [[from us, to us, covered|bright|dark|lower|swapped|frozen, or a name of images]];
images: {name: [left, right]} in hex;
i2c: [[from us, to us, camera, absent|other|forgets|hung|held|mute|bus|arbitration]]; exposures: [[us, rows]] that the sensors' own control chooses;
flash: hex of bank 2's last four sectors or absent; broken: [offset there of a word that power failed in]; flash_errors: [[from us, to us]]; erase_us;
reset_flags: RCC_RSR of each start, then that of a software reset; hard_fault_us and overflow_us (of the stack) or absent; resets_us: when it is reset
from outside; resets: how often a reset may start it again. Result: see `execute`.
"""
import functools, json, struct, sys
from collections import namedtuple
from unicorn import UC_HOOK_CODE, UC_HOOK_MEM_READ
from cortex_m import execute
from cortex_m7 import CortexM7
from otg import Otg

WIDTH, HEIGHT = 320, 240
UNIQUE_ID, LOADER = (0x1FF1E800, bytes.fromhex("2e0031000e51303434363337")), 0x1FF09800
RAM = [(0x1FF00000, 0x20000), (0x20000000, 0x20000), (0x24000000, 0x80000), (0x30000000, 0x48000)]
FLASH, MHZ = (0x08000000, 0x200000), 400.0
TIM5, DMA1, DCMI, EXTI, FLASH2, AHB1LPENR = 0x40000C00, 0x40020000, 0x48020000, 0x58000000, 0x52002100, 0x58024500
# UARTs and USB (address, interrupt), I2C of the sensors, line of VSYNC, pin of the trigger, time of
# a row; do both cameras' rows come as one?
Wiring = namedtuple("Wiring", "host autopilot i2c vsync trigger usb row_us joined")
WIRINGS = {
    "stm32h743": Wiring((0x40004800, 39), (0x40004400, 38), 0x40005400, 7, ("D", 14), (0x40080000, 101), 27.5, False),
    "portenta-h7": Wiring((0x40011000, 37), (0x40011400, 71), 0x40005C00, 5, ("G", 7), (0x40040000, 77), 29.4, True),
}
USB_BYTES, ULPI_PINS = 0x40000, (("A", 3), ("A", 5), ("B", 0), ("B", 1), ("B", 5), ("B", 10), ("B", 11), ("B", 12), ("B", 13), ("C", 0), ("H", 4), ("I", 11))
TIM5_IRQ, DCMI_IRQ, VSYNC_IRQ = 50, 78, 23
DARK = bytes(level // 16 for level in range(256))
LIGHTER = [bytes(min(level + more, 255) for level in range(256)) for more in range(4)]
bit = lambda value, at: value >> at & 1


def mixed(number):
    """A hash: a staircase of levels would look like itself some blocks on."""
    number &= 0xFFFFFFFF
    number = (number ^ number >> 15) * 0x2C1B3C6D & 0xFFFFFFFF
    number = (number ^ number >> 12) * 0x297A2D39 & 0xFFFFFFFF
    return number ^ number >> 15


@functools.lru_cache(maxsize=256)
def blocks(row, picture):
    grey = lambda column: 40 + mixed(column * 73 + row * 151 + picture * 29) % 180
    return b"".join(bytes([grey(column)]) * 8 for column in range(WIDTH // 8 + 2))


def sensor_row(camera, frame, y, picture=None):
    """Grey blocks of 8 px; the right camera sees them 10 px further left. The same in tests/tests/machine. Or what is wrong with the picture."""
    if picture == "covered" and camera == "left":
        return bytes([18]) * WIDTH
    if picture == "bright":
        return b"\xff" * WIDTH
    if picture == "lower" and camera == "right":
        y = max(y - 5, 0)
    is_right = (camera == "right") != (picture == "swapped")
    shift = 10 if is_right else 0
    row = blocks(y // 8, 0 if picture == "frozen" else frame // 2)[shift:shift + WIDTH]
    return row.translate(DARK) if picture == "dark" else row


class Sensor:
    """Registers of an MT9V034."""

    def __init__(self, name):
        self.name, self.registers, self.pointer, self.frame = name, {0x00: 0x1324, 0xBB: 200, 0xBA: 16}, 0, 0

    def write(self, data):
        self.pointer = data[0]
        if len(data) >= 3:
            self.registers[self.pointer] = data[1] << 8 | data[2]

    def read(self, count):
        value = self.registers.get(self.pointer, 0)
        return [value >> 8, value & 255][:count]

    def waits_for_trigger(self):
        return self.registers.get(0x07, 0) >> 3 & 3 == 3

    def exposed_rows(self):
        chosen = self.registers.get(0xAF, 3) & 3
        return self.registers[0xBB] if chosen else self.registers.get(0x0B, 200)


class I2c:
    ERRORS = {"bus": 1 << 8, "arbitration": 1 << 9}

    def __init__(self, core, sensors, faults):
        self.core, self.faults = core, faults
        self.sensors, self.registers, self.times_off = sensors, {}, 0
        self._reset()

    def _reset(self):
        self.flags, self.mode, self.left, self.data, self.answer, self.held = 1, None, 0, [], [], None

    def _fault(self, address):
        name = self.sensors[address].name if address in self.sensors else None
        return next(((kind, last) for first, last, camera, kind in self.faults if camera == name and first <= self.core.now < last), (None, 0))

    def _start(self, is_read):
        (fault, last), sensor = self._fault(self.address), self.sensors.get(self.address)
        if fault in self.ERRORS:
            self.flags |= self.ERRORS[fault]
        elif sensor is None or fault == "absent":
            self.flags |= 1 << 4 | 1 << 5
        elif fault == "hung" or fault == "mute" and is_read:  # the clock is held: from the address on, or when a byte is to be read
            pass  # after that the block waits for its program, and holds the clock itself
        elif is_read:
            self.mode, self.answer = "read", [0x13, 0x13] if fault == "other" and sensor.pointer == 0 else sensor.read(self.left)
            self.flags |= 4
        else:
            self.mode, self.flags, self.held = "forget" if fault == "forgets" else "write", self.flags | 2, last if fault == "held" else None

    def _finish(self):
        if self.mode in ("write", "forget") and self.data:
            self.sensors[self.address].write(self.data if self.mode == "write" else self.data[:1])
        self.data, self.mode = [], None

    def _stop(self):
        self.flags = (self.flags | 1 << 5) & ~(1 << 15 | 1 << 6 | 6)
        self._finish()

    def _complete(self):
        if bit(self.registers.get(4, 0), 25):
            self._stop()
        else:
            self.flags |= 1 << 6

    def read(self, at):
        if at == 0x18:
            return self.flags
        if at != 0x24:
            return self.registers.get(at, 0)
        value = self.answer.pop(0) if self.answer else 0
        if not self.answer:
            self.flags &= ~4
            self._complete()
        return value

    def write(self, at, value):
        self.registers[at] = value
        if at == 0 and not bit(value, 0):
            self.times_off += 1
            self._reset()
        elif at == 4 and bit(value, 13):
            self._finish()
            self.address, self.left, self.flags = value >> 1 & 0x7F, value >> 16 & 0xFF, 1 | 1 << 15
            self._start(bit(value, 10))
            self.registers[4] = value & ~(1 << 13)
        elif at == 4 and bit(value, 14):
            self._stop()
        elif at == 0x1C:
            self.flags &= ~(value & 0x3F38)
        elif at == 0x28:
            self.data.append(value & 255)
            self.left -= 1
            if self.left <= 0:
                self.flags &= ~2
                if self.held:  # after the last byte
                    self.core.at(self.held, lambda times=self.times_off: times == self.times_off and self._stop())
                else:
                    self._complete()


class Uart:
    def __init__(self, core, base, irq, baud):
        self.core, self.base, self.irq, self.byte_us = core, base, irq, 10e6 / baud
        self.sent, self.times, self.received, self.listener = bytearray(), [], [], None
        self.restart()

    def restart(self):
        self.control, self.empty, self.idle = 0, 1, 0

    def flags(self):
        return self.empty << 7 | self.empty << 6 | 3 << 21 | bool(self.received) << 5 | self.idle << 4

    def signal(self):
        if self.control & self.flags() & (1 << 7 | 1 << 6 | 1 << 5 | 1 << 4):
            self.core.raise_level(self.irq)

    def receive_all(self, data):
        """At the line's pace."""
        for i, byte in enumerate(data):
            self.core.at(self.core.now + self.byte_us * i, lambda byte=byte: self.receive(byte))

    def receive(self, byte):
        self.received.append(byte)
        self.idle = 0
        self.signal()

    def read(self, at):
        if at == 0x24:
            value = self.received.pop(0) if self.received else 0
            self.idle = int(not self.received)
            return value
        return {0x00: self.control, 0x1C: self.flags()}.get(at, 0)

    def write(self, at, value):
        if at == 0x00:
            self.control = value
            self.signal()
        elif at == 0x20 and bit(value, 4):
            self.idle = 0
        elif at == 0x28:
            self.sent.append(value & 255)
            self.times.append(round(self.core.now))
            self.empty = 0
            self.core.at(self.core.now + self.byte_us, self._is_empty)
            if self.listener:
                self.listener.hear()

    def _is_empty(self):
        self.empty = 1
        self.signal()


class AutopilotClock:
    """An autopilot that answers a board's TIMESYNC by its own clock."""

    def __init__(self, core, uart, ahead_us):
        self.core, self.uart, self.ahead_us, self.heard = core, uart, ahead_us, 0

    def hear(self):
        frame = self.uart.sent[self.heard:]
        if len(frame) < 2 or len(frame) < frame[1] + 12:
            return
        self.heard += len(frame)
        theirs, ours = struct.unpack("<2q", bytes(frame[10:-2].ljust(16, b"\0")[:16]))
        if int.from_bytes(frame[7:10], "little") == 111 and theirs == 0:
            message = bytes((16, 0, 0, 0, 1, 1, 111, 0, 0)) + struct.pack("<2q", round(self.core.now + self.ahead_us) * 1000, ours)
            self.uart.receive_all(b"\xfd" + message + struct.pack("<H", crc_x25(message + bytes((34,)))))


def crc_x25(data):
    crc = 0xFFFF
    for byte in data:
        low = (byte ^ crc) & 0xFF
        low = (low ^ low << 4) & 0xFF
        crc = crc >> 8 ^ low << 8 ^ low << 3 ^ low >> 4
    return crc


class Timer:
    """TIM5 as the clock of embassy-time: 16 bits of 1 MHz, interrupts at 0, at half, and at an alarm."""

    def __init__(self, core):
        self.core = core
        self.restart()

    def restart(self):
        self.start, self.flags, self.wanted, self.compare, self.generation = None, 0, 0, [0] * 4, 0
        self.looks, self.looked = 0, 0

    def count(self):
        return 0 if self.start is None else int(self.core.now - self.start) & 0xFFFF

    def signal(self):
        if self.flags & self.wanted & 0x1F:
            self.core.raise_level(TIM5_IRQ)

    def _arm(self):
        if self.start is None:
            return
        self.generation += 1
        generation, elapsed = self.generation, int(self.core.now - self.start)

        def every_turn(flag):
            if self.generation == generation:
                self.flags |= flag
                self.signal()
                self.core.at(self.core.now + 65536, lambda: every_turn(flag))

        for flag, count in ((1, 0), (2, 0x8000), (4, self.compare[1])):
            turn = elapsed // 65536 * 65536 + count
            self.core.at(self.start + (turn if turn > elapsed else turn + 65536), lambda flag=flag: every_turn(flag))

    def look(self):
        """A program that does nothing but look at the clock is let look every 5 us: most of a run's reads are its delays."""
        executed = self.core.clock.executed
        self.looks = self.looks + 1 if executed - self.looked < 100 else 0
        self.looked = executed
        if self.looks > 8 and self.core.events:
            self.core.wait(max(0.0, min(5.0, self.core.events[0][0] - self.core.now)))

    def read(self, at):
        self.core.wait(0.02)
        if at == 0x24:
            self.look()
            return self.count()
        if 0x34 <= at <= 0x40:
            return self.compare[(at - 0x34) // 4]
        return {0x10: self.flags, 0x0C: self.wanted}.get(at, self.core.registers.get(TIM5 + at, 0))

    def write(self, at, value):
        self.core.registers[TIM5 + at] = value
        if at == 0 and value & 1 and self.start is None:
            self.start = self.core.now
            self._arm()
        elif at == 0x10:
            self.flags &= value
        elif at == 0x0C:
            self.wanted = value & 0x1F
            self.signal()
        elif 0x34 <= at <= 0x40:
            self.compare[(at - 0x34) // 4] = value & 0xFFFF
            self._arm()


class Capture:
    """DCMI and the DMA stream behind it."""

    def __init__(self, core):
        self.core, self.targets = core, set()
        self.restart()

    def restart(self):
        self.flags, self.wanted, self.control, self.capturing, self.armed = 0, 0, 0, False, False
        self.in_blanking, self.between_frames, self.dma, self.place, self.words, self.carry = 1, 1, False, 0, 0, b""

    def signal(self, flags=0):
        self.flags |= flags
        if self.flags & self.wanted:
            self.core.raise_interrupt(DCMI_IRQ)

    def put(self, data):
        if not (self.armed and self.dma):
            return
        base, size = self.core.registers[DMA1 + 0x1C], self.words * 4
        self.targets.add((base, size))
        self.carry += data
        data, self.carry = self.carry[:len(self.carry) & ~3], self.carry[len(self.carry) & ~3:]
        while data:
            part = data[:size - self.place]
            self.core.uc.mem_write(base + self.place, bytes(part))
            self.place, data = (self.place + len(part)) % size, data[len(part):]

    def read(self, at):
        status = self.in_blanking | self.between_frames << 1
        return {0: self.control, 4: status, 8: self.flags, 0x0C: self.wanted, 0x10: self.flags & self.wanted}.get(at, 0)

    def write(self, at, value):
        if at == 0:
            self.control, self.capturing = value, bool(value & 1 and bit(value, 14))
            self.armed &= self.capturing
        elif at == 0x0C:
            self.wanted = value
            self.signal()
        elif at == 0x14:
            self.flags &= ~value

    def switch_dma(self, value):
        if value & 1 and not self.dma:
            self.words, self.place = self.core.registers.get(DMA1 + 0x14, 0) & 0xFFFF, 0
        self.dma = bool(value & 1)


class Board:
    KEPT_FLASH, KEPT_BYTES = 0x08180000, 0x80000

    def __init__(self, image, scenario):
        wiring = self.wiring = WIRINGS[scenario["board"]]
        self.core = CortexM7(image, FLASH, RAM, MHZ)
        self.core.serve(self.read, self.write, {base + 0x28 for base in (wiring.host[0], wiring.autopilot[0], wiring.i2c)})
        self.faults = {(camera, frame): kind for camera, frame, kind in scenario.get("faults", [])}
        self.pictures, self.picture, self.erase_us = scenario.get("pictures", []), None, scenario.get("erase_us", 1e6)
        self.images = {name: [bytes.fromhex(image) for image in pair] for name, pair in scenario.get("images", {}).items()}
        self.sensors = {0x48: Sensor("left"), 0x4C: Sensor("right")}
        self.uart, self.autopilot = Uart(self.core, *wiring.host, 921600), Uart(self.core, *wiring.autopilot, 57600)
        self.commands, self.messages, self.on_usb = scenario.get("host", []), scenario.get("autopilot", []), scenario.get("port") == "usb"
        self.exposures = scenario.get("exposures", [])
        self.usb = Otg(self.core, wiring.usb[1], self.phy, self.on_usb)
        self.host = self.usb.host if self.on_usb else self.uart
        self.timer, self.capture, self.i2c = Timer(self.core), Capture(self.core), I2c(self.core, self.sensors, scenario.get("i2c", []))
        self.parts = {wiring.i2c: self.i2c, TIM5: self.timer, wiring.host[0]: self.uart, wiring.autopilot[0]: self.autopilot}
        self.next_flags = iter(scenario.get("reset_flags", [0x00EE0000]))
        self.pins, self.vsync, self.reset_flags = {}, 0, next(self.next_flags)
        self.flash_errors, self.broken = scenario.get("flash_errors", []), set(scenario.get("broken", []))
        self.triggers, self.erases, self.last_feed, self.longest_unfed = 0, 0, None, 0.0
        for word in self.broken:
            self.core.uc.hook_add(UC_HOOK_MEM_READ, lambda *_, word=word: self.read_word(word), None, self.KEPT_FLASH + word, self.KEPT_FLASH + word + 31)
        if "autopilot_clock_us" in scenario:
            self.autopilot.listener = AutopilotClock(self.core, self.autopilot, scenario["autopilot_clock_us"])
        self.core.uc.mem_write(*UNIQUE_ID)
        self.core.uc.mem_write(LOADER, (0x20001000).to_bytes(4, "little") + (LOADER + 9).to_bytes(4, "little"))
        self.core.uc.hook_add(UC_HOOK_CODE, lambda *_: self.core._end("the chip's boot loader"), None, LOADER + 8, LOADER + 8)
        self.special = self._special()
        self._begin()

    def expose(self, rows):
        for sensor in self.sensors.values():
            sensor.registers[0xBB] = rows

    def _begin(self):
        self.core.registers[AHB1LPENR] = 0x1E03C023
        takes = {self.command: self.commands, lambda data: self.autopilot.receive_all(bytes.fromhex(data)): self.messages, self.expose: self.exposures}
        for take, all_data in takes.items():
            for time, data in all_data:
                if time > self.core.now:
                    self.core.at(time, lambda take=take, data=data: take(data))

    def command(self, data):
        if self.on_usb and data in self.host.ACTS:
            self.host.act(data)
        elif self.on_usb:
            self.host.send(bytes.fromhex(data))
        else:
            self.uart.receive_all(bytes.fromhex(data))

    def restart(self):
        """After a reset that the program asked for."""
        self.core.reset()
        for part in (self.uart, self.usb, self.autopilot, self.timer, self.capture):
            part.restart()
        self.pins, self.vsync, self.reset_flags, self.last_feed = {}, 0, next(self.next_flags, 1 << 24), None
        self._begin()

    def levels(self):
        self.uart.signal()
        self.usb.signal()
        self.autopilot.signal()
        self.timer.signal()

    def edges(self):
        pass

    def report(self):
        usb = {**self.usb.host.report(), "uart": bytes(self.uart.sent).hex(), "uart_us": self.uart.times} if self.on_usb else {}
        return {"regions": list(self.core.regions.values()), "dma": sorted(self.capture.targets), **usb}

    def phy(self):
        """USB's PHY that clocks, power and pins allow: HSI48 for the chip's own, which has no ULPI clock in sleep either; a clock from outside."""
        get, is_own = lambda at: self.core.registers.get(at, 0), not self.wiring.joined
        enable, clock, ulpi = (0x580244D8, 27, 28) if is_own else (0x580244D8, 25, 26)
        is_on = bit(get(enable), clock) and bit(get(0x5802480C), 24)
        if is_own:
            has_clock = bit(get(0x58024400), 12) and get(0x58024454) >> 20 & 3 == 3 and not bit(get(AHB1LPENR), ulpi)
            return "internal" if is_on and has_clock and self.are_usb((("A", 11), ("A", 12))) else None
        is_up = bit(self.pins.get("H", 0), 1) and bit(self.pins.get("J", 0), 4)
        return "ulpi" if is_on and is_up and bit(get(enable), ulpi) and self.are_usb(ULPI_PINS) else None

    def are_usb(self, pins):
        """Do these pins have the alternate function 10?"""
        def function(port, pin):
            base = 0x58020000 + 0x400 * (ord(port) - 65)
            mode, alternate = (self.core.registers.get(base + at, 0) for at in (0, 0x20 + pin // 8 * 4))
            return alternate >> pin % 8 * 4 & 15 if mode >> pin * 2 & 3 == 2 else None

        return all(function(*pin) == 10 for pin in pins)

    # Cameras.

    def reaches(self, name):
        """Do the pins of this sensor, or of the joiner that has the name of the left one, reach the DCMI?"""
        return self.wiring.joined or name == ("right" if bit(self.pins.get("D", 0), 15) else "left")

    def trigger(self):
        self.triggers += 1
        if self.reaches("left"):  # both images of a pair are of one picture
            self.picture = next((kind for first, last, kind in self.pictures if first <= self.core.now < last), None)
        waiting = [sensor for sensor in self.sensors.values() if sensor.waits_for_trigger()]
        if not self.wiring.joined:
            for sensor in waiting:
                self.play([sensor])
        elif len(waiting) == 2:
            self.play(waiting)

    def row(self, camera, frame, y, picture):
        """Of an image that was given each pair is up to three grey levels lighter than the one before: a camera whose pixels stay is frozen."""
        if picture not in self.images:
            return sensor_row(camera, frame, y, picture)
        image = self.images[picture][camera == "right"]
        return image[y * WIDTH:(y + 1) * WIDTH].translate(LIGHTER[frame // 2 % 4])

    def play(self, sensors):
        """One frame of a sensor, or of both side by side, bad by its name's faults: a short row or too few of them, bytes that are lost, no VSYNC, or no
        frame at all."""
        core, capture, name, frame, row_us = self.core, self.capture, sensors[0].name, sensors[0].frame, self.wiring.row_us
        picture = self.picture
        fault, start = self.faults.get((name, frame)), core.now + max(sensor.exposed_rows() for sensor in sensors) * row_us
        names = [sensor.name for sensor in sensors]
        for sensor in sensors:
            sensor.frame += 1
        on_bus, vsync = lambda: self.reaches(name), self.wiring.vsync

        def begin():
            if on_bus():
                capture.between_frames, capture.armed, capture.carry = 0, capture.capturing, b""
                if bit(core.registers.get(EXTI, 0), vsync) and fault != "blind":
                    self.vsync |= 1 << vsync
                    if bit(core.registers.get(EXTI + 0x80, 0), vsync):
                        core.raise_interrupt(VSYNC_IRQ)

        def row_begins():
            if on_bus():
                capture.in_blanking = 0

        def row_ends(y):
            if on_bus():
                data = b"".join(self.row(name, frame, y, picture) for name in names)
                capture.put(data[:300] if fault == "short" and y == 77 else data)
                capture.in_blanking = 1
                capture.signal(16 | (2 if fault == "overrun" and y == 50 else 0))

        def end():
            if on_bus():
                capture.between_frames = 1
                capture.signal(8 | 1)

        if fault == "none":
            return
        rows = 200 if fault == "few" else HEIGHT
        core.at(start, begin)
        for y in range(rows):
            core.at(start + row_us * y + 1, row_begins)
            core.at(start + row_us * y + row_us - 2.5, lambda y=y: row_ends(y))
        core.at(start + row_us * rows, end)

    # Registers.

    def read(self, at):
        core, usb = self.core, self.wiring.usb[0]
        if usb <= at < usb + USB_BYTES:
            return self.usb.read(at - usb)
        if at & ~0x3FF in self.parts:
            return self.parts[at & ~0x3FF].read(at & 0x3FF)
        value = core.registers.get(at, 0)
        if DCMI <= at < DCMI + 0x40:
            return self.capture.read(at - DCMI)
        if 0x58020000 <= at < 0x58022C00 and at & 0x3FF == 0x14:
            return self.pins.get(chr(65 + (at - 0x58020000 >> 10)), 0)
        return self.special[at](value) if at in self.special else value

    def _special(self):
        """Registers that do not just hold what was written: {address: what is read, by what was written}."""
        ready = lambda *pairs: lambda value: value | sum(bit(value, on) << done for on, done in pairs)
        clocks = ready((0, 2), (7, 8), (12, 13), (16, 17), (24, 25), (26, 27), (28, 29))
        failing = lambda: any(first <= self.core.now < last for first, last in self.flash_errors)
        return {
            0x58024400: lambda value: clocks(value) | 0xC005,  # RCC
            0x58024474: ready((0, 1)), 0x58024470: ready((0, 1)),
            0x58024410: lambda value: (value & ~0x38) | (value & 7) << 3,
            0x580244D0: lambda _: self.reset_flags,
            0x58024804: lambda value: value | 1 << 13, 0x5802480C: lambda value: value | 1 << 26 | 1 << 16, 0x58024818: lambda value: value | 1 << 13,
            0x58000420: ready((0, 8)), 0x5C001000: lambda _: 0x20036450,
            DMA1 + 0x10: lambda value: (value & ~1) | self.capture.dma,
            DMA1 + 0x14: lambda _: (self.capture.words * 4 - self.capture.place) // 4,
            EXTI + 0x88: lambda _: self.vsync,
            FLASH2 + 0x10: lambda value: value | failing() << 22,
        }

    def write(self, at, value):
        core, usb = self.core, self.wiring.usb[0]
        if usb <= at < usb + USB_BYTES:
            return self.usb.write(at - usb, value)
        if at & ~0x3FF in self.parts:
            return self.parts[at & ~0x3FF].write(at & 0x3FF, value)
        core.registers[at] = value
        if DCMI <= at < DCMI + 0x40:
            self.capture.write(at - DCMI, value)
        elif at == DMA1 + 0x10:
            self.capture.switch_dma(value)
        elif at == 0x580244D0 and bit(value, 16):
            self.reset_flags = 0
        elif at == 0x58004800 and value == 0xAAAA:
            self.feed()
        elif at == EXTI + 0x88:
            self.vsync &= ~value
        elif at == FLASH2 + 0x0C and bit(value, 7) and bit(value, 2):
            self.erase(value)
        elif at == FLASH2 + 0x14:
            core.registers[FLASH2 + 0x10] = core.registers.get(FLASH2 + 0x10, 0) & ~value
        elif 0x58020000 <= at < 0x58022C00:
            self.set_pins(chr(65 + (at - 0x58020000 >> 10)), at & 0x3FF, value)
        elif at == 0x58024484 and value & 1:
            self.capture.restart()

    def feed(self):
        if self.last_feed is not None:
            self.longest_unfed = max(self.longest_unfed, self.core.now - self.last_feed)
        self.last_feed = self.core.now

    def erase(self, command):
        """Nothing runs meanwhile: the other bank's code could, and it waits for this one."""
        sector = command >> 8 & 7
        self.broken = {word for word in self.broken if word >> 17 != sector - 4}
        self.core.uc.mem_write(0x08100000 + sector * 0x20000, b"\xff" * 0x20000)
        self.core.wait(self.erase_us)
        self.core.registers[FLASH2 + 0x0C] = command & ~0x80
        self.erases += 1

    def read_word(self, word):
        """A word that power failed in cannot be corrected (here it faults no processor)."""
        if word in self.broken:
            self.core.registers[FLASH2 + 0x10] = self.core.registers.get(FLASH2 + 0x10, 0) | 1 << 26

    def set_pins(self, port, at, value):
        before = self.pins.get(port, 0)
        if at == 0x14:
            self.pins[port] = value & 0xFFFF
        elif at == 0x18:
            self.pins[port] = (before & ~(value >> 16)) | (value & 0xFFFF)
        trigger_port, pin = self.wiring.trigger
        if port == trigger_port and self.pins.get(port, 0) & ~before & 1 << pin:
            self.trigger()


def main(image, scenario, result):
    scenario = json.load(open(scenario))
    execute(Board(image, scenario), scenario, result)


if __name__ == "__main__":
    main(*sys.argv[1:4])
