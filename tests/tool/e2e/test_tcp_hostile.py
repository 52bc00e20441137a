#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tool at a Modbus TCP server that means harm: it ends or goes on in its time, shows no reading that was not
sent to it, says why, and prints nothing that drives a terminal. Each server ends with its test.
It needs real time: CTest runs one such file at a time."""
import threading
import time

import e2e
import tcp_server
from tcp_server import adu, registers

SAID = (0x0823, 0xDCB2, 0x0701, 0)  # HPS-167S #5: 2083 mm
OTHER = (0x03E8, 0xDCB2, 0x0701, 0)  # 1000 mm
NONSENSE = 'the received bytes are not Modbus TCP. Check the port number (usually 502)'


class Case(tcp_server.Case):
    def reader(self, options):
        server = self.server()
        reader = self.fathom(f'read hps167s --port {server} --format csv {options}')
        server.accept()
        return server, reader

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


class Reading(Case):
    @e2e.each(**{f'a_header_that_says_{words}_bytes_follow': length for words, length in
                 (('no', 0), ('one', 1), ('255', 255), ('65535', 65535))})
    def length(self, length):
        """Even with the right transaction and the right bytes behind it."""
        server, reader = self.reader('--timeout 60000')
        transaction, _, _ = server.request()
        response = bytearray(registers(transaction, 1, *SAID))
        response[4:6] = length.to_bytes(2, 'big')
        server.say(response)
        done = self.ends(reader, 1, f'attempt 1: {server}: {NONSENSE}')
        self.assertEqual(done.mm, [])
        self.needs_little(done)

    def test_thousands_of_responses_to_other_requests_do_not_hide_the_right_one(self):
        server, reader = self.reader('--count 1 --timeout 15000')
        transaction, _, _ = server.request()
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
        transaction, _, _ = server.request()
        flood = bytes(response(transaction)) * 500
        self.meanwhile(lambda: server.say(flood) is None)
        done = self.ends(reader, 1, 'attempt 1: ', 'attempt 2: ')
        self.assertEqual(done.mm, [])
        for words in ('wiring', 'resistor', '--baud'):  # of which a connection has none
            self.assertNotIn(words, done.err)

    def test_a_byte_a_second_of_a_long_response_is_none_and_costs_no_time_of_the_processor(self):
        server, reader = self.reader('--count 2 --timeout 1500')
        transaction, _, _ = server.request()
        drip = iter(adu(transaction, 1, 3, 250, *bytes(250)))
        self.meanwhile(lambda: server.say((next(drip),)) is None and not reader.process.poll() and
                       not time.sleep(1))
        done = self.ends(reader, 1, 'attempt 2: no response from hps167s:1 ')
        self.assertEqual(done.mm, [])
        self.needs_little(done)

    def test_what_came_before_the_request_is_no_response(self):
        server, reader = self.reader('--count 2 --timeout 1000')
        transaction, _, _ = server.request()
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
        done = self.ends(reader, 1, 'the server closed the connection')
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
