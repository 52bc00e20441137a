# SPDX-License-Identifier: MIT
"""What the tests of fathom scan share."""
import e2e

# Far more than a simulated sensor takes on a busy machine; so that load makes it slow, not wrong.
PATIENT = '--listen 1 --timeout 500'


class Case(e2e.Case):
    def scan(self, port, options, *said, code=0):
        """To the end; the objects that it found are in .found."""
        done = self.run_fathom(f'scan --port {port} --format json {options}', seconds=100)
        self.found = self.ends(done, code, *said).json
        return done

    def expect_unharmed(self, sim):
        counters = sim.end().told
        for device in counters:
            self.assertEqual((device['writes'], device['resets'], device['resets_refused']), (0, 0, 0),
                             device)
        return counters

    def expect_unasked(self, sim):
        counters, = sim.end().told
        self.assertEqual((counters['requests'], counters['crc_errors'], counters['others']), (0, 0, 0))
        return counters
