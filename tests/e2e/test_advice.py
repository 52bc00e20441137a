#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What fathom read advises, from what was heard on the line. Each case is one that a wrong cable, setting or device
brings about; the device is scripted."""
import re

import e2e

REQUEST = e2e.adu(1, 3, 1, 0, 0, 1)  # A16 6: register 0x0100 of address 1
HPS_REQUEST = e2e.adu(1, 3, 0, 8, 0, 4)  # HPS-167S #5
GOOD = e2e.registers(1, 754)
CAUSES = ('wiring', 'supply', '--baud', '--parity', '--address', '--timeout', 'termination', 'echo', 'master',
          'damaged', 'refused', 'check', 'try ')


class Asked(e2e.Case):
    def ask(self, *answers, sensor=('a16', '--mode', 'modbus'), request=REQUEST, timeout=150, code=1, arguments=()):
        """One request is answered with each of these (bytes, or several written one by one), then it ends."""
        device = self.device()
        reader = self.fathom('read', *sensor, '--port', device.path, '--count', len(answers), '--timeout', timeout,
                             *arguments)
        for answer in answers:
            self.assertEqual(device.read(len(request)), request)
            if answer:
                device.write(answer)
        done = reader.finish(5)
        self.assertEqual(done.code, code, done.err)
        return done

    def advised(self, done, attempt, *words):
        lines = [line for line in done.err.splitlines() if line.startswith(f'fathom: attempt {attempt}: ')]
        self.assertEqual(len(lines), 1, done.err)
        for word in words:
            self.assertIn(word, lines[0])
        return lines[0]

    def test_on_a_good_line_no_advice_appears(self):
        done = self.ask(GOOD, GOOD, GOOD, code=0)
        self.assertEqual(done.err, 'fathom: attempts 3, failed 0, readings 3\nfathom: line: answers 3\n')
        for cause in CAUSES:
            self.assertNotIn(cause, done.err)

    def test_nothing_heard_is_wiring_supply_address_and_rate(self):
        line = self.advised(self.ask(b''), 1, 'nothing was heard at all', 'supply', 'A and B', '--address', '--baud')
        self.assertNotIn('echo', line)

    def test_bytes_without_a_frame_are_rate_or_parity_and_no_other_rate_is_offered_where_there_is_none(self):
        line = self.advised(self.ask(b'\x80\xF8\x00\x80'), 1, 'bytes were heard, but no Modbus frame',
                            'check --baud and --parity (now 9600 8N1)', 'A and B swapped')
        self.assertNotIn(', try', line)

    def test_bytes_without_a_frame_offer_the_rates_that_the_sensor_can_be_set_to(self):
        done = self.ask(b'\x80\xF8\x00\x80', sensor=('hps167s',), request=HPS_REQUEST)
        self.advised(done, 1, '(now 19200 8E1), try --baud 57600, 115200 or 230400')

    def test_bytes_without_a_frame_at_other_settings_offer_the_factorys(self):
        done = self.ask(b'\x80\xF8\x00\x80', sensor=('hps167s', '--baud', '57600', '--parity', 'none'),
                        request=HPS_REQUEST)
        self.advised(done, 1, '(now 57600 8N1), try without them (19200 8E1, as from the factory)')

    def test_another_units_answer_names_its_address(self):
        line = self.advised(self.ask(e2e.registers(7, 754)), 1, 'address 7', 'try --address 7')
        self.assertNotIn('--baud', line)

    def test_another_units_exception_names_its_address_too(self):
        self.advised(self.ask(e2e.adu(9, 0x83, 2)), 1, 'try --address 9')

    def test_another_masters_requests_are_told(self):
        # it asks address 5 for four registers of an HPS-167S, and that one answers
        other = e2e.adu(5, 3, 0, 8, 0, 4) + e2e.registers(5, 2083, 0xDCB2, 0x0701, 0)
        line = self.advised(self.ask(other), 1, 'requests of another master were heard (it asked address 5)')
        self.assertNotIn('--address', line)

    def test_only_the_own_request_is_an_echo_without_a_sensor(self):
        for sensor, request in ((('a16', '--mode', 'modbus'), REQUEST), (('hps167s',), HPS_REQUEST)):
            with self.subTest(sensor):
                done = self.ask(request, request, sensor=sensor, request=request)
                for attempt in (1, 2):
                    line = self.advised(done, attempt, "only the tool's own request came back",
                                        'wiring behind the adapter', 'supply')
                    self.assertNotIn('nothing was heard', line)

    def test_with_echo_told_to_be_off_it_is_the_same_advice(self):
        done = self.ask(REQUEST, arguments=('--echo', 'off'))
        self.advised(done, 1, "only the tool's own request came back", 'wiring behind the adapter')

    def test_an_echo_and_an_answer_are_a_reading_without_advice(self):
        for echo in ('auto', 'on'):
            with self.subTest(echo):
                done = self.ask(REQUEST + GOOD, REQUEST + GOOD, arguments=('--echo', echo), code=0)
                self.assertEqual(done.out.count(' 754 mm'), 2)
                self.assertEqual(done.err, 'fathom: attempts 2, failed 0, readings 2\nfathom: line: answers 2\n')

    def test_a_late_answer_names_a_time_out_that_is_long_enough(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--count', 2, '--timeout', 200)
        device.read(8)
        reader.expect('attempt 1: no answer from address 1: nothing was heard at all', 'err')
        device.write(GOOD)  # some 200 ms after the request: twice that, and more if this machine is slow
        device.read(8)
        done = reader.finish(5)
        line = self.advised(done, 2, 'it answers, but too late; try a longer --timeout')
        took, offered = (int(number) for number in re.search(
            r'it took (\d+) ms, so --timeout (\d+)$', line).groups())
        self.assertGreaterEqual(took, 200)
        self.assertGreaterEqual(offered, 2 * took)
        self.assertLess(offered, 2 * took + 102)
        self.assertEqual((done.code, done.out), (1, ''))

    def damaged(self):
        answer = bytearray(GOOD)
        answer[4] ^= 0x10
        return bytes(answer)

    def test_damaged_now_and_then_is_the_line_and_not_the_settings(self):
        done = self.ask(GOOD, self.damaged(), GOOD)
        line = self.advised(done, 2, 'was damaged', 'other answers were good', 'cable', 'termination', 'ground',
                            '(1 of 2 attempts damaged)')
        self.assertNotIn('--parity', line)
        self.assertEqual(done.out.count(' 754 mm'), 2)

    def test_damaged_from_the_start_may_be_the_settings(self):
        self.advised(self.ask(self.damaged()), 1, 'was damaged', '--parity', 'termination', 'no other unit')

    def test_exceptions_are_told_by_name_and_what_they_mean(self):
        for number, name, meaning in ((1, 'illegal function', 'check that it is a16'),
                                      (2, 'illegal data address', 'no such register; check that it is a16'),
                                      (3, 'illegal data value', 'check that it is a16'),
                                      (4, 'device failure', 'supply off and on'), (6, 'device busy', '--retries'),
                                      (11, 'gateway target silent', 'gateway'), (7, 'unknown', 'no code of')):
            with self.subTest(number):
                line = self.advised(self.ask(e2e.adu(1, 0x83, number)), 1,
                                    f'address 1 refused: exception {number:02} ({name}): ', meaning)
                self.assertEqual('check that it is' in line, number in (1, 2, 3, 7))

    def test_a_sensor_that_sends_by_itself_is_named(self):
        for data, name in ((e2e.frame(1953) * 3, 'an a16'), (e2e.frame(1000, 2000, 1953, 3562) * 2, 'an a05')):
            with self.subTest(name):
                self.advised(self.ask(data), 1, f'frames of {name} that sends by itself were heard',
                             f'fathom read {name[3:]} --mode auto')


class Sending(e2e.Case):
    def hear(self, sensor, data):
        """One attempt of 300 ms, in which this comes once."""
        device = self.device()
        reader = self.fathom('read', sensor, '--port', device.path, '--count', 1, '--timeout', 300, '--format', 'csv')
        reader.expect('^sensor,')
        device.write(data)
        done = reader.finish(5)
        self.assertEqual((done.code, done.out.count('\n')), (1, 1), done.err)
        return done.err.splitlines()[0]

    def test_nothing_heard_is_wiring_and_supply(self):
        line = self.hear('a16', b'')
        self.assertRegex(line, 'nothing was heard at all; check the supply, the wire .*--mode modbus')

    def test_bytes_without_a_frame_are_rate_or_parity(self):
        self.assertRegex(self.hear('a05', b'\x80\xF8\x00\x80' * 6),
                         r'bytes were heard, but no frame of a05; check --baud and --parity \(now 9600 8N1\)')

    def test_frames_of_the_other_sensor_name_it(self):
        self.assertIn('frames of an a05 that sends by itself were heard; try: fathom read a05',
                      self.hear('a16', e2e.frame(1000, 2000, 1953, 3562) * 3))
        self.assertIn('frames of an a16 that sends by itself were heard; try: fathom read a16',
                      self.hear('a05', e2e.frame(1953) * 4))

    def test_modbus_on_the_line_of_a_sensor_that_should_send(self):
        self.assertIn('Modbus was heard on this line', self.hear('a16', e2e.adu(1, 3, 1, 0, 0, 1)))

    def test_on_a_good_line_no_advice_appears(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--port', device.path, '--count', 1, '--timeout', 2000)
        while not reader.seen['out']:
            device.write(e2e.frame(1953))
            e2e.select.select([reader.pidfd], [], [], 0.06)
        done = reader.finish(5)
        self.assertEqual((done.code, done.out.count('1953 mm')), (0, 1))
        for cause in CAUSES:
            self.assertNotIn(cause, done.err)


if __name__ == '__main__':
    e2e.main()
