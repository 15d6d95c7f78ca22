"""A Cortex-M33: identification, and the MPU of Armv8-M, of which only what it was told is kept.

Not in it: the Security extension beyond Unicorn's secure state, in which everything runs; limits of the stacks where the model pushes registers.
"""
from unicorn.arm_const import UC_CPU_ARM_CORTEX_M33
from cortex_m import Core


class CortexM33(Core):
    MODEL = UC_CPU_ARM_CORTEX_M33
    READ = {0xE000ED90: 8 << 8, 0xE000ED00: 0x411FD210}
    FLOATS_IN_USE = 12

    def protect(self, at, value):
        if at == 0xE000EDA0:  # RLAR
            number, start = self.registers.get(0xE000ED98, 0), self.registers.get(0xE000ED9C, 0)
            self.regions[number] = (start & ~31, (value | 31) + 1 - (start & ~31), value & 1)
