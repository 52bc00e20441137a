#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom decode: every frame of the datasheets, their misprints, what is no hex; what a request makes of its
response, the commands of the HPS-167S, and bytes that are damaged."""
import json
import random
import re
import subprocess

import e2e
from e2e import ASK_A16, adu, registers

WHOLE = '01 03 02 02 F2 38 A1'
READ, WRITE, WRITE_MANY = 'read holding registers', 'write single register', 'write multiple registers'
FIRST, SECOND = 'a16 0x0100 distance', 'a16 0x0101 real-time-distance'
FOUR = {'probe_1_mm': 1000, 'probe_2_mm': 2000, 'probe_3_mm': 1953, 'probe_4_mm': 3562}
ADDRESSES = ['a16 set 0x0200 address', 'a05 set 0x0200 address']
DETAILS, MEASURE, RESET = ('hps167s #3 sensor details', 'hps167s #5 single measurement',
                           'hps167s #6 factory reset of the interface')

# Every frame that the datasheets print (misprints corrected), in their order, so that a response follows its
# request: bytes, protocol, direction, what each sensor takes it for, fields of the last of these.
FRAMES = [
    ('FF 07 A1 A7', 'stream', 'response', 'a16 measurement', {'distance_mm': 1953}),
    ('01 03 01 00 00 01 85 F6', READ, 'request', FIRST, {}),
    ('01 03 02 02 F2 38 A1', READ, 'response', FIRST, {'distance_mm': 754}),
    ('01 03 01 01 00 01 D4 36', READ, 'request', SECOND, {}),
    ('01 03 02 02 EF F8 A8', READ, 'response', SECOND, {'real_time_distance_mm': 751}),
    ('01 06 02 00 00 05 48 71', WRITE, 'both', ADDRESSES, {'address': 5}),
    ('01 06 02 02 00 01 E8 72', WRITE, 'both', 'a16 set 0x0202 operating-mode', {'operating_mode': 'automatic'}),
    ('01 06 02 07 00 01 F8 73', WRITE, 'both', 'a16 set 0x0207 automatic-value', {'automatic_value': 'real-time'}),
    ('01 06 02 05 00 00 98 73', WRITE, 'both', 'a16 set 0x0205 switch-polarity', {'switch_polarity': 'negative'}),
    ('01 06 02 06 07 D0 6B DF', WRITE, 'both', 'a16 set 0x0206 switch-threshold', {'switch_threshold_mm': 2000}),
    ('FF 03 E8 07 D0 07 A1 0D EA 60', 'stream', 'response', 'a05 measurement', FOUR),
    ('55 AA 01 01 01', 'dyp', 'request', 'a05 measure with all probes', {}),
    ('55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62', 'dyp', 'response', 'a05 measurement', FOUR),
    ('55 AA 01 10 10', 'dyp', 'request', 'a05 measure with probe 1', {}),
    ('55 AA 01 10 07 A1 B8', 'dyp', 'response', 'a05 measurement', {'probe_1_mm': 1953}),
    ('55 AA 05 03 07', 'dyp', 'both', 'a05 set the address', {'address': 5}),
    ('01 03 01 06 00 01 65 F7', READ, 'request', 'a05 0x0106 distance of probe 1', {}),
    ('01 03 02 01 3C B9 C5', READ, 'response', 'a05 0x0106 distance of probe 1', {'probe_1_mm': 316}),
    ('01 03 01 07 00 01 34 37', READ, 'request', 'a05 0x0107 distance of probe 2', {}),
    ('01 03 02 09 1B FE 1F', READ, 'response', 'a05 0x0107 distance of probe 2', {'probe_2_mm': 2331}),
    ('01 03 01 07 00 03 B5 F6', READ, 'request', 'a05 0x0107 distances of probes 2 to 4', {}),
    ('01 03 06 00 FA 02 93 09 7A 8F 47', READ, 'response', 'a05 0x0107 distances of probes 2 to 4',
     {'probe_2_mm': 250, 'probe_3_mm': 659, 'probe_4_mm': 2426}),
    ('01 06 02 00 00 05 48 71', WRITE, 'both', ADDRESSES, {'address': 5}),
    ('01 03 00 01 00 03 54 0B', READ, 'request', 'hps167s #1 interface version', {}),
    ('01 03 00 02 00 04 E5 C9', READ, 'request', 'hps167s #2 interface configuration', {}),
    ('01 03 00 03 00 0B F4 0D', READ, 'request', DETAILS, {}),
    ('01 03 16 B0 00 39 00 25 42 34 57 14 20 34 38 35 01 06 07 05 13 09 17 03 09 1A DC', READ, 'response', DETAILS,
     {'sensor_version': '3.9 of 2019-09-23', 'uuid': '00390025423457142034383501060705', 'ack': 'B0'}),
    ('01 03 00 04 00 01 C5 CB', READ, 'request', 'hps167s #4 AFE temperature', {}),
    ('01 03 00 08 00 04 C5 CB', READ, 'request', MEASURE, {}),
    ('01 03 08 08 23 DC B2 07 01 00 00 FD 41', READ, 'response', MEASURE,
     {'distance_mm': 2083, 'magnitude': 723.1744, 'ambient': 1, 'precision': 0}),
    ('01 03 00 09 00 01 54 08', READ, 'request', RESET, {}),
    ('01 03 02 00 01 79 84', READ, 'response', RESET, {'result': 'success'}),
    ('01 06 00 0A 00 05 69 CB', WRITE, 'both', 'hps167s #7 warm-up time', {'warm_up_s': 5}),
    ('01 06 00 11 00 01 18 0F', WRITE, 'both', 'hps167s #9 baud rate', {'baud': 19200}),
    ('01 06 00 12 00 00 29 CF', WRITE, 'both', 'hps167s #10 measurement after power-on',
     {'measure_after_power_on': 'off'}),
    ('01 06 00 13 00 FF 38 4F', WRITE, 'both', 'hps167s #11 termination resistor', {'termination': 'on'}),
    ('01 10 00 20 00 02 40 02', WRITE_MANY, 'response', 'hps167s #15 reconnect time', {}),
    ('01 83 02 C0 F1', 'refuses to ' + READ, 'response',
     [' the request is refused', 'hps167s illegal start address or register address'], {}),
]


class Case(e2e.Case):
    def decode(self, *words, code=0):
        """The objects of one run; words are bytes in hex, as text or as they are, and options."""
        words = [word.hex(' ') if isinstance(word, bytes) else word for word in words]
        done = self.run_fathom('decode --format json', *words)
        self.assertEqual((done.code, done.err), (code, ''), done)
        return done.json

    def one(self, *words, code=0):
        one, = self.decode(*words, code=code)
        return one

    def file(self, text):
        with open(self.path('capture'), 'wb') as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        return self.path('capture')


class Datasheets(Case):
    def check_is(self, found, row):
        text, name, direction, what, fields = row
        protocol = name if name in ('stream', 'dyp') else 'modbus'
        self.assertEqual((found['bytes'], found['protocol'], found['direction']), (text, protocol, direction))
        if protocol == 'modbus':
            self.assertEqual((found['name'], found['address'], found['function']),
                             (name, 1, int(text.split()[1], 16)))
        check = text[-5:] if protocol == 'modbus' else text[-2:]
        self.assertEqual(found['checksum'], {'right': True, 'found': check, 'expected': check})
        self.assertEqual([f'{one.get("model", "")} {one["what"]}' for one in found['meanings']],
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

    def test_every_frame_alone_is_good_and_with_a_wrong_last_byte_told_with_the_right_one(self):
        for text, _, direction, _, fields in FRAMES:
            with self.subTest(text):
                found = self.one(text)
                self.assertTrue(found['checksum']['right'])
                # Which probes an a05 was asked for is known from the request only.
                self.assertIn([*fields.values()], [[*one['fields'].values()] for one in found['meanings']])
                good = bytes.fromhex(text)
                found = self.one(good[:-1] + bytes([good[-1] ^ 0x10]), code=1)
                size = 2 if found['protocol'] == 'modbus' else 1
                self.assertEqual((found['direction'], found['checksum']['right'], found['checksum']['expected']),
                                 (direction, False, good[-size:].hex(' ').upper()))

    def test_the_text_names_unit_function_field_and_checksum(self):
        done = self.run_fathom('decode 01 03 00 08 00 04 C5 CB 01 03 08 08 23 DC B2 07 01 00 00 FD 41')
        self.assertEqual(done.out.splitlines(), [
            '000000  01 03 00 08 00 04 C5 CB',
            '        Modbus RTU, request, address 1, function 03 read holding registers',
            '        hps167s  #5 single measurement',
            '        CRC C5 CB right',
            '000008  01 03 08 08 23 DC B2 07 01 00 00 FD 41',
            '        Modbus RTU, response, address 1, function 03 read holding registers',
            '        hps167s  #5 single measurement',
            '            distance               2083 mm',
            '            magnitude              723.1744',
            '            ambient                1',
            '            precision              0',
            '        CRC FD 41 right'])


class Input(Case):
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

    # Words of the message; the arguments, or what is in the file that is the last one.
    @e2e.each(**{f'what_cannot_be_decoded_is_told_with_its_place_{number}': row for number, row in enumerate((
        ("line 2, character 5: 'G' is no hex digit", '', '01 03\n 02 G2\n'),
        ("line 1, character 3: 'x' is no hex digit", '', '01x03'),
        ('line 3, character 4: a byte has two hex digits', '', '01\n\n02 3 04'),
        ("line 1, character 1: '?' is no hex digit", '', '\xe4'),
        ('add --raw', '', '\x01\x03'),
        ("line 1, character 4: '?' is no hex digit", '', '01 \x00\x03'),
        ("argument 3, character 2: 'G' is no hex digit", '01 03 0G'),
        ('argument 1, character 1: a byte has two hex digits', '010'),
        ("argument 1, character 1: 'n' is no hex digit, and there is no file of that name", 'nowhere'),
        ("--protocol is 'rtu'. It takes auto, modbus, dyp or stream.", '--protocol rtu 01'),
        ("unknown sensor 'a17'. Did you mean one of a17nyuw, a17ny4w?", '--sensor a17 01'),
        ("--format is 'csv'. It takes text or json.", '--format csv 01'),
        ('a16 has no frames of this --protocol', '--sensor a16 --protocol dyp 01'),
        ('--raw takes one file', '--raw 01 02'),
        ('no bytes to explain', '', '# nothing\n', 1),
        ('/nowhere/x: No such file', '--raw /nowhere/x', None, 1),
        (': Is a directory', '/', None, 1)))})
    def wrong(self, words, arguments, text=None, code=2):
        done = self.ends(['decode', *arguments.split(), *([] if text is None else [self.file(text)])], code, words,
                         out='')
        self.assertEqual(len(done.err.splitlines()), 1)

    def test_a_long_capture_takes_no_long_time(self):
        done = self.ends(['decode', '--raw', self.file(e2e.frame(754) * 50000)], 0)
        self.assertEqual(done.out.count('distance 754 mm'), 50000)

    def test_more_than_4_mib_are_refused(self):
        for count in ((1 << 22) + 1, 1 << 26):
            self.ends(['decode', '--raw', self.file(bytes(count))], 1, re.compile(
                'more than the 4194304 bytes that are decoded at a time'), out='')

    def test_the_examples_of_the_help_work(self):
        text = self.run_fathom('decode --help').out
        examples = re.findall(r'^ +fathom (decode .*[0-9A-F]{2})$', text, re.M)
        self.assertEqual(len(examples), 2)
        for example in examples:
            self.ends(example, 0)


UNKNOWN = 'its request is not here; what it answers hangs on that'
NO_DISTANCE, NO_TARGET = 'no distance that it can mean', 'no target: out of range, or too weak'
HPS = '--sensor hps167s'


def asks(unit, address, count=1):
    return adu(unit, 3, *divmod(address, 256), 0, count)


def writes(address, value):
    return adu(1, 6, *divmod(address, 256), *divmod(value, 256))


def dyp(*data):
    """55 AA, then these, then the low byte of the sum."""
    frame = bytes((0x55, 0xAA, *data))
    return frame + bytes([sum(frame) & 0xFF])


def answered(address, *values):
    """These registers, when they are asked for."""
    return asks(1, address, len(values)), registers(1, *values)


class Meaning(Case):
    """What the last of some frames is told to be. Of its first meaning: what it is, its fields, which of
    these have remarks (or which remarks); of itself: a remark, and whatever else."""

    def tells(self, words, note=None, code=0, directions=None, **expected):
        *before, found = self.decode(*words, code=code)
        if directions is not None:
            self.assertEqual([one['direction'] for one in (*before, found)], directions)
        if note is not None:
            self.assertTrue(any(note in one for one in found['notes']) if note else not found['notes'], found)
        for name, value in expected.items():
            told = found['meanings'][0][name] if name in ('what', 'fields', 'notes') else found[name]
            self.assertEqual([*told] if isinstance(value, list) else told, value)

    @e2e.each(
        an_exception_without_a_function_is_told=[([adu(1, 2)], {'note': 'no function; HPS table 40', 'code': 1})],
        a_crc_in_the_order_of_the_tables_is_told=[
            (['01 03 00 01 00 03 0B 54'],
             {'note': 'the two bytes of the CRC are swapped: the low one goes first', 'code': 1})],
        **{'0109_is_probe_4': [(answered(0x0109, 250), {'fields': {'probe_4_mm': 250}})]},
        one_response_is_explained_by_each_request=[
            (answered(address, 1), {'fields': fields, 'directions': ['request', 'response']})
            for address, fields in (
            (0x0100, {'distance_mm': 1}), (0x0205, {'switch_polarity': 'positive'}), (0x0206, {'switch_threshold_mm': 1}),
            (0x0207, {'automatic_value': 'real-time'}), (0x0108, {'probe_3_mm': 1}), (0x0010, {'probe_1_mm': 1}),
            (0x0013, {'probe_4_mm': 1}), (0x0009, {'result': 'success'}), (0x0200, {'address': 1}),
            (0x0004, {'temperature_degc': -17.2, 'temperature_degf': 1}))],  # (1 - 32) * 5 / 9 = -17.22
        a_response_of_another_length_is_not_the_one=[([ASK_A16, registers(1, 700, 800)], {'note': UNKNOWN})],
        a_damaged_request_explains_nothing=[
            (['01 03 01 00 00 01 85 F7', registers(1, 754)], {'note': UNKNOWN, 'code': 1})],
        a_response_from_another_unit_is_not_the_one=[
            ([ASK_A16, registers(2, 700)], {'note': UNKNOWN}),
            ([ASK_A16, registers(2, 700), registers(1, 754)], {'what': '0x0100 distance', 'note': ''})],
        a_request_is_answered_once=[([ASK_A16, registers(1, 700)], {'note': ''}),
                                    ([ASK_A16, registers(1, 700), registers(1, 701)], {'note': UNKNOWN})],
        broadcast_to_a16_is_answered_from_another_address=[
            ([asks(255, 0x0200), registers(9, 9)],
             {'fields': {'address': 9}, 'directions': ['request', 'response']})],
        a_write_that_comes_twice_is_acknowledged=[
            (['01 06 02 00 00 05 48 71'], {'note': ''}),
            (['01 06 02 00 00 05 48 71'] * 2, {'note': 'acknowledges the request before, or is its echo'})],
        # 20 09 27, 2 1 0
        **{'1_is_a_date_and_a_version': [(answered(1, 0x1409, 0x1B02, 0x0100),
                                          {'fields': {'interface_version': '2.1.0 of 2020-09-27'}})],
           '2_is_the_configuration': [
               (answered(2, 0xFF00, 0x0500, 0x0000, 0xB403),
                {'fields': {'termination': 'on', 'measure_after_power_on': 'off', 'warm_up_s': 5,
                            'reconnect_time_ms': 180, 'baud_code': 3, 'baud': 115200}, 'notes': {}}),
               (answered(2, 0x0100, 0x0500, 0x0000, 0xB505),  # 01, 181 ms, code 5
                {'notes': ['baud_code', 'termination', 'reconnect_time_ms']})],
           '4_is_fahrenheit_and_celsius': [
               ([HPS, *answered(4, said)], {'fields': {'temperature_degc': celsius, 'temperature_degf': degrees_f}})
               for said, degrees_f, celsius in ((77, 77, 25.0), (14, 14, -10.0), (0x10000 - 40, -40, -40.0),
                                                (100, 100, 37.8), (31, 31, -0.6), (32, 32, 0.0))],
           '5_tells_targets_from_what_is_none': [
               ([HPS, *answered(8, *values)], {'notes': {'distance_mm': note} if note else {}}) for values,
               note in (
                   ((30000, 1, 1, 0), None), ((30001, 1, 1, 0), NO_DISTANCE), ((0, 1, 1, 0), NO_DISTANCE),
                   ((79, 1, 1, 0), 'below its range of 80 mm and more'), ((80, 1, 1, 0), None),
                   ((65529, 1, 1, 0), NO_DISTANCE), ((65530, 1, 1, 0), NO_TARGET),
                   ((65534, 1, 1, 0), NO_TARGET),
                   ((65535, 0, 0x00FF, 65535), 'the abnormal packet: the sensor has failed'),
                   ((65535, 1, 0x00FF, 65535), 'no distance, and not the abnormal packet'))],
           '15_is_32_bits': [
               ([adu(1, 16, 0, 0x20, 0, 2, 4, *ms.to_bytes(4, 'big'))],
                {'what': '#15 reconnect time', 'fields': {'reconnect_time_ms': ms}, 'notes': notes})
               for ms, notes in ((180, {}), (0x12345678 // 18 * 18, {}),
                                 (181, {'reconnect_time_ms': 'no multiple of 18'}))]},
        what_is_written=[
            ([HPS, writes(address, value)], {'fields': fields, 'notes': [*fields][:bad]})
            for address, value, fields, bad in (
                (0x0A, 256, {'warm_up_s': 256}, 1), (0x10, 32, {'address': 32}, 0),
                (0x10, 33, {'address': 33}, 1), (0x11, 4, {'baud': 230400}, 0),
                (0x11, 9, {'baud': '0x0009'}, 1),
                (0x12, 0xFF, {'measure_after_power_on': 'on'}, 0),
                (0x13, 7, {'termination': '0x0007'}, 1), (0x14, 0xFFF1, {'distance_offset_mm': -15}, 0),
                (0x15, 0, {'load_settings': 'user'}, 0), (0x15, 0xFF, {'load_settings': '0x00FF'}, 1),
                (0x15, 1, {'load_settings': '0x0001'}, 1), (0x16, 0xFF9C, {'filter_sensitivity': -100}, 0),
                (0x16, 101, {'filter_sensitivity': 101}, 1))],
        what_resets_the_device_says_so=[([asks(1, 9)], {'note': 'hps167s: resets the device'}), ([writes(0x15, 0xFF)],
                                         {'note': "hps167s: resets the device's settings"}),
                                        ([writes(0x15, 0)], {'note': ''})],
        a_wrong_length_is_told=[([asks(1, 8, 3)], {'note': 'hps167s: #5 has 4 registers, not 3; it refuses this'})],
        each_probe_of_the_55_aa_protocol=[
            row for probe in (1, 2, 3, 4) for row in (
                ([dyp(9, 0x0F + probe)], {'what': f'measure with probe {probe}', 'address': 9}),
                ([dyp(9, 0x0F + probe), dyp(9, 0x0F + probe, 3, 0xE8)], {'fields': {f'probe_{probe}_mm': 1000}}))],
        what_the_55_aa_protocol_does_not_have_is_told=[
            ([dyp(1, 0x14)], {'what': 'unknown command', 'command': 0x14}),
            ([dyp(0xFF, 3)], {'notes': {'address': 'not from 1 to 254'}}),
            ([dyp(0xFF, 1)], {'note': 'FF is the broadcast address'}),
            ([dyp(5, 3)], {'note': 'every a05 on the line obeys'})],
        distances_that_are_none_are_told=[
            row for value, note in ((0, 'unknown: no target, or something at the probe; see --means of fathom read'),
                                     (0xFFFF, 'refused: no distance, and no value of the family'), (0xFFFD, 'no target'),
                                    (0xFFFE, 'no target: interference by another unit')) for row in (
                ([e2e.frame(value)], {'notes': {'distance_mm': note}}),
                ([dyp(1, 0x10, *divmod(value, 256))], {'notes': {'probe_1_mm': note}}))],
        reads_that_an_a05_does_not_have_are_told=[
            (['--sensor a05', asks(1, 0x0108, 3)],
             {'what': '0x0108 is probe 3; a read must not go past the last probe'})],
        registers_of_an_a16_that_go_one_way_are_told=[
            ([asks(1, 0x0202)], {'note': 'a16: 0x0202 is write-only'}),
            ([writes(0x0100, 1)], {'what': '0x0100 distance, which is read-only'}),
            ([writes(0x0205, 2)], {'notes': {'switch_polarity': 'not one of its values'}}),
            ([writes(0x0200, 255)], {'notes': {'address': 'not from 0 to 254'}}),
            ([asks(1, 0x0100, 2)], {'note': 'a16: a read of several registers is not in its datasheet'})],
        what_no_sensor_has_is_told=[([asks(1, 0x1234, 2)], {'what': 'none of these sensors knows this',
                                                            'fields': {'address': '0x1234', 'registers': 2}})])
    def means(self, rows):
        for words, expected in rows:
            with self.subTest(words):
                self.tells(words, **expected)

    def test_the_magnitude_is_exact(self):
        # 65535 << 16 = 4294901760; an exponent over 16 is not believed.
        text = self.run_fathom(['decode', registers(1, 1000, 65535, 0x1000, 0).hex()]).out
        self.assertRegex(text, r'magnitude +429490\.1760\n')
        self.tells([HPS, *answered(8, 1000, 1, 0x1100, 0)], notes={'magnitude': 'the exponent is over 16'})

    @e2e.each(  # what the datasheet prints, and what it should be
        the_sum_of_the_13_byte_response_is_62=('55 AA 01 01 03 E8 07 D0 07 A1 0D EA 60', '60', '62'),
        the_crc_of_the_request_before_the_exception_is_c5_cb=('01 03 00 08 00 04 C5 C8', 'C5 C8', 'C5 CB'))
    def misprint(self, text, found, expected):
        self.assertEqual(self.one(text, code=1)['checksum'], {'right': False, 'found': found, 'expected': expected})
        self.assertIn(f' {found} WRONG, it should be {expected}', self.run_fathom('decode', text).out)

    def test_a_frame_begins_with_one_ff(self):
        extra, good = self.decode('FF FF 07 A1 A7', code=1)
        self.assertEqual((extra['protocol'], extra['bytes'], good['bytes']), (None, 'FF', 'FF 07 A1 A7'))
        self.assertIn('an FF too many', extra['notes'][0])

    def test_the_command_that_sets_the_address_is_03_and_carries_no_distance(self):
        self.tells(['55 AA 05 03 07'], what='set the address')
        self.tells(['55 AA 05 10 14'], what='measure with probe 1')  # 55 + AA + 05 + 10
        # with data, as the table has it: 55 + AA + 05 + 03 + 07 + A1 = 1AF
        self.assertEqual(self.decode('55 AA 05 03 07 A1 AF', code=1)[-1]['protocol'], None)

    def test_alone_it_is_all_of_these(self):
        whats = [one['what'] for one in self.one(registers(1, 1))['meanings']]
        self.assertEqual(len(whats), 10)
        for word in ('0x0100', '0x0101', '0x0200', '0x0205', '0x0206', '0x0207', 'if a probe was read', '#4', '#6'):
            self.assertTrue(any(word in what for what in whats), (word, whats))

    @e2e.each(
        a_named_a16_leaves_the_others_out=('--sensor a16', registers(1, 1), ['a16'] * 6),
        a_named_a05_leaves_the_others_out=('--sensor a05', registers(1, 1), ['a05'] * 2),
        a_named_hps167s_leaves_the_others_out=(HPS, registers(1, 1), ['hps167s'] * 2),
        too_far_for_a16_and_a05_too_hot_for_4=('', registers(1, 20000), [None]),
        an_hps167s_has_1_to_32=('', registers(40, 77), ['a16', 'a16', 'a16', 'a16', 'a05', 'a05']))
    def sensors(self, options, response, expected):
        self.assertEqual([one.get('model') for one in self.one(*options.split(), response)['meanings']], expected)

    def test_a_refusal_names_the_code_in_both_ways(self):
        found = self.decode(adu(7, 6, 0, 0x10, 0, 40), adu(7, 0x86, 4))[1]
        self.assertEqual(found['name'], 'refuses to write single register')
        self.assertEqual(found['meanings'][0]['fields'], {'exception': 4})
        self.assertEqual(found['meanings'][0]['notes'], {'exception': 'server device failure'})
        self.assertEqual(found['meanings'][1]['what'], 'device operation failed')
        self.assertIn('refuses the request before', found['notes'])


class Damage(Case):
    def test_no_flipped_bit_is_called_right(self):
        """Every single-bit error of the Modbus frames, a line each; the CRC finds them all."""
        frames = [bytes.fromhex(row[0]) for row in FRAMES if row[1] not in ('stream', 'dyp')]
        lines = [bytes(byte ^ (1 << bit) if at == place else byte for at, byte in enumerate(frame))
                 for frame in frames for place in range(len(frame)) for bit in range(8)]
        found = self.decode('--protocol modbus', self.file('\n'.join(line.hex(' ') for line in lines)), code=1)
        self.assertEqual([one['bytes'] for one in found if one.get('checksum', {}).get('right')], [])
        self.assertEqual(sum(one['length'] for one in found), sum(map(len, lines)))

    def test_frames_are_found_in_noise(self):
        chance = random.Random(7)
        noise = [bytes(chance.choice(b'\x00\x12\x34\x77\x9C') for _ in range(chance.randint(0, 9)))
                 for _ in range(200)]
        frames = [asks(3, 0x0101) if i % 2 else registers(3, chance.randrange(500, 9000)) for i in range(200)]
        found = self.decode(self.file(b''.join(a + b for a, b in zip(noise, frames)).hex()), code=1)
        good = [one['bytes'] for one in found if one['protocol'] == 'modbus' and one['checksum']['right']]
        self.assertEqual(good, [frame.hex(' ').upper() for frame in frames])
        self.assertEqual(sum(one['length'] for one in found), sum(map(len, noise + frames)))

    def test_a_stream_that_begins_in_mid_frame_falls_into_step(self):
        stream = b''.join(e2e.frame(mm) for mm in range(700, 760))
        first, *rest = self.decode('--raw', self.file(stream[1:]), code=1)
        self.assertEqual((first['protocol'], first['length']), (None, 3))
        self.assertEqual([one['meanings'][0]['fields']['distance_mm'] for one in rest], list(range(701, 760)))

    def test_a_sum_does_not_win_over_a_crc(self):
        # The response with 65535, 65277 and 64511 in it has FF FF FE FD and FF FF FE FC within: good sums.
        response = registers(1, 0xFFFF, 0xFEFC, 0xFBFF)
        self.one(response)
        self.one(response[:-1] + bytes([response[-1] ^ 1]), code=1)

    @e2e.each(
        a_response_of_12_registers_is_none=('01 03 18' + ' 00' * 26, None),
        an_exception_0c_is_none=('01 83 0C 00 00', None),
        a_request_for_12_registers_is_none=('01 03 01 00 00 0C 85 F6', None),
        a_response_that_ends_early=('01 03 02 02', 'request of 8 or a response of 7 bytes, but ends early'),
        a_long_response_that_ends_early=('01 03 16 B0 00 39 00 25 42 34',
                                         'begins like a Modbus response of 27 bytes, but ends early'),
        a_55_aa_frame_that_ends_early=('55 AA 01', 'begins like a 55 AA frame, but is none'),
        a_byte=('01', ''))
    def leftover(self, text, why):
        """Bytes that are no frame; None: whatever is said of them."""
        found = self.one(text, code=1)
        self.assertEqual(found['protocol'], None)
        if why is not None:
            self.assertEqual(len(found['notes']), 1 if why else 0)
            self.assertIn(why, ' '.join(found['notes']))

    def test_leftovers_and_damaged_frames_keep_to_their_lines(self):
        found = self.decode(self.file('00 11 22\n33 44\n'), code=1)
        self.assertEqual([one['bytes'] for one in found], ['00 11 22', '33 44'])
        found = self.decode(self.file('FF 07 A1 A6\n01 03 02 02 F2 38 A0\nFF 07 A1 A5\n'), code=1)
        self.assertEqual([one['checksum']['expected'] for one in found], ['A7', '38 A1', 'A7'])

    def test_a_named_protocol_finds_no_other(self):
        for option, text, protocol in (('--protocol dyp', WHOLE, None),
                                       ('--protocol stream', 'FF 07 A1 A7', 'stream'),
                                       (HPS, 'FF 07 A1 A7', None)):
            self.assertEqual(self.one(option, text, code=0 if protocol else 1)['protocol'], protocol)

    def test_another_function_is_told(self):
        found = self.one(adu(1, 4, 0, 0, 0, 1))
        self.assertEqual((found['function'], found['name']), (4, 'do what none of these sensors can'))


if __name__ == '__main__':
    e2e.main()
