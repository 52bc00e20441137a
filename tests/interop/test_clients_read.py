#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Other people's Modbus clients read our simulated sensors: every register and every command. What they have
to see is worked out by hand from --distance and the datasheets."""
import re

import interop
from interop import e2e

# The datasheet's examples of commands #3 and #5 (HPS-167S).
DETAILS = 'B000 3900 2542 3457 1420 3438 3501 0607 0513 0917 0309'
MEASUREMENT = '0823 DCB2 0701 0000'  # 2083 mm, 0xDCB2 << 7, ambient 1, precision 0

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


interop.for_each_client(Reads, globals())

if __name__ == '__main__':
    interop.main()
