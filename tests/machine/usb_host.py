"""The device controller of an RP2350's USB, and a host at the other end: bus reset, enumeration, a CDC ACM port opened (DTR), bulk packets.

Not in it: the wire (bits, NAK, SOF, errors, retries), suspend, ISO, double buffers, an unplugged cable. What the device does against the
protocol (data toggle, address, a packet that is too long) is a line in `faults`. RP2350 datasheet: 12.7; USB 2.0: 8.4, 9.4; CDC PSTN 1.2.
"""
import ctypes, struct

PACKET_US = 60.0  # a bulk packet of 64 bytes: 19 a frame at most
AVAILABLE, STALL, PID, FULL = 1 << 10, 1 << 11, 1 << 13, 1 << 15
BUS_RESET, SETUP = 1 << 19, 1 << 17
USB_IRQ = 14


class UsbHost:
    def __init__(self, core, dpram):
        self.core, self.memory = core, (ctypes.c_uint8 * 0x1000).from_address(dpram)
        self.sent, self.times, self.faults, self.to_send = bytearray(), [], [], []
        self.restart()

    def restart(self):
        self.registers, self.status, self.done, self.script, self.address = {}, 0, 0, None, 0
        self.toggles, self.in_endpoint, self.out_endpoint, self.is_busy, self.descriptors = {}, None, None, set(), {}

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
        elif at == 0x4C and value >> 16 & 1 and not self.script:  # pull-up: plugged in
            self.script = self._enumerate()
            self._resume()
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
        endpoint, is_in = at - 0x80 >> 3, not at & 4
        if at < 0x80 or not self._word(at & ~3) & AVAILABLE or (endpoint, is_in) in self.is_busy:
            return
        if (endpoint, is_in) == (self.in_endpoint, True):
            self._later(endpoint, is_in, self._take_results)
        elif (endpoint, is_in) == (self.out_endpoint, False) and self.to_send:
            self._later(endpoint, is_in, self._send_next)

    def _later(self, endpoint, is_in, call):
        self.is_busy.add((endpoint, is_in))

        def go():
            self.is_busy.discard((endpoint, is_in))
            call()

        self.core.at(self.core.now + PACKET_US, go)

    def _finish(self, endpoint, is_in, length=None):
        """A packet over the wire: its buffer belongs to the device again."""
        at = self._control(endpoint, is_in)
        word = self._word(at)
        if (word >> 13 & 1) != self.toggles.get((endpoint, is_in), 0):
            self.faults.append("data toggle of endpoint %d %s" % (endpoint, "in" if is_in else "out"))
        self.toggles[endpoint, is_in] = self.toggles.get((endpoint, is_in), 0) ^ 1
        if self.registers.get(0, 0) & 0x7F != self.address:
            self.faults.append("address")
        word &= ~(AVAILABLE | (FULL if is_in else 0))
        if not is_in:
            word = (word & ~0x3FF) | FULL | length
        struct.pack_into("<I", self.memory, at, word)
        self.done |= 1 << (2 * endpoint + (0 if is_in else 1))
        self.signal()

    def _packet_in(self, endpoint):
        length, at = self._word(self._control(endpoint, True)) & 0x3FF, self._buffer(endpoint, True)
        data = bytes(self.memory[at:at + length])
        if length > 64:
            self.faults.append("a packet of %d bytes" % length)
        self._finish(endpoint, True)
        return data

    def _packet_out(self, endpoint, data):
        at = self._buffer(endpoint, False)
        self.memory[at:at + len(data)] = data
        self._finish(endpoint, False, len(data))

    def _take_results(self):
        data = self._packet_in(self.in_endpoint)
        self.sent += data
        self.times += [round(self.core.now)] * len(data)

    def send(self, data):
        self.to_send += [data[i:i + 64] for i in range(0, len(data), 64)]
        if self.out_endpoint is not None:
            self.touched(self._control(self.out_endpoint, False))

    def _send_next(self):
        self._packet_out(self.out_endpoint, self.to_send.pop(0))

    # The host: a generator that is resumed after so many microseconds.

    def _resume(self):
        wait = next(self.script, None)
        if wait is not None:
            self.core.at(self.core.now + wait, self._resume)

    def _available(self, is_in):
        for _ in range(2000):
            word = self._word(self._control(0, is_in))
            if word & STALL:
                return False
            if word & AVAILABLE:
                return True
            yield 50
        self.faults.append("endpoint 0 does not answer")
        return False

    def _transfer(self, kind, request, value, index, data=b"", length=0):
        """A control transfer: what was read, or None if it was refused."""
        self.memory[0:8] = struct.pack("<BBHHH", kind, request, value, index, len(data) or length)
        for is_in in (True, False):  # a setup packet ends what was before
            at = self._control(0, is_in)
            struct.pack_into("<I", self.memory, at, self._word(at) & ~(AVAILABLE | STALL))
            self.toggles[0, is_in] = 1
        self.status |= SETUP
        self.signal()
        yield 50
        got = b""
        while kind & 0x80 and len(got) < length:
            if not (yield from self._available(True)):
                return None
            part = self._packet_in(0)
            got += part
            yield 50
            if len(part) < 64:
                break
        for i in range(0, len(data), 64):
            if not (yield from self._available(False)):
                return None
            self._packet_out(0, data[i:i + 64])
            yield 50
        status_is_in = not kind & 0x80
        self.toggles[0, status_is_in] = 1
        if not (yield from self._available(status_is_in)):
            return None
        if status_is_in:
            self._packet_in(0)
        else:
            self._packet_out(0, b"")
        yield 2000
        return got

    def _enumerate(self):
        yield 1000
        self.status |= BUS_RESET
        self.signal()
        yield 10_000
        self.descriptors["device"] = yield from self._transfer(0x80, 6, 0x0100, 0, length=18)
        yield from self._transfer(0, 5, 23, 0)
        self.address = 23
        head = yield from self._transfer(0x80, 6, 0x0200, 0, length=9)
        if not head:
            return
        configuration = yield from self._transfer(0x80, 6, 0x0200, 0, length=struct.unpack_from("<H", head, 2)[0])
        for name, at in (("product", 15), ("serial", 16)):
            text = yield from self._transfer(0x80, 6, 0x0300 | self.descriptors["device"][at], 0x0409, length=255)
            self.descriptors[name] = (text or b"")[2:].decode("utf-16-le")
        yield from self._transfer(0, 9, configuration[5], 0)
        self._find_endpoints(configuration)
        yield from self._transfer(0x21, 0x20, 0, 0, data=struct.pack("<IBBB", 115200, 0, 0, 8))
        yield from self._transfer(0x21, 0x22, 3, 0)  # DTR and RTS: open
        for endpoint, is_in in ((self.in_endpoint, True), (self.out_endpoint, False)):
            self.touched(self._control(endpoint, is_in))

    def _find_endpoints(self, configuration):
        at = 0
        while at < len(configuration):
            if configuration[at + 1] == 5 and configuration[at + 3] & 3 == 2:
                endpoint = configuration[at + 2]
                if endpoint & 0x80:
                    self.in_endpoint = endpoint & 15
                else:
                    self.out_endpoint = endpoint
            at += configuration[at]

    def report(self):
        texts = {name: value for name, value in self.descriptors.items() if name != "device"}
        device = self.descriptors.get("device") or b""
        return {"usb": {**texts, "faults": self.faults, "ids": list(struct.unpack_from("<2H", device, 8)) if len(device) == 18 else None}}
