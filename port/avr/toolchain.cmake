# SPDX-License-Identifier: MIT
# cmake --preset avr: an ATmega328P at 16 MHz. Another clock or chip: -DFATHOM_AVR_HZ=8000000UL -DFATHOM_AVR_MCU=atmega168p.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR avr)
set(CMAKE_C_COMPILER avr-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(FATHOM_MACHINE avr CACHE STRING "Its folder in port/")
set(FATHOM_AVR_MCU atmega328p CACHE STRING "What avr-gcc calls the chip")
set(FATHOM_AVR_HZ 16000000UL CACHE STRING "The chip's clock, with UL")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES FATHOM_AVR_MCU FATHOM_AVR_HZ)
set(CMAKE_C_FLAGS_INIT "-mmcu=${FATHOM_AVR_MCU} -DF_CPU=${FATHOM_AVR_HZ} -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-mmcu=${FATHOM_AVR_MCU} -Wl,--gc-sections")
