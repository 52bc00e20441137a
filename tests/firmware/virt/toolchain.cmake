# SPDX-License-Identifier: MIT
# QEMU's board "virt" with a 32-bit RISC-V.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(FATHOM_MACHINE virt CACHE STRING "The machine whose images are built")
set(CMAKE_C_FLAGS_INIT "-march=rv32imac_zicsr -mabi=ilp32 -mcmodel=medany -ffreestanding -ffunction-sections -fdata-sections")
# Without _zicsr, by whose name gcc 12 does not find its library; the last -march counts.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-march=rv32imac -mabi=ilp32 -nostdlib -Wl,--gc-sections")
set(CMAKE_C_STANDARD_LIBRARIES_INIT "-lgcc")
