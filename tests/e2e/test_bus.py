#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Several sensors on one pair: fathom read in one loop, also at different line settings; who is named, who is counted,
who is left alone; and examples/bus.c."""
import collections
import json
import os
import re
import signal
import threading

import e2e
import tcp_server

BUILD = os.environ.get('FATHOM_BUILD') or os.path.dirname(e2e.FATHOM)
BUS = ['a16:1:modbus', 'a05:2:modbus', 'hps167s:7']
SEEN = ['--distance', '1@1953', '--distance', '2@1000,2000,no-target,3562', '--distance', '3@2083']
ASK_A16 = bytes.fromhex('01 03 01 00 00 01 85 F6')  # A16 6(4) ex 1
ASK_HPS = bytes.fromhex('01 03 00 08 00 04 C5 CB')  # HPS table 17
ANSWER_754 = bytes.fromhex('01 03 02 02 F2 38 A1')  # A16 6(4) ex 1
ANSWER_2083 = bytes.fromhex('01 03 08 08 23 DC B2 07 01 00 00 FD 41')  # HPS table 18


def objects(text):
    return [json.loads(line) for line in text.splitlines() if line.startswith('{')]


class Read(e2e.Case):
    def bus(self, *arguments):
        return self.sim(*BUS, *SEEN, *arguments)

    def test_three_models_with_two_line_settings_are_read_in_one_loop(self):
        sim = self.bus()
        done = self.run_fathom('read', *BUS, '--port', sim.port, '--count', 4, '--format', 'json')
        self.assertEqual(done.code, 0, done.err)
        got = collections.Counter((o['sensor'], o['mode'], o['address'], o['probe'], o['status'], o['distance_mm'])
                                  for o in objects(done.out))
        self.assertEqual(got, collections.Counter({('a16', 'modbus', 1, 1, 'target', 1953): 4,
                                                   ('a05', 'modbus', 2, 1, 'target', 1000): 4,
                                                   ('a05', 'modbus', 2, 2, 'target', 2000): 4,
                                                   ('a05', 'modbus', 2, 3, 'no_target', None): 4,
                                                   ('a05', 'modbus', 2, 4, 'target', 3562): 4,
                                                   ('hps167s', 'modbus', 7, 1, 'target', 2083): 4}))
        self.assertEqual(done.err.splitlines(), [
            'fathom: attempts 12, failed 0, readings 24', 'fathom: a16:1: attempts 4, failed 0, readings 4',
            'fathom: a05:2: attempts 4, failed 0, readings 16', 'fathom: hps167s:7: attempts 4, failed 0, readings 4',
            'fathom: line: answers 12'])

    def test_each_line_of_text_names_sensor_and_address(self):
        sim = self.bus()
        done = self.run_fathom('read', *BUS, '--port', sim.port, '--count', 1)
        lines = [re.sub(r'^ *[\d.]+ s  ', '', line) for line in done.out.splitlines()]
        self.assertEqual(sorted(line.split('  ')[0] for line in lines),
                         ['a05:2 probe 1', 'a05:2 probe 2', 'a05:2 probe 3', 'a05:2 probe 4', 'a16:1', 'hps167s:7'])

    def test_a_table_has_the_columns_of_all(self):
        sim = self.bus()
        done = self.run_fathom('read', 'a16:1', 'hps167s:7', '--port', sim.port, '--count', 1, '--format', 'csv')
        header, *rows = [line.split(',') for line in done.out.splitlines()]
        self.assertEqual(header[-3:], ['magnitude', 'ambient', 'precision'])
        self.assertEqual({row[0]: row[-3:] for row in rows}, {'a16': ['', '', ''], 'hps167s': ['723.1744', '1', '0']})
        self.assertEqual({len(row) for row in rows}, {len(header)})

    def test_each_request_leaves_at_the_rate_of_its_sensor(self):
        """Both have the factory's address, which is no conflict at two rates."""
        device = self.device()
        rates = collections.defaultdict(set)
        reader = self.fathom('read', 'a16:1', 'hps167s:1', '--port', device.path, '--count', 3, '--format', 'json')
        for _ in range(6):
            asked = device.read(8)
            rates[asked].add(device.baud())
            device.write(ANSWER_754 if asked == ASK_A16 else ANSWER_2083)
        done = reader.finish()
        self.assertEqual(done.code, 0, done.err)
        self.assertEqual(rates, {ASK_A16: {e2e.termios.B9600}, ASK_HPS: {e2e.termios.B19200}})
        self.assertEqual(sorted((o['sensor'], o['distance_mm']) for o in objects(done.out)),
                         [('a16', 754)] * 3 + [('hps167s', 2083)] * 3)

    def test_one_rate_for_all_if_that_is_asked_for(self):
        device = self.device()
        reader = self.fathom('read', 'a16:1', 'hps167s:2', '--port', device.path, '--baud', 57600, '--count', 1,
                             '--timeout', 50)
        for _ in range(2):
            device.read(8)
            self.assertEqual(device.baud(), e2e.termios.B57600)
        self.assertEqual(reader.finish().code, 1)

    def test_a_form_with_colons_is_the_form_with_options(self):
        sim = self.sim('a16:5:modbus', '--distance', '754')
        for words in (['a16:5:modbus'], ['a16:5'], ['a16', '--address', 5, '--mode', 'modbus']):
            one, = self.read_json(*words, '--port', sim.port, '--count', 1)
            self.assertEqual((one['mode'], one['address'], one['distance_mm']), ('modbus', 5, 754))

    def test_the_end_comes_after_so_many_seconds(self):
        sim = self.bus()
        done = self.run_fathom('read', *BUS, '--port', sim.port, '--duration', 2)
        self.assertEqual(done.code, 0, done.err)
        self.assertTrue(2 <= done.elapsed < 8, done.elapsed)
        self.assertGreaterEqual(len(done.out.splitlines()), 6)


class Dead(e2e.Case):
    """One of three does not answer."""

    def answer(self, device, stop, requests):
        """As an A16 at address 1 and an A05 at 3 do; nobody is at address 2."""
        while not stop.is_set():
            if not e2e.select.select([device.master], [], [], 0.02)[0]:
                continue
            asked = device.read(8)
            requests.append(asked[0])
            if asked[0] != 2:
                device.write(e2e.registers(asked[0], *[754] * asked[5]))

    def read(self, *arguments):
        device = self.device()
        requests = []
        stop = threading.Event()
        thread = threading.Thread(target=self.answer, args=(device, stop, requests))
        thread.start()
        try:
            done = self.run_fathom('read', 'a16:1', 'a16:2', 'a05:3', '--port', device.path, *arguments)
        finally:
            stop.set()
            thread.join()
        return done, collections.Counter(requests)

    def test_it_is_named_and_left_alone_and_the_others_are_read(self):
        done, requests = self.read('--duration', 8, '--timeout', 500, '--stats', '--format', 'json')
        self.assertEqual(done.code, 1)
        for line in done.err.splitlines():
            if 'attempt ' in line:
                self.assertRegex(line, r'^fathom: a16:2: attempt \d+: no answer from address 2: ')
        # The first attempt may come before anybody has answered.
        self.assertIn('nothing was heard of it, while others on this line answer; check its supply', done.err)
        stats, = objects(done.err)
        units = {one['address']: one for one in stats['units']}
        self.assertEqual([(one['sensor'], one['mode'], one['address']) for one in stats['units']],
                         [('a16', 'modbus', 1), ('a16', 'modbus', 2), ('a05', 'modbus', 3)])
        # After the third silence it is left alone for one time-out of 0.5 s, then for 2, 4 and 8 (modbus_unit.h). So it is
        # asked at 0, 1, 2, 4, 7, 12 and 21 time-outs at the earliest, and 8 s are 16.
        self.assertIn(requests[2], (4, 5, 6))
        self.assertEqual(units[2]['silences'], units[2]['failures'])
        self.assertEqual((units[2]['answers'], units[2]['readings'], units[2]['answer_us']), (0, 0, None))
        self.assertTrue(0 <= units[2]['alone_us'] <= 4000000)
        self.assertTrue(max(one['alone_us'] for one in units.values()) == units[2]['alone_us'])
        for address in (1, 3):
            self.assertEqual((units[address]['silences'], units[address]['alone_us'], units[address]['failed']), (0, 0, 0))
            self.assertGreater(units[address]['answer_us']['min'], 0)
        # 120 ms and 400 ms are their periods; of eight seconds the dead one took 3 s at most.
        self.assertGreaterEqual(requests[1], 10)
        self.assertGreaterEqual(requests[3], 6)
        self.assertEqual(stats['unit'], {'answers': units[1]['answers'] + units[3]['answers'], 'failures': units[2]['failures']})
        self.assertEqual(stats['attempts'], sum(one['attempts'] for one in stats['units']))
        self.assertEqual(stats['requests'], sum(requests.values()))

    def test_text_tells_the_same_of_each(self):
        done, requests = self.read('--count', 4, '--timeout', 300, '--stats')
        lines = done.err.splitlines()
        self.assertEqual(requests, {1: 4, 2: 4, 3: 4})
        self.assertTrue(any(re.match(r'fathom: a16:1: attempts 4, failed 0, readings 4, answers 4, failures 0, silences in a '
                                     r'row 0, left alone for 0\.0 s, time to answer: shortest [\d.]+ ms', line) for line in lines))
        self.assertTrue(any(re.fullmatch(r'fathom: a16:2: attempts 4, failed 4, readings 0, answers 0, failures 4, silences in '
                                         r'a row 4, left alone for 0\.[56] s', line) for line in lines), done.err)
        self.assertTrue(any(line.startswith('fathom: a05:3: attempts 4, failed 0, readings 16, ') for line in lines))

    def test_the_last_words_name_it_too(self):
        done, _ = self.read('--count', 3, '--timeout', 300)
        self.assertRegex(done.err, r'(?m)^fathom: a16:2: attempts 3, failed 3, readings 0, silences in a row 3, left alone for')
        self.assertRegex(done.err, r'(?m)^fathom: a16:1: attempts 3, failed 0, readings 3$')

    def test_the_only_one_on_a_line_is_asked_again_and_again(self):
        device = self.device()
        done = self.run_fathom('read', 'a16:2', '--port', device.path, '--timeout', 60, '--count', 8, '--stats', '--format', 'json')
        one, = objects(done.err)[0]['units']
        self.assertEqual((one['failed'], one['answers']), (8, 0))
        self.assertLessEqual(one['alone_us'], 1)

    def test_a_late_answer_explains_the_failure_of_its_unit_alone(self):
        """Address 2 answers when its time is over, while address 3, where nobody is, is being asked."""
        device = self.device()
        reader = self.fathom('read', 'a16:2', 'a16:3', '--port', device.path, '--timeout', 400, '--count', 2)
        errors = []
        for _ in range(4):
            asked = device.read(8)
            if asked[0] == 2:
                errors.append(reader.expect('a16:2: attempt', 'err').string)
                device.write(e2e.registers(2, 754))
        errors += reader.finish().err.splitlines()
        told = [line for line in errors if 'attempt 2' in line]
        self.assertTrue(any('a16:2: attempt 2: no answer from address 2: it answers, but too late' in line for line in told), errors)
        self.assertTrue(any(re.search('a16:3: attempt 2: no answer from address 3: (?!it answers)', line) for line in told), errors)
        self.assertFalse(any('address 2 that was heard' in line for line in errors), errors)


class Gateway(e2e.Case):
    """Over TCP: the line and its settings are the gateway's."""

    def test_several_sensors_behind_a_gateway_are_read_in_one_loop(self):
        server = tcp_server.Server()
        self.addCleanup(server.close)
        reader = self.fathom('read', 'a16:1', 'hps167s:7', '--port', server.path, '--count', 2, '--timeout', 5000, '--format',
                             'json')
        server.accept()
        asked = []
        for _ in range(4):
            request = server.request()
            asked.append((request[6], request[8:].hex()))  # unit, first register and count
            values = (754,) if request[6] == 1 else (0x0823, 0xDCB2, 0x0701, 0)  # HPS-167S table 18
            server.say(tcp_server.registers(int.from_bytes(request[:2], 'big'), request[6], *values))
        done = reader.finish()
        self.assertEqual(done.code, 0, done.err)
        self.assertEqual(sorted(asked), [(1, '01000001')] * 2 + [(7, '00080004')] * 2)
        self.assertEqual(sorted((o['sensor'], o['address'], o['distance_mm']) for o in objects(done.out)),
                         [('a16', 1, 754)] * 2 + [('hps167s', 7, 2083)] * 2)

    def test_one_address_is_one_sensor_there(self):
        done = self.run_fathom('read', 'a16:1', 'hps167s:1', '--port', 'tcp:127.0.0.1:1')
        self.assertEqual(done.code, 2)
        self.assertIn('a16:1 and hps167s:1 have the same address', done.err)


class Port(e2e.Case):
    def test_the_loss_of_the_port_is_told_once_and_ends_it(self):
        device = self.device()
        reader = self.fathom('read', 'a16:1', 'hps167s:2', '--port', device.path)
        device.read(8)
        device.hang_up()
        done = reader.finish()
        self.assertEqual(done.code, 1)
        self.assertEqual(len(re.findall('attempt', done.err)) - len(re.findall('attempts', done.err)), 1, done.err)
        self.assertNotRegex(done.err, r'a16:1: attempt \d')

    def test_ctrl_c_ends_it_in_order(self):
        sim = self.sim(*BUS, *SEEN)
        reader = self.fathom('read', *BUS, '--port', sim.port)
        reader.expect('hps167s:7')
        done = reader.end(signal.SIGINT)
        self.assertEqual(done.code, 0, done.err)


# arguments, what the line must have
WRONG = [
    (['a16', 'a05:2:auto'], 'a05 in mode auto sends by itself and cannot share a line with others; ask it, such as a05:2:modbus'),
    (['a16:1:modbus', 'a16:1:modbus'], 'a16:1 and a16:1 have the same address, so both would answer at once'),
    (['a16:1', 'a05:1'], 'a16:1 and a05:1 have the same address'),
    (['a05:1:modbus', 'a05:2:dyp'], 'a damaged answer in mode dyp can change the address of another a05 on the line; ask them '
                                    'all by Modbus, such as a05:2:modbus'),
    (['a16:1', 'a05:2', '--address', '5'], 'with several sensors --address and --mode stand behind each name'),
    (['a16:1', 'a05:2', '--mode', 'modbus'], 'with several sensors --address and --mode stand behind each name'),
    (['a16:1', '--address', '5'], "'a16:1' and an option say the same; leave one of them out"),
    (['a16:1:modbus', '--mode', 'auto'], "'a16:1:modbus' and an option say the same"),
    (['a16:0'], "the address of a16 is a number from 1 to 254, not '0'"),
    (['hps167s:33'], "the address of hps167s is a number from 1 to 32, not '33'"),
    (['a16:1:dyp'], "there is no mode 'dyp' for a16, only auto, modbus"),
    (['a16:1:'], "there is no mode '' for a16"),
    ([f'a16:{address}' for address in range(1, 34)], 'a line has 32 sensors at most'),
    (['a16', '--duration', '0'], '--duration takes a whole number from 1 to 1000000000'),
]


class Wrong(e2e.Case):
    def test_what_cannot_be_is_said_before_anything_is_sent(self):
        for arguments, words in WRONG:
            with self.subTest(arguments=arguments):
                done = self.run_fathom('read', *arguments, '--port', '/nowhere')
                self.assertEqual((done.code, done.out, len(done.err.splitlines())), (2, '', 1), done.err)
                self.assertIn(words, done.err)


class Example(e2e.Case):
    def run_example(self, *arguments):
        return self.start(os.path.join(BUILD, 'examples', 'example_bus'), *arguments).finish()

    def test_it_reads_three_sensors_while_one_comes_and_goes(self):
        done = self.run_example()
        self.assertEqual((done.code, done.err), (0, ''))
        before, between, after = re.split('-- .*\n', done.out)
        for part, has_a05 in ((before, True), (between, False), (after, True)):
            got = set(re.findall(r' s  (\S+) +probe (\d)  +(\d+ mm|no target)', part))
            expected = {('A16', '1', '1953 mm'), ('HPS-167S', '1', '2083 mm')}
            if has_a05:
                expected |= {('A05', '1', '1000 mm'), ('A05', '2', '2000 mm'), ('A05', '3', 'no target'), ('A05', '4', '3562 mm')}
            self.assertEqual(got, expected)
        # 600 ms of time-out, once more until its late answer can no longer come; left alone after the third, for 0.6 s
        failures = re.search(r'A05 +answers \d+, failures (\d+), silences in a row (\d+), left alone for ([\d.]+) s', between)
        self.assertEqual(failures[1], failures[2])
        self.assertGreaterEqual(int(failures[1]), 3)
        self.assertRegex(after, r'A05 +answers \d+, failures \d+, silences in a row 0, left alone for 0\.0 s')
        self.assertRegex(after, r'A16 +answers \d+, failures 0, ')
        self.assertRegex(after, r'HPS-167S answers \d+, failures 0, ')

    def test_it_reads_a_port_too(self):
        sim = self.sim('a16:1:modbus', 'a05:2:modbus', 'hps167s:7', *SEEN)
        done = self.run_example(sim.port, '2')
        self.assertEqual((done.code, done.err), (0, ''))
        for words in ('A16      probe 1   1953 mm', 'A05      probe 4   3562 mm', 'HPS-167S probe 1   2083 mm'):
            self.assertIn(words, done.out)

    def test_a_port_that_is_not_there_is_said(self):
        done = self.run_example('/nowhere')
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertIn('/nowhere', done.err)


if __name__ == '__main__':
    e2e.main()
