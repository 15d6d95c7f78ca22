"""An HM01B0 behind a DW_apb_i2c: its registers, and which frames it sends. The names of both are those of the firmware's drivers.

Not in it: exposure control, gain, black level, test pattern. Only nibbles of 324x244 at falling edges of PCLKO, by the trigger's level, are sent.
"""
import functools

WIDTH, HEIGHT = 324, 244
BYTE_US = 22.5  # nine bits at 400 kHz
AFTER_RESET = {0x0000: 0x01, 0x0001: 0xB0, 0x0100: 0, 0x0202: 1, 0x0203: 8, 0x0340: 2, 0x0341: 0x32, 0x0342: 1, 0x0343: 0x72, 0x3059: 0, 0x3060: 0x20}


def mixed(number):
    """A hash: a staircase of levels would look like itself some blocks on."""
    number &= 0xFFFFFFFF
    number = (number ^ number >> 15) * 0x2C1B3C6D & 0xFFFFFFFF
    number = (number ^ number >> 12) * 0x297A2D39 & 0xFFFFFFFF
    return number ^ number >> 15


@functools.lru_cache(maxsize=256)
def blocks(row, picture):
    grey = lambda column: 40 + mixed(column * 73 + row * 151 + picture * 29) % 180
    return b"".join(bytes([grey(column)]) * 8 for column in range(-1, WIDTH // 8 + 3))


def frame_bytes(is_right, frame):
    """Grey blocks of 8 px inside the border of 2 px; the right camera sees them 10 px further left. The same in tests/tests/machine."""
    shift = 8 + (10 if is_right else 0)
    row = lambda y: blocks((y - 2) // 8, frame // 2)[shift - 2:shift - 2 + WIDTH]
    return b"".join(row(y) for y in range(HEIGHT))


class Sensor:
    def __init__(self, is_right):
        self.is_right, self.frame, self.is_sending = is_right, 0, False
        self.reset()

    def reset(self):
        self.registers = dict(AFTER_RESET)

    def write(self, data):
        self.pointer = data[0] << 8 | data[1]
        for value in data[2:]:
            if self.pointer == 0x0103:
                self.reset()
            elif self.pointer > 1:
                self.registers[self.pointer] = value
            self.pointer += 1

    def read(self):
        value = self.registers.get(self.pointer, 0)
        self.pointer += 1
        return value

    def word(self, at):
        return self.registers.get(at, 0) << 8 | self.registers.get(at + 1, 0)

    def is_triggered(self):
        """By a level, and set up for the wires that the board has."""
        mode = {0x0100: 5, 0x3010: 1, 0x0383: 1, 0x0387: 1, 0x0390: 0}
        value = lambda at: self.registers.get(at, 0)
        return all(value(at) == wanted for at, wanted in mode.items()) and value(0x3059) & 0xE0 == 0x40 \
            and value(0x3060) & 0x30 == 0 and value(0x3068) & 1 == 1 and value(0x3064) & 4 == 4

    def pixel_divider(self):
        return 8 >> (self.registers[0x3060] & 3)


class I2c:
    """A byte after the other: an address is not looked at before there is an order."""

    def __init__(self, core, sensors):
        self.core, self.sensors = core, sensors
        self.restart()

    def restart(self):
        self.registers, self.orders, self.received, self.raw, self.abort = {}, [], [], 0, 0
        self.direction, self.data, self.is_running, self.transaction = None, [], False, getattr(self, "transaction", 0) + 1

    def read(self, at):
        if at == 0x10:
            return self.received.pop(0) if self.received else 0
        if at == 0x40:
            self.raw = self.abort = 0
            return 0
        if at in (0x34, 0x70, 0x80):  # whoever waits for an event: time goes on
            self.core.wait(0.5)
        status = (len(self.orders) < 16) << 1 | (not self.orders) << 2 | bool(self.received) << 3 | self.is_running
        enabled = self.registers.get(0x6C, 0) & 1 or self.is_running
        return {0x34: self.raw, 0x70: status, 0x74: len(self.orders), 0x78: len(self.received), 0x80: self.abort, 0x9C: int(enabled)}.get(
            at, self.registers.get(at, 0))

    def write(self, at, value):
        self.registers[at] = value
        if at == 0x6C and not value & 1:
            self.orders, self.received = [], []
        elif at == 0x10 and self.registers.get(0x6C, 0) & 1 and not self.abort:
            self.orders.append(value)
            if not self.is_running:
                self.is_running = True
                self._at(BYTE_US, self._turn)

    def _at(self, us, call):
        transaction = self.transaction
        self.core.at(self.core.now + us, lambda: self.transaction == transaction and call())

    def _stop(self):
        if self.direction == 0 and self.data:
            self.sensor.write(self.data)
        self.direction, self.data, self.is_running, self.raw = None, [], False, self.raw | 1 << 9

    def _turn(self):
        """The oldest order; before it the address, if the direction is another one."""
        if not self.orders:
            return self._at(2.0, self._turn) if self.registers.get(0x6C, 0) & 1 else self._stop()
        is_read = self.orders[0] >> 8 & 1
        if self.direction != is_read:
            if self.data:
                self.sensor.write(self.data)
            self.direction, self.data, self.sensor = is_read, [], self.sensors.get(self.registers.get(0x04, 0) & 0x7F)
            if not self.sensor:
                self.orders, self.abort, self.raw = [], 1, self.raw | 1 << 6
                return self._stop()
            return self._at(BYTE_US, self._turn)
        order = self.orders.pop(0)
        if is_read:
            self.received.append(self.sensor.read())
        else:
            self.data.append(order & 255)
        self._stop() if order >> 9 & 1 else self._at(BYTE_US, self._turn)
