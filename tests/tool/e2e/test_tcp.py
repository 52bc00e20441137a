#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read over TCP: what it says and returns when there is no connection, when it breaks, and when what
comes is late, cut, glued, another's or no Modbus at all. It needs real time: CTest runs one such file at a time."""
import os
import re
import socket
import threading
import time

import e2e
import tcp_server
from tcp_server import adu, registers

SAID = (0x0823, 0xDCB2, 0x0701, 0)  # HPS-167S #5: 2083 mm
OTHER = (0x03E8, 0xDCB2, 0x0701, 0)  # 1000 mm
NONSENSE = 'the received bytes are not Modbus TCP. Check the port number (usually 502)'


class Case(tcp_server.Case):
    def reader(self, options='', server=None):
        """A server, and a tool that has connected."""
        server = server or self.server()
        timeout = '' if '--timeout' in options else '--timeout 5000'
        reader = self.fathom(f'read hps167s --port {server} --format csv {timeout} {options}')
        server.accept()
        return server, reader

    def asked(self, server, unit=1):
        """The transaction of the next request, which is HPS-167S #5."""
        transaction, asked, rest = server.request()
        self.assertEqual((asked, rest), (unit, bytes((3, 0, 8, 0, 4))))
        return transaction

    def reads(self, reader, code, mm, *said):
        self.assertEqual(self.ends(reader, code, *said).mm, [str(one) for one in mm])

    def meanwhile(self, work):
        """Does this over and over, until it says that it is over or the connection is gone."""
        def run():
            try:
                while work():
                    pass
            except (OSError, AssertionError):  # the tool has what it wanted
                pass
        worker = threading.Thread(target=run, daemon=True)
        worker.start()
        self.addCleanup(worker.join, e2e.PATIENCE)


class NoConnection(Case):
    def fails(self, port, *words, code=1):
        done = self.ends(['read', 'hps167s', '--port', port, '--count', '1'], code, *words, out='')
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        return done

    @e2e.each(refused=socket.AF_INET, refused_at_an_ipv6_address=socket.AF_INET6)
    def refused(self, family):
        server = self.server(backlog=None, family=family)
        self.fails(str(server),
                   f'{server}: Connection refused: nothing serves this port; check it (502 is usual)')

    @e2e.each(
        an_unknown_host=('tcp:no-such-host.invalid', 'the host is not known: ',
                         'check its name, or give its address in numbers'),
        # A broadcast address: no connection leads there.
        an_address_without_a_way=('tcp:127.255.255.255',
                                  'Network is unreachable: there is no way to this address'))
    def nowhere(self, port, words, more=''):
        self.fails(port, f'{port}: {words}', more)

    def test_no_response_to_the_connection_is_given_up_after_5_seconds(self):
        done = self.fails(self.full(), ': Connection timed out: nothing answers at this address')
        self.assertGreaterEqual(done.elapsed, 5)
        self.needs_little(done)

    @e2e.each(a_signal_ends_the_wait_of_read_for_a_connection=('read hps167s', 0),
              a_signal_ends_the_wait_of_a_session_for_a_connection=('get hps167s baud', 1))
    def ended(self, command, code):
        reader = self.fathom(f'{command} --port {self.full()}')
        # It connects when it has its socket; a signal before that ends it as well.
        deadline = time.monotonic() + e2e.PATIENCE
        while not self.has_socket(f'/proc/{reader.process.pid}/fd'):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.005)
        self.assertNotIn('timed out', self.ends(reader.end(), code).err)

    @staticmethod
    def has_socket(folder):
        try:
            return any('socket:' in os.readlink(f'{folder}/{name}') for name in os.listdir(folder))
        except FileNotFoundError:
            return False

    @e2e.each(**{f'paths_that_are_none_{words.replace(" ", "_")}': (words, *paths) for words, *paths in (
        ('the host is missing', '', ':502', '[]:502'), ('the bracket', '[::1'), ('in brackets', '::1'),
        ('the port is a number', 'h:0', 'h:65536', 'h:', 'h:5 ', '[::1]502'), ('too long', 'h' * 256))})
    def none(self, words, *paths):
        for path in paths:
            self.fails(f'tcp:{path}', words, "See 'fathom read --help'.", code=2)

    @e2e.each(**{f'what_needs_a_serial_port_is_refused_{sensor}_{mode}': (sensor, mode) for sensor, mode in
                 (('a16', 'auto'), ('a05', 'auto'), ('a05', 'dyp'))})
    def serial(self, sensor, mode):
        self.ends(f'read {sensor} --mode {mode} --port {self.server()}', 2,
                  f'mode {mode} needs a serial port. Over TCP, use Modbus: {sensor}:modbus, or a converter', out='')


class Responses(Case):
    def test_a_reading(self):
        server, reader = self.reader('--address 7 --count 1')
        server.say(registers(self.asked(server, 7), 7, *SAID))
        self.reads(reader, 0, [2083])

    def test_a_reading_from_an_ipv6_address(self):
        server, reader = self.reader('--count 1', self.server(family=socket.AF_INET6))
        server.say(registers(self.asked(server), 1, *SAID))
        self.reads(reader, 0, [2083])

    def test_after_a_response_in_pieces_a_short_one_is_seen_at_once(self):
        """Meanwhile the system woke the tool for a whole response only."""
        server, reader = self.reader('--count 2 --timeout 60000')
        response = registers(self.asked(server), 1, *SAID)
        server.say(response[:10])
        reader.until_asleep()  # it has seen the half
        server.say(response[10:])
        transaction = self.asked(server)
        reader.until_asleep()
        server.say(adu(transaction, 1, 0x83, 2))
        self.reads(reader, 1, [2083], 'refused the request: exception 02')

    def test_half_a_response_is_none_and_costs_no_time_of_the_processor(self):
        server, reader = self.reader('--count 1 --timeout 1500')
        server.say(registers(self.asked(server), 1, *SAID)[:11])
        self.reads(reader, 1, [],
                   ': only a part of a response was received: its header announces more bytes. Try a longer --timeout')
        self.needs_little(reader.done)

    @e2e.each(
        a_wrong_transaction_is_no_response=(lambda asked: registers(asked ^ 1, 1, *OTHER),
                                          'attempt 1: no response'),
        another_unit=(lambda asked: registers(asked, 9, *OTHER),
                      'the server responds as unit 9, and not as unit 1'),
        fewer_registers_than_were_asked_for=(lambda asked: registers(asked, 1, *OTHER[:3]),
                                             'the response does not fit the request'),
        a_byte_count_that_is_not_the_headers=(
            lambda asked: adu(asked, 1, 3, 8, 0x03, 0xE8),
            ': the response has a wrong length'),
        a_function_that_was_not_asked=(
            lambda asked: adu(asked, 1, 0x2B, 0x0E, 1, 1, 0, 0, 0),
            'the response does not fit the request. Check that the server speaks Modbus TCP'),
        an_exception_of_the_sensor=(lambda asked: adu(asked, 1, 0x83, 2),
                                    'refused the request: exception 02 (illegal data address): '))
    def wrong(self, response, words):
        """The next right response is read."""
        server, reader = self.reader('--count 2 --timeout 1000')
        server.say(response(self.asked(server)))
        server.say(registers(self.asked(server), 1, *SAID))
        self.reads(reader, 1, [2083], words)

    @e2e.each(**{f'exceptions_of_a_gateway_are_no_response_and_said_{number}': (number, name) for number,
                 name in
                 ((10, 'path unavailable'), (11, 'target device failed to respond'))})
    def gateway(self, number, name):
        server, reader = self.reader('--count 2 --timeout 60000')
        server.say(adu(self.asked(server), 1, 0x83, number))
        server.say(adu(self.asked(server), 1, 0x83, number))
        self.reads(reader, 1, [])
        first, second = re.findall(r'attempt \d: .*', reader.done.err)
        self.assertIn(f'the gateway responds with exception {number} (gateway {name}). Check ', first)
        self.assertIn('the same cause as before, 2 times in a row', second)
        self.assertLess(reader.done.elapsed, 10)  # each attempt ended with the word and not with its time-out

    def test_silence_after_a_final_word_is_silence(self):
        server, reader = self.reader('--count 2 --timeout 500')
        server.say(adu(self.asked(server), 1, 0x83, 11))
        self.asked(server)
        self.reads(reader, 1, [], 'attempt 1: no response from hps167s:1 at ', 'the gateway responds with exception 11',
                   re.compile('attempt 2: .*: the connection is open, but nothing was received'))

    def test_each_final_word_after_the_time_out_is_that_of_its_unit(self):
        server = self.server()
        reader = self.fathom(f'read hps167s:8 hps167s:9 --port {server} --count 2 --timeout 100')
        server.accept()
        for _ in range(4):
            transaction, unit, _ = server.request()
            time.sleep(0.3)
            server.say(adu(transaction, unit, 0x83, 11))
        self.reads(reader, 1, [], *(re.compile(rf'hps167s:{unit}: attempt 2: .*: the gateway responds with exception 11')
                                    for unit in (8, 9)))

    @e2e.each(path_unavailable=(10, 'gateway path unavailable'),
              target_silent=(11, 'gateway target device failed to respond'))
    def requested(self, number, name):
        """By fathom request."""
        server = self.server()
        request = self.fathom(f'request 1 3 0x0101 --timeout 500 --port {server}')
        server.accept()
        transaction, unit, rest = server.request()
        self.assertEqual((unit, rest), (1, bytes((3, 1, 1, 0, 1))))
        server.say(adu(transaction, 1, 0x83, number))
        self.ends(request, 1, f'the gateway responds with exception {number} ({name}). Check UNIT')

    @e2e.each(
        another_identifier=(lambda asked: registers(asked + 1, 1, *SAID),
                            'the server responds with another transaction identifier'),
        unit_0=(lambda asked: registers(asked, 0, *SAID), 'the server responds as unit 0, and not as unit 1'),
        unit_255=(lambda asked: registers(asked, 255, *SAID), 'the server responds as unit 255, and not as'),
        another_unit_before_the_right_one=(lambda asked: registers(asked, 2, *OTHER) + registers(asked, 1, *SAID),
                                           'the server responds as unit 2, and not as unit 1'),
        busy_as_unit_255=(lambda asked: adu(asked, 255, 0x83, 6),
                          'the gateway responds with exception 06 (server device busy). It serves another request. Try '
                          '--retries 2'))
    def foreign(self, response, words):
        server, reader = self.reader('--count 1 --timeout 1000')
        server.say(response(self.asked(server)))
        self.reads(reader, 1, [], words)

    def test_a_gateway_that_tries_a_dead_unit_again_serves_the_others_meanwhile(self):
        """Its word about unit 9 arrives 2 s after the request, and a request to unit 1 waits for it."""
        server = self.server()
        reader = self.fathom(f'read hps167s:1 hps167s:9 --port {server} --count 3 --interval 100 --format csv')
        server.accept()
        readings = 0
        while readings < 3:
            transaction, unit, _ = server.request()
            if unit == 9:
                time.sleep(2)
                server.say(adu(transaction, 9, 0x83, 11))
            else:
                server.say(registers(transaction, 1, *SAID))
                readings += 1
        self.meanwhile(lambda: server.say(adu(server.request()[0], 9, 0x83, 11)) or True)
        self.reads(reader, 1, [2083] * 3, 'hps167s:9: attempt 2: no response from hps167s:9 at ',
                   'the gateway responds with exception 11')

    def test_a_response_after_the_time_out_is_measured(self):
        server, reader = self.reader('--count 2 --timeout 500')
        transaction = self.asked(server)
        time.sleep(1.5)
        server.say(registers(transaction, 1, *SAID))
        self.asked(server)
        self.reads(reader, 1, [], re.compile(r'arrived after the time-out \(it took 1[5-9]\d\d ms\)'))

    def test_a_silent_server(self):
        server, reader = self.reader('--count 3 --timeout 100')
        for _ in range(3):
            self.asked(server)
        self.reads(reader, 1, [])
        words = 'the connection is open, but nothing was received. Check --address'
        self.assertEqual(reader.done.err.count(words), 1, reader.done.err)
        self.assertIn('the same cause as before, 3 times in a row', reader.done.err)
        self.needs_little(reader.done)

    def test_a_server_that_falls_silent(self):
        """After a good response the address is right; a gateway may wait for another unit."""
        server, reader = self.reader('--count 2 --timeout 100')
        server.say(registers(self.asked(server), 1, *SAID))
        self.asked(server)
        self.reads(reader, 1, [2083], 'nothing was received. Earlier responses were good, so the settings are right. Check the line')
        self.assertNotIn('--address', reader.done.err)

    def test_an_a05_behind_a_gateway(self):
        server = self.server()
        reader = self.fathom(f'read a05 --mode modbus --port {server} --count 1 --format csv')
        server.accept()
        transaction, unit, request = server.request()
        self.assertEqual((unit, request), (1, bytes((3, 1, 6, 0, 4))))
        server.say(registers(transaction, 1, 1000, 2000, 1953, 3562))
        self.reads(reader, 0, [1000, 2000, 1953, 3562])

    def test_sensors_behind_one_gateway_and_one_that_is_dead(self):
        server = self.server()
        reader = self.fathom(f'read hps167s:1 hps167s:2 a16:250:modbus --port {server} --count 2 --timeout '
                             '1000 --format csv')
        server.accept()
        asked = []
        while asked.count(1) < 2 or asked.count(250) < 2:
            transaction, unit, request = server.request()
            asked.append(unit)
            if unit == 1:
                server.say(registers(transaction, 1, *SAID))
            elif unit == 250:
                self.assertEqual(request, bytes((3, 1, 0, 0, 1)))  # A16: the processed distance
                server.say(registers(transaction, 250, 754))
        done = self.ends(reader, 1, re.compile('no response from hps167s:2 at .*: the connection is open, but nothing was received'))
        self.assertEqual(sorted(done.mm), ['2083', '2083', '754', '754'])
        self.assertEqual(done.err.count('hps167s:2: attempt '), 2, done.err)


class Broken(Case):
    def breaks(self, words, response):
        server, reader = self.reader()
        server.say(response(self.asked(server)))
        self.reads(reader, 1, [], f'fathom: attempt 1: {server}: {words}',
                   '. Start again. With --reconnect, fathom connects again')
        self.assertEqual(reader.done.err.count('attempt 1:'), 1, reader.done.err)

    @e2e.each(closed=(b'', tcp_server.Server.hang_up), reset=(b'', tcp_server.Server.reset),
              closed_in_the_middle_of_a_response=(registers(0, 1, *SAID)[2:10], tcp_server.Server.hang_up))
    def each_connection(self, rest, end):
        server, reader = self.reader()
        for number in range(5):
            server.say((self.asked(server).to_bytes(2, 'big') + rest)[:10 if rest else 0])
            end(server)
            if number != 4:
                server.accept()
        self.reads(reader, 1, [], f'fathom: attempt 1: {server}: the server closes each connection without a response; '
                   'some serve one program at a time', '. Start again. With --reconnect, fathom connects again')
        self.assertEqual(reader.done.err.count('attempt 1:'), 1, reader.done.err)

    def test_nonsense(self):
        for nonsense in (b'HTTP/1.1 400 Bad Request\r\n\r\n', b'SSH-2.0-x\r\n', bytes(5) + b'\1\0\0',
                         b'\xff' * 300):
            self.breaks(NONSENSE, lambda _, nonsense=nonsense: nonsense)

    def test_with_reconnect_it_goes_on_at_the_next_connection(self):
        server, reader = self.reader('--reconnect --count 3')
        server.say(registers(self.asked(server), 1, *SAID))
        self.asked(server)
        server.say(b'\xff' * 6)
        server.hang_up()
        reader.expect(f'attempt 2: .*{NONSENSE[:40]}.*. Waiting until it is back', 'err')
        server.accept()
        server.say(registers(self.asked(server), 1, *OTHER))
        self.reads(reader, 1, [2083, 1000], f'fathom: {server}: it is back; reading goes on')

    def test_with_reconnect_a_server_that_is_not_there_yet_is_waited_for(self):
        server = self.server(backlog=None)
        reader = self.fathom(f'read hps167s --port {server} --reconnect --count 1 --format csv')
        reader.expect('Connection refused: .*; waiting until it is there', 'err')
        again = self.server(number=server.number)
        again.accept()
        again.say(registers(self.asked(again), 1, *SAID))
        self.reads(reader, 0, [2083])


class Hostile(Case):
    """A server that means harm: the tool ends or goes on in its time, shows no reading that was not sent to it, says why, and
    prints nothing that drives a terminal. Each server ends with its test."""
    @e2e.each(**{f'a_header_that_says_{words}_bytes_follow': length for words, length in
                 (('no', 0), ('one', 1), ('255', 255), ('65535', 65535))})
    def length(self, length):
        """Even with the right transaction and the right bytes behind it."""
        server, reader = self.reader('--timeout 60000')
        transaction = self.asked(server)
        response = bytearray(registers(transaction, 1, *SAID))
        response[4:6] = length.to_bytes(2, 'big')
        server.say(response)
        done = self.ends(reader, 1, f'attempt 1: {server}: {NONSENSE}')
        self.assertEqual(done.mm, [])
        self.needs_little(done)

    def test_thousands_of_responses_to_other_requests_do_not_hide_the_right_one(self):
        server, reader = self.reader('--count 1 --timeout 15000')
        transaction = self.asked(server)
        server.say(*(registers(transaction ^ (1 + number), 1, *OTHER) for number in range(30000)))
        server.say(registers(transaction, 1, *SAID))
        done = self.ends(reader, 0)
        self.assertEqual(done.mm, ['2083'])
        self.assertLess(done.cpu, 2)

    @e2e.each(to_other_requests=lambda asked: registers(asked ^ 1, 1, *OTHER),
              of_other_units=lambda asked: registers(asked, 9, *OTHER),
              of_other_functions=lambda asked: adu(asked, 1, 4, 2, 3, 0xE8),
              of_other_lengths=lambda asked: registers(asked, 1, *OTHER[:3]),
              to_nothing=lambda asked: registers(0, 1, *OTHER))
    def flood(self, response):
        """Responses as fast as the connection takes them, without end. They cost processor time, and no more: it
        ends in 20 s. If requests cannot leave, it gives up after 10 s."""
        server, reader = self.reader('--count 2 --timeout 700')
        transaction = self.asked(server)
        flood = bytes(response(transaction)) * 500
        self.meanwhile(lambda: server.say(flood) is None)
        done = self.ends(reader, 1, 'attempt 1: ', 'attempt 2: ')
        self.assertEqual(done.mm, [])
        for words in ('wiring', 'resistor', '--baud'):  # of which a connection has none
            self.assertNotIn(words, done.err)

    def test_a_byte_a_second_of_a_long_response_is_none_and_costs_no_time_of_the_processor(self):
        server, reader = self.reader('--count 2 --timeout 1500')
        transaction = self.asked(server)
        drip = iter(adu(transaction, 1, 3, 250, *bytes(250)))
        self.meanwhile(lambda: server.say((next(drip),)) is None and not reader.process.poll() and
                       not time.sleep(1))
        done = self.ends(reader, 1, 'attempt 2: no response from hps167s:1 ')
        self.assertEqual(done.mm, [])
        self.needs_little(done)

    def test_what_came_before_the_request_is_no_response(self):
        server, reader = self.reader('--count 2 --timeout 1000')
        transaction = self.asked(server)
        server.say(registers(transaction, 1, *SAID), *(registers(number, 1, *OTHER) for number in range(3000)))
        server.request()
        self.assertEqual(self.ends(reader, 1).mm, ['2083'])

    def test_a_connection_that_ends_after_each_byte_is_tried_again_ever_more_seldom(self):
        server, reader = self.reader('--reconnect --duration 6')
        connections = 1
        while True:
            server.request()
            server.say(b'\x00')
            server.hang_up()
            if not e2e.is_ready(server.socket, 7) or reader.has_ended():
                break
            server.accept()
            connections += 1
        done = self.ends(reader, 1, 'the server closes each connection')
        self.needs_little(done)
        self.assertLess(connections, 16)
        self.assertEqual(done.mm, [])


class Terminal(Case):
    """What it says is made of the bytes by which terminals are driven."""
    HARM = bytes((0x1B, 0x5B, 0x9B, 0x07, 0x0D, 0x08, 0x22, 0x5C, 0xC2, 0x9D, 0x00, 0xFF, 0x1B, 0x63, 0x7F, 0x0A))

    def answers(self, server, offset):
        """One connection."""
        said = self.HARM[offset:] + self.HARM[:offset]

        def answer():
            transaction, unit, (function, *rest) = server.request()
            if function == 3:
                size = 2 * rest[3]
                server.say(adu(transaction, unit, 3, size, *(said * 20)[:size]))
            else:
                server.say(adu(transaction, unit, function | 0x80, self.HARM[offset % 16]))
            return True

        def serve():
            server.accept()
            while answer():
                pass
        self.meanwhile(serve)

    @e2e.each(**{command.split()[0] + ('_json' if 'json' in command else ''): command for command in (
        'info hps167s', 'info a16 --format json', 'read hps167s --count 3',
        'read hps167s --count 3 --format json', 'request 1 3 0x0100 120 --sensor hps167s',
        'request 1 3 0x0100 120 --format json', 'get a16 address', 'set a16 switch-threshold 900')})
    def harm(self, command):
        for offset in (0, 11):
            server = self.server()
            self.answers(server, offset)
            done = self.run_fathom(f'{command} --port {server} --timeout 300')
            self.assertNotIn(done.code, (2, -6, -11), done)
            self.assertNotEqual(done.out + done.err, '')
            self.assertRegex(done.out + done.err, r'\A[\n -~]*\Z')
            if '--format json' in command:
                self.assertTrue(done.all_json or done.code)


if __name__ == '__main__':
    e2e.main()
