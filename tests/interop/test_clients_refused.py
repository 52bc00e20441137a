#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What our simulated sensors say to other people's Modbus clients that ask what they may not. The HPS-167S
answers with an exception (HPS-167S "abnormal response code"); the A16 and the A05 document none and are
silent."""
import time

import interop
from interop import QUIET, e2e

MEASUREMENT = '0823 DCB2 0701 0000'  # HPS-167S #5, the datasheet's


class Refusals:
    @e2e.each(
        # The right ones are 3, 4, 11, 1 and 4.
        each_command_of_an_hps167s_has_its_own_length=(
            2, 'read:1:2 read:1:4 read:2:3 read:2:5 read:3:10 read:3:12 read:4:2 read:8:1 read:8:3 read:8:5 read:8:125'),
        between_the_commands_of_an_hps167s_there_is_nothing=(
            2, 'read:0:1 read:5:4 read:6:4 read:7:4 read:0x0100:1 read:0xFFFF:1'),
        # 03, 06 and 10 only (HPS-167S 2.2.4); here 01, 04 and 0x2B (mbpoll: 0x11).
        an_hps167s_has_no_other_functions=(1, 'coils:8:4 input:8:4 identify'))
    def refused(self, exception, steps):
        sim = self.sensor('hps167s --distance 2083')
        steps = steps.split()
        self.assertEqual(dict(zip(steps, self.ask(sim, 1, *steps))),
                         dict.fromkeys(steps, f'exception {exception}'))
        self.assertEqual(self.ask(sim, 1, 'read:8:4'), [MEASUREMENT])

    @e2e.each(
        an_a16_reads_one_register_at_a_time=('a16', 'read:0x0101:2 read:0x0205:2'),
        between_the_registers_of_an_a16_there_is_nothing=('a16', 'read:0x0102:1 read:0x0201:1 read:0:1'),
        an_a16_has_no_other_functions=('a16', 'coils:0x0101:1 input:0x0101:1 identify'),
        an_a05_does_not_read_past_the_last_probe=('a05', 'read:0x0109:2 read:0x0013:2'),
        between_the_registers_of_an_a05_there_is_nothing=('a05', 'read:0x0105:1 read:0x010A:1 read:0x0014:1'),
        an_a05_has_no_other_functions=('a05', 'coils:0x0106:4 input:0x0106:1 identify'))
    def silent(self, device, steps):
        sim = self.sensor(f'{device}:5:modbus --distance 754')
        for step in steps.split():
            self.assertEqual(self.ask(sim, 5, step, seconds=QUIET), ['no answer'], step)
            self.assertEqual(self.ask(sim, 5, 'read:0x0200:1'), ['0005'], f'after {step}')

    def test_another_unit_is_not_there(self):
        for device, units, step, said in (('a16:3:modbus', (2,), 'read:0x0101:1', '02F2'),
                                          ('a05:3:modbus', (4,), 'read:0x0106:1', '02F2'),
                                          ('hps167s:3', (2, 131), 'read:4:1', '004D')):  # 131 is 128 + 3
            sim = self.sensor(f'{device} --distance 754')
            for unit in units:
                self.assertEqual(self.ask(sim, unit, step, seconds=QUIET), ['no answer'],
                                 f'{device} at {unit}')
            self.assertEqual(self.ask(sim, 3, step), [said], device)


interop.for_each_client(Refusals, globals())


class Damage(interop.Pymodbus, interop.Case):
    """Requests as no client sends them, through pymodbus' own open port, and then one of its own."""

    def is_silent(self, sim, data):
        port = self.connect(sim).socket
        port.write(data)
        time.sleep(0.25)  # these take the simulator 20 ms
        return port.read(port.in_waiting) == b''

    @e2e.each(
        an_a16_is_silent_and_works_on=('a16::modbus', 'read:0x0200:1', '0001', (1, 3, 2, 0, 0, 1)),
        an_a05_is_silent_and_works_on=('a05::modbus', 'read:0x0200:1', '0001', (1, 3, 2, 0, 0, 1)),
        an_hps167s_is_silent_and_works_on=('hps167s', 'read:4:1', '004D', (1, 3, 0, 4, 0, 1)))
    def damaged(self, device, good, said, head):
        request = e2e.adu(*head)
        sim = self.sensor(f'{device} --distance 754')
        self.assertEqual(self.ask(sim, 1, good), [said])
        for what, data in (
                ('the CRC one off', request[:6] + bytes((request[6] ^ 1, request[7]))),
                ('the CRC one off in its other byte', request[:7] + bytes((request[7] ^ 0x80,))),
                ('the CRC in the other order', request[:6] + request[:5:-1]),
                ('no CRC', request[:6]),
                ('a bit of the unit', bytes((request[0] ^ 2,)) + request[1:]),
                ('a bit of the count', request[:5] + bytes((request[5] ^ 1,)) + request[6:]),
                ('the last byte missing', request[:7]),
                ('the first byte missing', request[1:]),
                ('a byte too few, with its CRC', e2e.adu(*head[:5])),
                ('a byte too many, with its CRC', e2e.adu(*head, 0)),
                ('nothing behind the function', e2e.adu(*head[:2])),
                ('the unit alone', request[:1]),
                ('an answer', e2e.registers(1, 754)),
                ('two requests as one', request + request)):
            self.assertTrue(self.is_silent(sim, data), what)
            self.assertEqual(self.ask(sim, 1, good), [said], f'after {what}')

    def test_what_is_for_all_is_not_answered_by_an_hps167s(self):
        """"0x00 broadcast (no answer)" (HPS-167S 2.2.1)."""
        sim = self.sensor('hps167s --distance 2083')
        self.assertTrue(self.is_silent(sim, e2e.adu(0, 3, 0, 8, 0, 4)))
        self.assertEqual(self.ask(sim, 1, 'read:8:4'), [MEASUREMENT])


if __name__ == '__main__':
    interop.main()
