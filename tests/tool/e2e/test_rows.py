#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read as a log: a row for each attempt, handed over whole; files by day; and how little is said beside it."""
import csv
import os
import socket

import e2e

GOOD = e2e.SAYS_754
DAMAGED = bytes((*GOOD[:4], GOOD[4] ^ 0x10, *GOOD[5:]))
# In this order: no response, a wrong checksum, exception 2, two registers instead of one, a value over 16350 (A16).
SCRIPT = [GOOD, b'', DAMAGED, e2e.adu(1, 0x83, 2), e2e.registers(1, 754, 755), e2e.registers(1, 40000), GOOD]
STATUSES = ['target', 'no_response', 'damaged', 'exception', 'other_response', 'impossible_values', 'target']
HEADER = 'name,model,mode,address,probe,sequence,time_us,utc,status,interference,distance_mm,raw'


class Failures(e2e.Case):
    def ask(self, options, script=(*SCRIPT,)):
        device, reader = self.beside(f'read a16:1 --timeout 1000 --count {len(script)}', options.split())
        for response in script:
            device.asked(e2e.ASK_A16, response)
        return reader.finish()

    def test_each_attempt_is_a_row_of_csv_with_what_came_of_it(self):
        rows = self.ends(self.ask('--format csv'), 1).all_rows
        self.assertEqual([row['status'] for row in rows], STATUSES)
        for row in rows:
            self.assertEqual([row[name] for name in ('name', 'model', 'mode', 'address', 'probe')],
                             ['a16:1', 'a16', 'modbus', '1', '1'])
            self.assertRegex(row['utc'], r'^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z$')
            known = ['754', '754', 'false'] if row['status'] == 'target' else ['', '', '']
            self.assertEqual([row[name] for name in ('distance_mm', 'raw', 'interference')], known)
            self.assertEqual(row['sequence'] == '', row['status'] != 'target')
        times = [int(row['time_us']) for row in rows]
        self.assertEqual(times, sorted(times))
        # of the silent one it is when the time-out of 1 s was over
        self.assertGreaterEqual(times[1] - times[0], 1000000)

    def test_where_there_is_no_median_yet_a_failed_attempt_is_a_row(self):
        done = self.ends(self.ask('--format csv --median 3', [GOOD, b'', GOOD, GOOD]), 1)
        self.assertEqual([row['status'] for row in done.all_rows], ['no_response', 'target'])

    def test_an_attempt_of_four_probes_that_fails_as_a_whole_is_one_row_of_none(self):
        done = self.ends(f'read a05:2:modbus --port {self.device()} --timeout 60 --count 2 --format json', 1)
        self.assertEqual([(one['name'], one['probe'], one['status']) for one in done.all_json],
                         [('a05:2', None, 'no_response')] * 2)

    def test_a_sensor_that_sends_by_itself_is_stale(self):
        done = self.ends(f'read a16 --port {self.device()} --timeout 60 --count 2 --format csv', 1)
        self.assertEqual([(row['name'], row['address'], row['status']) for row in done.all_rows],
                         [('a16', '', 'stale')] * 2)


class Whole(e2e.Case):
    def writes(self, options):
        """What each write(2) has handed over: a socket of packets keeps them apart."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        sim = self.sim('a05:2:modbus,distance=1000,40000,1953,3562 hps167s:7,distance=2083')
        with ours:
            with theirs:
                reader = self.fathom(f'read a05:2 hps167s:7 --temperature --timeout 5000 --port {sim} --count 4 '
                                     f'{options}',
                                     ['--level', 'mounting=9000,height=8000,capacity=4000000000'], stdout=theirs)
            reader.finish()
            ours.settimeout(0)
            packets = []
            while packets[-1:] != [b'']:
                packets.append(ours.recv(65536))
        return [packet.decode() for packet in packets[:-1]]

    @e2e.each(csv=('--format csv', 1), json=('--format json', 0), text=('', 0))
    def write(self, options, header):
        packets = self.writes(options)
        rows = 4 + 4 * 3 + (4 if options else 0)  # the refused probe has none in text
        self.assertEqual(len(packets), header + rows)
        for packet in packets:
            self.assertEqual((packet.count('\n'), packet[-1]), (1, '\n'))


class Files(e2e.Case):
    def content(self, name):
        with open(self.path(name), encoding='ascii') as file:
            return file.read()

    def test_no_row_is_lost_or_truncated_at_midnight_and_each_is_in_the_file_of_its_day(self):
        sim = self.sim('hps167s:7 --distance 2083')
        os.mkdir(self.path('a.b'))
        for _ in range(2):  # 54 a second, so some on both sides; the second run adds to the files of the first
            self.ends(f'read hps167s:7 --port {sim} --count 100 --timeout 5000 --format csv --rotate day --output '
                      f'{self.path("a.b/tank.csv")}', 0, out='',
                      env=self.preload('clock_shim.c', MIDNIGHT_IN_US='1500000'))
        days = ('2026-02-28', '2026-03-01')
        self.assertEqual(sorted(os.listdir(self.path('a.b'))), [f'tank-{day}.csv' for day in days])
        sequences = []
        for day in days:
            header, *rows = self.content(f'a.b/tank-{day}.csv').splitlines()
            self.assertEqual(header, f'{HEADER},magnitude,ambient,precision')
            for row in csv.DictReader(rows, header.split(',')):
                self.assertEqual((row['utc'][:10], row['distance_mm'], row['precision']), (day, '2083', '0'))
                sequences.append(int(row['sequence']))
        self.assertEqual(sorted(sequences), sorted([*range(1, 101)] * 2))
        # The first reading of each run is of the first day, and its last one of the second.
        for day, sequence in zip(days, ('1', '100')):
            rows = self.content(f'a.b/tank-{day}.csv').splitlines()
            self.assertEqual([row['sequence'] for row in csv.DictReader(rows)].count(sequence), 2)

    def test_a_file_that_the_shell_adds_to_has_one_header(self):
        sim = self.sim('a16:1:modbus --distance 754')
        for options in ('', '--no-header'):
            with open(self.path('log.csv'), 'ab') as file:
                self.ends(f'read a16:1 --port {sim} --count 2 --format csv {options}', 0, stdout=file)
        self.assertEqual([line.split(',')[0] for line in self.content('log.csv').splitlines()], ['name'] + ['a16:1'] * 4)

    def test_a_file_that_is_emptied_meanwhile_goes_on_at_its_beginning(self):
        """As logrotate's copytruncate does."""
        sim, log = self.sim('hps167s:7 --distance 2083'), self.path('log.csv')
        reader = self.fathom(f'read hps167s:7 --port {sim} --format csv --output {log}')
        for _ in range(2):
            while not os.path.exists(log) or os.path.getsize(log) < 500:
                self.assertFalse(reader.has_ended(0.02))
            os.truncate(log, 0)
        while os.path.getsize(log) < 500:
            self.assertFalse(reader.has_ended(0.02))
        self.ends(reader.end(), 0)
        rows = self.content('log.csv').splitlines()
        self.assertEqual({row.split(',')[0] for row in rows}, {'hps167s:7'})

    def test_a_file_whose_header_has_other_columns_is_not_added_to(self):
        sim, log = self.sim('hps167s:7 --distance 2083'), self.path('log.csv')
        read = f'read hps167s:7 --port {sim} --count 1 --format csv --output {log}'
        with open(log, 'w', encoding='ascii') as file:
            file.write(f'{HEADER}\n')
        self.ends(read, 1, f'fathom: {log} has a header with other columns', out='')
        self.assertEqual(self.content('log.csv'), f'{HEADER}\n')
        self.ends(f'{read} --no-header', 0, out='')
        self.assertEqual(len(self.content('log.csv').splitlines()), 2)

    def test_text_is_not_added_to_a_file_of_csv(self):
        sim, log = self.sim('hps167s:7 --distance 2083'), self.path('log')
        with open(log, 'w', encoding='ascii') as file:
            file.write(f'{HEADER}\n')
        for form in ('text', 'json'):
            self.ends(f'read hps167s:7 --port {sim} --count 1 --format {form} --output {log}', 1,
                      f'fathom: {log} has the header of a CSV file. Append to it with --format csv', out='')
        self.assertEqual(self.content('log'), f'{HEADER}\n')

    @e2e.each(csv=('log.csv', '', '^name,'), json=('log.json', '', '^{"'), jsonl=('log.jsonl', '', '^{"'),
              text=('log.txt', '', '^ +0'), the_option_counts=('log.csv', '--format json', '^{"'))
    def ending(self, name, options, begin):
        """The ending of the file chooses the format."""
        sim = self.sim('hps167s:7 --distance 2083')
        self.ends(f'read hps167s:7 --port {sim} --count 1 --output {self.path(name)} {options}', 0, out='')
        self.assertRegex(self.content(name), begin)

    def test_one_without_a_header_is_added_to(self):
        sim, log = self.sim('hps167s:7 --distance 2083'), self.path('log.csv')
        for options in ('--no-header', ''):
            self.ends(f'read hps167s:7 --port {sim} --count 1 --format csv --output {log} {options}', 0, out='')
        self.assertEqual([line.split(',')[0] for line in self.content('log.csv').splitlines()], ['hps167s:7'] * 2)

    def test_a_pipe_gets_a_header(self):
        sim, pipe = self.sim('hps167s:7 --distance 2083'), self.path('pipe')
        os.mkfifo(pipe)
        end = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, end)
        self.ends(f'read hps167s:7 --port {sim} --count 1 --format csv --output {pipe}', 0, out='')
        self.assertTrue(os.read(end, 1000).startswith(f'{HEADER},magnitude'.encode()))

    def test_a_file_that_may_not_grow_ends_it_and_has_whole_rows(self):
        sim, log = self.sim('hps167s:7 --distance 2083'), self.path('log.csv')
        for limit in range(400, 480, 13):  # a row has some 80 bytes
            self.ends(self.start(['prlimit', f'--fsize={limit}', e2e.FATHOM, 'read', 'hps167s:7', '--port', str(sim),
                                  '--format', 'csv', '--output', log]), 1, f'{log}: File too large')
            self.assertLessEqual(os.path.getsize(log), limit)
            self.assertTrue(all(row.endswith(',723.1744,1,0') for row in self.content('log.csv').splitlines()[1:]))
            self.assertEqual(self.content('log.csv')[-1], '\n')

    @e2e.each(that_cannot_be_opened=('nowhere/log.csv', 'No such file or directory'),
              that_is_full=('/dev/full', 'No space left on device'))
    def file(self, name, words):
        self.ends(f'read a16 --port /nowhere --format csv --output {self.path(name)}', 1,
                  f'fathom: the readings cannot be written to {self.path(name)}: {words}\n', out='')


class Quiet(e2e.Case):
    def test_failures_and_remarks_are_not_told(self):
        done = self.ends(f'read a16:1 --port {self.device()} --timeout 60 --count 2 --interval 50 -q --format csv', 1)
        self.assertEqual((done.err, len(done.all_rows)), ('', 2))

    def test_nor_that_a_port_is_waited_for(self):
        done = self.ends(f'read a16:1 --port {self.path("none")} --reconnect --duration 1 --quiet', 0)
        self.assertEqual((done.out, done.err), ('', ''))

    @e2e.each(wrong_usage=('--count 0', 2, 'fathom read: --count is '),
              a_port_that_cannot_be_opened=('', 1, 'fathom: /nowhere: no such device'),
              an_output_that_is_broken=('--output /dev/full --format csv', 1, 'No space left'))
    def told(self, options, code, words):
        done = self.ends(f'read a16 --port /nowhere --quiet {options}', code, words)
        self.assertEqual(done.err.count('\n'), 1)

    def test_a_port_that_is_lost_for_good_is_told(self):
        device, reader = self.beside('read a16:1 --quiet')
        device.read(8)
        device.hang_up()
        self.assertEqual(self.ends(reader, 1, 'the device was unplugged').err.count('\n'), 1)

    def test_and_what_stats_asks_for(self):
        sim = self.sim('a16:1:modbus --distance 754')
        self.ends(f'read a16:1 --port {sim} --count 1 --quiet --stats', 0, 'fathom: attempts 1, failed 0, readings 1\n')


class Interval(e2e.Case):
    # A16 table 12: 120 ms; A05 3(3): 400 ms, 2(3)1: 250 ms, of one probe 100 ms; HPS-167S table 1: 54 a second
    @e2e.each(an_a16=('a16:1:modbus', '119', '120'), an_a05=('a05:1:modbus', '399', '400'),
              an_a05_by_55_aa=('a05:1:dyp', '249', '250'), one_probe_of_it=('a05:1:dyp --probes 1', '99', '100'),
              an_a16_that_is_triggered=('a16:1:controlled', '120', '121'),
              an_hps167s=('hps167s:1', '18', '18.52'))
    def raised(self, sensor, interval, least):
        sim = self.device()
        line = f'read {sensor} --port {sim} --timeout 60 --count 2 --interval'
        name = 'a16' if 'controlled' in sensor else ':'.join(sensor.split()[0].split(':')[:2])
        words = f'fathom: {name}: read every {least} ms, the shortest interval of this sensor (--interval {interval})\n'
        self.assertEqual(self.ends(f'{line} {interval}', 1).err.count(words), 1)
        self.assertNotIn('the shortest interval', self.run_fathom(f'{line} {int(interval) + 1}').err)

    def test_one_that_is_not_given_is_not_raised(self):
        self.assertNotIn('shortest interval', self.run_fathom(f'read a16:1 --port {self.device()} --timeout 60 --count 1').err)


class Port(e2e.Case):
    def test_the_environment_has_it_where_none_is_given(self):
        sim = self.sim('a16:1:modbus --distance 754')
        env = {**os.environ, 'FATHOM_PORT': str(sim)}
        for line in ('read a16:1 --count 1', 'get a16:1 address', 'scan --listen 1 --timeout 500 --baud 9600 --address 1'):
            self.ends(line, 0, env=env)
        done = self.ends('read a16:1 --count 1 -p /nowhere', 1, '/nowhere: no such device', env=env)
        self.assertNotIn('FATHOM_PORT', done.err)

    @e2e.each(*((line,) for line in ('read a16', 'get a16 address', 'scan', 'watch a16', 'info a16', 'save a16')))
    def named(self, line):
        self.ends(line, 1, '/nowhere: no such device', ' (FATHOM_PORT in the environment names this port)\n',
                  env={**os.environ, 'FATHOM_PORT': '/nowhere'})

    def test_an_empty_one_is_none(self):
        self.ends('read a16', 2, '--port is missing', env={**os.environ, 'FATHOM_PORT': ''})


if __name__ == '__main__':
    e2e.main()
