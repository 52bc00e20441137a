# SPDX-License-Identifier: MIT
"""What PlatformIO compiles of Fathom (library.json): the library, with port/serial for a port of your own, and the port
that platformio.ini names:

    custom_fathom_port = avr

avr or stm32f4. Without a line it is arduino where that is the framework, else none."""
import os

Import('env')  # noqa: F821

PORTS = ('arduino', 'avr', 'stm32f4')
ROOT = os.path.dirname(os.path.dirname(os.getcwd()))  # SCons runs this in its folder


def sources_of(port):
    """The library has the CRC twice, and a port may bring its own: one of them, and not the table of 512 bytes."""
    crc16 = ['-<src/codec/crc16.c>']
    if port == 'avr':
        crc16 += ['-<src/codec/crc16_small.c>', '-<port/avr/crc16_table.c>']
    return ['-<*>', '+<src/>', *([f'+<port/{port}/*.c>', f'+<port/{port}/*.cpp>'] if port else []), *crc16]


frameworks = env.get('PIOFRAMEWORK', [])  # noqa: F821
chosen = env.GetProjectOption('custom_fathom_port', 'arduino' if 'arduino' in frameworks else '')  # noqa: F821
if chosen and chosen not in PORTS:
    raise SystemExit(f'custom_fathom_port = {chosen}: it may be {", ".join(PORTS)}')
env.Replace(SRC_FILTER=sources_of(chosen))  # noqa: F821
env.Append(CPPPATH=[os.path.join(ROOT, 'port', name) for name in (chosen, 'serial') if name])  # noqa: F821
