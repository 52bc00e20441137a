#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom request behind a gateway that says that the unit is silent."""
import e2e
import tcp_server


class Request(tcp_server.Case):
    @e2e.each(path_unavailable=(10, 'gateway path unavailable'),
              target_silent=(11, 'gateway target device failed to respond'))
    def gateway(self, number, name):
        server = self.server()
        request = self.fathom(f'request 1 3 0x0101 --timeout 500 --port {server}')
        server.accept()
        transaction, unit, rest = server.request()
        self.assertEqual((unit, rest), (1, bytes((3, 1, 1, 0, 1))))
        server.say(tcp_server.adu(transaction, 1, 0x83, number))
        self.ends(request, 1, f'the gateway responds with exception {number} ({name}). Check UNIT')


if __name__ == '__main__':
    e2e.main()
