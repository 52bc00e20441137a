#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom info, get, set and reset at real ports: what they change stays, and other commands see it. What they print and
write in each case is in test_tool_settings."""
import e2e


class Settings(e2e.Case):
    def json(self, line):
        return self.ends(f'{line} --format json', 0).json[0]

    def counters(self, sim, *names):
        """What each simulated sensor has counted, of these; ends them."""
        return [tuple(one[name] for name in names) for one in sim.end().told]

    def reads(self, sensor, sim, count=1):
        return self.read_json(f'{sensor} --port {sim} --count {count}')

    @e2e.each(**{f'the_settings_of_a_sensor_are_listed_without_a_port_{row[0]}': row for row in (
        ('a16', 'switch-threshold', '1 to 16350 mm', 'operating-mode (write-only)', '0x0202'),
        ('a05', 'address', '1 to 254', 'every-address', 'EVERY A05'),
        ('hps167s', '19200, 57600, 115200, 230400', 'a multiple of 18', 'next power-on', 'distance-offset (write-only)',
         '(#14)'))})
    def listed(self, sensor, *words):
        out = self.ends(f'get {sensor}', 0).out
        self.assertEqual([word for word in words if word not in out], [])

    def test_what_is_told_changes_nothing(self):
        sim = self.sim('hps167s --counters')
        self.assertEqual(self.json(f'info hps167s --port {sim}')['baud'], 19200)
        (*changes, answered), = self.counters(sim, 'writes', 'flash_writes', 'resets', 'resets_refused', 'answered')
        self.assertEqual(changes, [0] * 4)
        self.assertGreater(answered, 5)

    def test_the_baud_rate_is_changed_and_followed_and_reset(self):
        sim = self.sim('hps167s:7 --counters')
        self.assertIn(f'fathom read hps167s:7:modbus --port {sim} --baud 115200',
                      self.ends(f'set hps167s:7 --port {sim} baud 115200', 0).out)
        self.assertEqual(self.json(f'get hps167s:7 --port {sim} --baud 115200 baud')['baud'], 115200)
        self.ends(f'get hps167s:7 --port {sim} baud', 1, 'no response')
        self.ends(f'reset hps167s:7 --port {sim} --baud 115200 --yes-restore-factory-settings', 0)
        self.assertEqual(len(self.reads('hps167s', sim)), 1)
        self.assertEqual(self.counters(sim, 'resets'), [(1,)])

    def test_where_another_has_address_1_nothing_is_reset(self):
        sim = self.sim('hps167s:7 hps167s:1 --counters')
        self.ends(f'reset hps167s:7 --port {sim} interface --yes', 1)
        self.assertEqual(self.counters(sim, 'resets'), [(0,), (0,)])

    @e2e.each(an_address_of_an_a16_is_followed=('a16:1:modbus', 'a16:5:modbus', 1),
              an_address_of_an_a05_is_followed=('a05:1:dyp', 'a05:5:dyp', 4),
              an_address_of_an_hps167s_is_followed=('hps167s', 'hps167s:5', 1))
    def follow(self, before, after, samples):
        sim = self.sim(before)
        name = 'every-address' if before == 'a05:1:dyp' else 'address'
        self.ends(f'set {before.split(":")[0]} --port {sim} {name} 5', 0)
        self.assertEqual(len(self.reads(after, sim)), samples)

    def test_an_offset_applies_until_the_sensor_is_reset(self):
        sim = self.sim('hps167s --distance 1000')
        self.ends(f'set hps167s --port {sim} distance-offset -- -15', 0)
        self.assertEqual(self.reads('hps167s', sim)[0]['distance_mm'], 985)
        self.ends(f'reset hps167s --port {sim} sensor --yes', 0)
        self.assertEqual(self.reads('hps167s', sim)[0]['distance_mm'], 1000)

    def test_an_a16_returns_to_automatic_output(self):
        sim = self.sim('a16')
        self.assertEqual(self.json(f'info a16 --port {sim}')['switch_threshold'], 1000)
        self.ends(f'set a16 --port {sim} automatic-output on', 0)
        self.assertEqual(len(self.reads('a16', sim, 2)), 2)

    def test_the_terminations_of_two_at_one_address_are_switched_off_at_once(self):
        sim = self.sim('hps167s hps167s --counters')
        self.ends(f'set hps167s --port {sim} termination off --all-units --yes', 0)
        self.assertEqual(self.counters(sim, 'writes', 'answered'), [(1, 0), (1, 0)])

    @e2e.each('info a16', 'get hps167s', 'get hps167s termination', 'set a05 address 5')
    def dead(self, line):
        self.ends(f'{line} --port {self.device()}', 1, 'no byte was received', out='')

    def test_a_full_output_is_said(self):
        sim = self.sim('a16:1:modbus')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'info a16 --port {sim}', 1, 'cannot write the output', stdout=full)


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
