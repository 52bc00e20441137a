#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom info, get, set and reset, against simulated sensors: what they print, what they change, and what
not."""
import signal

import e2e


def lost(first, end):
    """Faults of a simulated sensor: these frames do not come."""
    return ' '.join(f'--fault silence=1@{frame}' for frame in range(first, end))


class Settings(e2e.Case):
    def told(self, line, *said, code=0):
        """Standard output; and this is on the standard error."""
        return self.ends(line, code, *said).out

    def json(self, line):
        return self.ends(f'{line} --format json', 0).json[0]

    def counters(self, sim, *names):
        """What each simulated sensor has counted, of these; ends them."""
        return [tuple(one[name] for name in names) for one in sim.end(signal.SIGINT).told]

    def reads(self, sensor, sim, count=1):
        return self.read_json(f'{sensor} --port {sim} --count {count}')


class What(Settings):
    @e2e.each(**{f'the_settings_of_a_sensor_are_listed_without_a_port_{sensor}': (sensor, words) for sensor,
                 words in (
        ('a16', ['switch-threshold', '1 to 16350 mm', 'operating-mode (write-only)', '0x0202']),
        ('a05', ['address', '1 to 254', 'every-address', 'EVERY A05']),
        ('hps167s', ['19200, 57600, 115200, 230400', 'a multiple of 18', 'next power-on',
                     'distance-offset (write-only)', '(#14)']))})
    def listed(self, sensor, words):
        out = self.told(f'get {sensor}')
        for word in words:
            self.assertIn(word, out)

    def test_without_a_setting_get_prints_the_present_values(self):
        sim = self.sim('hps167s:7 --counters')
        got = self.json(f'get hps167s:7 --port {sim}')
        self.assertEqual({name: got[name] for name in ('address', 'baud', 'termination', 'warm_up')},
                         {'address': 7, 'baud': 19200, 'termination': True, 'warm_up': 0})
        self.assertNotIn('uuid', got)
        self.assertNotIn('distance_offset', got)  # write-only
        out = self.told(f'get hps167s:7 --port {sim}')
        self.assertRegex(out, r'(?m)^termination +on$')
        self.assertRegex(out, r'(?m)^distance-offset +- \(write-only\)$')
        self.assertEqual(self.counters(sim, 'writes'), [(0,)])

    # Between two frames there is room for a request where the machine has the time to send it by then, so each is tried
    # three times. 54 a second: test_tool_unasked, in simulated time.
    def test_an_hps167s_that_sends_unasked_is_told_and_set(self):
        sim = self.sim('hps167s --with unasked=60 --counters')
        for line, told in ((f'info hps167s --port {sim}', 'temperature                25.0 degC'),
                           (f'set hps167s --port {sim} measure-after-power-on off', 'power-on is off'),
                           (f'get hps167s --port {sim} measure-after-power-on', 'off')):
            tries = 3
            while (done := self.fathom(line).finish()).code != 0 and tries > 1:
                tries -= 1
            self.assertEqual(done.code, 0, done)
            self.assertIn(told, done.out)
        self.assertEqual(self.counters(sim, 'writes'), [(1,)])

    @e2e.each(address_0_of_an_a16_is_set_read_and_found='a16',
              address_0_of_an_a05_is_set_read_and_found='a05')
    def address_0(self, sensor):
        sim = self.sim(f'{sensor}::modbus --counters')
        self.ends(f'set {sensor} --port {sim} address 0', 2, 'may not be found again', '--yes')
        self.assertIn('from now on: fathom read',
                      self.told(f'set {sensor} --port {sim} address 0 --may-not-be-found-again'))
        self.assertEqual(self.json(f'info {sensor}:0 --port {sim}')['address'], 0)
        self.assertEqual({one['address'] for one in self.reads(f'{sensor}:0', sim)}, {0})
        self.ends(f'set {sensor}:0 --port {sim} address 1', 2, 'goes to all units')
        found, = self.ends(f'scan --port {sim} --address 0 --baud 9600 --listen 1 --timeout 1000 --format json', 0).json
        self.assertEqual((found['model'], found['address']), (sensor, 0))
        self.assertEqual(self.counters(sim, 'writes'), [(1,)])

    def test_one_that_leaves_no_room_for_a_request_is_told_apart_from_a_bad_line(self):
        sim = self.sim('hps167s --with unasked=12')
        self.ends(f'info hps167s --port {sim}', 1, 'the sensor sends measurements without a request',
                  f'setserial {sim} low_latency')

    @e2e.each(
        # the examples of #3; a temperature of 77 degrees Fahrenheit is (77 - 32) * 5 / 9 = 25.0
        everything_that_an_hps167s_tells=('hps167s:7', 'hps167s:7', {
            'name': 'hps167s:7', 'model': 'hps167s', 'mode': 'modbus', 'address': 7, 'line': '19200 8E1',
            'interface_version': '2.1.0 of 2020-09-27', 'sensor_version': '3.9 of 2019-09-23',
            'uuid': '00390025423457142034383501060705', 'temperature': 25.0, 'baud': 19200, 'baud_code': 1,
            'warm_up': 0, 'measure_after_power_on': True, 'termination': True, 'reconnect_time': 180}),
        everything_that_an_a16_tells=('a16:1:modbus --distance 754', 'a16', {
            'name': 'a16:1', 'model': 'a16', 'mode': 'modbus', 'line': '9600 8N1', 'address': 1,
            'switch_polarity': 'positive', 'switch_threshold': 1000, 'automatic_value': 'processed',
            'distance': 754, 'real_time_distance': 754}),
        everything_that_an_a05_tells=('a05:3:modbus --distance 1000,2000,1953,no-target', 'a05:3', {
            'name': 'a05:3', 'model': 'a05', 'mode': 'modbus', 'line': '9600 8N1', 'address': 3,
            'distances': '1000, 2000, 1953, no_target'}))
    def everything(self, device, sensor, expected):
        self.assertEqual(self.json(f'info {sensor} --port {self.sim(device)}'), expected)

    def test_a_termination_resistor_that_is_on_is_remarked(self):
        sim = self.sim('hps167s')
        self.assertIn('termination                on',
                      self.told(f'info hps167s --port {sim}', 'termination off'))
        self.told(f'set hps167s --port {sim} termination off')
        self.assertNotIn('resistor', self.ends(f'info hps167s --port {sim}', 0).err)

    def test_one_setting_is_told_alone(self):
        out = self.told(f'get hps167s --port {self.sim("hps167s")} reconnect-time')
        self.assertEqual(out.splitlines()[1].split(), ['reconnect-time', '180', 'ms'])

    def test_what_is_told_changes_nothing(self):
        sim = self.sim('hps167s --counters')
        self.told(f'info hps167s --port {sim}')
        (*changes, answered), = self.counters(sim, 'writes', 'flash_writes', 'resets', 'resets_refused',
                                              'answered')
        self.assertEqual(changes, [0] * 4)
        self.assertGreater(answered, 5)


class Change(Settings):
    def test_the_baud_rate_is_changed_and_followed(self):
        sim = self.sim('hps167s')
        out = self.told(f'set hps167s --port {sim} baud 115200')
        self.assertIn('baud is 115200 (was 19200)', out)
        self.assertIn(f'fathom read hps167s:1:modbus --port {sim} --baud 115200', out)
        self.assertEqual(self.json(f'get hps167s --port {sim} --baud 115200 baud')['baud'], 115200)
        self.ends(f'get hps167s --port {sim} baud', 1, 'no response')

    def test_without_confirmation_both_baud_rates_are_named(self):
        # frames 1 and 2 answer #2 for the user, 3 and 4 the driver; nothing is at 115200 yet; 5 acknowledges
        # the writing, and from then on all is lost
        sim = self.sim(f'hps167s --counters {lost(5, 30)}')
        self.told(f'set hps167s --port {sim} baud 115200',
                  'The sensor is at 19200 or at 115200 baud, perhaps from its next '
                  'power-on', f'fathom scan --port {sim} --baud 19200,115200', code=1)
        self.assertEqual(self.counters(sim, 'baud', 'writes'), [(115200, 1)])

    def change_address(self, device):
        sensor = device.split(':')[0]
        sim = self.sim(f'{device} --counters')
        out = self.told(f'set {sensor} --port {sim} address 5')
        self.assertIn('address is 5', out)
        self.assertIn(f'from now on: fathom read {sensor}:5:modbus', out)
        self.assertTrue(self.reads(f'{sensor}:5:modbus', sim))
        self.assertEqual(self.counters(sim, 'writes'), [(1,)])

    def test_an_address_is_changed_and_followed(self):
        self.change_address('a16:1:modbus')

    @e2e.each(an_address_of_an_a05_is_changed_and_followed='a05:1:modbus',
              an_address_of_an_hps167s_is_changed_and_followed='hps167s')
    def follow(self, device):
        self.change_address(device)

    def test_without_confirmation_both_addresses_are_named(self):
        sim = self.sim(f'a16:1:modbus --counters {lost(3, 20)}')
        self.told(f'set a16 --port {sim} address 5', 'The sensor is at address 1 or at address 5', code=1)
        self.assertEqual(self.counters(sim, 'address'), [(5,)])

    def test_an_address_in_use_is_not_given(self):
        sim = self.sim('a05:1:modbus a16:5:modbus --counters')
        self.told(f'set a05 --port {sim} address 5',
                  'not written: a sensor responds at address 5 already', code=1)
        self.assertEqual(self.counters(sim, 'writes'), [(0,), (0,)])

    def test_every_a05_gets_the_address_by_55_aa(self):
        sim = self.sim('a05:1:dyp')
        self.assertIn('address is 9', self.told(f'set a05 --port {sim} every-address 9'))
        self.assertEqual(len(self.reads('a05:9:dyp', sim)), 4)

    @e2e.each(**{f'what_is_so_already_is_not_written_{setting.split()[0]}': (device, setting) for device,
                 setting in (
        ('a16:1:modbus', 'switch-threshold 1000'), ('a05:1:modbus', 'address 1'),
        ('hps167s', 'termination on'))})
    def already(self, device, setting):
        sim = self.sim(f'{device} --counters')
        self.assertIs(self.json(f'set {device.split(":")[0]} --port {sim} {setting}')['written'], False)
        self.assertEqual(self.counters(sim, 'writes', 'flash_writes'), [(0, 0)])

    @e2e.each(**{f'every_setting_that_can_be_read_back_is_{name}': (device, name, value) for device, name,
                 value in (
        ('a16:1:modbus', 'switch-polarity', 'negative'), ('a16:1:modbus', 'switch-threshold', '2000'),
        ('a16:1:modbus', 'automatic-value', 'real-time'), ('hps167s', 'warm-up', '3'),
        ('hps167s', 'measure-after-power-on', 'off'), ('hps167s', 'termination', 'off'),
        ('hps167s', 'reconnect-time', '36'))})
    def read_back(self, device, name, value):
        sim, sensor = self.sim(device), device.split(':')[0]
        said = self.json(f'set {sensor} --port {sim} {name} {value}')
        shown = {'off': 'False'}.get(value, value)
        self.assertEqual((said['written'], said['confirmed'], str(said['value'])), (True, True, shown))
        self.assertEqual(str(self.json(f'get {sensor} --port {sim} {name}')[name.replace('-', '_')]), shown)

    @e2e.each(**{f'whatever_2_tells_can_be_set_{setting.split()[0]}': setting for setting in (
        'warm-up 3', 'measure-after-power-on off', 'termination off', 'reconnect-time 36', 'baud 57600')})
    def odd(self, setting):
        sim = self.sim('hps167s --with reconnect=1000 --with baud-code-00 --counters')
        self.assertRegex(self.told(f'get hps167s --port {sim} reconnect-time'), 'reconnect-time +1000 ms')
        self.told(f'set hps167s --port {sim} {setting}')
        self.assertEqual(self.counters(sim, 'writes'), [(1,)])

    def test_the_terminations_of_two_at_one_address_are_switched_off_at_once(self):
        sim = self.sim('hps167s hps167s --counters')
        line = f'set hps167s --port {sim} termination off --all-units'
        self.told(line, '--yes', code=2)
        self.assertEqual(self.told(f'{line} --yes'), 'all units: termination off: sent\n')
        self.assertEqual(self.counters(sim, 'writes', 'answered'), [(1, 0), (1, 0)])

    def test_a_setting_is_written_without_reading_anything(self):
        sim = self.sim('hps167s --counters')
        self.assertEqual(self.told(f'set hps167s --port {sim} termination off --blind'),
                         'hps167s:1: termination off: not confirmed\n')
        self.assertEqual(self.counters(sim, 'writes', 'answered'), [(1, 1)])

    def test_what_cannot_be_read_back_is_said_to_be_acknowledged(self):
        sim = self.sim('hps167s --distance 1000')
        for setting in ('distance-offset -15', 'filter-sensitivity 50', 'load-settings user'):
            self.assertIn('cannot be read back', self.told(f'set hps167s --port {sim} {setting}'))
        self.assertEqual(self.reads('hps167s', sim)[0]['distance_mm'], 985)

    def test_an_a16_returns_to_automatic_output(self):
        sim = self.sim('a16')
        self.told(f'info a16 --port {sim}')
        self.assertIn('frames are heard', self.told(f'set a16 --port {sim} automatic-output on'))
        self.assertEqual(len(self.reads('a16', sim, 2)), 2)

    def test_an_a16_that_does_not_send_afterwards_is_found_out(self):
        sim = self.sim('a16:1:modbus')
        self.told(f'set a16 --port {sim} automatic-output on', 'no frame was heard', code=1)
        self.assertIn('acknowledged', self.told(f'set a16 --port {sim} operating-mode controlled'))


class Failure(Settings):
    @e2e.each(**{'a_dead_line_is_explained_to_' + line.replace(' ', '_'): line for line in
                 ('info a16', 'get hps167s', 'get hps167s termination', 'set a05 address 5')})
    def dead(self, line):
        self.ends(f'{line} --port {self.device()}', 1, 'no byte was received', out='')

    def test_a_port_that_is_not_there(self):
        self.told('info a16 --port /nowhere', 'no such device', code=1)

    def test_a_lost_acknowledgement_does_not_matter_if_the_reading_confirms(self):
        sim = self.sim(f'a16:1:modbus {lost(3, 4)}')
        self.assertIn('2000 mm (was 1000)', self.told(f'set a16 --port {sim} switch-threshold 2000'))

    def test_a_setting_that_cannot_be_read_back_may_hold_or_not(self):
        sim = self.sim(f'a16:1:modbus {lost(3, 5)}')
        self.told(f'set a16 --port {sim} switch-threshold 2000', 'The value may be set or not', code=1)

    def test_a_full_output_is_said(self):
        sim = self.sim('a16:1:modbus')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'info a16 --port {sim}', 1, 'cannot write the output', stdout=full)


class Reset(Settings):
    RESTORE = '--yes-restore-factory-settings'

    def test_the_interface_gets_its_factory_settings_and_is_followed(self):
        sim = self.sim('hps167s:7 --counters')
        self.told(f'set hps167s:7 --port {sim} baud 57600')
        out = self.told(f'reset hps167s:7 --port {sim} --baud 57600 {self.RESTORE}')
        self.assertIn('address 1, 19200 8E1, termination on', out)
        self.assertEqual(len(self.reads('hps167s', sim)), 1)
        self.assertEqual(self.counters(sim, 'resets'), [(1,)])

    def test_the_sensor_loads_its_factory_settings(self):
        sim = self.sim('hps167s --distance 1000 --counters')
        self.told(f'set hps167s --port {sim} distance-offset -- -15')
        self.assertIn('acknowledged',
                      self.told(f'reset hps167s --port {sim} --yes-load-factory-sensor-settings'))
        self.assertEqual(self.reads('hps167s', sim)[0]['distance_mm'], 1000)

    def test_where_another_has_address_1_nothing_is_sent(self):
        sim = self.sim('hps167s:7 hps167s:1 --counters')
        self.told(f'reset hps167s:7 --port {sim} {self.RESTORE}', code=1)
        self.assertEqual(self.counters(sim, 'resets'), [(0,), (0,)])

    def test_without_confirmation_both_places_are_named(self):
        # frames 1 to 4 at most response #2 before; what follows is lost
        sim = self.sim(f'hps167s:7 --counters {lost(3, 30)}')
        self.told(f'reset hps167s:7 --port {sim} {self.RESTORE}',
                  'It is at address 1, 19200 8E1, or still at address 7, 19200 8E1', code=1)
        self.assertEqual(self.counters(sim, 'resets'), [(1,)])


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
