#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tests/firmware/virt/images/hps167s.c on QEMU's virt."""
import re

import qemu


class Transaction(qemu.Transaction, qemu.Case):
    def check(self, port):
        """30 responses of 13 bytes are more than an index of the ring can count."""
        done = self.end_well(self.boot('hps167s', port, traces=('serial_update_parameters',)))
        self.assertEqual(self.readings(done.out, 'gate'), ['probe 1 2083 mm'] * 30)
        # QEMU's UART has 399193 baud to divide, of which 19009 is next to 19200. Each register that is written makes a
        # line; the last one is what holds.
        self.assertEqual(re.findall(r'^serial_update_parameters (.*)$', done.err, re.M)[-1],
                         "baudrate=19009 parity='E' data=8 stop=1")


if __name__ == '__main__':
    qemu.main()
