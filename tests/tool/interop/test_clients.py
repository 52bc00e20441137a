#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Other people's Modbus clients read our simulated sensors, change them and set them up, and ask what they
may not. What they have to see is worked out by hand from --distance and the datasheets: the HPS-167S refuses
with an exception ("abnormal response code"); the A16 and the A05 document none and are silent.

What is set is read back where it can be: by #2 of the HPS-167S, whose eight bytes are termination, automatic
measuring, warm-up in s, reconnect time in ms (four), code of the rate; by a measurement; by the register.

It needs real time: CTest runs one such file at a time."""
import re

import interop
from interop import QUIET, e2e

# The datasheet's examples of commands #3 and #5 (HPS-167S).
DETAILS = 'B000 3900 2542 3457 1420 3438 3501 0607 0513 0917 0309'
MEASUREMENT = '0823 DCB2 0701 0000'  # 2083 mm, 0xDCB2 << 7, ambient 1, precision 0
FACTORY = 'FFFF 0000 0000 B401'  # #2 of the simulator at its start: no warm-up, 180 ms = 0xB4

FOUR = ['03E8', '07D0', '07A1', '0DEA']  # 1000, 2000, 1953, 3562 mm
NEAR = 'a05::modbus --distance 1000,2000,1953,3562'


def runs(first, *runs):
    """So many registers from there, and what they say."""
    return (' '.join(f'read:{first + at}:{count}' for at, count in runs),
            *(' '.join(FOUR[at:at + count]) for at, count in runs))


class Reads:
    @e2e.each(
        both_distances_of_an_a16=('a16::modbus --distance 754', 'read:0x0100:1 read:0x0101:1', '02F2',
                                  '02F2'),
        # Address, polarity 1, threshold 1 m, processed: from the factory (A16 4(2), 6).
        the_settings_of_an_a16=('a16:9:modbus', 'read:0x0200:1 read:0x0205:1 read:0x0206:1 read:0x0207:1',
                                '0009', '0001', '03E8', '0000'),
        an_a16_with_nothing_in_range=('a16::modbus --distance no-target', 'read:0x0101:1', 'FFFD'),
        an_a16_with_interference=('a16::modbus --distance interference', 'read:0x0101:1', 'FFFE'),
        the_ends_of_what_a_register_can_say=('a16::modbus --distance 0', 'read:0x0101:1', '0000'),
        the_other_end_of_what_a_register_can_say=('a16::modbus --distance 65535', 'read:0x0101:1', 'FFFF'),
        every_run_of_probes_of_an_a05=(NEAR, *runs(0x0106, (0, 1), (1, 1), (2, 1), (3, 1), (0, 2), (1, 2),
                                                   (2, 2),
                                                   (0, 3), (1, 3), (0, 4))),
        the_same_probes_of_an_a05_in_the_other_block=(NEAR, *runs(0x0010, (0, 1), (1, 1), (2, 1), (3, 1),
                                                                  (0, 4))),
        what_each_probe_of_an_a05_can_say=('a05::modbus --distance no-target,interference,250,4500',
                                           'read:0x0106:4', 'FFFD FFFE 00FA 1194'),
        the_address_of_an_a05=('a05:247:modbus', 'read:0x0200:1', '00F7'),  # the highest of the specification
        the_longest_distance_of_an_hps167s_at_the_highest_address=('hps167s:32 --distance 18000', 'read:8:4',
                                                                   '4650 DCB2 0701 0000'),  # 70 * 256 + 80
        # Distance, ambient and precision all ones, magnitude 0; the exponent stands beside the magnitude.
        the_abnormal_packet_of_an_hps167s=('hps167s --distance fault', 'read:8:4', 'FFFF 0000 00FF FFFF'),
        # #1: 2020-09-27, 2.1.0. #2: termination and output on, no warm-up, 180 ms = 0xB4 in four bytes, 19200
        # = 1. #3: the datasheet's. #4: 77 degrees Fahrenheit.
        the_other_commands_of_an_hps167s=('hps167s', 'read:1:3 read:2:4 read:3:11 read:4:1',
                                          '1409 1B02 0100', 'FFFF 0000 0000 B401', DETAILS, '004D'))
    def reads(self, device, steps, *said):
        unit = re.search(r':(\d+)', device)
        self.assertEqual(self.ask(self.sensor(device), int(unit[1]) if unit else 1, *steps.split()), [*said])

    def test_the_datasheets_measurement_of_an_hps167s(self):
        sim = self.sensor('hps167s', f'--distance 2083 --link {self.path("tof")}')
        sim.port = self.path('tof')
        self.assertEqual(self.ask(sim, 1, *['read:8:4'] * 3), [MEASUREMENT] * 3)

    def test_an_hps167s_that_sees_nothing(self):
        """65.53 m; what the light says then is not in the datasheet."""
        sim = self.sensor('hps167s --distance no-target')
        self.assertEqual([said[:4] for said in self.ask(sim, 1, 'read:8:4')], ['FFFA'])  # 65530


class Refusals:
    @e2e.each(
        # The right ones are 3, 4, 11, 1 and 4.
        each_command_of_an_hps167s_has_its_own_length=(
            2, 'read:1:2 read:1:4 read:2:3 read:2:5 read:3:10 read:3:12 read:4:2 read:8:1 read:8:3 read:8:5 '
               'read:8:125'),
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
            self.assertEqual(self.ask(sim, 5, step, seconds=QUIET), ['no response'], step)
            self.assertEqual(self.ask(sim, 5, 'read:0x0200:1'), ['0005'], f'after {step}')

    def test_another_unit_is_not_there(self):
        for device, units, step, said in (('a16:3:modbus', (2,), 'read:0x0101:1', '02F2'),
                                          ('a05:3:modbus', (4,), 'read:0x0106:1', '02F2'),
                                          ('hps167s:3', (2, 131), 'read:4:1', '004D')):  # 131 is 128 + 3
            sim = self.sensor(f'{device} --distance 754')
            for unit in units:
                self.assertEqual(self.ask(sim, unit, step, seconds=QUIET), ['no response'],
                                 f'{device} at {unit}')
            self.assertEqual(self.ask(sim, 3, step), [said], device)


class Writes:
    @e2e.each(the_address_of_an_a16=('a16', 0x0101), the_address_of_an_a05=('a05', 0x0109))
    def moves(self, device, register):
        """A new address counts at once, and the response comes from the old one."""
        sim = self.sensor(f'{device}::modbus --distance 754')
        self.assertEqual(self.ask(sim, 1, 'read:0x0200:1', 'write:0x0200:9'), ['0001', 'done'])
        self.assertEqual(self.ask(sim, 1, 'read:0x0200:1', seconds=QUIET), ['no response'])
        self.assertEqual(self.ask(sim, 9, 'read:0x0200:1', f'read:{register}:1'), ['0009', '02F2'])
        self.assertEqual(self.ask(sim, 9, f'write:0x0200:{self.most_unit}'), ['done'])
        self.assertEqual(self.ask(sim, self.most_unit, 'read:0x0200:1'), [f'{self.most_unit:04X}'])

    @e2e.each(
        an_a16_does_not_take_the_broadcast_address_for_its_own=('a16', 'write:0x0200:0xFF',
                                                                'write:0x0200:0x0105'),
        an_a05_does_not_take_the_broadcast_address_for_its_own=('a05', 'write:0x0200:0xFF',
                                                                'write:0x0200:0x0105'),
        a_distance_of_an_a16_is_not_to_be_written=('a16', 'write:0x0101:1', 'write:0x0300:1'),
        a_distance_of_an_a05_is_not_to_be_written=('a05', 'write:0x0106:1', 'write:0x0010:1'),
        an_a16_has_no_function_16=('a16', 'many:0x0200:7,7'),
        an_a05_has_no_function_16=('a05', 'many:0x0200:7,7'))
    def refuses(self, device, *steps):
        """No exceptions are documented: what is not obeyed is not answered."""
        sim = self.sensor(f'{device}:5:modbus --distance 754')
        for step in steps:
            self.assertEqual(self.ask(sim, 5, step, seconds=QUIET), ['no response'], step)
        self.assertEqual(self.ask(sim, 5, 'read:0x0200:1'), ['0005'])

    def test_the_reset_of_an_hps167s_is_for_its_own_length_alone(self):
        """#6 is a read that changes everything: address 1, and in #2 the warm-up of 5 s from the factory."""
        sim = self.sensor('hps167s:7 --distance 2083')
        self.assertEqual(self.ask(sim, 7, 'read:9:2', 'read:9:4', 'read:8:4'),
                         ['exception 2', 'exception 2', '0823 DCB2 0701 0000'])
        self.assertEqual(self.ask(sim, 7, 'read:9:1'), ['0001'])  # 00, then 01 on success
        self.assertEqual(self.ask(sim, 7, 'read:2:4', seconds=QUIET), ['no response'])
        self.assertEqual(self.ask(sim, 1, 'read:2:4'), ['FFFF 0500 0000 B401'])


class Settings:
    @e2e.each(
        no_termination_of_an_hps167s=('write:0x13:0', '00FF 0000 0000 B401'),
        what_is_so_already_may_be_written_again=('write:0x13:0xFF', FACTORY),
        the_reconnect_time_of_an_hps167s_by_function_16=('many:0x20:0,360',
                                                         'FFFF 0000 0001 6801'),  # 360 = 0x168
        # 0x00010002 = 65538 = 3641 * 18
        the_reconnect_time_has_its_high_word_first=('many:0x20:1,2', 'FFFF 0000 0100 0201'))
    def sets(self, step, said):
        """#2 before and behind it."""
        sim = self.sensor('hps167s --distance 2083')
        self.assertEqual(self.ask(sim, 1, 'read:2:4', step, 'read:2:4'), [FACTORY, 'done', said])

    @e2e.each(a_value_that_it_does_not_have_is_exception_3=(3, 'write:0x0A:256', 'many:0x20:0,361'),
              # 06 of what 16 writes, and the other way round
              an_address_that_it_does_not_have_is_exception_2=(2, 'write:0x0B:0', 'write:0x20:360', 'many:0x1F:0,360',
                                                               'many:0x0A:7,7'))
    def refused_write(self, code, *steps):
        self.assertEqual(self.ask(self.sensor('hps167s'), 1, *steps, 'read:2:4'),
                         [f'exception {code}'] * len(steps) + [FACTORY])


interop.for_each_client(globals(), Reads, Refusals, Writes, Settings)


if __name__ == '__main__':
    interop.main(at_once=8)
