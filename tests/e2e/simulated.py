# SPDX-License-Identifier: MIT
"""What the tests of fathom sim share: a look at its port through pyserial, byte for byte."""
import time

import serial

import e2e


class Case(e2e.Case):
    def open(self, sim, baudrate=None):
        """At the rate of its first device, where none is given."""
        rate = baudrate or (19200 if sim.command[2].startswith('hps167s') else 9600)
        port = serial.Serial(sim.port, timeout=e2e.PATIENCE, baudrate=rate)
        self.addCleanup(port.close)
        return port

    def ask(self, port, request, length, baud=None):
        """After the silence that ends whatever a device took for the beginning of a request: 4 ms at 9600
        baud."""
        time.sleep(0.02)
        port.baudrate = baud or port.baudrate
        port.reset_input_buffer()
        port.write(request)
        return port.read(length)

    def counters(self, sim, *names):
        """What each device says of these at the end."""
        return [tuple(one[name] for name in names) for one in sim.end().told]
