"""The device controller of an RP2350's USB, its memory in `rp2350.c`, with a host at the other end (`usb_host.py`). RP2350 datasheet: 12.7.

Not in it: suspend, ISO, double buffers, an unplugged cable.
"""
import ctypes, struct
from usb_host import UsbHost

AVAILABLE, STALL, FULL = 1 << 10, 1 << 11, 1 << 15
BUS_RESET, SETUP = 1 << 19, 1 << 17
USB_IRQ = 14


class Rp2350Usb:
    is_fast = False

    def __init__(self, core, dpram):
        self.core, self.memory, self.host = core, (ctypes.c_uint8 * 0x1000).from_address(dpram), UsbHost(core, self)
        self.restart()

    def restart(self):
        self.registers, self.status, self.done = {}, 0, 0
        self.host.restart()

    # Registers.

    def read(self, at):
        if at == 0x98:
            return self._raw() & self.registers.get(0x90, 0)
        return {0x50: self.status, 0x58: self.done, 0x8C: self._raw()}.get(at, self.registers.get(at, 0))

    def write(self, at, value):
        self.registers[at] = value
        if at == 0x50:
            self.status &= ~value
        elif at == 0x58:
            self.done &= ~value
        elif at == 0x4C and value >> 16 & 1:  # pull-up
            self.host.plugged()
        self.signal()

    def _raw(self):
        return (self.done != 0) << 4 | (self.status >> 19 & 1) << 12 | (self.status >> 17 & 1) << 16

    def signal(self):
        if self._raw() & self.registers.get(0x90, 0):
            self.core.raise_interrupt(USB_IRQ)

    # Endpoints.

    def _word(self, at):
        return struct.unpack_from("<I", self.memory, at)[0]

    def _control(self, endpoint, is_in):
        return 0x80 + 8 * endpoint + (0 if is_in else 4)

    def _buffer(self, endpoint, is_in):
        return self._word(8 * endpoint + (0 if is_in else 4)) & 0xFFC0 if endpoint else 0x100

    def touched(self, at):
        """The device has written to control of an endpoint, or of its buffer."""
        if at >= 0x80:
            self.host.ready(at - 0x80 >> 3, not at & 4)

    def answer(self, endpoint, is_in):
        word = self._word(self._control(endpoint, is_in))
        return False if word & STALL else bool(word & AVAILABLE) or None

    def pid(self, endpoint, is_in):
        return self._word(self._control(endpoint, is_in)) >> 13 & 1

    @property
    def address(self):
        return self.registers.get(0, 0) & 0x7F

    def begin_reset(self):
        self.status |= BUS_RESET
        self.signal()

    def end_reset(self):
        pass

    def setup(self, data):
        self.memory[0:8] = data
        for is_in in (True, False):  # it ends what was before
            at = self._control(0, is_in)
            struct.pack_into("<I", self.memory, at, self._word(at) & ~(AVAILABLE | STALL))
        self.status |= SETUP
        self.signal()

    def _finish(self, endpoint, is_in, length=None):
        """A packet over the wire: its buffer belongs to the device again."""
        at = self._control(endpoint, is_in)
        word = self._word(at) & ~(AVAILABLE | (FULL if is_in else 0))
        if not is_in:
            word = (word & ~0x3FF) | FULL | length
        struct.pack_into("<I", self.memory, at, word)
        self.done |= 1 << (2 * endpoint + (0 if is_in else 1))
        self.signal()

    def take(self, endpoint):
        length, at = self._word(self._control(endpoint, True)) & 0x3FF, self._buffer(endpoint, True)
        data = bytes(self.memory[at:at + length])
        self._finish(endpoint, True)
        return data

    def give(self, endpoint, data):
        at = self._buffer(endpoint, False)
        self.memory[at:at + len(data)] = data
        self._finish(endpoint, False, len(data))
