#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read --stats: every counter by its name, and every reading that did not come has one."""
import json
import select
import time

import e2e

REQUEST = e2e.adu(1, 3, 1, 0, 0, 1)

LINE = ['answers', 'bytes_of_no_frame', 'port_errors', 'requests_without_an_answer', 'damaged_answers', 'exceptions',
        'answers_that_do_not_fit', 'late_answers', 'frames_that_nobody_asked_for', 'bad_bytes']
STREAM = ['frames', 'missed_frames', 'ambiguous_frames', 'unsure_frames', 'stale', 'bytes']
FAILURES = ['impossible_values', 'port', 'no_answer', 'damaged', 'exception', 'other_answer', 'stale', 'other']


class Stats(e2e.Case):
    def ask(self, answers, *arguments, **options):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--count', len(answers),
                             '--timeout', 150, *arguments, **options)
        for answer in answers:
            self.assertEqual(device.read(8), REQUEST)
            if answer:
                device.write(answer)
        return reader.finish(8)

    def objects(self, done):
        """Those on stderr; stdout has readings only."""
        for line in done.out.splitlines():
            self.assertIn('distance_mm', json.loads(line))
        return [json.loads(line) for line in done.err.splitlines() if line.startswith('{')]

    def test_each_failure_has_its_counter(self):
        good = e2e.registers(1, 754)
        damaged = bytearray(good)
        damaged[4] ^= 0x10
        answers = [good, b'', bytes(damaged), e2e.adu(1, 0x83, 2), e2e.registers(1, 754, 755), e2e.registers(1, 40000), good,
                   e2e.registers(2, 754)]
        done = self.ask(answers, '--stats', '--format', 'json')
        self.assertEqual(done.code, 1)
        one, = self.objects(done)
        self.assertEqual(list(one), ['time_us', 'attempts', 'failed', 'readings', 'requests', 'skipped_frames', 'reconnects',
                                     'failures', 'line', 'stream', 'unit', 'port', 'answer_us', 'units'])
        self.assertEqual((list(one['failures']), list(one['line']), list(one['unit'])),
                         (FAILURES, LINE, ['answers', 'failures']))
        self.assertEqual((one['attempts'], one['failed'], one['readings'], one['requests'], one['reconnects']),
                         (8, 6, 2, 8, 0))
        self.assertEqual(one['failures'], {'impossible_values': 1, 'port': 0, 'no_answer': 2, 'damaged': 1, 'exception': 1,
                                           'other_answer': 1, 'stale': 0, 'other': 0})
        # 754, 754 and 40000 were answers; the foreign frame was dropped: 7 bytes, and the damaged and the long one
        self.assertEqual({name: one['line'][name] for name in LINE if name != 'bytes_of_no_frame'},
                         {'answers': 3, 'port_errors': 0, 'requests_without_an_answer': 2, 'damaged_answers': 1,
                          'exceptions': 1, 'answers_that_do_not_fit': 1, 'late_answers': 0,
                          'frames_that_nobody_asked_for': 1, 'bad_bytes': 0})
        self.assertEqual(one['line']['bytes_of_no_frame'], 7 + 9 + 7)
        self.assertEqual(one['unit'], {'answers': 3, 'failures': 5})
        self.assertEqual((one['stream'], one['port']), (None, None))
        times = one['answer_us']
        self.assertEqual(times['answers'], 2)
        # eight characters of ten bits at 9600 baud leave before an answer is looked for
        self.assertTrue(0 < times['min'] <= times['mean'] <= times['max'] < 150000 + 60000, times)

    def test_text_has_every_counter_too(self):
        done = self.ask([e2e.registers(1, 754), b''], '--stats')
        lines = done.err.splitlines()[1:]
        self.assertEqual(lines[0], 'fathom: attempts 2, failed 1, readings 1')
        self.assertEqual(lines[1], 'fathom: requests 2, skipped frames 0, reconnects 0')
        self.assertEqual(lines[2], 'fathom: failures: impossible values 0, port 0, no answer 1, damaged 0, exception 0, '
                                   'other answer 0, stale 0, other 0')
        self.assertEqual(lines[3], 'fathom: line: answers 1, bytes of no frame 0, port errors 0, requests without an answer 1, '
                                   'damaged answers 0, exceptions 0, answers that do not fit 0, late answers 0, '
                                   'frames that nobody asked for 0, bad bytes 0')
        self.assertEqual(lines[4], 'fathom: unit: answers 1, failures 1')
        self.assertRegex(lines[5], r'^fathom: a16:1: attempts 2, failed 1, readings 1, answers 1, failures 1, '
                                   r'silences in a row 1, left alone for 0\.0 s, '
                                   r'time to answer: shortest [\d.]+ ms, mean [\d.]+ ms, longest [\d.]+ ms$')
        self.assertEqual(len(lines), 6)

    def test_retries_are_requests(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--count', 1, '--timeout', 60,
                             '--retries', 2, '--stats', '--format', 'json')
        one, = self.objects(reader.finish(5))
        self.assertEqual((one['attempts'], one['requests'], one['failures']['no_answer']), (1, 3, 1))
        self.assertIsNone(one['answer_us'])

    def test_every_frame_of_a_stream_is_accounted_for(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--port', device.path, '--count', 4, '--interval', 250, '--stats', '--format',
                             'json')
        frames = [e2e.frame(1953), e2e.frame(40000)]  # the second one cannot be a distance
        deadline = time.monotonic() + e2e.PATIENCE
        while not select.select([reader.pidfd], [], [], 0.06)[0] and time.monotonic() < deadline:
            device.write(frames[0])
            frames.reverse()
        one, = self.objects(reader.finish(5))
        self.assertEqual((list(one['stream']), one['unit']), (STREAM, None))
        self.assertEqual(one['attempts'], 4)
        self.assertEqual(one['readings'] + one['failures']['impossible_values'], 4)
        self.assertGreater(one['skipped_frames'], 3)
        self.assertEqual(one['stream']['frames'], 4 + one['skipped_frames'] + one['stream']['missed_frames'])
        self.assertEqual(one['requests'], 0)

    def test_four_probes_are_one_frame(self):
        sim = self.sim('a05', '--distance', '1000')
        done = self.run_fathom('read', 'a05', '--port', sim.port, '--count', 2, '--interval', 700, '--stats', '--format', 'json')
        one, = self.objects(done)
        self.assertEqual((one['attempts'], one['readings'], done.code), (2, 8, 0))
        self.assertEqual(one['stream']['frames'], 2 + one['skipped_frames'] + one['stream']['missed_frames'])

    def test_every_so_often_also_while_nothing_comes(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--timeout', 600000, '--stats=1',
                             '--format', 'json')
        first = json.loads(reader.expect('^{.*', 'err')[0])
        second = json.loads(reader.expect('^{.*', 'err')[0])
        self.assertEqual((first['requests'], first['attempts']), (1, 0))
        self.assertTrue(900000 < second['time_us'] - first['time_us'] < 3000000)
        self.assertTrue(1000000 <= first['time_us'] < 3000000)
        done = reader.end()
        self.assertEqual((done.code, done.out), (0, ''))
        self.assertGreaterEqual(len(self.objects(done)), 3)  # and at the end
        self.assertLess(done.cpu, 0.3)

    def test_also_while_a_port_is_waited_for(self):
        reader = self.fathom('read', 'a16', '--port', self.path('nowhere'), '--reconnect', '--stats=1')
        reader.expect('waiting until it is there', 'err')
        reader.expect('^fathom: attempts 0, failed 0, readings 0$', 'err')
        self.assertEqual(reader.end().code, 0)

    def test_without_it_the_summary_is_short(self):
        done = self.ask([e2e.registers(1, 754)], '--format', 'json')
        self.assertEqual(done.err, 'fathom: attempts 1, failed 0, readings 1\nfathom: line: answers 1\n')

    def test_line_errors_that_the_port_counts_are_told_and_explain_a_failure(self):
        for name, option in (('parity', '--parity'), ('framing', '--baud')):
            with self.subTest(name):
                environment = {**self.preload('icount_shim.c'), 'ICOUNT': name}
                done = self.ask([b'\x80\xF8\x00\x80'], '--stats', '--format', 'json', env=environment)
                self.assertIn('so most likely ' + option, done.err)
                one, = self.objects(done)
                self.assertEqual(list(one['port']), ['parity_errors', 'framing_errors', 'overruns', 'breaks'])
                # 3 with each look after the first: after the attempt, and at the end
                self.assertEqual(one['port'], {'parity_errors': 0, 'framing_errors': 0, 'overruns': 0, 'breaks': 0,
                                               f'{name}_errors': 6})


if __name__ == '__main__':
    e2e.main()
