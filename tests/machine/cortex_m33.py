"""A Cortex-M33: identification, and the MPU of Armv8-M, of which only what it was told is kept.

Not in it: the Security extension beyond Unicorn's secure state, in which everything runs; limits of the stacks where the model pushes registers, except after an overflow.
"""
from unicorn.arm_const import UC_ARM_REG_CONTROL, UC_ARM_REG_SP, UC_CPU_ARM_CORTEX_M33
from cortex_m import Core

STKOF = 19  # as Unicorn numbers it


class CortexM33(Core):
    MODEL = UC_CPU_ARM_CORTEX_M33
    READ = {0xE000ED90: 8 << 8, 0xE000ED00: 0x411FD210}
    FLOATS_IN_USE = 12

    def protect(self, at, value):
        if at == 0xE000EDA0:  # RLAR
            number, start = self.registers.get(0xE000ED98, 0), self.registers.get(0xE000ED9C, 0)
            self.regions[number] = (start & ~31, (value | 31) + 1 - (start & ~31), value & 1)

    def escalate(self, number):
        """Below the limit of its stack nothing is written, and the stack pointer is left at the limit."""
        if number != STKOF:
            return False
        self.registers[0xE000ED28], self.registers[0xE000ED2C] = 1 << 20, 1 << 30  # CFSR, HFSR
        floats = self.uc.reg_read(UC_ARM_REG_CONTROL) >> 2 & 1
        self.uc.reg_write(UC_ARM_REG_SP, self.limit + (0x68 if floats else 0x20))
        self.raise_fault()
        return True

    @property
    def limit(self):
        """Of the program's stack."""
        return self.symbols["_stack_end"]
