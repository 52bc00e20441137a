#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read over TCP: what it says and returns when there is no connection, when it breaks, and when what comes
is late, cut, glued, another's or no Modbus at all."""
import os
import re
import socket
import time

import e2e
import tcp_server
from tcp_server import adu, registers

SAID = (0x0823, 0xDCB2, 0x0701, 0)  # HPS-167S #5: 2083 mm
OTHER = (0x03E8, 0xDCB2, 0x0701, 0)  # 1000 mm
LITTLE = 0.3  # seconds of CPU


class Case(e2e.Case):
    def server(self, **options):
        server = tcp_server.Server(**options)
        self.addCleanup(server.close)
        return server

    def reader(self, server, *arguments):
        """A tool that has connected."""
        timeout = () if '--timeout' in arguments else ('--timeout', '5000')
        reader = self.fathom('read', 'hps167s', '--port', server.path, '--format', 'csv', *timeout, *arguments)
        server.accept()
        return reader

    def asked(self, server, unit=1):
        """The transaction of the next request, which is HPS-167S #5."""
        request = server.request()
        transaction = int.from_bytes(request[:2], 'big')
        self.assertEqual(request, adu(transaction, unit, 3, 0, 8, 0, 4))
        return transaction

    def distances(self, done):
        return [row.split(',')[9] for row in done.out.splitlines()[1:]]


class NoConnection(Case):
    def fails(self, port, *words, code=1, **options):
        done = self.run_fathom('read', 'hps167s', '--port', port, '--count', '1', **options)
        self.assertEqual((done.code, done.out), (code, ''), done.err)
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        for word in words:
            self.assertIn(word, done.err)
        return done

    def test_refused(self):
        server = self.server()
        server.close()
        self.fails(server.path, f'{server.path}: Connection refused: nothing serves this port; check it (502 is usual)')

    def test_refused_at_an_ipv6_address(self):
        server = self.server(family=socket.AF_INET6)
        server.close()
        self.fails(f'tcp:[::1]:{server.number}', f'tcp:[::1]:{server.number}: Connection refused: ')

    def test_an_unknown_host(self):
        self.fails('tcp:no-such-host.invalid', 'tcp:no-such-host.invalid: the host is not known: ',
                   'check its name, or give its address in numbers')

    def test_an_address_without_a_way(self):
        """A broadcast address: no connection leads there."""
        self.fails('tcp:127.255.255.255', 'tcp:127.255.255.255: Network is unreachable: there is no way to this address')

    def full(self):
        """A server whose queue is full: what connects now hears nothing."""
        server = self.server(backlog=0)
        for _ in range(4):
            waiting = socket.socket()
            self.addCleanup(waiting.close)
            waiting.setblocking(False)
            waiting.connect_ex(('127.0.0.1', server.number))
        return server

    def test_no_answer_to_the_connection_is_given_up_after_5_seconds(self):
        done = self.fails(self.full().path, ': Connection timed out: nothing answers at this address')
        self.assertTrue(5 <= done.elapsed < 15, done.elapsed)
        self.assertLess(done.cpu, LITTLE)

    def test_a_signal_ends_the_wait_for_a_connection(self):
        server = self.full()
        reader = self.fathom('read', 'hps167s', '--port', server.path)
        # It connects when it has its socket; a signal before that ends it as well.
        deadline = time.monotonic() + e2e.PATIENCE
        while not any('socket:' in self.link(reader, name) for name in self.descriptors(reader)):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.005)
        began = time.monotonic()
        self.assertEqual(reader.end().code, 1)
        self.assertLess(time.monotonic() - began, 3)

    @staticmethod
    def descriptors(program):
        return os.listdir(f'/proc/{program.process.pid}/fd')

    @staticmethod
    def link(program, name):
        try:
            return os.readlink(f'/proc/{program.process.pid}/fd/{name}')
        except FileNotFoundError:
            return ''

    def test_paths_that_are_none(self):
        for path, words in (('tcp:', 'the host is missing'), ('tcp::502', 'the host is missing'),
                            ('tcp:[]:502', 'the host is missing'), ('tcp:[::1', 'the bracket'),
                            ('tcp:::1', 'in brackets'), ('tcp:h:0', 'the port is a number'),
                            ('tcp:h:65536', 'the port is a number'), ('tcp:h:', 'the port is a number'),
                            ('tcp:h:5 ', 'the port is a number'), ('tcp:[::1]502', 'the port is a number'),
                            ('tcp:' + 'h' * 256, 'too long')):
            self.fails(path, words, '; try: fathom read --help', code=2)

    def test_what_needs_a_serial_port_is_refused(self):
        server = self.server()
        for sensor, mode in (('a16', 'auto'), ('a05', 'auto'), ('a05', 'dyp')):
            done = self.run_fathom('read', sensor, '--mode', mode, '--port', server.path)
            self.assertEqual((done.code, done.out), (2, ''))
            self.assertIn(f'mode {mode} needs a serial port; over tcp: a sensor is asked by Modbus: --mode modbus',
                          done.err)


class Answers(Case):
    def test_a_reading(self):
        server = self.server()
        reader = self.reader(server, '--address', '7', '--count', '1')
        server.say(registers(self.asked(server, 7), 7, *SAID))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (0, ['2083']), done.err)

    def test_a_reading_from_an_ipv6_address(self):
        server = self.server(family=socket.AF_INET6)
        server.path = f'tcp:[::1]:{server.number}'
        reader = self.reader(server, '--count', '1')
        server.say(registers(self.asked(server), 1, *SAID))
        self.assertEqual(self.distances(reader.finish()), ['2083'])

    def test_every_request_has_another_transaction(self):
        server = self.server()
        reader = self.reader(server, '--count', '5')
        seen = set()
        for _ in range(5):
            seen.add(self.asked(server))
            server.say(registers(max(seen), 1, *SAID))
        self.assertEqual(self.distances(reader.finish()), ['2083'] * 5)
        self.assertEqual(len(seen), 5)

    def test_a_byte_at_a_time(self):
        server = self.server()
        reader = self.reader(server, '--count', '1')
        for byte in registers(self.asked(server), 1, *SAID):
            server.say((byte,))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (0, ['2083']), done.err)

    def test_after_an_answer_in_pieces_a_short_one_is_seen_at_once(self):
        """Meanwhile the system woke the tool for a whole answer only."""
        server = self.server()
        reader = self.reader(server, '--count', '2', '--timeout', '60000')
        answer = registers(self.asked(server), 1, *SAID)
        server.say(answer[:10])
        time.sleep(0.2)  # until the tool has seen the half; if it has not, this test shows less
        server.say(answer[10:])
        transaction = self.asked(server)
        time.sleep(0.2)  # until it sleeps
        server.say(adu(transaction, 1, 0x83, 2))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, ['2083']), done.err)
        self.assertIn('attempt 2: address 1 refused: exception 02', done.err)

    def test_half_an_answer_is_none_and_costs_no_time_of_the_processor(self):
        server = self.server()
        reader = self.reader(server, '--count', '1', '--timeout', '1500')
        server.say(registers(self.asked(server), 1, *SAID)[:11])
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertIn('attempt 1: no answer from address 1: the connection stands, but nothing came back; ', done.err)
        self.assertLess(done.cpu, LITTLE)

    def test_the_rest_of_an_answer_that_came_too_late_does_not_disturb(self):
        server = self.server()
        reader = self.reader(server, '--count', '2', '--timeout', '700')
        late = registers(self.asked(server), 1, *OTHER)
        server.say(late[:10])
        transaction = self.asked(server)  # the next
        server.say(late[10:], registers(transaction, 1, *SAID))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, ['2083']), done.err)

    def test_a_late_answer_is_not_taken_for_the_next(self):
        server = self.server()
        reader = self.reader(server, '--count', '2', '--timeout', '700')
        first = self.asked(server)
        second = self.asked(server)
        self.assertNotEqual(first, second)
        server.say(registers(first, 1, *OTHER))
        server.say(registers(second, 1, *SAID))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, ['2083']), done.err)

    def test_a_wrong_transaction_is_no_answer(self):
        server = self.server()
        reader = self.reader(server, '--count', '1', '--timeout', '700')
        server.say(registers(self.asked(server) ^ 1, 1, *OTHER))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))

    def test_answers_glued_together(self):
        server = self.server()
        reader = self.reader(server, '--count', '2')
        first = self.asked(server)
        server.say(registers(first - 1, 1, *OTHER), registers(first, 1, *SAID), registers(first, 1, *OTHER))
        server.say(registers(self.asked(server), 1, *SAID))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (0, ['2083'] * 2), done.err)

    def test_another_unit(self):
        server = self.server()
        reader = self.reader(server, '--count', '1', '--timeout', '700')
        server.say(registers(self.asked(server), 9, *OTHER))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertIn('the line works, but it was address 9 that was heard; try --address 9', done.err)

    def test_fewer_registers_than_were_asked_for(self):
        server = self.server()
        reader = self.reader(server, '--count', '1', '--timeout', '700')
        server.say(registers(self.asked(server), 1, *OTHER[:3]))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertIn('address 1 answered something else than was asked', done.err)

    def test_a_byte_count_that_is_not_the_headers(self):
        server = self.server()
        reader = self.reader(server, '--count', '2', '--timeout', '700')
        server.say(adu(self.asked(server), 1, 3, 8, 0x03, 0xE8))
        server.say(registers(self.asked(server), 1, *SAID))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, ['2083']), done.err)
        self.assertIn('attempt 1: the answer of address 1 was damaged; its length is not what it says', done.err)

    def test_a_function_that_nobody_asked(self):
        server = self.server()
        reader = self.reader(server, '--count', '1', '--timeout', '700')
        server.say(adu(self.asked(server), 1, 0x2B, 0x0E, 1, 1, 0, 0, 0))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertIn('an answer came that does not fit; check that the server is one of Modbus TCP', done.err)

    def test_an_exception_of_the_sensor(self):
        server = self.server()
        reader = self.reader(server, '--count', '1')
        server.say(adu(self.asked(server), 1, 0x83, 2))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertIn('attempt 1: address 1 refused: exception 02 (illegal data address): ', done.err)

    def test_exceptions_of_a_gateway_are_no_answer_and_said(self):
        for number, name in ((10, 'path unavailable'), (11, 'target silent')):
            server = self.server()
            reader = self.reader(server, '--count', '2', '--timeout', '700')
            server.say(adu(self.asked(server), 1, 0x83, number))
            self.asked(server)  # about which the gateway says nothing
            done = reader.finish()
            self.assertEqual((done.code, self.distances(done)), (1, []))
            first, second = re.findall(r'attempt \d: .*', done.err)
            self.assertIn(f'no answer from address 1: the gateway says exception {number} (gateway {name}); check ', first)
            self.assertIn('the connection stands, but nothing came back', second)

    def test_a_silent_server(self):
        server = self.server()
        reader = self.reader(server, '--count', '3', '--timeout', '100')
        for _ in range(3):
            self.asked(server)
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertEqual(done.err.count('no answer from address 1: the connection stands, but nothing came back; check '
                                        '--address, '), 3, done.err)
        self.assertLess(done.cpu, LITTLE)

    def test_an_a05_behind_a_gateway(self):
        server = self.server()
        reader = self.fathom('read', 'a05', '--mode', 'modbus', '--port', server.path, '--count', '1', '--format', 'csv')
        server.accept()
        request = server.request()
        self.assertEqual(request[2:], adu(0, 1, 3, 1, 6, 0, 4)[2:])
        server.say(registers(int.from_bytes(request[:2], 'big'), 1, 1000, 2000, 1953, 3562))
        self.assertEqual(self.distances(reader.finish()), ['1000', '2000', '1953', '3562'])


    def test_sensors_behind_one_gateway_and_one_that_is_dead(self):
        server = self.server()
        reader = self.fathom('read', 'hps167s:1', 'hps167s:2', 'a16:250:modbus', '--port', server.path, '--count', '2',
                             '--timeout', '1000', '--format', 'csv')
        server.accept()
        asked = []
        while asked.count(1) < 2 or asked.count(250) < 2:
            request = server.request()
            asked.append(request[6])
            transaction = int.from_bytes(request[:2], 'big')
            if request[6] == 1:
                server.say(registers(transaction, 1, *SAID))
            elif request[6] == 250:
                self.assertEqual(request[7:], bytes((3, 1, 0, 0, 1)))  # A16: the processed distance
                server.say(registers(transaction, 250, 754))
        done = reader.finish()
        self.assertEqual(done.code, 1, done.err)
        self.assertEqual(sorted(self.distances(done)), ['2083', '2083', '754', '754'])
        self.assertEqual(done.err.count('hps167s:2: attempt '), 2, done.err)
        self.assertIn('no answer from address 2: the connection stands, but nothing came back', done.err)


class Broken(Case):
    def ends(self, server, reader, words):
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, []))
        self.assertIn(f'fathom: attempt 1: {server.path}: {words}', done.err)
        self.assertIn('; start again (with --reconnect it is connected again)', done.err)
        self.assertEqual(done.err.count('attempt 1:'), 1, done.err)

    def test_reset_by_the_server(self):
        server = self.server()
        reader = self.reader(server)
        self.asked(server)
        server.reset()
        self.ends(server, reader, 'the server reset the connection; some serve one program at a time')

    def test_closed_by_the_server(self):
        server = self.server()
        reader = self.reader(server)
        self.asked(server)
        server.hang_up()
        self.ends(server, reader, 'the server closed the connection; some serve one program at a time')

    def test_closed_in_the_middle_of_an_answer(self):
        server = self.server()
        reader = self.reader(server)
        server.say(registers(self.asked(server), 1, *SAID)[:10])
        server.hang_up()
        self.ends(server, reader, 'the server closed the connection')

    def test_nonsense(self):
        for nonsense in (b'HTTP/1.1 400 Bad Request\r\n\r\n', b'SSH-2.0-x\r\n', bytes(5) + b'\1\0\0', b'\xff' * 300):
            server = self.server()
            reader = self.reader(server)
            self.asked(server)
            server.say(nonsense)
            self.ends(server, reader, 'what was answered is no Modbus TCP; check the port (502 is usual)')

    def test_with_reconnect_it_goes_on_at_the_next_connection(self):
        server = self.server()
        reader = self.reader(server, '--reconnect', '--count', '3')
        server.say(registers(self.asked(server), 1, *SAID))
        self.asked(server)
        server.reset()
        reader.expect('attempt 2: .*the server reset the connection.*; waiting until it is back', 'err')
        server.accept()
        server.say(registers(self.asked(server), 1, *OTHER))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (1, ['2083', '1000']), done.err)
        self.assertIn(f'fathom: {server.path}: it is back; reading goes on', done.err)

    def test_with_reconnect_a_server_that_is_not_there_yet_is_waited_for(self):
        server = self.server()
        server.close()
        reader = self.fathom('read', 'hps167s', '--port', server.path, '--reconnect', '--count', '1', '--format', 'csv')
        reader.expect('Connection refused: .*; waiting until it is there', 'err')
        again = tcp_server.Server.__new__(tcp_server.Server)
        again.socket = socket.socket()
        again.client = None
        self.addCleanup(again.close)
        again.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        again.socket.bind(('127.0.0.1', server.number))
        again.socket.listen(1)
        again.accept()
        again.say(registers(self.asked(again), 1, *SAID))
        done = reader.finish()
        self.assertEqual((done.code, self.distances(done)), (0, ['2083']), done.err)


if __name__ == '__main__':
    e2e.main()
