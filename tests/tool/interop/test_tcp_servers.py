#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The same as test_servers_request.py over TCP."""
import interop
import test_servers_request
from interop import e2e


class Servers(test_servers_request.Servers):
    def test_a_function_that_no_server_has_is_exception_01(self):
        """Over RTU neither server knows where such a request ends, and both are silent."""
        port = self.served(test_servers_request.LINE, 1, test_servers_request.FIRST, [1])
        found = self.ask(port, '1 0x41 12 34 --yes', 1, 'unit 1 refused: exception 01 (illegal function)')
        self.assertEqual(found['received'], e2e.adu(1, 0xC1, 1).hex(' ').upper())


class PymodbusTcp(interop.Tcp, interop.PymodbusServer, Servers, interop.Case):
    pass


class LibmodbusTcp(interop.Tcp, interop.LibmodbusServer, Servers, interop.Case):
    pass


if __name__ == '__main__':
    interop.main()
