#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom request at a real terminal: what it does when the port goes or the output is full; and that `fathom decode`
understands the bytes that it prints."""
import e2e

READ = e2e.adu(1, 3, 1, 1, 0, 1)  # A16 6(4), example 2


class Request(e2e.Case):
    def asked(self, response, options=''):
        device, request = self.beside('request 1 3 0x0101', options)
        device.asked(READ, response)
        return device, request

    def test_what_it_prints_is_what_decode_takes(self):
        _, request = self.asked(e2e.registers(1, 751))
        out = self.ends(request, 0).out
        for name in ('sent', 'received'):
            line = next(line for line in out.splitlines() if line.startswith(name))
            self.assertIn('CRC', self.ends(f'decode {line[len(name):]}', 0).out)

    def test_without_yes_nothing_leaves_and_the_port_is_not_opened(self):
        self.ends(f'request 1 6 0x0200 5 --port {self.path("none")}', 2, 'Nothing was sent yet. To confirm that, add --yes', out='')

    def test_a_lost_port_is_told(self):
        device, request = self.asked(b'', '--timeout 600000')
        device.hang_up()
        self.ends(request, 1, device.port)  # in 20 s, and not after its ten minutes

    def test_an_output_that_is_full_is_a_failure(self):
        with open('/dev/full', 'w', encoding='utf-8') as full:
            device, request = self.beside('request 1 3 0x0101', stdout=full)
            device.asked(READ, e2e.registers(1, 751))
            self.ends(request, 1, 'the output cannot be written')


if __name__ == '__main__':
    e2e.main()
