"""Core 1 of an RP2350: a second Cortex-M33 on the same SRAM and flash, with a PPB of its own, started by the boot ROM's protocol (datasheet, 5.3),
and the queues between both cores (3.1.5).

Both run in turns: core 1 is brought to core 0's time whenever that one stops, which it does at least every millisecond; while core 0 sleeps, they
advance together. An event has the time at which it was sent. Not in it: interrupts of core 1, spinlocks, doorbells, contention for memory.
"""
from unicorn.arm_const import UC_ARM_REG_MSP, UC_ARM_REG_PC, UC_ARM_REG_SP
from cortex_m33 import CortexM33

SIO, PSM, WATCHDOG = 0xD0000000, 0x40018000, 0x400D8000
FIFO_ST, FIFO_WR, FIFO_RD, DEPTH = 0x50, 0x54, 0x58, 4
CPACR = 0xE000ED88
PROC1 = 24  # of FRCE_OFF
SLICE_US = 20  # of both while core 0 sleeps
WAITS = "waits"


class Core1(CortexM33):
    STACK = "_second_stack_end", "_second_program_stack_start"

    def __init__(self, board, image, scenario):
        self.board, self.answers, self.is_alive = board, scenario.get("core1") != "absent", True
        super().__init__(image, (board.core.flash, board.core.flash_bytes), [], board.core.mhz, first=board.core)
        board.core.other = self
        self.uc.mmio_map(0x40000000, 0x20000000, self._read_chip, 0x40000000, self._write_chip, 0x40000000)
        self.uc.mmio_map(SIO, 0x1000, self._read_chip, SIO, self._write_chip, SIO)
        self.queues = [], []  # of words to core 0, to core 1
        self.starts, self.joins = 0, 0
        self.boot()

    # Boot ROM.

    def boot(self):
        """In the boot ROM: it says so, and waits for words."""
        self.is_awake, self.is_launched, self.words = False, False, []
        for queue in self.queues:
            queue.clear()
        if self.answers:
            self.queues[0].append(0)

    def _take_word(self):
        word = self.queues[1].pop()
        expected = (0, 0, 1)[len(self.words):len(self.words) + 1]
        self.words = self.words + [word] if not expected or word == expected[0] else []
        self.queues[0].append(word)
        if len(self.words) == 6:
            self._launch(*self.words[3:])

    def _launch(self, vectors, stack, entry):
        """Code in RAM has been copied there by now, and lies where it was before."""
        self.reset()
        self.registers[0xE000ED08] = vectors
        for register in (UC_ARM_REG_MSP, UC_ARM_REG_SP):
            self.uc.reg_write(register, stack)
        self.uc.reg_write(UC_ARM_REG_PC, entry | 1)
        if not self.starts:
            for start, (size, _) in self.functions.items():
                if start >= 0x20000000:
                    self._hook_hints(start, bytes(self.uc.mem_read(start, size)))
        self.clock.now = max(self.now, self.board.core.now)
        self.stack_top, self.starts = stack, self.starts + 1
        self.is_awake = self.is_launched = True

    # Turns.

    def follow(self, until):
        """Executes to a time, us, or until it waits for an event."""
        while self.is_awake and self.is_alive and self.now < until:
            self.run(until, lambda: None)
            if self.ending == WAITS:
                self.is_awake = False
            elif self.ending:
                self.board.core._end("core 1: %s" % self.ending)
                self.is_alive = False
            self.ending = None

    def _sleep(self, *_):
        if self.event:
            self.event = False
        else:
            self.ending = WAITS

    def take_event(self, time):
        """From core 0."""
        if self.is_launched and not self.is_awake:
            self.clock.now, self.is_awake, self.joins = max(self.now, time), True, self.joins + 1
        else:
            self.event = True

    def at_work(self, call):
        """Calls it when core 1 works, in code of the flash."""
        if self.is_awake and self.is_in_flash():
            call()
        else:
            self.board.core.at(self.board.core.now + 10, lambda: self.at_work(call))

    def fill_stack(self):
        """The next register that is pushed does not fit; one is pushed at once: what is popped would be none of its own."""
        code = self.uc.mem_read(self.uc.reg_read(UC_ARM_REG_PC) & ~1, 2)
        if int.from_bytes(code, "little") & 0xFE00 == 0xB400 or bytes(code) == b"\x2d\xe9":
            self.uc.reg_write(UC_ARM_REG_SP, self.limit + 2)
        else:
            self.board.core.at(self.board.core.now + 10, lambda: self.at_work(self.fill_stack))

    @property
    def limit(self):
        return self.symbols[self.STACK[0]]

    def die(self):
        self.is_alive = False

    def is_in_flash(self):
        return self.is_launched and self.flash <= self.uc.reg_read(UC_ARM_REG_PC) < self.flash + self.flash_bytes

    # Registers of the chip that core 1 may use.

    def read_queue(self, at, to):
        """Registers of the queues as this core sees them."""
        queue, other = self.queues[to], self.queues[1 - to]
        if at == FIFO_RD:
            return queue.pop(0) if queue else 0
        return (len(queue) > 0) | (len(other) < DEPTH) << 1 if at == FIFO_ST else 0

    def write_queue(self, at, value, to):
        if at == FIFO_WR and len(self.queues[to]) < DEPTH:
            self.queues[to].append(value)
            if to and self.answers and not self.is_launched and not self.board.is_held(PROC1):
                self._take_word()

    def _read_chip(self, _, offset, size, base):
        at = base + offset
        if at == SIO:
            return 1
        if base == SIO and FIFO_ST <= at & 0xFFF <= FIFO_RD:
            return self.read_queue(at & 0xFFF, 1)
        if at & ~0x7FFF in (PSM, WATCHDOG):
            return self.board.read(at)
        self.ending = "read of %#x" % at
        self.uc.emu_stop()
        return 0

    def _write_chip(self, _, offset, size, value, base):
        at = base + offset
        if base == SIO and FIFO_ST <= at & 0xFFF <= FIFO_RD:
            self.write_queue(at & 0xFFF, value, 0)
        elif at & ~0x7FFF in (PSM, WATCHDOG) and size == 4:
            self.board.write(at, value, size)
            if self.board.core.ending:  # it has reset the chip
                self.die()
                self.uc.emu_stop()
        else:
            self.ending = "write to %#x" % at
            self.uc.emu_stop()

    def report(self):
        return {"starts": self.starts, "joins": self.joins, "executed": [self.board.core.clock.executed, self.clock.executed],
                "stack": self.stack(self.STACK) if self.starts else None, "cpacr": self.registers.get(CPACR, 0)}
