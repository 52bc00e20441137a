#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""port/posix on the 8250s of a PC, by Debian's cloud-amd64 kernel. ttyS0 is the console, ttyS1 and ttyS2 are joined by
a cable."""
import re

import guest


class Pc(guest.Guest):
    def __init__(self):
        super().__init__('amd64', 'gcc', ['pc', 'tty'],
                         ['qemu-system-x86_64', '-m', '128'], 'console=ttyS0')
        cable = self.path('cable')
        self.command += ['-serial', 'chardev:console', '-chardev', f'socket,id=near,path={cable},server=on,wait=off',
                         '-chardev', f'socket,id=far,path={cable}', '-serial', 'chardev:near', '-serial', 'chardev:far',
                         '-trace', 'serial_update_parameters']

    def do_chip(self, baud, parity, stop_bits):
        """Were these the settings that a chip got last?"""
        found = re.fullmatch(r"serial_update_parameters baudrate=(\d+) parity='(.)' data=8 stop=(\d)",
                             self.trace()[-1][1].strip())
        return int(found is not None and found.groups() == (baud, parity, stop_bits))


guest.main(Pc)
