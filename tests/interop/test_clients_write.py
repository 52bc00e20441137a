#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Other people's Modbus clients change our simulated sensors, and see by a read that they did, or did not."""
import interop
from interop import QUIET, e2e


class Writes:
    @e2e.each(the_address_of_an_a16=('a16', 0x0101), the_address_of_an_a05=('a05', 0x0109))
    def moves(self, device, register):
        """A new address counts at once, and the answer comes from the old one."""
        sim = self.sensor(f'{device}::modbus --distance 754')
        self.assertEqual(self.ask(sim, 1, 'read:0x0200:1', 'write:0x0200:9'), ['0001', 'done'])
        self.assertEqual(self.ask(sim, 1, 'read:0x0200:1', seconds=QUIET), ['no answer'])
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
            self.assertEqual(self.ask(sim, 5, step, seconds=QUIET), ['no answer'], step)
        self.assertEqual(self.ask(sim, 5, 'read:0x0200:1'), ['0005'])

    def test_the_reset_of_an_hps167s_is_for_its_own_length_alone(self):
        """#6 is a read that changes everything: address 1, and in #2 the warm-up of 5 s from the factory."""
        sim = self.sensor('hps167s:7 --distance 2083')
        self.assertEqual(self.ask(sim, 7, 'read:9:2', 'read:9:4', 'read:8:4'),
                         ['exception 2', 'exception 2', '0823 DCB2 0701 0000'])
        self.assertEqual(self.ask(sim, 7, 'read:9:1'), ['0001'])  # 00, then 01 on success
        self.assertEqual(self.ask(sim, 7, 'read:2:4', seconds=QUIET), ['no answer'])
        self.assertEqual(self.ask(sim, 1, 'read:2:4'), ['FFFF 0500 0000 B401'])


interop.for_each_client(Writes, globals())


class Alone(interop.Pymodbus, interop.Case):
    @e2e.each(an_a16_obeys_what_is_for_all='a16', an_a05_obeys_what_is_for_all='a05')
    def all_obey(self, device):
        """0xFF is for all, and answered by none."""
        sim = self.sensor(f'{device}:5:modbus')
        self.assertEqual(self.ask(sim, 255, 'write:0x0200:6', seconds=QUIET), ['no answer'])
        self.assertEqual(self.ask(sim, 6, 'read:0x0200:1'), ['0006'])

    @e2e.each(the_first_command_ends_the_automatic_output_of_an_a16=('a16', e2e.frame(754)),
              the_first_command_ends_the_automatic_output_of_an_a05=('a05', e2e.frame(754, 754, 754, 754)))
    def stops(self, device, frame):
        """With the first command to this address (A16 5(0), A05 1(1))."""
        sim = self.sensor(f'{device}:5:auto --distance 754')
        port = self.connect(sim).socket
        port.reset_input_buffer()
        self.assertEqual(port.read(len(frame)), frame)
        self.stop(sim)
        self.assertEqual(self.ask(sim, 5, 'read:0x0200:1'), ['0005'])


if __name__ == '__main__':
    interop.main()
