#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What fathom read advises, from what was heard on the line. Each case is one that a wrong cable, setting or
device brings about; the device is scripted."""
import re

import e2e

GOOD = e2e.SAYS_754
DAMAGED = bytes((*GOOD[:4], GOOD[4] ^ 0x10, *GOOD[5:]))
NOISE = b'\x80\xF8\x00\x80'
CAUSES = ('wiring', 'supply', '--baud', '--parity', '--address', '--timeout', 'termination', 'echo', 'master',
          'damaged', 'refused', 'check', 'try ')
A16, HPS = 'a16 --mode modbus', 'hps167s'
TO_A05 = e2e.frame(1000, 2000, 1953, 3562)


class Asked(e2e.Case):
    def ask(self, *responses, sensor=A16, code=1):
        """One request is answered with each of these; then it ends."""
        request = e2e.ASK_HPS if sensor.startswith(HPS) else e2e.ASK_A16
        return self.ends(self.play(f'read {sensor} --timeout 1200', request,
                                   *([response] for response in responses)), code)

    def advised(self, done, attempt, *words, never='no such words'):
        lines = [line for line in done.err.splitlines() if line.startswith(f'fathom: attempt {attempt}: ')]
        self.assertEqual(len(lines), 1, done.err)
        for word in words:
            self.assertIn(word, lines[0])
        self.assertNotIn(never, lines[0])
        return lines[0]

    def test_on_a_good_line_no_advice_appears(self):
        done = self.ask(GOOD, GOOD, GOOD, code=0)
        self.assertEqual(done.err, '')
        for cause in CAUSES:
            self.assertNotIn(cause, done.err)

    @e2e.each(
        nothing_heard_is_wiring_supply_address_and_rate=(
            b'', ['no byte was received', 'power', 'A and B', '--address', '--baud'], 'echo'),
        bytes_without_a_frame_are_rate_or_parity_and_no_other_rate_is_offered_where_there_is_none=(
            NOISE, ['bytes were received, but no Modbus frame', 'Check --baud and --parity (now 9600 8N1)',
                    'Swapped wires A and B'], 'try'),
        bytes_without_a_frame_offer_the_rates_that_the_sensor_can_be_set_to=(
            NOISE, ['(now 19200 8E1; try --baud 57600, 115200 or 230400'], 'factory settings', HPS),
        bytes_without_a_frame_at_other_settings_offer_the_factorys=(
            NOISE, ['(now 57600 8N1; with factory settings 19200 8E1)'], ', 115200',
            'hps167s --baud 57600 --parity none'),
        another_units_response_names_its_address=(
            e2e.registers(7, 754), ['address 7', 'Try --address 7'], '--baud'),
        another_units_exception_names_its_address_too=(e2e.adu(9, 0x83, 2), ['Try --address 9'], '--baud'),
        # it asks address 5 for four registers of an HPS-167S, and that one answers
        another_masters_requests_are_told=(
            e2e.adu(5, 3, 0, 8, 0, 4) + e2e.registers(5, 2083, 0xDCB2, 0x0701, 0),
            ['another master sends requests on this line (to address 5)'], '--address'),
        with_echo_told_to_be_off_it_is_the_same_advice=(
            e2e.ASK_A16, ["only the tool's own request was received", 'wires behind the adapter'],
            'no byte was received', A16 + ' --echo off'),
        damaged_from_the_start_may_be_the_settings=(
            DAMAGED, ['damaged response from ', '--parity', 'termination', 'no other sensor'], 'earlier responses'))
    def once(self, response, words, never, sensor=A16):
        self.advised(self.ask(response, sensor=sensor), 1, *words, never=never)

    def test_only_the_own_request_is_an_echo_without_a_sensor(self):
        for sensor, request in ((A16, e2e.ASK_A16), (HPS, e2e.ASK_HPS)):
            self.advised(self.ask(request, sensor=sensor), 1, "only the tool's own request was received",
                         'wires behind the adapter', 'supply', never='no byte was received')

    def test_the_advice_is_printed_once_for_a_cause_and_another_cause_in_full(self):
        """Another address that responds is another cause."""
        full, again = 'Check |Try ', 'no response from .*: the same cause as before, {} times in a row$'
        seven, nine = e2e.registers(7, 754), e2e.registers(9, 754)
        done = self.ask(b'', b'', b'', NOISE, b'', seven, nine, nine)
        for attempt, words in enumerate((full, again.format(2), again.format(3), full, full, full, full, again.format(2)), 1):
            self.assertRegex(self.advised(done, attempt), words)

    def test_an_echo_and_a_response_are_a_reading_without_advice(self):
        for echo in ('auto', 'on'):
            both = e2e.ASK_A16 + GOOD
            done = self.ask(both, both, sensor=f'{A16} --echo {echo}', code=0)
            self.assertEqual(done.out.count(' 754 mm'), 2)
            self.assertEqual(done.err, '')

    def test_a_late_response_names_a_time_out_that_is_long_enough(self):
        device, reader = self.beside(f'read {A16} --count 2 --timeout 500')
        device.read(8)
        reader.expect('attempt 1: .*: no byte was received', 'err')
        device.write(GOOD)  # some 500 ms after the request: twice that, and more if this machine is slow
        device.read(8)
        done = self.ends(reader, 1, out='')
        line = self.advised(done, 2, 'the response arrived after the time-out')
        took, offered = map(int, re.search(r'it took (\d+) ms\)\. Try a longer --timeout, such as --timeout (\d+)$', line).groups())
        self.assertGreaterEqual(took, 500)
        self.assertGreaterEqual(offered, 2 * took)
        self.assertLess(offered, 2 * took + 102)

    def test_damaged_now_and_then_is_the_line_and_not_the_settings(self):
        done = self.ask(GOOD, DAMAGED, GOOD)
        self.advised(done, 2, 'damaged response from ', 'earlier responses were good', 'cable', 'termination', 'ground',
                     '(1 of 2 attempts)', never='--parity')
        self.assertEqual(done.out.count(' 754 mm'), 2)

    def test_exceptions_are_told_by_name_and_what_they_mean(self):
        rows = ((1, 'illegal function', 'Check that the sensor is a16'),
                (2, 'illegal data address', 'no such register. Check that the sensor is a16'),
                (3, 'illegal data value', 'Check that the sensor is a16'), (4, 'server device failure', 'supply off and on'),
                (6, 'server device busy', '--retries'), (11, 'gateway target device failed to respond', 'gateway'),
                (7, 'unknown', 'no such code'))
        done = self.ask(*(e2e.adu(1, 0x83, row[0]) for row in rows))
        for attempt, (number, name, meaning) in enumerate(rows, 1):
            line = self.advised(done, attempt, f'refused the request: exception {number:02} ({name}): ',
                                meaning)
            self.assertEqual('Check that the sensor is a16' in line, number in (1, 2, 3, 7))

    def test_a_sensor_that_sends_by_itself_is_named(self):
        for data, name in ((e2e.frame(1953) * 3, 'a16'), (TO_A05 * 2, 'a05')):
            self.advised(self.ask(data), 1, f'frames of {name} in automatic mode were received',
                         f'fathom read {name} --mode auto')


class Sending(e2e.Case):
    @e2e.each(
        nothing_heard_is_wiring_and_supply=('a16', b'', 'no byte was received. Check the power and the wire .*--mode modbus'),
        bytes_without_a_frame_are_rate_or_parity=(
            'a05', NOISE * 6,
            r'the bytes form no frame of a05.*\. Check --baud and --parity \(now 9600 8N1\)'),
        frames_of_the_other_sensor_name_it=(
            'a16', TO_A05 * 3, "frames of a05 in automatic mode were received. Try 'fathom read a05 --mode auto'"),
        frames_of_the_other_sensor_name_it_too=(
            'a05', e2e.frame(1953) * 4,
            "frames of a16 in automatic mode were received. Try 'fathom read a16 --mode auto'"),
        modbus_on_the_line_of_a_sensor_that_should_send=('a16', e2e.ASK_A16, 'Modbus frames were received, but no measurement of a16'))
    def hear(self, sensor, data, words):
        """One attempt of 1 s, in which this comes once."""
        device, reader = self.beside(f'read {sensor} --count 1 --timeout 1000 --format csv')
        device.write(data)
        done = self.ends(reader, 1)
        self.assertEqual(done.rows, [])
        self.assertRegex(done.err.splitlines()[0], words)

    def test_on_a_good_line_no_advice_appears(self):
        device, reader = self.beside('read a16 --count 1 --timeout 2000')
        while not reader.has_ended(0.06):
            device.write(e2e.frame(1953))
        done = self.ends(reader, 0)
        self.assertEqual(done.out.count('1953 mm'), 1)
        for cause in CAUSES:
            self.assertNotIn(cause, done.err)


if __name__ == '__main__':
    e2e.main()
