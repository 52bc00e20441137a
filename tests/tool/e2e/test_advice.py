#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the tool advises, from what was heard on the line. Each case is one that a wrong cable, setting, device or another
program brings about; the device is scripted. Each row of the table of causes has a case."""
import os
import re
import signal
import subprocess
import sys
import termios
import time

import e2e
import tcp_server

GOOD = e2e.SAYS_754
DAMAGED = bytes((*GOOD[:4], GOOD[4] ^ 0x10, *GOOD[5:]))
NOISE = b'\x80\xF8\x00\x80'
DAMAGED_FRAME = bytes((*e2e.frame(1953)[:3], 0))
CAUSES = ('wiring', 'supply', '--baud', '--parity', '--address', '--timeout', 'termination', 'echo', 'master',
          'damaged', 'refused', 'check', 'try ')
A16, HPS = 'a16 --mode modbus', 'hps167s'
TO_A05 = e2e.frame(1000, 2000, 1953, 3562)

# ---- the table of causes in diagnosis/advice.c ----

STRING = r'"(?:\\.|[^"\\])*"'


def parse_table():
    """The rows, as 'STATUSES: facts': a pattern for the message, and how many characters of it stand in the table."""
    with open(os.path.join(e2e.ROOT, 'examples/fathom/diagnosis/advice.c'), encoding='utf-8') as file:
        text = re.sub(r'\\\n', ' ', file.read())
    macros = dict(re.findall(rf'^#define (\w+) +((?:{STRING}|\w+|\s)+?)$', text, re.M))
    rows = {}
    text = text[text.index(' causes[] = {'):text.index(' failures[] = {')]
    for statuses, facts, what, advice in re.findall(
            rf'{{([A-Z_ |]+), "([^"]*)",\s+((?:{STRING}|[A-Z_]+|\s)+),\s+((?:{STRING}|[A-Z_]+|\s)+)}}', text):
        def expand(words):
            return ''.join(part[1:-1] if part[0] == '"' else expand(macros[part])
                           for part in re.findall(rf'{STRING}|\w+', words))
        whole = expand(what) + ('' if advice == 'NULL' else '. ' + expand(advice))
        pattern = ''
        for part in re.findall(r'\[[\w-]+:|\]|\{[\w-]+\}|[^\[\]{}]+', whole):
            pattern += {'[': '(?:', ']': ')?', '{': '.*'}.get(part[0]) or re.escape(part)
        rows[f'{statuses}: {facts}'] = (re.compile(pattern + '[.]?$'), len(re.sub(r'\[.*?\]|\{.*?\}', '', whole)), whole)
    return rows


ROWS = parse_table()
# Rows whose evidence needs a clock, pins or a port that a test in C simulates, or a server: the file that expects the text.
ELSEWHERE = {
    'PORT: ': 'test_tool_scan.c',
    'UNSUPPORTED: ': 'test_tool_scan.c',
    **{f'{status}: pins{more}': 'test_tool_pins.c' for status, more in (
        ('NO_RESPONSE', ' noises'), ('NO_RESPONSE', ''), ('MALFORMED', ''), ('STALE', ''))},
    **{f'{status}: {facts}': 'e2e/test_tcp.py' for status, facts in (
        ('NO_RESPONSE', 'asked gateway-busy'), ('NO_RESPONSE', 'asked gateway'),
        ('NO_RESPONSE', 'asked other-unit'),
        ('NO_RESPONSE', 'asked other-identifier'), ('NO_RESPONSE', 'asked incomplete'),
        ('NO_RESPONSE', 'asked tcp bytes'), ('NO_RESPONSE', 'asked tcp'),
        ('NO_RESPONSE', 'asked tcp worked'), ('CHECKSUM', 'asked tcp'))},
    **{f'{status}: {facts}': 'e2e/test_gateway.py' for status, facts in (
        ('NO_RESPONSE', 'asked closed'), ('NO_RESPONSE', 'asked rtu'), ('NO_MATCH', 'asked converter mbap'))},
    'LINE_BUSY: asked': 'test_tool_request.c',
    'OTHER_MASTER: request': 'test_tool_request.c',
    'OTHER_MASTER: ': 'interop/test_servers_raw.py',
}
# No script brings these about: a network that loses the first packet of a connection, a pulse that no program read for 2.5 s, a frame of the unit that the line drops, floods that
# leave no silence on a busy machine, and the end of the table, the library's words for what no row explains.
UNEXPLAINED = {'PORT: connecting', 'STALE: pins pulses', 'NO_RESPONSE: asked own', 'LINE_BUSY: asked own', 'LINE_BUSY: asked worked',
               'LINE_BUSY: asked tcp', 'ANY: '}
AUTO, MODBUS = 'read a16 --format csv --timeout 400', 'read a16 --mode modbus --format csv --timeout 400'
SENSOR = 'read hps167s --format csv --timeout 400'
FRAME = e2e.frame(1953)
TAKEN = 'PORT: lost taken'
EVERYONE = 'GOOD | NO_MATCH | STALE | MALFORMED | OTHER_MASTER'


def repeat(data, pause=0.04):
    """Sends this again and again, until the expected message was printed."""
    def step(test, device, reader):
        os.set_blocking(device.master, False)
        end = time.monotonic() + e2e.PATIENCE
        seen = b''
        while not reader.has_ended(pause) and time.monotonic() < end:
            if seen != reader.said['err'] and test.has_named(reader):
                break
            seen = reader.said['err']
            try:
                device.write(data)
            except BlockingIOError:
                pass
    return step


def late(test, device, reader):
    reader.expect('attempt 1', 'err')
    device.write(GOOD)


def hold(test, device, reader):
    """Another program opens the port and reads nothing."""
    with open(device.port, 'rb', buffering=0) as port:
        process = subprocess.Popen(['sleep', '60'], stdin=port)  # pylint: disable=consider-using-with
    test.addCleanup(process.wait)
    test.addCleanup(process.kill)


def hang_up(test, device, reader):
    """As getty does. Without the rights of root, a setting of the port is changed instead."""
    if os.geteuid() != 0:
        change(test, device, reader)
        return
    subprocess.run([sys.executable, '-c', 'import ctypes, fcntl, os, sys, termios; os.setsid(); '
                    'fcntl.ioctl(os.open(sys.argv[1], os.O_RDWR), termios.TIOCSCTTY, 1); '
                    'ctypes.CDLL(None).vhangup()', device.port], check=False)  # SIGHUP ends it


def change(test, device, reader):
    settings = termios.tcgetattr(device.slave)
    settings[4] = settings[5] = termios.B115200
    termios.tcsetattr(device.slave, termios.TCSANOW, settings)


def reading(test, device, reader):
    """Frames until one of them is a reading."""
    while not reader.hear(lambda: b',1953,' in reader.said['out'], 0.06):
        device.write(FRAME)


def frames(*parts):
    """A stream whose frames are these, in turns."""
    def step(test, device, reader):
        for part in parts * 60:
            device.write(part)
            reader.has_ended(0.01)
    return step


class Table(e2e.Case):
    wanted = {}  # of the running cases, by program

    def has_named(self, reader):
        """The row of one of its messages is the expected one: of the rows that fit, the one with the longest text."""
        for line in reader.lines('err'):
            fits = [key for key, (pattern, _, _) in ROWS.items() if pattern.search(line)]
            if max(fits, key=lambda key: ROWS[key][1], default=None) == self.wanted[reader]:
                return True
        return False

    def shows(self, key, line, *steps, port=None, device=None, **options):
        device = device or self.device()
        reader = self.fathom(line, ['--port', port or device.port], **options)
        self.wanted[reader] = key
        if '--format csv' in line:
            reader.expect('^name,')
        for step in steps:
            if callable(step):
                step(self, device, reader)
            elif isinstance(step, tuple):
                device.asked(*step)
            else:
                device.write(step)
        if not reader.hear(lambda: self.has_named(reader)):
            reader.fail(f'{key} did not come')

    ASKED, OF_HPS = e2e.ASK_A16, e2e.ASK_HPS
    CASES = (
        (TAKEN + ' holder' if os.geteuid() == 0 else f'{EVERYONE}: holder', AUTO, hold,
         lambda test, device, reader: reader.expect('attempt 1', 'err'), hang_up),  # a search serves 200 ms
        (TAKEN if os.geteuid() == 0 else f'{EVERYONE}: changed', AUTO, hang_up),
        ('PORT: lost waits', AUTO + ' --reconnect', lambda test, device, reader: device.hang_up()),
        ('PORT: lost', AUTO, lambda test, device, reader: device.hang_up()),
        ('CANCELLED: ', 'request 1 3 0x0101 1 --timeout 10000', (e2e.adu(1, 3, 1, 1, 0, 1),),
         lambda test, device, reader: reader.send(signal.SIGINT)),
        (f'{EVERYONE}: holder', AUTO, hold),
        (f'{EVERYONE}: holder', MODBUS, hold, (ASKED, DAMAGED)),
        (f'{EVERYONE}: changed', AUTO, change),
        ('GOOD: ', AUTO, frames(FRAME, FRAME, DAMAGED_FRAME)),
        ('NO_RESPONSE | CHECKSUM: triggered', AUTO + ' --mode controlled'),
        ('NO_RESPONSE | CHECKSUM: triggered bytes', AUTO + ' --mode controlled', (b'\0', e2e.frame(1953)[:3] + b'\0')),
        ('NO_RESPONSE | CHECKSUM: triggered automatic', 'read a02yytw --format csv', repeat(FRAME, 0.1)),
        ('NO_RESPONSE | CHECKSUM | STALE: zeros', 'read a02yytw --format csv', repeat(b'\0', 0.1)),
        ('NO_RESPONSE | CHECKSUM | STALE: zeros', 'read a02yyuw --format csv --timeout 400', repeat(b'\0', 0.1)),
        ('NO_RESPONSE | CHECKSUM: triggered relative', 'read a02yytw --format csv --timeout 400'),
        ('NO_RESPONSE: asked late', MODBUS, late),
        ('NO_MATCH: asked headless', MODBUS, (ASKED, GOOD[1:])),
        ('NO_MATCH: asked headless', MODBUS, (ASKED, GOOD), (ASKED, b'\xC5\x30' + GOOD[3:])),
        ('NO_MATCH: asked headless', MODBUS, (ASKED, ASKED + b'\x80' + GOOD[1:])),
        ('NO_MATCH: asked headless', 'read a05 --mode dyp --format csv --timeout 400',
         (bytes.fromhex('55 AA 01 01 01'), bytes.fromhex('01 01 02 F2 02 F2 02 F2 02 F2 D1'))),
        ('NO_MATCH: asked headless', 'request 0x15 4 0 1', (e2e.adu(21, 4, 0, 0, 0, 1), bytes.fromhex('C5 30 00 01 48 F3'))),
        ('NO_MATCH: asked masters', MODBUS, (ASKED, e2e.adu(5, 3, 0, 8, 0, 4))),
        ('NO_MATCH: asked foreign impossible', SENSOR, (OF_HPS, e2e.registers(200, 1, 2, 3, 4))),
        ('NO_MATCH: asked foreign', MODBUS, (ASKED, e2e.registers(7, 754))),
        ('NO_MATCH | STALE: stream', MODBUS, (ASKED, FRAME * 3)),
        ('STALE | CHECKSUM: listened silence worked', AUTO, reading),
        ('STALE | CHECKSUM: listened silence addressed', SENSOR + ' --mode auto'),
        ('STALE | CHECKSUM: listened silence relative', 'read a02yyuw --format csv --timeout 400'),
        ('STALE | CHECKSUM: listened silence', AUTO),
        ('STALE | CHECKSUM: listened addressed foreign', SENSOR + ' --mode auto', e2e.registers(5, 2083, 1, 2, 3)),
        ('STALE | CHECKSUM: listened modbus relative', 'read a02yyuw --format csv --timeout 400', repeat(e2e.ASK_A16 + GOOD)),
        ('STALE | CHECKSUM: listened modbus', AUTO, e2e.ASK_A16),
        ('STALE | CHECKSUM: listened modbus', AUTO, repeat(GOOD)),
        ('STALE | CHECKSUM: listened ambiguous', AUTO, repeat(e2e.frame(511) * 50, 0)),
        ('STALE | CHECKSUM: listened worked', AUTO, reading, repeat(NOISE)),
        ('STALE | CHECKSUM: listened', AUTO, repeat(NOISE)),
        ('EXCEPTION: ', MODBUS, (ASKED, e2e.adu(1, 0x83, 2))),
        ('NO_MATCH | MALFORMED: asked crowded', SENSOR, (OF_HPS, e2e.registers(1, 1, 2) * 3)),
        ('NO_RESPONSE: asked only-echo', MODBUS, (ASKED, ASKED)),
        ('NO_RESPONSE: asked bytes worked', MODBUS, (ASKED, GOOD), (ASKED, NOISE)),
        ('NO_RESPONSE: asked bytes', MODBUS, (ASKED, NOISE)),
        ('NO_RESPONSE: asked worked', MODBUS, (ASKED, GOOD)),
        ('NO_RESPONSE: asked others', 'read a16:1:modbus a16:2:modbus --format csv --timeout 400', (ASKED, GOOD)),
        ('NO_RESPONSE: asked', MODBUS),
        ('CHECKSUM: asked tty part', MODBUS, (ASKED, GOOD[:5])),
        ('NO_MATCH: asked tty pieces', MODBUS, (ASKED, GOOD[:3]),
         lambda test, device, reader: reader.expect('attempt 1', 'err'), GOOD[3:], (ASKED, GOOD[:3])),
        ('CHECKSUM: asked worked', MODBUS, (ASKED, GOOD), (ASKED, DAMAGED)),
        ('CHECKSUM: asked', MODBUS, (ASKED, DAMAGED)),
        ('MALFORMED: unexpected', MODBUS, (ASKED, e2e.registers(1, 754, 754))),
        ('MALFORMED: setting', 'get a16:1 automatic-value --timeout 400', (e2e.adu(1, 3, 2, 7, 0, 1), e2e.registers(1, 9999))),
        ('MALFORMED: refused code', MODBUS, (ASKED, e2e.registers(1, 0xFFFF))),
        ('MALFORMED: refused', MODBUS, (ASKED, e2e.registers(1, 20000))),
        ('MALFORMED: ', SENSOR + ' --window 80-5000', (OF_HPS, e2e.registers(1, 5001, 1, 2, 3))),
    )

    @e2e.each(*CASES)
    def row(self, key, line, *steps):
        self.shows(key, line, *steps)

    def test_the_console_of_the_kernel_is_a_cause(self):
        root = self.path('root')
        os.makedirs(f'{root}/dev')
        device = self.device()
        os.symlink(device.port, f'{root}/dev/ttyUSB0')
        os.makedirs(f'{root}/sys/class/tty/console')
        with open(f'{root}/sys/class/tty/console/active', 'w', encoding='ascii') as file:
            file.write('tty0 ttyUSB0\n')
        self.shows('NO_MATCH | STALE | MALFORMED: console bytes', AUTO,
                   lambda test, device, reader: reader.expect('ttyUSB0: the port is the console of the kernel', 'err'),
                   repeat(NOISE), device=device, port='/dev/ttyUSB0', env=self.preload('usb_shim.c', USB_ROOT=root))

    def test_a_connection_that_is_lost_is_a_cause(self):
        server = tcp_server.Server()
        self.addCleanup(server.close)

        def leave(test, device, reader):
            server.accept()
            server.request()
            server.say(b'\xff' * 8)
        self.shows('PORT: lost network', 'read a16::modbus --timeout 400', leave, port=str(server))

    def test_a_computer_that_was_asleep_is_a_cause(self):
        """For 600 s; no time-out ends before. The kernel passes bytes to the slave of a pseudo terminal some time after the
        write: the tool goes on as soon as they are there."""
        woken = self.path('woken')

        def asleep(test, device, reader):
            reader.until_asleep()
            reader.send(signal.SIGSTOP)
            with open(woken, 'wb'):
                device.write(GOOD)
            test.assertTrue(e2e.is_ready(device.slave, e2e.PATIENCE))
            reader.send(signal.SIGCONT)
        self.shows('NO_RESPONSE: asked old', 'read a16 --mode modbus --format csv --timeout 60000', (e2e.ASK_A16,), asleep,
                   env=self.preload('clock_shim.c', LATER_IF=woken))

    def test_every_row_has_a_case(self):
        cases = {case[0] for case in self.CASES} | set(ELSEWHERE) | UNEXPLAINED
        cases |= {'NO_MATCH | STALE | MALFORMED: console bytes', 'PORT: lost network', 'NO_RESPONSE: asked old', TAKEN,
                  TAKEN + ' holder'}
        self.assertEqual(set(ROWS), cases)

    def test_a_row_that_is_shown_elsewhere_is_expected_there(self):
        for key, name in ELSEWHERE.items():
            with open(os.path.join(e2e.ROOT, 'tests/tool', name), encoding='utf-8') as file:
                text = re.sub(r'"\s*"|\'\s*f?\'', '', file.read())
            parts = [part.strip(' (:.') for part in re.split(r'\[.*?\]|\{.*?\}', ROWS[key][2])]
            self.assertTrue(any(part[:22] in text for part in parts if len(part) > 15), (key, name, parts))


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
        a_silent_module_names_its_other_forms_by_their_letters=(
            'a02yyuw', b'', r'read it as that: a02yytw \(T, controlled\), a02yymw \(M, pwm\), a02yy4w \(4, modbus\)$'),
        a_silent_board_names_its_other_forms_by_their_resistors=(
            'aj-sr04m', b'', r'read it as that: aj-sr04m::controlled \(R19 = 47k\), aj-sr04m::pwm \(R19 open, or 300k\)$'),
        a_silent_board_with_a_trigger_does_so_too=(
            'jsn-sr04t::controlled', b'', r': jsn-sr04t::auto \(47k, or pad M1\), jsn-sr04t::pwm \(resistor open, or 360k\), '
            r'jsn-sr04t::free \(200k\)$'),
        a_silent_module_without_other_forms_names_none=('r01uw', b'', r"wire of the sensor's TX$"),
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
