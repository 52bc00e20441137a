# SPDX-License-Identifier: MIT
# Arm's MPS2 board with the image AN385, a Cortex-M3, which QEMU has as mps2-an385.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(FATHOM_MACHINE mps2 CACHE STRING "The machine whose images are built")
set(CMAKE_C_FLAGS_INIT "-mcpu=cortex-m3 -mthumb -ffreestanding -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-mcpu=cortex-m3 -mthumb -nostdlib -Wl,--gc-sections")
set(CMAKE_C_STANDARD_LIBRARIES_INIT "-lgcc")
