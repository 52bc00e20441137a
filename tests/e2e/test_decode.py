#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom decode: every frame of the datasheets, their misprints, and what is no hex."""
import json
import re
import subprocess

import decoding
import e2e
from decoding import FRAMES

WHOLE = '01 03 02 02 F2 38 A1'


class Datasheets(decoding.Case):
    def check_is(self, found, row):
        text, name, direction, what, fields = row
        protocol = name if name in ('stream', 'dyp') else 'modbus'
        self.assertEqual((found['bytes'], found['protocol'], found['direction']), (text, protocol, direction))
        if protocol == 'modbus':
            self.assertEqual((found['name'], found['address'], found['function']),
                             (name, 1, int(text.split()[1], 16)))
        check = text[-5:] if protocol == 'modbus' else text[-2:]
        self.assertEqual(found['checksum'], {'right': True, 'found': check, 'expected': check})
        self.assertEqual([f'{one.get("sensor", "")} {one["what"]}' for one in found['meanings']],
                         [what] if isinstance(what, str) else what)
        self.assertEqual(found['meanings'][-1]['fields'], fields)

    def test_every_frame_is_explained_in_one_capture(self):
        self.assertEqual(len(FRAMES), 38)
        for between in '\n ':
            found = self.decode(self.file(between.join(row[0] for row in FRAMES)))
            self.assertEqual(len(found), 38)
            offset = 0
            for one, row in zip(found, FRAMES):
                with self.subTest(row[0]):
                    self.check_is(one, row)
                    self.assertEqual((one['offset'], one['length']), (offset, len(row[0].split())))
                    offset += one['length']

    def test_every_frame_alone_is_good_and_its_meaning_is_among_those_told(self):
        for row in FRAMES:
            with self.subTest(row[0]):
                found = self.one(row[0])
                self.assertTrue(found['checksum']['right'])
                # Which probes an a05 was asked for is known from the request only.
                self.assertIn(list(row[4].values()),
                              [list(one['fields'].values()) for one in found['meanings']])

    def test_every_frame_with_a_wrong_last_byte_is_told_with_the_right_one(self):
        for row in FRAMES:
            with self.subTest(row[0]):
                good = bytes.fromhex(row[0])
                found = self.one(good[:-1] + bytes([good[-1] ^ 0x10]), code=1)
                size = 2 if found['protocol'] == 'modbus' else 1
                self.assertEqual(found['direction'], row[2])
                self.assertFalse(found['checksum']['right'])
                self.assertEqual(found['checksum']['expected'], good[-size:].hex(' ').upper())

    def test_the_text_names_unit_function_field_and_checksum(self):
        done = self.run_fathom('decode 01 03 00 08 00 04 C5 CB 01 03 08 08 23 DC B2 07 01 00 00 FD 41')
        self.assertEqual(done.out.splitlines(), [
            '000000  01 03 00 08 00 04 C5 CB',
            '        Modbus RTU, request, address 1, function 03 read holding registers',
            '        hps167s  #5 single measurement',
            '        CRC C5 CB right',
            '000008  01 03 08 08 23 DC B2 07 01 00 00 FD 41',
            '        Modbus RTU, answer, address 1, function 03 read holding registers',
            '        hps167s  #5 single measurement',
            '            distance          2083 mm',
            '            magnitude         723.1744',
            '            ambient           1',
            '            precision         0',
            '        CRC FD 41 right'])


class Misprints(decoding.Case):
    def test_the_sum_of_the_13_byte_answer_is_62(self):
        found = self.one('55 AA 01 01 03 E8 07 D0 07 A1 0D EA 60', code=1)
        self.assertEqual(found['checksum'], {'right': False, 'found': '60', 'expected': '62'})
        self.assertIn('sum 60 WRONG, it should be 62', self.run_fathom('decode', found['bytes']).out)

    def test_the_crc_of_the_request_before_the_exception_is_c5_cb(self):
        found = self.decode('01 03 00 08 00 04 C5 C8', '01 83 02 C0 F1', code=1)
        self.assertEqual([one['checksum']['expected'] for one in found], ['C5 CB', 'C0 F1'])
        self.assertEqual([one['checksum']['right'] for one in found], [False, True])
        self.assertIn('CRC C5 C8 WRONG, it should be C5 CB', self.run_fathom('decode', found[0]['bytes']).out)

    def test_a_crc_in_the_order_of_the_tables_is_told(self):
        found = self.one('01 03 00 01 00 03 0B 54', code=1)
        self.assertEqual(found['checksum']['expected'], '54 0B')
        self.assertIn('the two bytes of the CRC are swapped: the low one goes first', found['notes'])

    def test_a_frame_begins_with_one_ff(self):
        extra, good = self.decode('FF FF 07 A1 A7', code=1)
        self.assertEqual((extra['protocol'], extra['bytes'], good['bytes']), (None, 'FF', 'FF 07 A1 A7'))
        self.assertIn('an FF too many', extra['notes'][0])

    def test_an_exception_without_a_function_is_told(self):
        self.assertIn('no function; HPS table 40', self.one(e2e.adu(1, 2), code=1)['notes'][0])

    def test_the_command_that_sets_the_address_is_03_and_carries_no_distance(self):
        self.assertEqual(self.meaning('55 AA 05 03 07')['what'], 'set the address')
        self.assertEqual(self.meaning('55 AA 05 10 14')['what'], 'measure with probe 1')  # 55 + AA + 05 + 10
        # with data, as the table has it: 55 + AA + 05 + 03 + 07 + A1 = 1AF
        self.assertEqual([one['protocol'] for one in self.decode('55 AA 05 03 07 A1 AF', code=1)][-1], None)

    def test_0109_is_probe_4(self):
        found = self.decode(e2e.adu(1, 3, 1, 9, 0, 1), e2e.registers(1, 250))
        self.assertEqual(found[1]['meanings'][0]['fields'], {'probe_4_mm': 250})


class Input(decoding.Case):
    def test_every_way_to_write_hex(self):
        for text in ('010302 02f238a1', '0x01,0x03,0x02,0x02,0xF2,0x38,0XA1', '01:03:02:02:f2:38:a1',
                     '{0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1};', '0x01030202F238A1',
                     '# a comment 99\n01 03 02 # two\n\n\t02 F2\r\n38;A1#'):
            with self.subTest(text):
                self.assertEqual(self.one(self.file(text))['bytes'], WHOLE)

    def test_arguments_and_the_standard_input_are_taken_too(self):
        self.assertEqual(self.one(*WHOLE.split())['bytes'], WHOLE)
        for words in ([], ['-']):
            done = subprocess.run([e2e.FATHOM, 'decode', '--format', 'json', *words], input=WHOLE, text=True,
                                  capture_output=True, check=True, timeout=e2e.PATIENCE)
            self.assertEqual(json.loads(done.stdout)['bytes'], WHOLE)

    def test_raw_bytes(self):
        self.assertEqual(self.one('--raw', self.file(bytes.fromhex(WHOLE)))['bytes'], WHOLE)

    def wrong(self, words, *arguments, code=2):
        done = self.ends(['decode', *arguments], code, words, out='')
        self.assertEqual(len(done.err.splitlines()), 1)

    @e2e.each(**{f'what_is_no_hex_is_told_with_its_place_{number}': row for number, row in enumerate((
        ("'G' (line 2, character 5) is no hex digit", '01 03\n 02 G2\n'),
        ("'x' (line 1, character 3) is no hex digit", '01x03'),
        ('a byte has two hex digits (line 3, character 4)', '01\n\n02 3 04'),
        ("'?' (line 1, character 1) is no hex digit", '\xe4'), ('give --raw', '\x01\x03')))})
    def no_hex(self, words, text):
        self.wrong(words, self.file(text))

    def test_what_is_no_hex_in_an_argument_is_told_with_its_place(self):
        self.wrong("'G' (argument 3, character 2) is no hex digit", '01', '03', '0G')
        self.wrong('a byte has two hex digits (argument 1, character 1)', '010')
        self.wrong("'n' (argument 1, character 1) is no hex digit, and there is no file of that name",
                   'nowhere')

    def test_what_cannot_be_read_is_told(self):
        self.wrong('no bytes to explain', self.file('# nothing\n'), code=1)
        self.wrong('/nowhere/x: No such file', '--raw', '/nowhere/x', code=1)
        self.wrong(f'{self.folder}: Is a directory', self.folder, code=1)

    def test_wrong_usage_is_told(self):
        for words, line in (("there is no protocol 'rtu', only auto, modbus, dyp, stream",
                             '--protocol rtu 01'),
                            ("there is no sensor 'a17', only a16, a05, hps167s", '--sensor a17 01'),
                            ("there is no format 'csv', only text, json", '--format csv 01'),
                            ('a16 does not speak dyp', '--sensor a16 --protocol dyp 01'),
                            ('--raw takes one file', '--raw 01 02')):
            self.wrong(words, *line.split())

    def test_a_long_capture_takes_no_long_time(self):
        done = self.ends(['decode', '--raw', self.file(e2e.frame(754) * 50000)], 0)
        self.assertEqual(done.out.count('distance 754 mm'), 50000)

    def test_the_examples_of_the_help_work(self):
        text = self.run_fathom('decode --help').out
        examples = re.findall(r'^ +fathom (decode .*[0-9A-F]{2})$', text, re.M)
        self.assertEqual(len(examples), 2)
        for example in examples:
            self.ends(example, 0)
        self.assertEqual([line for line in text.splitlines() if len(line) > 124], [])


if __name__ == '__main__':
    e2e.main()
