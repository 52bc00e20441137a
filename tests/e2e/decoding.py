# SPDX-License-Identifier: MIT
"""What the tests of fathom decode share."""
import json

import e2e

READ, WRITE, WRITE_MANY = 'read holding registers', 'write single register', 'write multiple registers'
FIRST, SECOND = 'a16 0x0100 processed distance', 'a16 0x0101 real-time distance'
FOUR = {'probe_1_mm': 1000, 'probe_2_mm': 2000, 'probe_3_mm': 1953, 'probe_4_mm': 3562}
ADDRESSES = ['a16 set 0x0200 slave address', 'a05 set 0x0200 slave address']
DETAILS, MEASURE, RESET = ('hps167s #3 sensor details', 'hps167s #5 single measurement',
                           'hps167s #6 factory reset of the interface')

# Every frame that the datasheets print (misprints corrected), in their order, so that an answer follows its
# request: bytes, protocol, direction, what each sensor takes it for, fields of the last of these.
FRAMES = [
    ('FF 07 A1 A7', 'stream', 'answer', 'a16 automatic or controlled output', {'distance_mm': 1953}),
    ('01 03 01 00 00 01 85 F6', READ, 'request', FIRST, {}),
    ('01 03 02 02 F2 38 A1', READ, 'answer', FIRST, {'distance_mm': 754}),
    ('01 03 01 01 00 01 D4 36', READ, 'request', SECOND, {}),
    ('01 03 02 02 EF F8 A8', READ, 'answer', SECOND, {'distance_mm': 751}),
    ('01 06 02 00 00 05 48 71', WRITE, 'both', ADDRESSES, {'address': 5}),
    ('01 06 02 02 00 01 E8 72', WRITE, 'both', 'a16 set 0x0202 operating mode', {'mode': 'automatic'}),
    ('01 06 02 07 00 01 F8 73', WRITE, 'both', 'a16 set 0x0207 data type of the automatic output',
     {'output': 'real-time'}),
    ('01 06 02 05 00 00 98 73', WRITE, 'both', 'a16 set 0x0205 switch output polarity',
     {'polarity': 'negative'}),
    ('01 06 02 06 07 D0 6B DF', WRITE, 'both', 'a16 set 0x0206 switch threshold', {'threshold_mm': 2000}),
    ('FF 03 E8 07 D0 07 A1 0D EA 60', 'stream', 'answer', 'a05 automatic output', FOUR),
    ('55 AA 01 01 01', 'dyp', 'request', 'a05 measure with all probes', {}),
    ('55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62', 'dyp', 'answer', 'a05 all probes have measured', FOUR),
    ('55 AA 01 10 10', 'dyp', 'request', 'a05 measure with probe 1', {}),
    ('55 AA 01 10 07 A1 B8', 'dyp', 'answer', 'a05 one probe has measured', {'probe_1_mm': 1953}),
    ('55 AA 05 03 07', 'dyp', 'both', 'a05 set the address', {'new_address': 5}),
    ('01 03 01 06 00 01 65 F7', READ, 'request', 'a05 0x0106 distance of probe 1', {}),
    ('01 03 02 01 3C B9 C5', READ, 'answer', 'a05 0x0106 distance of probe 1', {'probe_1_mm': 316}),
    ('01 03 01 07 00 01 34 37', READ, 'request', 'a05 0x0107 distance of probe 2', {}),
    ('01 03 02 09 1B FE 1F', READ, 'answer', 'a05 0x0107 distance of probe 2', {'probe_2_mm': 2331}),
    ('01 03 01 07 00 03 B5 F6', READ, 'request', 'a05 0x0107 distances of probes 2 to 4', {}),
    ('01 03 06 00 FA 02 93 09 7A 8F 47', READ, 'answer', 'a05 0x0107 distances of probes 2 to 4',
     {'probe_2_mm': 250, 'probe_3_mm': 659, 'probe_4_mm': 2426}),
    ('01 06 02 00 00 05 48 71', WRITE, 'both', ADDRESSES, {'address': 5}),
    ('01 03 00 01 00 03 54 0B', READ, 'request', 'hps167s #1 interface version', {}),
    ('01 03 00 02 00 04 E5 C9', READ, 'request', 'hps167s #2 interface configuration', {}),
    ('01 03 00 03 00 0B F4 0D', READ, 'request', DETAILS, {}),
    ('01 03 16 B0 00 39 00 25 42 34 57 14 20 34 38 35 01 06 07 05 13 09 17 03 09 1A DC', READ, 'answer',
     DETAILS,
     {'ack': 'B0', 'uuid': '00390025423457142034383501060705', 'date': '2019-09-23', 'version': '3.9'}),
    ('01 03 00 04 00 01 C5 CB', READ, 'request', 'hps167s #4 AFE temperature', {}),
    ('01 03 00 08 00 04 C5 CB', READ, 'request', MEASURE, {}),
    ('01 03 08 08 23 DC B2 07 01 00 00 FD 41', READ, 'answer', MEASURE,
     {'distance_mm': 2083, 'magnitude': 723.1744, 'ambient': 1, 'precision': 0}),
    ('01 03 00 09 00 01 54 08', READ, 'request', RESET, {}),
    ('01 03 02 00 01 79 84', READ, 'answer', RESET, {'result': 'success'}),
    ('01 06 00 0A 00 05 69 CB', WRITE, 'both', 'hps167s #7 warm-up time', {'warm_up_s': 5}),
    ('01 06 00 11 00 01 18 0F', WRITE, 'both', 'hps167s #9 baud rate', {'baud_code': 1, 'baud_rate': 19200}),
    ('01 06 00 12 00 00 29 CF', WRITE, 'both', 'hps167s #10 measurement after power-on',
     {'continuous_measurement': 'off'}),
    ('01 06 00 13 00 FF 38 4F', WRITE, 'both', 'hps167s #11 termination resistor', {'termination': 'on'}),
    ('01 10 00 20 00 02 40 02', WRITE_MANY, 'answer', 'hps167s #15 reconnect time', {}),
    ('01 83 02 C0 F1', 'refuses to ' + READ, 'answer',
     [' the request is refused', 'hps167s illegal start address or register address'], {}),
]


class Case(e2e.Case):
    def decode(self, *words, code=0):
        """The objects of one run; words are bytes in hex, as text or as they are, and options."""
        words = [word.hex(' ') if isinstance(word, bytes) else word for word in words]
        done = self.run_fathom(['decode', '--format', 'json', *words])
        self.assertEqual((done.code, done.err), (code, ''), done.out)
        return [json.loads(line) for line in done.out.splitlines()]

    def one(self, *words, code=0):
        one, = self.decode(*words, code=code)
        return one

    def meaning(self, *words):
        """The first one."""
        return self.one(*words)['meanings'][0]

    def file(self, text):
        with open(self.path('capture'), 'wb') as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        return self.path('capture')
