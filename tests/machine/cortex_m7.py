"""A Cortex-M7: identification, and the MPU of Armv7-M, of which regions without any access end a run."""
from unicorn import UC_HOOK_MEM_READ, UC_HOOK_MEM_WRITE
from unicorn.arm_const import UC_ARM_REG_PC, UC_CPU_ARM_CORTEX_M7
from cortex_m import Core


class CortexM7(Core):
    MODEL = UC_CPU_ARM_CORTEX_M7
    READ = {0xE000ED90: 16 << 8, 0xE000ED00: 0x411FC271, 0xE000ED80: 0xF00FE019, 0xE000ED78: 0x09000003}

    def __init__(self, *board):
        self.forbidden = {}
        super().__init__(*board)

    def protect(self, at, value):
        if at != 0xE000EDA0 or not value & 1:  # RASR
            return
        address, number = self.registers.get(0xE000ED9C, 0), self.registers.get(0xE000ED98, 0)
        number = address & 15 if address & 16 else number
        start, size = address & ~0x1F, 1 << ((value >> 1 & 31) + 1)
        self.regions[number] = (start, size, value >> 16 & 0x3F)  # TEX S C B
        if not value >> 24 & 7:
            self._forbid(number, start, size)

    def _forbid(self, number, start, size):
        def on_access(uc, access, address, *_):
            self._end("access to %#x, which the MPU forbids, in %s" % (address, self.where(uc.reg_read(UC_ARM_REG_PC))))

        if number in self.forbidden:
            self.uc.hook_del(self.forbidden[number])
        self.forbidden[number] = self.uc.hook_add(UC_HOOK_MEM_READ | UC_HOOK_MEM_WRITE, on_access, None, start, start + size - 1)
