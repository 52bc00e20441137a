#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom decode: what a request makes of its answer, the commands of the HPS-167S, and bytes that are
damaged."""
import random

import decoding
import e2e
from e2e import ASK_A16, adu, registers

UNKNOWN = 'its request is not here; what it answers hangs on that'


def asks(unit, address, count=1):
    return adu(unit, 3, *divmod(address, 256), 0, count)


class Context(decoding.Case):
    def asked(self, request, answer, *words):
        """What the answer means."""
        found = self.decode(*words, request, answer)
        self.assertEqual([one['direction'] for one in found], ['request', 'answer'])
        return found[1]['meanings']

    def test_one_answer_is_explained_by_each_request(self):
        for address, fields in (
                (0x0100, {'distance_mm': 1}), (0x0200, {'address': 1}), (0x0205, {'polarity': 'positive'}),
                (0x0206, {'threshold_mm': 1}), (0x0207, {'output': 'real-time'}), (0x0108, {'probe_3_mm': 1}),
                (0x0010, {'probe_1_mm': 1}), (0x0013, {'probe_4_mm': 1}), (0x0009, {'result': 'success'}),
                (0x0004, {'temperature_f': 1, 'temperature_c': -17.2})):  # (1 - 32) * 5 / 9 = -17.22
            with self.subTest(hex(address)):
                self.assertEqual(self.asked(asks(1, address), registers(1, 1))[-1]['fields'], fields)

    def test_alone_it_is_all_of_these(self):
        whats = [one['what'] for one in self.one(registers(1, 1))['meanings']]
        self.assertEqual(len(whats), 10)
        for word in ('0x0100', '0x0101', '0x0200', '0x0205', '0x0206', '0x0207', 'if a probe was read', '#4',
                     '#6'):
            self.assertTrue(any(word in what for what in whats), (word, whats))

    def test_a_named_sensor_leaves_the_others_out(self):
        for sensor, count in (('a16', 6), ('a05', 2), ('hps167s', 2)):
            told = self.one('--sensor', sensor, registers(1, 1))['meanings']
            self.assertEqual([one['sensor'] for one in told], [sensor] * count)

    def test_what_a_sensor_cannot_have_meant_is_left_out(self):
        told = self.one(registers(1, 20000))['meanings']  # too far for a16 and a05, too hot for #4
        self.assertEqual([one.get('sensor') for one in told], [None])
        told = self.one(registers(40, 77))['meanings']  # an HPS-167S has 1..32
        self.assertNotIn('hps167s', [one['sensor'] for one in told])

    def test_an_answer_from_another_unit_is_not_the_one(self):
        found = self.decode(ASK_A16, registers(2, 700), registers(1, 754))
        self.assertIn(UNKNOWN, found[1]['notes'])
        self.assertEqual([one['what'] for one in found[2]['meanings']], ['0x0100 processed distance'])

    @e2e.each(an_answer_of_another_length_is_not_the_one=(ASK_A16, registers(1, 700, 800), 0),
              a_damaged_request_explains_nothing=('01 03 01 00 00 01 85 F7', registers(1, 754), 1))
    def unexplained(self, request, answer, code):
        self.assertIn(UNKNOWN, self.decode(request, answer, code=code)[1]['notes'])

    def test_a_request_is_answered_once(self):
        found = self.decode(ASK_A16, registers(1, 700), registers(1, 701))
        self.assertEqual([bool(one['notes']) for one in found], [False, False, True])

    def test_broadcast_to_a16_is_answered_from_another_address(self):
        self.assertEqual(self.asked(asks(255, 0x0200), registers(9, 9))[-1]['fields'], {'address': 9})

    def test_a_write_that_comes_twice_is_acknowledged(self):
        found = self.decode(*['01 06 02 00 00 05 48 71'] * 2)
        self.assertEqual([one['notes'] for one in found],
                         [[], ['acknowledges the request before, or is its echo']])

    def test_a_refusal_names_the_code_in_both_ways(self):
        found = self.decode(adu(7, 6, 0, 0x10, 0, 40), adu(7, 0x86, 4))[1]
        self.assertEqual(found['name'], 'refuses to write single register')
        self.assertEqual(found['meanings'][0]['fields'], {'exception': 4})
        self.assertEqual(found['meanings'][0]['notes'], {'exception': 'server device failure'})
        self.assertEqual(found['meanings'][1]['what'], 'device operation failed')
        self.assertIn('refuses the request before', found['notes'])


class Hps167s(decoding.Case):
    def asked(self, address, *values):
        """What these registers mean when they are asked for."""
        return self.decode('--sensor', 'hps167s', asks(1, address, len(values)),
                           registers(1, *values))[1]['meanings'][0]

    def test_1_is_a_date_and_a_version(self):
        told = self.asked(1, 0x1409, 0x1B02, 0x0100)  # 20 09 27, 2 1 0
        self.assertEqual(told['fields'], {'date': '2020-09-27', 'version': '2.1.0'})

    def test_2_is_the_configuration(self):
        told = self.asked(2, 0xFF00, 0x0500, 0x0000, 0xB403)
        self.assertEqual(told['fields'], {'termination': 'on', 'continuous_output': 'off', 'warm_up_s': 5,
                                          'reconnect_time_ms': 180, 'baud_code': 3, 'baud_rate': 115200})
        self.assertEqual(told['notes'], {})
        told = self.asked(2, 0x0100, 0x0500, 0x0000, 0xB505)  # 01, 181 ms, code 5
        self.assertEqual(set(told['notes']), {'termination', 'reconnect_time_ms', 'baud_code'})

    def test_4_is_fahrenheit_and_celsius(self):
        for degrees_f, celsius in ((77, 25.0), (14, -10.0), (0x10000 - 40, -40.0), (100, 37.8), (31, -0.6),
                                   (32, 0.0)):
            self.assertEqual(self.asked(4, degrees_f)['fields']['temperature_c'], celsius)

    def test_5_tells_targets_from_what_is_none(self):
        no_distance, no_target = 'no distance that it can mean', 'no target: out of range, or too weak'
        for values, note in (
                ((30000, 1, 1, 0), None), ((30001, 1, 1, 0), no_distance), ((0, 1, 1, 0), no_distance),
                ((65529, 1, 1, 0), no_distance), ((65530, 1, 1, 0), no_target), ((65534, 1, 1, 0), no_target),
                ((65535, 0, 0x00FF, 65535), 'the abnormal packet: the sensor has failed'),
                ((65535, 1, 0x00FF, 65535), 'no distance: a fault')):
            with self.subTest(values):
                self.assertEqual(self.asked(8, *values)['notes'].get('distance_mm'), note)

    def test_the_magnitude_is_exact(self):
        # 65535 << 16 = 4294901760; an exponent over 16 is not believed.
        text = self.run_fathom(['decode', registers(1, 1000, 65535, 0x1000, 0).hex()]).out
        self.assertRegex(text, r'magnitude +429490\.1760\n')
        self.assertEqual(self.asked(8, 1000, 1, 0x1100, 0)['notes'], {'magnitude': 'the exponent is over 16'})

    def test_what_is_written(self):
        for address, value, fields, notes in (
                (0x0A, 256, {'warm_up_s': 256}, 1), (0x10, 32, {'new_address': 32}, 0),
                (0x10, 33, {'new_address': 33}, 1),
                (0x11, 4, {'baud_code': 4, 'baud_rate': 230400}, 0),
                (0x11, 9, {'baud_code': 9, 'baud_rate': 19200}, 1),
                (0x12, 0xFF, {'continuous_measurement': 'on'}, 0), (0x13, 7, {'termination': '0x0007'}, 1),
                (0x14, 0xFFF1, {'offset_mm': -15}, 0), (0x15, 0, {'settings': 'of the user'}, 0),
                (0x15, 0xFF, {'settings': 'of the factory'}, 0), (0x15, 1, {'settings': '0x0001'}, 1),
                (0x16, 0xFF9C, {'filter_sensitivity': -100}, 0), (0x16, 101, {'filter_sensitivity': 101}, 1)):
            with self.subTest((address, value)):
                told = self.meaning('--sensor', 'hps167s', adu(1, 6, 0, address, *divmod(value, 256)))
                self.assertEqual((told['fields'], len(told['notes'])), (fields, notes))

    def test_15_is_32_bits(self):
        for ms, notes in ((180, {}), (0x12345678 // 18 * 18, {}),
                          (181, {'reconnect_time_ms': 'no multiple of 18'})):
            told = self.meaning(adu(1, 16, 0, 0x20, 0, 2, 4, *ms.to_bytes(4, 'big')))
            self.assertEqual(told, {**told, 'what': '#15 reconnect time', 'fields': {'reconnect_time_ms': ms},
                                    'notes': notes})

    def test_what_resets_the_device_says_so(self):
        self.assertIn('hps167s: resets the device', self.one(asks(1, 9))['notes'])
        self.assertIn("hps167s: resets the device's settings", self.one(adu(1, 6, 0, 0x15, 0, 0xFF))['notes'])
        self.assertEqual(self.one(adu(1, 6, 0, 0x15, 0, 0))['notes'], [])

    def test_a_wrong_length_is_told(self):
        self.assertIn('hps167s: #5 has 4 registers, not 3; it refuses this', self.one(asks(1, 8, 3))['notes'])


def dyp(*data):
    """55 AA, then these, then the low byte of the sum."""
    frame = bytes((0x55, 0xAA, *data))
    return frame + bytes([sum(frame) & 0xFF])


class Ultrasonic(decoding.Case):
    def test_each_probe_of_the_55_aa_protocol(self):
        for probe in (1, 2, 3, 4):
            asked, told = self.decode(dyp(9, 0x0F + probe), dyp(9, 0x0F + probe, 3, 0xE8))
            self.assertEqual((asked['meanings'][0]['what'], asked['address']),
                             (f'measure with probe {probe}', 9))
            self.assertEqual(told['meanings'][0]['fields'], {f'probe_{probe}_mm': 1000})

    def test_what_the_55_aa_protocol_does_not_have_is_told(self):
        found = self.one(dyp(1, 0x14))
        self.assertEqual((found['command'], found['meanings'][0]['what']), (0x14, 'no command of it'))
        self.assertEqual(self.meaning(dyp(0xFF, 3))['notes'], {'new_address': 'not from 1 to 254'})
        self.assertIn('FF is the broadcast address', self.one(dyp(0xFF, 1))['notes'][0])
        self.assertIn('every a05 on the line obeys', self.one(dyp(5, 3))['notes'][0])

    def test_distances_that_are_none_are_told(self):
        for value, note in ((0, 'no target, as older firmware says it'), (0xFFFD, 'no target'),
                            (0xFFFE, 'no target: interference by another unit')):
            for frame in (e2e.frame(value), dyp(1, 0x10, *divmod(value, 256))):
                self.assertEqual(list(self.meaning(frame)['notes'].values()), [note])

    def test_reads_that_an_a05_does_not_have_are_told(self):
        self.assertEqual(self.meaning('--sensor', 'a05', asks(1, 0x0108, 3))['what'],
                         '0x0108 is probe 3, and a read may not go past the last one')

    def test_registers_of_an_a16_that_go_one_way_are_told(self):
        self.assertIn('a16: 0x0202 can be written only', self.one(asks(1, 0x0202))['notes'])
        self.assertEqual(self.meaning(adu(1, 6, 1, 0, 0, 1))['what'],
                         '0x0100 processed distance, which can be read only')
        self.assertEqual(self.meaning(adu(1, 6, 2, 5, 0, 2))['notes'], {'polarity': 'not 0 or 1'})
        self.assertEqual(self.meaning(adu(1, 6, 2, 0, 0, 255))['notes'], {'address': 'not from 0 to 254'})
        self.assertIn('a16: a read of several registers is not in its datasheet',
                      self.one(asks(1, 0x0100, 2))['notes'])

    def test_what_no_sensor_has_is_told(self):
        told, = self.one(asks(1, 0x1234, 2))['meanings']
        self.assertEqual(told['what'], 'none of these sensors knows this')
        self.assertEqual(told['fields'], {'address': '0x1234', 'registers': 2})


class Damage(decoding.Case):
    def test_no_flipped_bit_is_called_right(self):
        """Every single-bit error of the Modbus frames, a line each; the CRC finds them all."""
        frames = [bytes.fromhex(row[0]) for row in decoding.FRAMES if row[1] not in ('stream', 'dyp')]
        lines = [bytes(byte ^ (1 << bit) if at == place else byte for at, byte in enumerate(frame))
                 for frame in frames for place in range(len(frame)) for bit in range(8)]
        found = self.decode('--protocol', 'modbus', self.file('\n'.join(line.hex(' ') for line in lines)),
                            code=1)
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
        # The answer with 65535, 65277 and 64511 in it has FF FF FE FD and FF FF FE FC within: good sums.
        answer = registers(1, 0xFFFF, 0xFEFC, 0xFBFF)
        self.one(answer)
        self.one(answer[:-1] + bytes([answer[-1] ^ 1]), code=1)

    def test_noise_is_not_taken_for_frames_that_no_sensor_sends(self):
        for noise in ('01 03 18' + ' 00' * 26, '01 83 0C 00 00', '01 03 01 00 00 0C 85 F6'):
            with self.subTest(noise):
                self.assertEqual(self.one(noise, code=1)['protocol'], None)

    def test_what_ends_early_is_told(self):
        for text, why in (('01 03 02 02', 'request of 8 or an answer of 7 bytes, but ends early'),
                          ('01 03 16 B0 00 39 00 25 42 34',
                           'begins like a Modbus answer of 27 bytes, but ends early'),
                          ('55 AA 01', 'begins like a 55 AA frame, but is none')):
            with self.subTest(text):
                found = self.one(text, code=1)
                self.assertEqual((found['protocol'], len(found['notes'])), (None, 1))
                self.assertIn(why, found['notes'][0])
        self.assertEqual(self.one('01', code=1)['notes'], [])

    def test_leftovers_end_with_the_line(self):
        found = self.decode(self.file('00 11 22\n33 44\n'), code=1)
        self.assertEqual([one['bytes'] for one in found], ['00 11 22', '33 44'])

    def test_damaged_frames_keep_to_their_lines(self):
        found = self.decode(self.file('FF 07 A1 A6\n01 03 02 02 F2 38 A0\nFF 07 A1 A5\n'), code=1)
        self.assertEqual([one['checksum']['expected'] for one in found], ['A7', '38 A1', 'A7'])

    def test_a_named_protocol_finds_no_other(self):
        for name, text, protocol in (('--protocol dyp', '01 03 02 02 F2 38 A1', None),
                                     ('--protocol stream', 'FF 07 A1 A7', 'stream'),
                                     ('--sensor hps167s', 'FF 07 A1 A7', None)):
            self.assertEqual(self.one(*name.split(), text, code=0 if protocol else 1)['protocol'], protocol)

    def test_another_function_is_told(self):
        found = self.one(adu(1, 4, 0, 0, 0, 1))
        self.assertEqual((found['function'], found['name']), (4, 'do what none of these sensors can'))


if __name__ == '__main__':
    e2e.main()
