"""A host of a USB device controller: bus reset, enumeration, other requests, a CDC ACM port that is opened and closed (DTR), bulk packets.

A controller (`rp2350_usb.py`, `otg.py`) calls `plugged` when its pull-up comes, and `ready(endpoint, is_in)` when an endpoint may have become so. It has
`begin_reset`, `end_reset`, `setup(data)`; `answer(endpoint, is_in)`: True, None (NAK) or False (STALL); `pid(endpoint, is_in)` of the packet that is next;
`take(endpoint)` and `give(endpoint, data)` of a packet; `address`; `is_fast`: at high speed; for a bus that is suspended `suspend` and `resume`.

Not in it: the wire (bits, SOF, errors, retries), ISO, double buffers, the interrupt endpoint, a hub's wait of 100 ms. What the device does against
the protocol (data toggle, address, sizes of packets) is a line in `faults`. USB 2.0: 5.8.3, 8.4, 9.4; CDC PSTN 1.2.
"""
import struct

PACKET_US, FAST_PACKET_US = 60.0, 11.0  # of a bulk endpoint, 64 bytes: 19 a frame at most; 512 bytes: 13 a microframe
ATTACH_US = 5000
TRANSFER = 2  # packets that a read of Linux's driver for CDC ACM takes; fewer if one of them is short


class UsbHost:
    ACTS = ("close", "open", "pause", "resume", "ask", "suspend", "wake", "reset")

    def __init__(self, core, device):
        self.core, self.device = core, device
        self.sent, self.times, self.faults, self.wanted = bytearray(), [], [], []
        self.descriptors, self.answers, self.is_reading = {}, {}, True
        self.restart()

    def restart(self):
        """The device is gone with a reset of its chip; a program at the host asks again when it is back."""
        self.script = None
        self._forget()

    def _forget(self):
        self.address, self.toggles, self.packet_bytes, self.is_busy = 0, {}, {}, set()
        self.in_endpoint, self.out_endpoint, self.is_open, self.to_send, self.part, self.packets = None, None, False, [], b"", 0

    def plugged(self):
        if not self.script:
            self._run(self._enumerate())

    # Requests of a program at the host: served in order, as soon as the port is there.

    def send(self, data):
        self._want(lambda: self._queue(data))

    def act(self, name):
        """`close` or `open` the port; `pause` and `resume` reading; `ask` what no enumeration does; `suspend` and `wake` the bus; `reset` it, and the
        device is enumerated anew."""
        scripts = {"close": lambda: self._set_lines(0), "open": lambda: self._set_lines(3), "reset": self._enumerate,
                   "pause": lambda: self._read(False), "resume": lambda: self._read(True), "ask": self._ask,
                   "suspend": self._suspend, "wake": self._wake}
        self._want(lambda: self._run(scripts[name]()))

    def _want(self, call):
        self.wanted.append(call)
        self._go_on()

    def _go_on(self):
        while self.wanted and self.out_endpoint is not None and not self.script:
            self.wanted.pop(0)()

    def _queue(self, data):
        size = self.packet_bytes[self.out_endpoint, False]
        self.to_send += [data[i:i + size] for i in range(0, len(data), size)]
        self.ready(self.out_endpoint, False)

    # Packets.

    def ready(self, endpoint, is_in):
        """The device may have something there, or room."""
        if (endpoint, is_in) in self.is_busy or not self.device.answer(endpoint, is_in):
            return
        if (endpoint, is_in) == (self.in_endpoint, True) and self.is_open and self.is_reading:
            self._later(endpoint, is_in, self._take_results)
        elif (endpoint, is_in) == (self.out_endpoint, False) and self.to_send:
            self._later(endpoint, is_in, self._send_next)

    def _later(self, endpoint, is_in, call):
        busy = self.is_busy
        busy.add((endpoint, is_in))

        def go():
            busy.discard((endpoint, is_in))
            if busy is self.is_busy:  # no bus reset since then
                call()

        self.core.at(self.core.now + (FAST_PACKET_US if self.device.is_fast else PACKET_US), go)

    def _check(self, endpoint, is_in):
        toggle = self.toggles.get((endpoint, is_in), 0)
        if self.device.pid(endpoint, is_in) != toggle:
            self.faults.append("data toggle of endpoint %d %s" % (endpoint, "in" if is_in else "out"))
        self.toggles[endpoint, is_in] = toggle ^ 1
        if self.device.address != self.address:
            self.faults.append("address")

    def _packet_in(self, endpoint):
        self._check(endpoint, True)
        data = self.device.take(endpoint)
        if len(data) > self.packet_bytes.get((endpoint, True), 64):
            self.faults.append("a packet of %d bytes" % len(data))
        return data

    def _packet_out(self, endpoint, data):
        self._check(endpoint, False)
        self.device.give(endpoint, data)

    def _take_results(self):
        """A program gets the bytes of a read that is full, or that a short packet ends."""
        data = self._packet_in(self.in_endpoint)
        self.part, self.packets = self.part + data, self.packets + 1
        if self.packets == TRANSFER or len(data) < self.packet_bytes[self.in_endpoint, True]:
            self.sent += self.part
            self.times += [round(self.core.now)] * len(self.part)
            self.part, self.packets = b"", 0
        self.ready(self.in_endpoint, True)

    def _send_next(self):
        self._packet_out(self.out_endpoint, self.to_send.pop(0))
        self.ready(self.out_endpoint, False)

    # Control transfers: generators that are resumed after so many microseconds.

    def _run(self, script):
        self.script = script
        self._resume(script)

    def _resume(self, script):
        if script is not self.script:
            return
        wait = next(script, None)
        if wait is not None:
            self.core.at(self.core.now + wait, lambda: self._resume(script))
        else:
            self.script = None
            self._go_on()

    def _answered(self, is_in):
        for _ in range(2000):
            answer = self.device.answer(0, is_in)
            if answer is not None:
                return answer
            yield 50
        self.faults.append("endpoint 0 does not answer")
        return False

    def _transfer(self, kind, request, value, index, data=b"", length=0):
        """A control transfer: what was read, or None if it was refused."""
        self.device.setup(struct.pack("<BBHHH", kind, request, value, index, len(data) or length))
        self.toggles[0, True] = self.toggles[0, False] = 1
        yield 50
        got = b""
        while kind & 0x80 and len(got) < length:
            if not (yield from self._answered(True)):
                return None
            part = self._packet_in(0)
            got += part
            yield 50
            if len(part) < 64:
                break
        for i in range(0, len(data), 64):
            if not (yield from self._answered(False)):
                return None
            self._packet_out(0, data[i:i + 64])
            yield 50
        status_is_in = not kind & 0x80
        self.toggles[0, status_is_in] = 1
        if not (yield from self._answered(status_is_in)):
            return None
        if status_is_in:
            self._packet_in(0)
        else:
            self._packet_out(0, b"")
        yield 2000
        return got

    def _enumerate(self):
        yield ATTACH_US
        self._forget()
        self.descriptors = {}
        self.device.begin_reset()
        yield 10_000
        self.device.end_reset()
        yield 1000
        device = yield from self._transfer(0x80, 6, 0x0100, 0, length=18)
        self.descriptors["device"] = device
        yield from self._transfer(0, 5, 23, 0)
        self.address = 23
        head = yield from self._transfer(0x80, 6, 0x0200, 0, length=9)
        if not head:
            return
        configuration = yield from self._transfer(0x80, 6, 0x0200, 0, length=struct.unpack_from("<H", head, 2)[0])
        for name, at in (("manufacturer", 14), ("product", 15), ("serial", 16)):
            text = yield from self._transfer(0x80, 6, 0x0300 | device[at], 0x0409, length=255)
            self.descriptors[name] = (text or b"")[2:].decode("utf-16-le")
        yield from self._transfer(0, 9, configuration[5], 0)
        endpoints = self._endpoints(configuration)
        yield from self._transfer(0x21, 0x20, 0, 0, data=struct.pack("<IBBB", 115200, 0, 0, 8))
        self.in_endpoint, self.out_endpoint = endpoints
        yield from self._set_lines(3)

    def _set_lines(self, lines):
        """DTR and RTS, and results are read: the port is open; or neither."""
        self.is_open, self.part, self.packets = lines == 3, b"", 0
        yield from self._transfer(0x21, 0x22, lines, 0)
        if self.is_open:
            self.ready(self.in_endpoint, True)

    def _read(self, is_reading):
        self.is_reading = is_reading
        self.ready(self.in_endpoint, True)
        yield 0

    def _suspend(self):
        self.is_reading = False
        yield 3000
        self.device.suspend()

    def _wake(self):
        self.device.resume()
        yield 20_000
        yield from self._read(True)

    def _ask(self):
        """Requests of all kinds; the answers are hexadecimal, none where the device stalled."""
        coding, other = struct.pack("<IBBB", 57600, 0, 0, 8), self.notices
        results, commands = self.in_endpoint | 0x80, self.out_endpoint
        for name, kind, request, value, index, data, length in (
            ("status", 0x80, 0, 0, 0, b"", 2), ("wake", 0, 3, 1, 0, b"", 0), ("woken status", 0x80, 0, 0, 0, b"", 2), ("no wake", 0, 1, 1, 0, b"", 0),
            ("configuration", 0x80, 8, 0, 0, b"", 1), ("interface", 0x81, 10, 0, 1, b"", 1), ("no such setting", 1, 11, 5, 1, b"", 0),
            ("interface status", 0x81, 0, 0, 0, b"", 2), ("no such interface", 0x81, 0, 0, 7, b"", 2), ("setting", 1, 11, 0, 1, b"", 0),
            ("no such setting of none", 1, 11, 0, 7, b"", 0), ("capabilities", 0x80, 6, 0x0F00, 0, b"", 255),
            ("no such feature", 0, 3, 9, 0, b"", 0), ("no such feature of an interface", 1, 3, 0, 0, b"", 0),
            ("no such feature of an endpoint", 2, 3, 5, other, b"", 0), ("no such request", 0x80, 12, 0, 0, b"", 2),
            ("no such request of an endpoint", 0x82, 12, 0, other, b"", 2),
            ("halt results", 2, 3, 0, results, b"", 0), ("halted results", 0x82, 0, 0, results, b"", 2), ("results go on", 2, 1, 0, results, b"", 0),
            ("halt commands", 2, 3, 0, commands, b"", 0), ("halted commands", 0x82, 0, 0, commands, b"", 2), ("commands go on", 2, 1, 0, commands, b"", 0),
            ("no configuration", 0, 9, 0, 0, b"", 0), ("none", 0x80, 8, 0, 0, b"", 1), ("configuration again", 0, 9, 1, 0, b"", 0),
            ("again", 0x80, 8, 0, 0, b"", 1),
            ("encapsulated", 0x21, 0, 0, 0, b"AT", 0), ("short coding", 0x21, 0x20, 0, 0, coding[:4], 0), ("coding of results", 0xA1, 0x21, 0, 1, b"", 7),
            ("languages", 0x80, 6, 0x0300, 0, b"", 255), ("no such text", 0x80, 6, 0x0309, 0x0409, b"", 255), ("no such descriptor", 0x80, 6, 0x2100, 0, b"", 9),
            ("endpoint", 0x82, 0, 0, other, b"", 2), ("halt", 2, 3, 0, other, b"", 0), ("halted", 0x82, 0, 0, other, b"", 2),
            ("go on", 2, 1, 0, other, b"", 0), ("gone on", 0x82, 0, 0, other, b"", 2), ("set coding", 0x21, 0x20, 0, 0, coding, 0),
            ("coding", 0xA1, 0x21, 0, 0, b"", 7), ("unknown in", 0xC0, 1, 0, 0, b"", 4), ("unknown out", 0x40, 1, 0, 0, b"", 0),
            ("too long", 0x40, 2, 0, 0, bytes(130), 0),
        ):
            answer = yield from self._transfer(kind, request, value, index, data, length)
            self.answers[name] = None if answer is None else answer.hex()
            if answer is not None:
                self._start_toggles(kind, request, index)

    def _start_toggles(self, kind, request, index):
        """DATA0 is next at endpoints that were configured, whose interface was set, or that are no longer halted. USB 2.0: 9.1.1.5, 9.4.5."""
        data = [(self.in_endpoint, True), (self.out_endpoint, False)]
        notices = [(self.notices & 15, True)]
        started = {(0, 9): data + notices, (1, 11): data if index else notices, (2, 1): [(index & 15, bool(index >> 7))]}
        for key in started.get((kind, request), []):
            self.toggles.pop(key, None)

    def _endpoints(self, configuration):
        at, found = 0, {}
        while at < len(configuration):
            if configuration[at + 1] == 5 and configuration[at + 3] & 3 == 2:
                address, size = configuration[at + 2], struct.unpack_from("<H", configuration, at + 4)[0]
                found[address >> 7] = address & 15
                self.packet_bytes[address & 15, bool(address >> 7)] = size
                if size not in ((512,) if self.device.is_fast else (8, 16, 32, 64)):
                    self.faults.append("a bulk endpoint of %d bytes" % size)
            elif configuration[at + 1] == 5:
                self.notices = configuration[at + 2]
            at += configuration[at]
        return found[1], found[0]

    def report(self):
        texts = {name: value for name, value in self.descriptors.items() if name != "device"}
        device = self.descriptors.get("device") or b""
        ids = list(struct.unpack_from("<2H", device, 8)) if len(device) == 18 else None
        return {"answers": self.answers, "usb": {**texts, "faults": self.faults, "ids": ids, "is_fast": self.device.is_fast, "unread": len(self.part)}}
