# SPDX-License-Identifier: MIT
"""What PlatformIO's SCons compiles with here: the compilers of this system, which PlatformIO would load as packages."""
from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
board = env.BoardConfig()
if board.get('build.mcu') == 'atmega328p':
    prefix, cpu, linker = 'avr-', ['-mmcu=atmega328p'], []
else:
    prefix, cpu = 'arm-none-eabi-', ['-mcpu=cortex-m4', '-mthumb', '-ffreestanding']
    linker = ['-nostdlib', '-L$PROJECT_SRC_DIR', '-Tstm32f4.ld']
    env.Append(LIBS=['gcc'])
env.Replace(CC=prefix + 'gcc', CXX=prefix + 'g++', AS=prefix + 'gcc', AR=prefix + 'ar', RANLIB=prefix + 'ranlib',
            SIZETOOL=prefix + 'size', PROGSUFFIX='.elf')
env.Append(CCFLAGS=[*cpu, '-Os', '-ffunction-sections', '-fdata-sections'], CPPDEFINES=[('F_CPU', '$BOARD_F_CPU')],
           CFLAGS=['-std=gnu11'], LINKFLAGS=[*cpu, '-Os', '-Wl,--gc-sections', *linker])

Default(env.BuildProgram())
