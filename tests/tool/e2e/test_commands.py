#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The commands for one sensor at real ports, terminals and files: what they change stays, other commands see it, and a
full output or a lost port ends them. What they print and write in each case is in test_tool_*.c."""
import os
import pty
import re
import signal

import e2e

FIRST = '00390025423457142034383501060705'  # HPS-167S #3: the example; the further ones count up from it
READ = e2e.adu(1, 3, 1, 1, 0, 1)  # A16 6(4), example 2
ALARM = 'near<500/600,unknown=off,no-response=on'
MEASURING = 'calibrate hps167s --known 2000 --dry-run --samples 150'
SETTINGS = 'save a16:1 --timeout 1000'


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

    def test_an_a16_returns_to_automatic_output(self):
        sim = self.sim('a16')
        self.assertEqual(self.json(f'info a16 --port {sim}')['switch_threshold'], 1000)
        self.ends(f'set a16 --port {sim} automatic-output on', 0)
        self.assertEqual(len(self.reads('a16', sim, 2)), 2)

    @e2e.each('info a16', 'get hps167s')
    def dead(self, line):
        self.ends(f'{line} --port {self.device()}', 1, 'no byte was received', out='')

    def test_a_full_output_is_said(self):
        sim = self.sim('a16:1:modbus')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'info a16 --port {sim}', 1, 'cannot write the output', stdout=full)


class Backup(e2e.Case):
    def on(self, command, sensor, sim, more='', code=0, *said, **options):
        return self.ends(f'{command} {sensor} --port {sim} --file {self.path("unit")} {more}', code, *said, **options).out

    def change(self, old, new):
        with open(self.path('unit'), encoding='ascii') as file:
            text = file.read()
        self.assertEqual(text.count(old), 1)
        with open(self.path('unit'), 'w', encoding='ascii') as file:
            file.write(text.replace(old, new))
        return text

    def writes(self, sim):
        return [one['writes'] for one in sim.end(signal.SIGINT).told]

    def test_an_output_that_is_full_leaves_no_file_and_writes_nothing(self):
        sim = self.sim('a16:1:modbus --counters')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'save a16 --port {sim}', 1, 'cannot write the output', stdout=full)
            os.mkdir(self.path('closed'), 0o555)
            if os.getuid() != 0:  # whom nothing is closed to
                self.ends(f'save a16 --port {sim} --file {self.path("closed/unit")}', 1, 'Permission denied')
            self.assertEqual(os.listdir(self.path('closed')), [])
            self.on('save', 'a16', sim)
            self.change('switch-threshold = 1000', 'switch-threshold = 2000')
            self.on('restore', 'a16', sim, '', 1, 'cannot write the output', stdout=full)
        self.assertEqual(self.writes(sim), [0])


class Commission(e2e.Case):
    def setUp(self):
        super().setUp()
        self.record = self.path('record.txt')

    def commission(self, sim, *line):
        return self.fathom('commission', *line, ['--port', sim.port, '--record', self.record])

    def units(self):
        """The lines of the record, without the date."""
        with open(self.record, encoding='ascii') as file:
            return [line.split()[:4] for line in file if not line.startswith('#')]

    def counters(self, sim):
        return self.ends(sim.end(signal.SIGINT), 0).told

    def test_three_units_one_by_one_interrupted_and_taken_up_again(self):
        sim = self.sim('hps167s hps167s hps167s --one-by-one --counters --distance 1234')
        first = self.commission(sim, 'hps167s --addresses 2-4')
        first.expect('writes termination off')
        first.expect('writes address 2')
        self.ends(first.end(signal.SIGINT), 1)
        self.assertEqual(self.units(), [['hps167s', '2', FIRST, 'planned']])
        second = self.commission(sim, 'hps167s --addresses 2-4')
        second.expect('address 2 is done: termination off from the next power-on, 1234 mm', seconds=60)
        sim.expect('sensor 2 is connected', 'err')
        second.expect('writes address 3', seconds=60)
        second.expect('address 3 is done')
        self.ends(second.end(signal.SIGINT), 1)
        self.assertIn('1 of 3' if 'address 3 is not done' in second.done.out else '2 of 3', second.done.out)
        done = self.commission(sim, 'hps167s --addresses 2-4').finish(60)
        self.ends(done, 0)
        self.assertIn('3 of 3 addresses are assigned and verified\n', done.out)
        self.assertEqual(self.units(), [['hps167s', str(2 + i), f'{FIRST[:-1]}{5 + i}', 'done'] for i in range(3)])
        self.assertEqual(os.listdir(self.folder), ['record.txt'])  # nothing of the way it is written is left
        counters = self.counters(sim)
        self.assertEqual([one['address'] for one in counters], [2, 3, 4])
        self.assertEqual([one['flash_writes'] for one in counters], [2, 2, 1])


class Calibrate(e2e.Case):
    def flash_writes(self, sim):
        return sim.end(signal.SIGINT).told[0]['flash_writes']

    @e2e.each(
        # 10 mm off, and 5 more by an old offset: -15, after which 5 are missing; -10
        a_device_that_replaces_is_made_right=('--distance 2010', 2, 'offset: -10 mm; flash writes: 2; #12 replaces'),
        a_device_that_adds_is_made_right=('--distance 2010 --with offset-adds', 1,
                                          'offset: -15 mm or the old offset minus 15 mm; flash writes: 1'))
    def made_right(self, device, writes, said):
        sim = self.sim(f'hps167s:7 {device} --counters')
        self.ends(f'set hps167s:7 --port {sim} distance-offset 5', 0)
        done = self.ends(f'calibrate hps167s:7 --port {sim} --known 2000 --samples 5', 0)
        self.assertIn(f'known 2000 mm; {said}', done.out)
        self.assertEqual(done.out.count('to flash'), writes)
        self.assertEqual(self.read_json(f'hps167s:7 --port {sim} --count 1')[0]['distance_mm'], 2000)
        self.assertEqual(self.flash_writes(sim), writes + 1)  # one by set

    def test_what_cannot_be_announced_is_not_written(self):
        sim = self.sim('hps167s --distance 2015 --counters')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'calibrate hps167s --port {sim} --known 2000', 1, 'cannot write the output; flash writes: 0',
                      stdout=full)
        self.assertEqual(self.flash_writes(sim), 0)


class Request(e2e.Case):
    def asked(self, response, options=''):
        device, request = self.beside('request 1 3 0x0101', options)
        device.asked(READ, response)
        return device, request

    def test_what_it_prints_is_what_decode_takes(self):
        _, request = self.asked(e2e.registers(1, 751))
        out = self.ends(request, 0).out
        for name in ('sent', 'received'):
            line = next(line for line in out.splitlines() if line.startswith(name))
            self.assertIn('CRC', self.ends(f'decode {line[len(name):]}', 0).out)

    def test_without_yes_nothing_leaves_and_the_port_is_not_opened(self):
        self.ends(f'request 1 6 0x0200 5 --port {self.path("none")}', 2, 'Nothing was sent yet. To confirm that, add --yes', out='')

    def test_a_lost_port_is_told(self):
        device, request = self.asked(b'', '--timeout 600000')
        device.hang_up()
        self.ends(request, 1, device.port)  # in 20 s, and not after its ten minutes

    def test_an_output_that_is_full_is_a_failure(self):
        with open('/dev/full', 'w', encoding='utf-8') as full:
            device, request = self.beside('request 1 3 0x0101', stdout=full)
            device.asked(READ, e2e.registers(1, 751))
            self.ends(request, 1, 'cannot write the output')


class Alarm(e2e.Case):
    def begin(self, port, options='--until-alarm'):
        return self.fathom(f'read a16 --mode modbus --port {port} --timeout 400', options,
                           ['--alarm', f'{ALARM},unknown-after=700'])

    def test_until_alarm_ends_with_3_when_the_port_is_lost_and_waited_for(self):
        port = self.path('port')
        device = self.device()
        os.symlink(device.port, port)
        reader = self.begin(port, '--until-alarm --reconnect')
        device.asked(e2e.ASK_A16, e2e.registers(1, 700))
        reader.expect('alarm off, 700 mm')
        os.unlink(port)
        device.hang_up()
        self.assertRegex(self.ends(reader, 3, 'Waiting').out, r'a16: alarm no_response \(on\)\n$')

    def test_a_port_that_is_lost_is_no_response_of_any_sensor(self):
        """Also of those that have just responded."""
        sim = self.sim('a16:1:modbus a16:2:modbus --distance 700', ['--link', self.path('line')])
        reader = self.fathom(f'read a16:1 a16:2 --reconnect --port {self.path("line")}',
                             ['--alarm', f'{ALARM},unknown-after=2500'])
        for sensor in ('a16:1', 'a16:2'):
            reader.expect(f'{sensor}: alarm off, 700 mm')
        sim.end(signal.SIGKILL)
        for sensor in ('a16:1', 'a16:2'):
            reader.expect(rf'{sensor}: alarm no_response \(on\)')
        self.assertNotIn('not known', reader.end(signal.SIGINT).out)

    def test_a_port_that_never_comes_is_no_response_too(self):
        done = self.ends(self.begin(self.path('none'), '--until-alarm --reconnect --format csv'), 3)
        self.assertEqual([(row['address'], row['alarm'], row['is_on']) for row in done.rows],
                         [('1', 'no_response', 'true')])


class Progress(e2e.Case):
    @e2e.each(save=(SETTINGS, b'reading the settings'), calibrate=(MEASURING, b'measuring'))
    def shown(self, line, doing):
        port = self.device() if 'a16' in line else self.sim('hps167s --distance 2015').port
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        program = self.fathom(f'{line} --port {port}', stderr=slave)
        os.close(slave)
        said = b''
        while e2e.is_ready(master, e2e.PATIENCE):
            try:
                said += os.read(master, 4096)
            except OSError:  # the last writer has gone
                break
        done = program.finish()
        self.assertNotIn('\r', done.out)
        seconds = [int(number) for number in re.findall(rb'\r' + doing + rb', (\d+) s\x1b\[K', said)]
        self.assertEqual((seconds[0], seconds), (2, sorted(seconds)))
        # the line is removed before anything else is printed
        self.assertRegex(said, rb' s\x1b\[K\r\x1b\[K(fathom: |$)')

    @e2e.each(save_in_a_pipe=(SETTINGS,), calibrate_in_a_pipe=(MEASURING,))
    def piped(self, line):
        port = self.device() if 'a16' in line else self.sim('hps167s --distance 2015').port
        self.assertNotIn('\r', self.run_fathom(f'{line} --port {port}').err)


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
