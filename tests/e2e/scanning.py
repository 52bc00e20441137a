# SPDX-License-Identifier: MIT
"""What the tests of fathom scan share."""
import json

import e2e

# Far more than a simulated sensor takes on a busy machine; so that load makes it slow, not wrong.
PATIENT = ('--listen', 1, '--timeout', 500)


class Case(e2e.Case):
    def scan(self, port, *arguments, code=0, seconds=100):
        """To the end; the objects that it found are in .found."""
        done = self.run_fathom('scan', '--port', port, '--format', 'json', *arguments, seconds=seconds)
        self.assertEqual(done.code, code, done.out + done.err)
        self.found = [json.loads(line) for line in done.out.splitlines()]
        return done

    def counters(self, sim):
        lines = sim.end().err.splitlines()
        return [json.loads(line) for line in lines if line.startswith('{')]

    def expect_unharmed(self, sim):
        counters = self.counters(sim)
        for device in counters:
            self.assertEqual((device['writes'], device['resets'], device['resets_refused']), (0, 0, 0), device)
        return counters
