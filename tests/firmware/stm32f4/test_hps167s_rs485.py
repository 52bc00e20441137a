#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/stm32f4/hps167s_rs485.c on QEMU's netduinoplus2. Its USARTs do not tell their rate, so that the far ends
are at 115200 baud, QEMU's own."""
import qemu


class Transaction(qemu.Transaction, qemu.Case):
    baud = 115200
    sim_options = ('--baud', '115200')

    def check(self, port):
        done = self.end_well(self.boot('hps167s_rs485_qemu', None, port))  # USART2
        # A board's 5 ms of silence end a frame here, which a far end on a busy machine pauses now and then.
        self.assertEqual(self.readings(done.out, 'gate', most_errors=1000), ['probe 1 2083 mm'] * 10)


if __name__ == '__main__':
    qemu.main()
