#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom info, get, set and reset, against simulated sensors: what they print, what they change, and what not."""
import json
import signal

import e2e


class Settings(e2e.Case):
    def told(self, *arguments, code=0):
        """Standard output; what it said on the standard error stands in self.err."""
        done = self.run_fathom(*arguments)
        self.err = done.err
        self.assertEqual(done.code, code, done.out + done.err)
        return done.out

    def json(self, *arguments, code=0):
        return json.loads(self.told(*arguments, '--format', 'json', code=code))

    def counters(self, sim):
        """What the simulated sensors have counted; ends them."""
        done = sim.end(signal.SIGINT)
        return [json.loads(line) for line in done.err.splitlines() if line.startswith('{')]


class What(Settings):
    def test_the_settings_of_a_sensor_are_listed_without_a_port(self):
        for sensor, words in (('a16', ['switch-threshold', '1 to 16350 mm', 'operating-mode (write-only)', '0x0202']),
                              ('a05', ['address', '1 to 254', 'every-address', 'EVERY A05']),
                              ('hps167s', ['19200, 57600, 115200, 230400', 'a multiple of 18', 'next power-on',
                                           'distance-offset (write-only)', '(#14)'])):
            out = self.told('get', sensor)
            for word in words:
                self.assertIn(word, out)

    def test_everything_that_an_hps167s_tells(self):
        # the examples of #3; a temperature of 77 degrees Fahrenheit is (77 - 32) * 5 / 9 = 25.0
        sim = self.sim('hps167s:7')
        self.assertEqual(self.json('info', 'hps167s:7', '--port', sim.port), {
            'sensor': 'hps167s', 'asked_at': 7, 'mode': 'modbus', 'line': '19200 8E1',
            'interface-version': '2.1.0 of 2020-09-27', 'sensor-version': '3.9 of 2019-09-23',
            'uuid': '00390025423457142034383501060705', 'temperature': 25.0, 'baud': 19200, 'warm-up': 0,
            'measure-after-power-on': 'on', 'termination': 'on', 'reconnect-time': 180})

    def test_a_termination_resistor_that_is_on_is_remarked(self):
        sim = self.sim('hps167s')
        self.assertIn('termination                on', self.told('info', 'hps167s', '--port', sim.port))
        self.assertIn('termination off', self.err)
        self.told('set', 'hps167s', '--port', sim.port, 'termination', 'off')
        self.told('info', 'hps167s', '--port', sim.port)
        self.assertNotIn('resistor', self.err)

    def test_everything_that_an_a16_tells(self):
        sim = self.sim('a16:1:modbus', '--distance', '754')
        self.assertEqual(self.json('info', 'a16', '--port', sim.port), {
            'sensor': 'a16', 'asked_at': 1, 'mode': 'modbus', 'line': '9600 8N1', 'address': 1,
            'switch-polarity': 'positive', 'switch-threshold': 1000, 'automatic-value': 'processed', 'distance': 754,
            'real-time-distance': 754})

    def test_everything_that_an_a05_tells(self):
        sim = self.sim('a05:3:modbus', '--distance', '1000,2000,1953,no-target')
        self.assertEqual(self.json('info', 'a05:3', '--port', sim.port), {
            'sensor': 'a05', 'asked_at': 3, 'mode': 'modbus', 'line': '9600 8N1', 'address': 3,
            'distances': '1000, 2000, 1953, no target'})

    def test_one_setting_is_told_alone(self):
        sim = self.sim('hps167s')
        self.assertEqual(self.told('get', 'hps167s', '--port', sim.port, 'reconnect-time').splitlines()[1].split(),
                         ['reconnect-time', '180', 'ms'])

    def test_what_is_told_changes_nothing(self):
        sim = self.sim('hps167s', '--counters')
        self.told('info', 'hps167s', '--port', sim.port)
        counted = self.counters(sim)[0]
        self.assertEqual((counted['writes'], counted['flash_writes'], counted['resets'], counted['resets_refused']),
                         (0, 0, 0, 0))
        self.assertGreater(counted['answered'], 5)


class Change(Settings):
    def test_the_baud_rate_is_changed_and_followed(self):
        sim = self.sim('hps167s')
        out = self.told('set', 'hps167s', '--port', sim.port, 'baud', '115200')
        self.assertIn('baud is 115200 (was 19200)', out)
        self.assertIn(f'fathom read hps167s:1:modbus --port {sim.port} --baud 115200', out)
        self.assertEqual(self.json('get', 'hps167s', '--port', sim.port, '--baud', '115200', 'baud')['baud'], 115200)
        self.assertIn('no answer', self.told('get', 'hps167s', '--port', sim.port, 'baud', code=1) + self.err)

    def test_without_confirmation_both_baud_rates_are_named(self):
        # frames 1 and 2 answer #2 for the user, 3 and 4 the driver; nothing is at 115200 yet; 5 acknowledges the
        # writing, and from then on all is lost
        lost = [word for frame in range(5, 30) for word in ('--fault', f'silence=1@{frame}')]
        sim = self.sim('hps167s', '--counters', *lost)
        self.told('set', 'hps167s', '--port', sim.port, 'baud', '115200', code=1)
        self.assertIn('it is at 19200 or at 115200 baud, perhaps from the next power-on', self.err)
        self.assertIn(f'fathom scan --port {sim.port} --baud 19200,115200', self.err)
        counted = self.counters(sim)[0]
        self.assertEqual((counted['baud'], counted['writes']), (115200, 1))

    def test_an_address_is_changed_and_followed(self):
        for device, sensor in (('a16:1:modbus', 'a16'), ('a05:1:modbus', 'a05'), ('hps167s', 'hps167s')):
            sim = self.sim(device, '--counters')
            out = self.told('set', sensor, '--port', sim.port, 'address', '5')
            self.assertIn('address is 5', out)
            self.assertIn(f'from now on: fathom read {sensor}:5:modbus', out)
            self.assertEqual(len(self.read_json(f'{sensor}:5:modbus', '--port', sim.port, '--count', '1')) > 0, True)
            self.assertEqual(self.counters(sim)[0]['writes'], 1)

    def test_without_confirmation_both_addresses_are_named(self):
        lost = [word for frame in range(3, 20) for word in ('--fault', f'silence=1@{frame}')]
        sim = self.sim('a16:1:modbus', '--counters', *lost)
        self.told('set', 'a16', '--port', sim.port, 'address', '5', code=1)
        self.assertIn('it is at address 1 or at address 5', self.err)
        self.assertEqual(self.counters(sim)[0]['address'], 5)

    def test_an_address_in_use_is_not_given(self):
        sim = self.sim('a05:1:modbus', 'a16:5:modbus', '--counters')
        self.told('set', 'a05', '--port', sim.port, 'address', '5', code=1)
        self.assertIn('a device answers at address 5 already, so nothing was changed', self.err)
        self.assertEqual([counted['writes'] for counted in self.counters(sim)], [0, 0])

    def test_every_a05_gets_the_address_by_55_aa(self):
        sim = self.sim('a05:1:dyp')
        self.assertIn('address is 9', self.told('set', 'a05', '--port', sim.port, 'every-address', '9'))
        self.assertEqual(len(self.read_json('a05:9:dyp', '--port', sim.port, '--count', '1')), 4)

    def test_what_is_so_already_is_not_written(self):
        for device, sensor, setting, value in (('a16:1:modbus', 'a16', 'switch-threshold', '1000'),
                                               ('a05:1:modbus', 'a05', 'address', '1'),
                                               ('hps167s', 'hps167s', 'termination', 'on')):
            sim = self.sim(device, '--counters')
            said = self.json('set', sensor, '--port', sim.port, setting, value)
            self.assertIs(said['written'], False)
            counted = self.counters(sim)[0]
            self.assertEqual((counted['writes'], counted['flash_writes']), (0, 0))

    def test_every_setting_that_can_be_read_back_is(self):
        for device, sensor, changes in (
                ('a16:1:modbus', 'a16', [('switch-polarity', 'negative'), ('switch-threshold', '2000'),
                                         ('automatic-value', 'real-time')]),
                ('hps167s', 'hps167s', [('warm-up', '3'), ('measure-after-power-on', 'off'), ('termination', 'off'),
                                        ('reconnect-time', '36')])):
            sim = self.sim(device)
            for setting, value in changes:
                said = self.json('set', sensor, '--port', sim.port, setting, value)
                self.assertEqual((said['written'], said['confirmed'], str(said['value'])), (True, True, value))
                got = self.json('get', sensor, '--port', sim.port, setting)
                self.assertEqual(str(got[setting]), value)

    def test_what_cannot_be_read_back_is_said_to_be_acknowledged(self):
        sim = self.sim('hps167s', '--distance', '1000')
        for setting, value in (('distance-offset', '-15'), ('filter-sensitivity', '50'), ('load-settings', 'user')):
            out = self.told('set', 'hps167s', '--port', sim.port, setting, value)
            self.assertIn('cannot be read back', out)
        self.assertEqual(self.read_json('hps167s', '--port', sim.port, '--count', '1')[0]['distance_mm'], 985)

    def test_an_a16_returns_to_automatic_output(self):
        sim = self.sim('a16')
        self.told('info', 'a16', '--port', sim.port)
        self.assertIn('frames are heard', self.told('set', 'a16', '--port', sim.port, 'automatic-output', 'on'))
        self.assertEqual(len(self.read_json('a16', '--port', sim.port, '--count', '2')), 2)

    def test_an_a16_that_does_not_send_afterwards_is_found_out(self):
        sim = self.sim('a16:1:modbus')
        self.told('set', 'a16', '--port', sim.port, 'automatic-output', 'on', code=1)
        self.assertIn('no frame was heard', self.err)
        self.assertIn('acknowledged', self.told('set', 'a16', '--port', sim.port, 'operating-mode', 'controlled'))


class Failure(Settings):
    def test_a_dead_line_is_explained(self):
        device = self.device()
        for command in (('info', 'a16'), ('get', 'hps167s', 'termination'), ('set', 'a05', 'address', '5')):
            self.assertEqual(self.told(*command, '--port', device.path, code=1), '')
            self.assertIn('nothing was heard at all', self.err)

    def test_a_port_that_is_not_there(self):
        self.told('info', 'a16', '--port', self.path('nowhere'), code=1)
        self.assertIn('no such device', self.err)

    def test_a_lost_acknowledgement_does_not_matter_if_the_reading_confirms(self):
        sim = self.sim('a16:1:modbus', '--fault', 'silence=1@3')
        self.assertIn('2000 mm (was 1000)', self.told('set', 'a16', '--port', sim.port, 'switch-threshold', '2000'))

    def test_a_setting_that_cannot_be_read_back_may_hold_or_not(self):
        sim = self.sim('a16:1:modbus', '--fault', 'silence=1@3', '--fault', 'silence=1@4')
        self.told('set', 'a16', '--port', sim.port, 'switch-threshold', '2000', code=1)
        self.assertIn('it may hold or not', self.err)

    def test_wrong_words_are_usage_errors(self):
        port = self.path('nowhere')
        for words, said in ((('get', 'a17'), "no sensor 'a17'"),
                            (('get', 'a16', '--port', port), 'which setting?'),
                            (('get', 'a16', '--port', port, 'colour'), "no setting 'colour'"),
                            (('get', 'a16', '--port', port, 'operating-mode'), 'write-only'),
                            (('get', 'a16', 'address'), '--port is missing'),
                            (('set', 'a16', '--port', port), 'which setting?'),
                            (('set', 'a16', '--port', port, 'address'), 'a value is missing'),
                            (('set', 'a16', '--port', port, 'address', '0'), '1 to 254'),
                            (('set', 'a16', '--port', port, 'address', '255'), '1 to 254'),
                            (('set', 'a16', '--port', port, 'address', '5x'), '1 to 254'),
                            (('set', 'a16', '--port', port, 'distance', '5'), 'cannot be set'),
                            (('set', 'hps167s', '--port', port, 'address', '33'), '1 to 32'),
                            (('set', 'hps167s', '--port', port, 'reconnect-time', '19'), 'a multiple of 18'),
                            (('set', 'hps167s', '--port', port, 'baud', '9600'), '57600'),
                            (('set', 'a05', '--mode', 'modbus', '--port', port, 'every-address', '5'), '--mode dyp'),
                            (('info', 'a16:1:auto', '--port', port), 'nothing is asked'),
                            (('info', 'a16', 'a05', '--port', port), 'one sensor at a time'),
                            (('reset', 'a16', '--port', port, '--yes-restore-factory-settings'), 'only an hps167s'),
                            (('reset', 'hps167s', '--port', port), '--yes-restore-factory-settings')):
            self.told(*words, code=2)
            self.assertIn(said, self.err)

    def test_a_full_output_is_said(self):
        sim = self.sim('a16:1:modbus')
        with open('/dev/full', 'w', encoding='ascii') as full:
            done = self.run_fathom('info', 'a16', '--port', sim.port, stdout=full)
        self.assertEqual(done.code, 1)
        self.assertIn('cannot be written', done.err)


class Reset(Settings):
    def test_the_interface_gets_its_factory_settings_and_is_followed(self):
        sim = self.sim('hps167s:7', '--counters')
        self.told('set', 'hps167s:7', '--port', sim.port, 'baud', '57600')
        out = self.told('reset', 'hps167s:7', '--port', sim.port, '--baud', '57600', '--yes-restore-factory-settings')
        self.assertIn('address 1, 19200 8E1, termination on', out)
        self.assertEqual(len(self.read_json('hps167s', '--port', sim.port, '--count', '1')), 1)
        self.assertEqual(self.counters(sim)[0]['resets'], 1)

    def test_the_sensor_loads_its_factory_settings(self):
        sim = self.sim('hps167s', '--distance', '1000', '--counters')
        self.told('set', 'hps167s', '--port', sim.port, 'distance-offset', '--', '-15')
        self.assertIn('acknowledged', self.told('reset', 'hps167s', '--port', sim.port,
                                                '--yes-load-factory-sensor-settings'))
        self.assertEqual(self.read_json('hps167s', '--port', sim.port, '--count', '1')[0]['distance_mm'], 1000)

    def test_where_another_has_address_1_nothing_is_sent(self):
        sim = self.sim('hps167s:7', 'hps167s:1', '--counters')
        self.told('reset', 'hps167s:7', '--port', sim.port, '--yes-restore-factory-settings', code=1)
        self.assertEqual([counted['resets'] for counted in self.counters(sim)], [0, 0])

    def test_without_confirmation_both_places_are_named(self):
        # frames 1 to 4 at most answer #2 before; what follows is lost
        lost = [word for frame in range(3, 30) for word in ('--fault', f'silence=1@{frame}')]
        sim = self.sim('hps167s:7', '--counters', *lost)
        self.told('reset', 'hps167s:7', '--port', sim.port, '--yes-restore-factory-settings', code=1)
        self.assertIn('it is at address 1, 19200 8E1, or still at address 7, 19200 8E1', self.err)
        self.assertEqual(self.counters(sim)[0]['resets'], 1)


if __name__ == '__main__':
    e2e.main()
