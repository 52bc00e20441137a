# SPDX-License-Identifier: MIT
# int of 16 bits. An ATmega2560, because its external RAM may reach to FFFF: simavr_host.c gives it that much, which
# avr-libc's start-up code has to be told (the stack begins at its end).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR avr)
set(CMAKE_C_COMPILER avr-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# __ASSERT_USE_STDERR: avr-libc's assert prints what it found.
set(CMAKE_C_FLAGS_INIT "-mmcu=atmega2560 -Os -ffunction-sections -fdata-sections -D__ASSERT_USE_STDERR")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-mmcu=atmega2560 -Wl,--gc-sections -Wl,--defsym=__stack=0xFFFF,--defsym=__DATA_REGION_LENGTH__=0xFE00")
