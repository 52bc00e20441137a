# SPDX-License-Identifier: MIT
"""The framework of Arduino, from Debian's core; the options are those of its platform.txt."""
import os

from SCons.Script import DefaultEnvironment

ARDUINO = '/usr/share/arduino/hardware/arduino/avr'
CORE = os.path.join(ARDUINO, 'cores/arduino')

env = DefaultEnvironment()
env.Append(CXXFLAGS=['-std=gnu++11', '-fpermissive', '-fno-exceptions', '-fno-threadsafe-statics'],
           CCFLAGS=['-w', '-flto'], LINKFLAGS=['-flto', '-fuse-linker-plugin'],
           CPPDEFINES=[('ARDUINO', '10819'), 'ARDUINO_AVR_UNO', 'ARDUINO_ARCH_AVR',
                       ('DECIMAL_DIG', '__DECIMAL_DIG__')],  # why: ../../../arduino/build.py
           CPPPATH=[CORE, os.path.join(ARDUINO, 'variants/standard')])
env.Append(LIBSOURCE_DIRS=[os.path.join(ARDUINO, 'libraries')])  # SoftwareSerial
env.Replace(AR='avr-gcc-ar', RANLIB='avr-gcc-ranlib')
# wiring_pulse.c and .S would be one object; no sketch here calls pulseIn.
env.Prepend(LIBS=[env.BuildLibrary(os.path.join('$BUILD_DIR', 'core'), CORE, ['+<*>', '-<wiring_pulse.*>'])])
