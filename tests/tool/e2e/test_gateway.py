#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Gateways that close connections, converters that pass raw bytes, and responses in pieces. It needs real time: CTest
runs one such file at a time."""
import os
import re
import time

import e2e
import mqtt
import tcp_server
from tcp_server import adu, registers

MM = (0x05DC,)  # A16 0x0100: 1500 mm
CLOSED = 'the server closes each connection without a response; some serve one program at a time'
END = {'closed': tcp_server.Server.hang_up, 'reset': tcp_server.Server.reset}


class Idle(tcp_server.Case):
    """A closed connection is no failure: the next request makes another one, and the interval is kept."""

    def reader(self, options=''):
        server = self.server()
        reader = self.fathom(f'read a16:1:modbus --port {server} --format csv --stats --interval 300 {options}')
        server.accept()
        return server, reader

    def reads(self, reader, count, reconnects):
        done = self.ends(reader, 0, f'attempts {count}, failed 0, readings {count}\n', f'reconnects {reconnects}\n')
        self.assertEqual(done.mm, ['1500'] * count)
        self.assertNotIn('attempt 1', done.err)
        times = [int(row['time_us']) for row in done.rows]
        for before, after in zip(times, times[1:]):
            self.assertLess(abs(after - before - 300000), 150000, times)
        self.needs_little(done)

    @e2e.each(**{f'{words}_after_each_response': end for words, end in END.items()})
    def after_each_response(self, end):
        server, reader = self.reader('--count 4')
        for number in range(4):
            server.say(registers(server.request()[0], 1, *MM))
            if number != 3:
                reader.expect(',1500\n')
                end(server)
                server.accept()
        self.reads(reader, 4, 3)

    @e2e.each(**{f'a_read_in_a_connection_that_is_{words}_{when}': (end, part) for words, end in END.items()
                 for when, part in (('is_sent_again', 0), ('in_the_middle_of_the_response_is_sent_again', 9))})
    def race(self, end, part):
        server, reader = self.reader('--count 3')
        server.say(registers(server.request()[0], 1, *MM))
        for _ in range(2):
            transaction, _, asked = server.request()
            server.say(registers(transaction, 1, *MM)[:part])
            end(server)
            server.accept()
            transaction, _, again = server.request()
            self.assertEqual(asked, again)
            server.say(registers(transaction, 1, *MM))
        self.reads(reader, 3, 2)

    def test_a_gateway_that_refuses_the_next_connection_for_200_ms(self):
        server, reader = self.reader('--count 2')
        server.say(registers(server.request()[0], 1, *MM))
        reader.expect(',1500\n')
        server.close()
        time.sleep(0.5)  # the second request is due after 300 ms
        again = self.server(number=server.number)
        again.accept()
        again.say(registers(again.request()[0], 1, *MM))
        done = self.ends(reader, 0, 'attempts 2, failed 0', 'reconnects 1')
        self.assertEqual(done.mm, ['1500'] * 2)

    def test_a_gateway_that_is_gone_is_a_failure_that_says_why(self):
        server, reader = self.reader()
        server.say(registers(server.request()[0], 1, *MM))
        reader.expect(',1500\n')
        server.close()
        done = self.ends(reader, 1, f'attempt 2: {server}: Connection refused: nothing serves this port')
        self.assertEqual(done.mm, ['1500'])
        self.needs_little(done)

    @e2e.each(**{f'each_connection_{words}': end for words, end in END.items()})
    def for_ever(self, end):
        """5 connections in 0.4 s, and then one after each pause of a lost port: 0.5, 1 and 2 s."""
        server, reader = self.reader('--reconnect --duration 4 --timeout 5000')
        connections = 1
        end(server)
        while not reader.has_ended():
            if e2e.is_ready(server.socket, 0.05):
                server.accept()
                connections += 1
                end(server)
        # A reset may come while a connection is opened: then the port is waited for, and there is no attempt.
        done = reader.done
        self.assertRegex(done.err, rf'{server}: (?:{CLOSED}|Connection reset by peer: the far end ends each connection)')
        self.assertRegex(done.err, '[Ww]aiting until it is (?:back|there)')
        self.assertEqual(done.code, 0 if 'attempts 0,' in done.err else 1)
        self.assertEqual(done.mm, [])
        self.assertLessEqual(connections, 15)  # one that is reset while it is opened is one more after a pause
        self.needs_little(done)

    def test_a_single_request_that_writes_is_never_sent_again(self):
        server = self.server()
        writer = self.fathom(f'request 1 6 0x0200 2 --yes --port {server}')
        server.accept()
        server.request()
        server.hang_up()
        self.ends(writer, 1, 'the far end closed the connection before it responded')
        self.assertFalse(e2e.is_ready(server.socket, 0))

    def test_a_setting_that_is_written_is_never_sent_again(self):
        """The connection ends with it. Whether the sensor has it is read over the next one."""
        server = self.server()
        writer = self.fathom(f'set a16 --port {server} switch-threshold 1200')
        server.accept()
        transaction, unit, asked = server.request()
        while asked[0] != 6:
            server.say(registers(transaction, unit, 1000))
            transaction, unit, asked = server.request()
        server.hang_up()
        server.accept()
        transaction, unit, asked = server.request()
        self.assertEqual(asked[0], 3)
        server.say(registers(transaction, unit, 1000))
        self.ends(writer, 1, 'differs: no acknowledgement was received, but it reads back another value')
        self.assertEqual(server.client.recv(12), b'')


class EachResponse(tcp_server.Case):
    """Each command that holds a port, with a gateway or a converter that closes each connection after a response."""
    COMMANDS = {'read': ('a16:1:modbus', 'read a16:1:modbus --count 3', ' s  a16 '),
                'get': ('a16:1:modbus', 'get a16', 'switch-threshold +1000 mm'),
                'set': ('a16:1:modbus', 'set a16 switch-threshold 1200', r'is 1200 mm \(was 1000\)'),
                'info': ('hps167s', 'info hps167s', 'interface'),
                'save': ('hps167s', 'save hps167s --file saved', '^'),
                'request': ('a05::modbus', 'request 1 3 0x0106 4 --sensor a05', 'probe 4')}

    @e2e.each(**{f'{name}_{kind}_{end}': (row, kind == 'rtu_over_tcp', end == 'reset')
                 for name, row in COMMANDS.items() for kind in ('modbus_tcp', 'rtu_over_tcp') for end in END})
    def works(self, row, is_raw, is_reset):
        sensors, command, words = row
        gateway = self.gateway(sensors, 19200 if 'hps' in sensors else 9600, is_raw=is_raw, frames=1, is_reset=is_reset)
        done = self.ends(self.run_fathom(*command.replace('saved', self.path('saved')).split(), '--port', str(gateway)), 0)
        self.assertRegex(done.out, words)
        self.assertNotRegex(done.err, 'closed|reset|attempt')
        self.assertGreaterEqual(gateway.connections, min(2, len(gateway.functions)))
        self.assertEqual(gateway.functions.count(6), int('set' in command))

    def test_watch(self):
        gateway = self.gateway('a16:1:modbus', frames=1)
        done = self.ends(f'watch a16:1:modbus --port {gateway} --duration 2', 0)
        self.assertNotIn('closed', done.out + done.err)
        self.assertGreater(gateway.connections, 2)

    def test_scan_over_a_converter_finds_each_model_and_changes_no_line_settings(self):
        gateway = self.gateway('hps167s:3', 19200, is_raw=True, frames=1)
        done = self.ends(f'scan --port {gateway} --address 2-4 --listen 1', 0)
        self.assertRegex(done.out, rf'^hps167s  address 3    - .*->  fathom read hps167s:3:modbus --port {gateway}\n$')
        self.assertIn('requests to addresses 2 to 4 at the line settings of the converter', done.err)
        nothing = self.ends(f'scan --port {gateway} --address 5 --listen 1 --format json', 1, out='')
        self.assertIn('The scan cannot change the settings of the converter: with factory settings, a16', nothing.err)
        # It responds to the first read of an HPS-167S by an exception, and later at address 255: one device.
        gateway = self.gateway('a16:3:modbus,with=exceptions,with=broadcast', 9600, is_raw=True)
        done = self.ends(f'scan --port {gateway} --listen 1', 0)
        self.assertRegex(done.out, r'^a16      address 3    - [^\n]*\n$')


class Converter(tcp_server.Case):
    @e2e.each(an_a16_in_mode_auto=('a16', 9600, 'a16'), an_a05_in_mode_auto=('a05', 9600, 'a05'),
              an_a05_in_mode_dyp=('a05:1:dyp', 9600, 'a05:1:dyp'), an_a16_in_mode_modbus=('a16:7:modbus', 9600, 'a16:7'),
              an_hps167s=('hps167s', 19200, 'hps167s'))
    def each_mode_also_in_pieces(self, sensors, baud, sensor):
        for pieces in (0, 0.062):
            gateway = self.gateway(sensors, baud, is_raw=True, pieces=pieces)
            rows = self.read_json(f'{sensor} --port {gateway} --count 2')
            self.assertGreaterEqual(len(rows), 2)

    def test_what_sends_by_itself_is_listened_to_over_the_next_connection(self):
        gateway = self.gateway('a16', is_raw=True, frames=3)
        done = self.ends(f'read a16 --port {gateway} --count 8 --stats', 0, 'failed 0')
        self.assertGreaterEqual(gateway.connections, 3, done.err)

    def test_a_server_of_modbus_tcp_is_named(self):
        """It takes 01 03 for a transaction; the response has the header of Modbus TCP."""
        server = self.server()
        reader = self.fathom(f'read a16:1:modbus --port rtu-{server} --count 1')
        server.accept()
        server.client.recv(8)
        server.say(adu(0x0103, 0x85, 0xF6 | 0x80, 1))
        self.ends(reader, 1, f'the response has the header of Modbus TCP. Use {server}')

    @e2e.each(a_response=('a16:1:modbus', '01 03 02 05 DC BA 8D'), an_exception=('a16:1:modbus', '01 83 02 C0 F1'))
    def raw_bytes_are_named(self, sensor, response):
        server = self.server()
        reader = self.fathom(f'read {sensor} --port {server} --count 1')
        server.accept()
        server.request()
        server.say(bytes.fromhex(response))
        self.ends(reader, 1, 'the response is a frame of Modbus RTU without the header of Modbus TCP: the converter '
                  'passes raw bytes. '
                  f'Use rtu-{server}')

    def test_silence_names_the_mode_unless_the_gateway_has_responded(self):
        server = self.server()
        reader = self.fathom(f'read a16:1:modbus --port {server} --count 3 --timeout 200')
        server.accept()
        server.request()
        words = f'If the converter passes raw bytes, which is the factory setting of many, use rtu-{server}'
        reader.expect(re.escape(words), 'err')
        server.say(registers(server.request()[0], 1, *MM))
        server.request()
        self.assertEqual(self.ends(reader, 1).err.count(words), 1)


class Publish(mqtt.Case, tcp_server.Case):
    @e2e.each(each_connection={'frames': 1}, each_connection_by_a_reset={'frames': 1, 'is_reset': True}, idle={'idle': 0.1})
    def a_gateway_closes(self, options):
        self.broker()
        subscriber = self.subscribe()
        gateway = self.gateway('hps167s:7', 19200, **options)
        publisher = self.publish(self.config(self.line(gateway, 'gate hps167s:7:modbus'), top='interval: 400'))
        states = mqtt.states(self.wait_for(subscriber, '/gate/state', count=8))
        self.assertEqual([state['seq'] for state in states], list(range(1, 9)))
        for before, after in zip(states, states[1:]):
            self.assertLess(abs(mqtt.utc(after['utc']) - mqtt.utc(before['utc']) - 0.4), 0.2, states)
        done = self.ends(publisher.end(), 0)
        self.assertNotRegex(done.out + done.err, 'attempt|closed|reset|no response')
        self.wait_for(subscriber, 'mill/status', lambda one: one.payload == 'offline')
        self.assertEqual([one.payload for one in self.messages(subscriber, '/gate/availability')], ['offline', 'online'])
        self.assertGreaterEqual(gateway.connections, 8)


class Long(tcp_server.Case):
    def test_no_interval_is_lost_while_the_gateway_closes_idle_connections(self):
        """20 s; with FATHOM_LONG an hour, and a gateway that closes after 3 s. The intervals meet the end of a connection
        before, at and after it."""
        seconds, idle = (3600, 3) if os.environ.get('FATHOM_LONG') else (6, 0.5)
        readers = []
        for factor in (0.98, 1.01, 1.6):
            gateway = self.gateway('hps167s', 19200, idle=idle)
            interval = round(idle * factor * 1000)
            readers.append((interval, self.fathom(f'read hps167s --port {gateway} --interval {interval} --stats '
                                                  f'--duration {seconds} --format csv')))
        for interval, reader in readers:
            done = self.ends(reader.finish(seconds + e2e.PATIENCE), 0, 'failed 0')
            self.assertGreaterEqual(len(done.mm), seconds * 1000 // interval - seconds // 300, done)


if __name__ == '__main__':
    e2e.main()
