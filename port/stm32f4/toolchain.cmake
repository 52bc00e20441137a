# SPDX-License-Identifier: MIT
# cmake --preset stm32f4: an STM32F405 or F407, Cortex-M4; its FPU is not used.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(FATHOM_MACHINE stm32f4 CACHE STRING "Its folder in port/")
set(CMAKE_C_FLAGS_INIT "-mcpu=cortex-m4 -mthumb -ffreestanding -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-mcpu=cortex-m4 -mthumb -nostdlib -Wl,--gc-sections")
set(CMAKE_C_STANDARD_LIBRARIES_INIT "-lgcc")
