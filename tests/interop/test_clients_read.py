#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Other people's Modbus clients read our simulated sensors: every register and every command. What they have to
see is worked out by hand from --distance and the datasheets."""
import interop

# The datasheet's examples of commands #3 and #5 (HPS-167S).
DETAILS = 'B000 3900 2542 3457 1420 3438 3501 0607 0513 0917 0309'
MEASUREMENT = '0823 DCB2 0701 0000'  # 2083 mm, 0xDCB2 << 7, ambient 1, precision 0

FOUR = ['03E8', '07D0', '07A1', '0DEA']  # 1000, 2000, 1953, 3562 mm


class Reads:
    def test_both_distances_of_an_a16(self):
        sim = self.sensor('a16::modbus', '--distance', '754')
        self.assertEqual(self.ask(sim, 1, 'read:0x0100:1', 'read:0x0101:1'), ['02F2', '02F2'])  # 2 * 256 + 242

    def test_the_settings_of_an_a16(self):
        """Address, polarity 1, threshold 1 m, processed: from the factory (A16 4(2), 6)."""
        sim = self.sensor('a16:9:modbus')
        self.assertEqual(self.ask(sim, 9, 'read:0x0200:1', 'read:0x0205:1', 'read:0x0206:1', 'read:0x0207:1'),
                         ['0009', '0001', '03E8', '0000'])

    def test_an_a16_with_nothing_in_range(self):
        sim = self.sensor('a16::modbus', '--distance', 'no-target')
        self.assertEqual(self.ask(sim, 1, 'read:0x0101:1'), ['FFFD'])

    def test_an_a16_with_interference(self):
        sim = self.sensor('a16::modbus', '--distance', 'interference')
        self.assertEqual(self.ask(sim, 1, 'read:0x0101:1'), ['FFFE'])

    def test_the_ends_of_what_a_register_can_say(self):
        for distance, said in (('0', '0000'), ('65535', 'FFFF')):
            sim = self.sensor('a16::modbus', '--distance', distance)
            self.assertEqual(self.ask(sim, 1, 'read:0x0101:1'), [said])

    def runs(self, first, *runs):
        sim = self.sensor('a05::modbus', '--distance', '1000,2000,1953,3562')
        self.assertEqual(self.ask(sim, 1, *(f'read:{first + at}:{count}' for at, count in runs)),
                         [' '.join(FOUR[at:at + count]) for at, count in runs])

    def test_every_run_of_probes_of_an_a05(self):
        self.runs(0x0106, (0, 1), (1, 1), (2, 1), (3, 1), (0, 2), (1, 2), (2, 2), (0, 3), (1, 3), (0, 4))

    def test_the_same_probes_of_an_a05_in_the_other_block(self):
        self.runs(0x0010, (0, 1), (1, 1), (2, 1), (3, 1), (0, 4))

    def test_what_each_probe_of_an_a05_can_say(self):
        sim = self.sensor('a05::modbus', '--distance', 'no-target,interference,250,4500')  # 0x00FA, 0x1194
        self.assertEqual(self.ask(sim, 1, 'read:0x0106:4'), ['FFFD FFFE 00FA 1194'])

    def test_the_address_of_an_a05(self):
        sim = self.sensor('a05:247:modbus')  # the highest of the specification
        self.assertEqual(self.ask(sim, 247, 'read:0x0200:1'), ['00F7'])

    def test_the_datasheets_measurement_of_an_hps167s(self):
        sim = self.sensor('hps167s', '--distance', '2083', '--link', self.path('tof'))
        sim.port = self.path('tof')
        self.assertEqual(self.ask(sim, 1, *['read:8:4'] * 3), [MEASUREMENT] * 3)

    def test_the_longest_distance_of_an_hps167s_at_the_highest_address(self):
        sim = self.sensor('hps167s:32', '--distance', '18000')  # 70 * 256 + 80
        self.assertEqual(self.ask(sim, 32, 'read:8:4'), ['4650 DCB2 0701 0000'])

    def test_an_hps167s_that_sees_nothing(self):
        """65.53 m; what the light says then is not in the datasheet."""
        sim = self.sensor('hps167s', '--distance', 'no-target')
        self.assertEqual([said[:4] for said in self.ask(sim, 1, 'read:8:4')], ['FFFA'])  # 65530

    def test_the_abnormal_packet_of_an_hps167s(self):
        """Distance, ambient and precision all ones, magnitude 0; the exponent stands beside the magnitude."""
        sim = self.sensor('hps167s', '--distance', 'fault')
        self.assertEqual(self.ask(sim, 1, 'read:8:4'), ['FFFF 0000 00FF FFFF'])

    def test_the_other_commands_of_an_hps167s(self):
        """#1: 2020-09-27, 2.1.0. #2: termination and output on, no warm-up, 180 ms = 0xB4 in four bytes, 19200 = 1.
        #3: the datasheet's. #4: 77 degrees Fahrenheit."""
        sim = self.sensor('hps167s')
        self.assertEqual(self.ask(sim, 1, 'read:1:3', 'read:2:4', 'read:3:11', 'read:4:1'),
                         ['1409 1B02 0100', 'FFFF 0000 0000 B401', DETAILS, '004D'])


class LibmodbusReads(interop.Libmodbus, Reads, interop.Case):
    pass


class PymodbusReads(interop.Pymodbus, Reads, interop.Case):
    pass


class MbpollReads(interop.Mbpoll, Reads, interop.Case):
    pass


if __name__ == '__main__':
    interop.main()
