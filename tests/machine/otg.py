"""The USB core of an STM32H7 (Synopsys OTG, ID 0x2300) as a device whose program moves the packets, with a host at the other end (`usb_host.py`).

In it: what the core needs before it connects, FIFOs by their sizes, status words of packets that came, endpoints' NAK, STALL and data toggles, the
address from the end of its transfer on, suspend of an idle bus and resume by the host, bus resets. What the program does against the core's rules is a line in the host's `faults`.
Not in it: DMA, host mode, ISO, transfers of more than a packet, what a bus reset leaves of a transfer (here nothing), remote wakeup, SOF, LPM,
session requests; EPENA of OUT endpoints: they take packets from CNAK on, as embassy's driver, which runs on such chips, counts on. RM0433: 60.
"""
import struct
from collections import deque
from usb_host import UsbHost

RXFLVL, USBSUSP, USBRST, ENUMDNE, IEPINT, OEPINT, WKUPINT = 1 << 4, 1 << 11, 1 << 12, 1 << 13, 1 << 18, 1 << 19, 1 << 31
XFRC, EPDISD, STUP, TXFE = 1 << 0, 1 << 1, 1 << 3, 1 << 7
ACTIVE, NAK, STALL, CNAK, SNAK, PID0, PID1, DISABLE, ENABLE = (1 << n for n in (15, 17, 21, 26, 27, 28, 29, 30, 31))
OUT_DATA, OUT_DONE, SETUP_DONE, SETUP_DATA = 2, 3, 4, 6
FIFO_WORDS, ENDPOINTS = 1024, 9
IDLE_US = 3000


class Otg:
    def __init__(self, core, irq, phy, has_host):
        """`phy()`: None, or "internal" or "ulpi" where clocks, power and pins are those of the one or the other."""
        self.core, self.irq, self.phy, self.has_host, self.is_fast = core, irq, phy, has_host, False
        self.host = UsbHost(core, self)
        self.restart()

    def restart(self):
        self.registers, self.flags, self.is_connected, self.address, self.suspends = {0x804: 2}, 0, False, 0, 0
        self.control, self.flagged, self.pids, self.fifos = {}, {}, {}, {n: bytearray() for n in range(ENDPOINTS)}
        self.statuses, self.words = deque(), deque()
        self.host.restart()

    def fault(self, text):
        self.host.faults.append(text)

    # Registers.

    def read(self, at):
        if at >= 0x1000:
            if not self.words:
                self.fault("an empty FIFO is read")
                return 0
            return self.words.popleft()
        key = self._endpoint(at)
        if key:
            return self._read_endpoint(key, at & 0x1F, at)
        value = self.registers.get(at, 0)
        special = {0x10: lambda: 1 << 31, 0x14: self._interrupts, 0x1C: lambda: self.statuses[0] if self.statuses else 0, 0x20: self._pop,
                   0x3C: lambda: 0x2300, 0x808: lambda: (0 if self.is_fast else 3) << 1, 0x818: self._endpoints_flagged}
        return special[at]() if at in special else value

    def write(self, at, value):
        if at >= 0x1000:
            self._push(at // 0x1000 - 1, value)
            return
        key = self._endpoint(at)
        if key:
            self._write_endpoint(key, at & 0x1F, at, value)
        elif at == 0x14:
            self.flags &= ~value
        elif at == 0x10:
            self._flush(value)
        else:
            self.registers[at] = value
            self._connect()
        self.signal()

    def signal(self):
        if self.registers.get(8, 0) & 1 and self._interrupts() & self.registers.get(0x18, 0):
            self.core.raise_level(self.irq)

    def _interrupts(self):
        mask = self.registers.get(0x81C, 0)
        daint = self._endpoints_flagged() & mask if mask else 0
        ends = (IEPINT if daint & 0xFFFF else 0) | (OEPINT if daint >> 16 else 0)
        is_host = not self.registers.get(0x0C, 0) >> 30 & 1
        return self.flags | ends | (RXFLVL if self.statuses else 0) | is_host

    def _endpoints_flagged(self):
        found = 0
        for endpoint in range(ENDPOINTS):
            empty = TXFE if self.registers.get(0x834, 0) >> endpoint & 1 else 0
            found |= bool(self._flags(endpoint, True) & (self.registers.get(0x810, 0) | empty)) << endpoint
            found |= bool(self._flags(endpoint, False) & self.registers.get(0x814, 0)) << (16 + endpoint)
        return found

    def _flags(self, endpoint, is_in):
        return self.flagged.get((endpoint, is_in), 0) | (TXFE if is_in and not self.fifos[endpoint] else 0)

    # Connecting.

    def _connect(self):
        get = lambda at: self.registers.get(at, 0)
        internal, ulpi = get(0x38) >> 16 & 1 and get(0x0C) >> 6 & 1, get(0x0C) >> 4 & 1 and not get(0x0C) >> 6 & 1
        kind = "internal" if internal else "ulpi" if ulpi else None
        self.is_fast = bool(ulpi) and get(0x800) & 3 == 0
        # Not disconnected by the program, a device by force, a session that is valid by force, and
        # a PHY.
        ready = not get(0x804) >> 1 & 1 and get(0x0C) >> 30 & 1 and get(0) >> 6 & 3 == 3 and kind and self.phy() == kind
        if ready and not self.is_connected:
            self.is_connected = True
            self._idle()
            if self.has_host:
                self.host.plugged()
        elif not ready and self.is_connected:
            self.fault("disconnected")
            self.is_connected = False

    def _idle(self):
        """A bus without a host's frames is suspended."""
        self.suspends += 1
        order = self.suspends

        def suspend():
            if self.suspends == order:
                self.suspend()

        self.core.at(self.core.now + IDLE_US, suspend)

    def suspend(self):
        self.flags |= USBSUSP
        self.signal()

    def resume(self):
        self.flags |= WKUPINT
        self.signal()

    def begin_reset(self):
        self.suspends += 1
        self.flags |= USBRST
        self.address = 0
        for endpoint in range(ENDPOINTS):
            for is_in in (True, False):
                self.control[endpoint, is_in] = self.control.get((endpoint, is_in), 0) & ~(ACTIVE | ENABLE) | NAK
        self.signal()

    def end_reset(self):
        self.flags |= ENUMDNE
        self.signal()

    # FIFOs.

    def _depth(self, endpoint):
        """Words of the FIFO of an IN endpoint, and where it begins."""
        value = self.registers.get(0x28 if endpoint == 0 else 0x100 + 4 * endpoint, 0)
        return value >> 16, value & 0xFFFF

    def _flush(self, value):
        if value >> 4 & 1:
            self.statuses.clear()
            self.words.clear()
        if value >> 5 & 1:
            which = value >> 6 & 31
            for endpoint in self.fifos if which == 16 else [which]:
                self.fifos[endpoint].clear()
            if which == 16:
                self._check_memory()

    def _check_memory(self):
        used = sorted([(0, self.registers.get(0x24, 0))] + [(start, words) for words, start in map(self._depth, range(ENDPOINTS)) if words])
        ends = [start + words for start, words in used]
        if any(end > start for end, (start, _) in zip(ends, used[1:])) or ends[-1] > FIFO_WORDS:
            self.fault("FIFOs overlap: %s" % used)

    def _push(self, endpoint, value):
        fifo = self.fifos[endpoint]
        fifo += struct.pack("<I", value)
        if not self.control.get((endpoint, True), 0) & ENABLE or len(fifo) > 4 * self._depth(endpoint)[0]:
            self.fault("a word too much in the FIFO of endpoint %d" % endpoint)
        if self._is_whole(endpoint):
            self.host.ready(endpoint, True)

    def _pop(self):
        if not self.statuses:
            self.fault("no status to read")
            return 0
        status = self.statuses.popleft()
        endpoint, kind = status & 15, status >> 17
        if kind in (OUT_DONE, SETUP_DONE):
            self.flagged[endpoint, False] = self.flagged.get((endpoint, False), 0) | (XFRC if kind == OUT_DONE else STUP)
        return status

    def _came(self, endpoint, kind, data=b""):
        """A packet that came: its status, its words."""
        self.statuses.append(endpoint | len(data) << 4 | kind << 17)
        self.words.extend(struct.unpack("<%dI" % ((len(data) + 3) // 4), data + bytes(-len(data) % 4)))

    # Endpoints.

    def _endpoint(self, at):
        """Its number and direction, if this is a register of one."""
        for first, is_in in ((0x900, True), (0xB00, False)):
            if first <= at < first + 32 * ENDPOINTS:
                return (at - first) // 32, is_in
        return None

    def _read_endpoint(self, key, part, at):
        endpoint, is_in = key
        if part == 0:
            return self.control.get(key, 0) | (ACTIVE if endpoint == 0 else 0)
        if part == 8:
            return self._flags(*key)
        if part == 0x18 and is_in:
            return self._depth(endpoint)[0] - len(self.fifos[endpoint]) // 4
        return self.registers.get(at, 0)

    def _write_endpoint(self, key, part, at, value):
        if part == 8:
            self.flagged[key] = self.flagged.get(key, 0) & ~value
        elif part:
            self.registers[at] = value
        else:
            self._write_control(key, value)

    def _write_control(self, key, value):
        old = self.control.get(key, 0)
        if value & SNAK and value & CNAK:
            self.fault("NAK set and cleared at once")
        nak = NAK if value & SNAK or old & NAK and not value & CNAK else 0
        if value & (PID0 | PID1):
            self.pids[key] = int(bool(value & PID1))
        enable = (old | value) & ENABLE
        if value & DISABLE:
            enable, self.flagged[key] = 0, self.flagged.get(key, 0) | EPDISD
        self.control[key] = value & ~(CNAK | SNAK | PID0 | PID1 | DISABLE | ENABLE | NAK) | nak | enable
        self.host.ready(*key)

    def _size(self, key):
        """Bytes and packets that the program gave or wants."""
        value = self.registers.get((0x910 if key[1] else 0xB10) + 32 * key[0], 0)
        return value & 0x7FFFF, value >> 19 & 0x3FF

    def _is_whole(self, endpoint):
        size, packets = self._size((endpoint, True))
        if packets > 1:
            self.fault("a transfer of %d packets is not in the model" % packets)
        return len(self.fifos[endpoint]) >= size

    def answer(self, endpoint, is_in):
        control = self.control.get((endpoint, is_in), 0)
        if control & STALL:
            return False
        if control & NAK or not (control & ACTIVE or endpoint == 0):
            return None
        if is_in:
            return control & ENABLE and self._is_whole(endpoint) or None
        size, packets = self._size((endpoint, False))
        room = self.registers.get(0x24, 0) - len(self.words) - len(self.statuses) > size // 4 + 2
        return room and (packets > 0 or endpoint == 0) or None

    def pid(self, endpoint, is_in):
        return self.pids.get((endpoint, is_in), 0)

    def _finish(self, key, size):
        """A packet over the wire: the core answers with NAK until the program asks for the next one."""
        self.pids[key] = self.pid(*key) ^ 1
        self.control[key] = self.control[key] & ~ENABLE | NAK
        self.registers[(0x910 if key[1] else 0xB10) + 32 * key[0]] = size

    def setup(self, data):
        for key in ((0, True), (0, False)):
            self.control[key] = self.control.get(key, 0) & ~STALL | NAK
            self.pids[key] = 1
        self._came(0, SETUP_DATA, data)
        self._came(0, SETUP_DONE)
        self.signal()

    def take(self, endpoint):
        key, fifo = (endpoint, True), self.fifos[endpoint]
        size, _ = self._size(key)
        data = bytes(fifo[:size])
        del fifo[:(size + 3) & ~3]
        self._finish(key, 0)
        self.flagged[key] = self.flagged.get(key, 0) | XFRC
        if endpoint == 0 and not size:
            self.address = self.registers.get(0x800, 0) >> 4 & 0x7F
        self.signal()
        return data

    def give(self, endpoint, data):
        key = (endpoint, False)
        size, _ = self._size(key)
        if len(data) > size:
            self.fault("%d bytes for an endpoint that wants %d" % (len(data), size))
        self._came(endpoint, OUT_DATA, data)
        self._came(endpoint, OUT_DONE)
        self._finish(key, size - len(data))
        self.signal()
