#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Other people's Modbus clients set up our simulated sensors: #7 to #15 of the HPS-167S by 06 and 16,
registers 0x0202 to 0x0207 of the A16. Each is read back where it can be: by #2, whose eight bytes are
termination, automatic measuring, warm-up in s, reconnect time in ms (four), code of the rate; by a
measurement; by the register."""
import interop
from interop import QUIET, SOON, e2e

FACTORY = 'FFFF 0000 0000 B401'  # #2 of the simulator at its start: no warm-up, 180 ms = 0xB4


class Settings:
    def hps(self):
        return self.sensor('hps167s --distance 2083')

    @e2e.each(
        the_warm_up_of_an_hps167s=('write:0x0A:7', 'FFFF 0700 0000 B401'),
        the_longest_warm_up_of_an_hps167s=('write:0x0A:255', 'FFFF FF00 0000 B401'),
        no_measuring_at_power_on_of_an_hps167s=('write:0x12:0', 'FF00 0000 0000 B401'),
        no_termination_of_an_hps167s=('write:0x13:0', '00FF 0000 0000 B401'),
        what_is_so_already_may_be_written_again=('write:0x13:0xFF', FACTORY),
        the_reconnect_time_of_an_hps167s_by_function_16=('many:0x20:0,360',
                                                         'FFFF 0000 0001 6801'),  # 360 = 0x168
        # 0x00010002 = 65538 = 3641 * 18
        the_reconnect_time_has_its_high_word_first=('many:0x20:1,2', 'FFFF 0000 0100 0201'))
    def sets(self, step, said):
        """#2 before and behind it."""
        self.assertEqual(self.ask(self.hps(), 1, 'read:2:4', step, 'read:2:4'), [FACTORY, 'done', said])

    def test_the_address_of_an_hps167s(self):
        sim = self.hps()
        self.assertEqual(self.ask(sim, 1, 'write:0x10:32'), ['done'])
        self.assertEqual(self.ask(sim, 1, 'read:2:4', seconds=QUIET), ['no answer'])
        self.assertEqual(self.ask(sim, 32, 'read:2:4', 'write:0x10:1'), [FACTORY, 'done'])
        self.assertEqual(self.ask(sim, 1, 'read:2:4'), [FACTORY])

    def test_the_rates_of_an_hps167s(self):
        """Acknowledged at the old one."""
        sim = self.hps()
        for code, baud in ((3, 115200), (2, 57600), (4, 230400), (1, 19200)):
            self.assertEqual(self.ask(sim, 1, f'write:0x11:{code}'), ['done'], baud)
            self.assertEqual(self.ask(sim, 1, 'read:2:4', seconds=QUIET), ['no answer'], baud)
            self.at_rate(sim, baud)
            self.assertEqual(self.ask(sim, 1, 'read:2:4'), [f'FFFF 0000 0000 B40{code}'], baud)

    def test_the_offset_of_an_hps167s_is_seen_in_what_it_measures(self):
        """-15 = 0xFFF1: 2083 mm are 2068 = 0x0814; 20 more than 2083 are 0x0837. #13 takes it away and
        back."""
        steps = [step for write in ('write:0x14:0xFFF1', 'write:0x14:20', 'write:0x15:0xFF', 'write:0x15:0')
                 for step in (write, 'read:8:4')]
        self.assertEqual(self.ask(self.hps(), 1, *steps),
                         [said for mm in ('0814', '0837', '0823', '0837')
                          for said in ('done', mm + ' DCB2 0701 0000')])

    def test_the_filter_of_an_hps167s(self):
        """+-100 is recommended; -100 = 0xFF9C."""
        self.assertEqual(self.ask(self.hps(), 1, 'write:0x16:100', 'write:0x16:0xFF9C', 'read:2:4'),
                         ['done', 'done', FACTORY])

    def test_what_no_command_of_an_hps167s_has_changes_nothing(self):
        """Values: exception 3. Addresses and lengths: exception 2; 06 of what 16 writes, and the other way
        round."""
        sim = self.hps()
        for code, steps in (
                (3, 'write:0x0A:256 write:0x10:0 write:0x10:33 write:0x12:1 write:0x13:0xFE write:0x15:1 '
                    'many:0x20:0,361'),
                (2, 'write:0x0B:0 write:0x17:0 write:0x20:360 write:9:1 write:8:4 many:0x20:0,360,0 many:0x1F:0,360 '
                    'many:0x0A:7,7 many:9:1,1')):
            steps = steps.split()
            self.assertEqual(dict(zip(steps, self.ask(sim, 1, *steps))),
                             dict.fromkeys(steps, f'exception {code}'))
        self.assertEqual(self.ask(sim, 1, 'read:2:4', 'read:8:4'), [FACTORY, '0823 DCB2 0701 0000'])

    def test_the_reset_of_an_hps167s_undoes_what_was_set(self):
        """Warm-up 5 s, 180 ms, and all else on."""
        self.assertEqual(self.ask(self.hps(), 1, 'write:0x0A:7', 'write:0x12:0', 'write:0x13:0',
                                  'many:0x20:0,360',
                                  'read:2:4', 'read:9:1', 'read:2:4'),
                         ['done'] * 4 + ['0000 0700 0001 6801', '0001', 'FFFF 0500 0000 B401'])

    def test_the_settings_of_an_a16(self):
        """Polarity, threshold, data type: read, written, read back."""
        sim = self.sensor('a16:9:modbus --distance 754')
        for register, before, value, behind in ((0x0205, '0001', 0, '0000'), (0x0206, '03E8', 2000, '07D0'),
                                                (0x0207, '0000', 1, '0001')):
            self.assertEqual(self.ask(sim, 9, f'read:{register}:1', f'write:{register}:{value}',
                                      f'read:{register}:1'),
                             [before, 'done', behind], hex(register))

    def test_the_operating_mode_of_an_a16_is_not_to_be_read(self):
        sim = self.sensor('a16:9:modbus --distance 754')
        self.assertEqual(self.ask(sim, 9, 'write:0x0202:1', 'write:0x0202:0'), ['done', 'done'])
        self.assertEqual(self.ask(sim, 9, 'read:0x0202:1', seconds=QUIET), ['no answer'])
        self.assertEqual(self.ask(sim, 9, 'read:0x0101:1'), ['02F2'])  # 754: RS-485 stays with Modbus

    def test_an_a16_is_silent_about_values_that_its_settings_do_not_have(self):
        sim = self.sensor('a16:9:modbus')
        for step in ('write:0x0202:2', 'write:0x0205:2', 'write:0x0207:0x0100'):
            self.assertEqual(self.ask(sim, 9, step, seconds=QUIET), ['no answer'], step)
        self.assertEqual(self.ask(sim, 9, 'read:0x0205:1', 'read:0x0206:1', 'read:0x0207:1'),
                         ['0001', '03E8', '0000'])


interop.for_each_client(Settings, globals())


class Alone(interop.Pymodbus, interop.Case):
    def test_all_hps167s_obey_what_is_for_all(self):
        """Unit 0, which answers nothing; pymodbus knows that and waits for nothing."""
        sim = self.sensor('hps167s')
        self.ask(sim, 0, 'write:0x0A:7', seconds=QUIET)
        self.assertEqual(self.ask(sim, 1, 'read:2:4'), ['FFFF 0700 0000 B401'])

    def test_an_a16_returns_to_its_automatic_output(self):
        """A16 6(4) example 4. The first frame comes 100 ms behind the command, the acknowledgement long
        before."""
        sim = self.sensor('a16:5:auto --distance 754')
        port = self.stop(sim)
        self.assertEqual(self.ask(sim, 5, 'write:0x0202:1'), ['done'])
        port.timeout = SOON
        self.assertEqual(port.read(8), 2 * e2e.frame(754))


if __name__ == '__main__':
    interop.main()
