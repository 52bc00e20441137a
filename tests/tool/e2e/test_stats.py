#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read --stats: every counter by its name, and every reading that did not come has one; late responses.
It needs real time: CTest runs one such file at a time."""
import json
import os
import re

import e2e

LINE = ['responses', 'dropped_bytes', 'port_errors', 'no_responses', 'damaged_responses', 'exceptions', 'other_responses',
        'late_responses', 'unsolicited_frames', 'maybe_unsolicited_responses', 'bad_bytes', 'old_bytes',
        'busy_attempts', 'other_master_attempts', 'other_master_requests']
STREAM = ['frames', 'missed_frames', 'ambiguous_frames', 'unsure_frames', 'damaged_frames', 'stale', 'bytes',
          'dropped_bytes']
RESPONSE = ['response_min_us', 'response_mean_us', 'response_max_us']
JSON = '--stats --format json'
GOOD = e2e.SAYS_754


class Stats(e2e.Case):
    def ask(self, responses, options, **more):
        device, reader = self.beside(f'read a16 --mode modbus --count {len(responses)} --timeout 1200 {options}',
                                     **more)
        for response in responses:
            device.asked(e2e.ASK_A16, response)
        return reader.finish()

    def told(self, done):
        """The one object on stderr; stdout has readings only."""
        for one in done.json:
            self.assertIn('distance_mm', one)
        one, = done.told
        return one

    def test_each_failure_has_its_counter(self):
        damaged = bytes((*GOOD[:4], GOOD[4] ^ 0x10, *GOOD[5:]))
        done = self.ask([GOOD, b'', damaged, e2e.adu(1, 0x83, 2), e2e.registers(1, 754, 755),
                         e2e.registers(1, 40000), GOOD, e2e.registers(2, 754)], JSON)
        self.assertEqual(done.code, 1)
        one = self.told(done)
        self.assertEqual(list(one), ['time_us', 'attempts', 'failed', 'readings', 'requests', 'skipped_frames',
                                     'reconnects', 'failures', 'line', 'stream', 'port', *RESPONSE, 'sensors'])
        self.assertEqual((list(one['failures']), list(one['line'])), (e2e.FAILURES, LINE))
        self.assertEqual([one[name] for name in ('attempts', 'failed', 'readings', 'requests', 'reconnects')],
                         [8, 6, 2, 8, 0])
        self.assertEqual(one['failures'], dict(zip(e2e.FAILURES, (1, 0, 2, 1, 1, 1, 0, 0, 0, 0))))
        # 754, 754 and 40000 were responses; the foreign frame was dropped: 7 bytes, and the damaged and the
        # long one
        self.assertEqual(one['line'], dict(zip(LINE, (3, 7 + 9 + 7, 0, 2, 1, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0))))
        sensor, = one['sensors']
        self.assertEqual([sensor[name] for name in ('name', 'model', 'responses', 'failed_requests')],
                         ['a16:1', 'a16', 3, 5])
        self.assertEqual((one['stream'], one['port']), (None, None))
        shortest, mean, longest = (one[name] for name in RESPONSE)
        # eight characters of ten bits at 9600 baud leave before a response is looked for
        self.assertTrue(0 < shortest <= mean <= longest < 1200000 + 60000, one)

    def test_a_name_that_is_made_up_of_a_port_needs_no_quotes(self):
        words = []
        for name in ('plain', 'a"b\\c'):
            os.symlink(self.sim('hps167s --distance 2083').port, self.path(name))
            words.append(f'hps167s:1@{self.path(name)}')
        done = self.ends(self.fathom(f'read --count 1 {JSON}', words), 0)
        names = ['hps167s:1@plain', 'hps167s:1@a_b_c']
        self.assertEqual([one['name'] for one in self.told(done)['sensors']], names)
        self.assertEqual(sorted(one['name'] for one in done.all_json), sorted(names))

    def test_text_has_every_counter_that_is_not_0(self):
        lines = self.ask([GOOD, b''], '--stats').err.splitlines()[1:]
        self.assertEqual(lines[:4], [
            'fathom: attempts 2, failed 1, readings 1', 'fathom: requests 2', 'fathom: failures: no_response 1',
            'fathom: line: responses 1, no_responses 1'])
        self.assertRegex(lines[4], r'^fathom: a16:1: attempts 2, failed 1, readings 1, responses 1, failed_requests 1, '
                                   r'timeouts_in_row 1, response_min_us (\d+), '
                                   r'response_mean_us \1, response_max_us \1$')
        self.assertEqual(len(lines), 5)

    def test_retries_are_requests(self):
        _, reader = self.beside(f'read a16 --mode modbus --count 1 --timeout 60 --retries 2 {JSON}')
        one = self.told(reader.finish())
        self.assertEqual((one['attempts'], one['requests'], one['failures']['no_response']), (1, 3, 1))
        self.assertIsNone(one['response_min_us'])

    def test_every_frame_of_a_stream_is_accounted_for(self):
        device, reader = self.beside(f'read a16 --count 4 --interval 800 {JSON}')
        frames = [e2e.frame(1953), e2e.frame(40000)]  # the second one cannot be a distance
        while not reader.has_ended(0.06):
            device.write(frames[0])
            frames.reverse()
        one = self.told(reader.finish())
        self.assertEqual((list(one['stream']), one['sensors']), (STREAM, []))
        self.assertEqual(one['attempts'], 4)
        self.assertEqual(one['readings'] + one['failures']['impossible_values'], 4)
        self.assertGreater(one['skipped_frames'], 3)
        self.assertEqual(one['stream']['frames'], 4 + one['skipped_frames'] + one['stream']['missed_frames'])
        self.assertEqual(one['requests'], 0)

    def test_four_probes_are_one_frame(self):
        sim = self.sim('a05 --distance 1000')
        one = self.told(self.ends(f'read a05 --port {sim} --count 2 --interval 700 {JSON}', 0))
        self.assertEqual((one['attempts'], one['readings']), (2, 8))
        self.assertEqual(one['stream']['frames'], 2 + one['skipped_frames'] + one['stream']['missed_frames'])

    def test_every_so_often_also_while_nothing_comes(self):
        _, reader = self.beside('read a16 --mode modbus --timeout 600000 --stats=1 --format json')
        first, second = (json.loads(reader.expect('^{.*', 'err')[0]) for _ in range(2))
        self.assertEqual((first['requests'], first['attempts']), (1, 0))
        self.assertTrue(1900000 <= second['time_us'] < 20000000)
        self.assertTrue(1000000 <= first['time_us'] < 10000000)
        done = self.ends(reader.end(), 0, out='')
        self.assertGreaterEqual(len(done.told), 3)  # and at the end
        self.needs_little(done)

    def test_also_while_a_port_is_waited_for(self):
        reader = self.fathom(f'read a16 --port {self.path("nowhere")} --reconnect --stats=1')
        reader.expect('waiting until it is there', 'err')
        reader.expect('^fathom: attempts 0, failed 0, readings 0$', 'err')
        self.ends(reader.end(), 0)

    @e2e.each(**{f'line_errors_that_the_port_counts_are_told_and_explain_a_failure_{name}': (name, option)
                 for name, option in (('parity', '--parity'), ('framing', '--baud'))})
    def line_errors(self, name, option):
        done = self.ask([b'\x80\xF8\x00\x80'], JSON, env=self.preload('icount_shim.c', ICOUNT=name))
        self.assertIn('so most likely ' + option, done.err)
        port = self.told(done)['port']
        self.assertEqual(list(port), ['parity_errors', 'framing_errors', 'overruns', 'breaks'])
        # 3 with each look after the first: after the attempt, and at the end
        self.assertEqual(port, {**dict.fromkeys(port, 0), f'{name}_errors': 6})

    def test_a_response_during_the_next_attempt_is_not_its_reading(self):
        device, reader = self.beside('read a16 --mode modbus --timeout 1000 --count 2 --format csv --stats')
        device.asked(e2e.ASK_A16)
        reader.expect('attempt 1: no response from a16:1 ', 'err')
        device.write(e2e.registers(1, 1111))  # to the first request; the second attempt has begun
        device.asked(e2e.ASK_A16, e2e.registers(1, 2222))  # only when the late one has come
        done = self.ends(reader, 1, 'attempts 2, failed 1, readings 1\n',
                         re.compile(r'line: responses 1, .*no_responses 1, .*late_responses 1'))
        self.assertEqual(done.mm, ['2222'])

    def test_a_sensor_that_falls_silent_is_not_shown_again(self):
        for sensor, values in (('a16', [1953]), ('a05', [1000, 2000, 1953, 3562])):
            device, reader = self.beside(f'read {sensor} --count 4 --timeout 400 --format csv')
            while len(reader.lines()) < 1 + len(values):
                device.write(e2e.frame(*values))
                reader.has_ended(0.06)
            mm = self.ends(reader, 1, ': no byte was received. Earlier readings were good').mm
            self.assertLess(len(mm), 4 * len(values))
            self.assertEqual(mm, list(map(str, values)) * (len(mm) // len(values)))


if __name__ == '__main__':
    e2e.main()
