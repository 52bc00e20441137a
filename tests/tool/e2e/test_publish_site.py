#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/site.sh in a copy of the repository: eight lines are published, it ends by itself and leaves nothing behind; and what
is missing on a machine it names."""
import os
import re
import shutil

import e2e
import test_demo


class Site(test_demo.Case):
    def test_a_site_is_published_and_nothing_is_left_behind(self):
        done = self.ends(self.run_script('examples/site.sh', self.copy), 0)
        shown = done.out.partition('(40 messages)')[2]
        self.assertEqual(len(re.findall('^fathom/mill/north/', shown, re.M)), 40 + 1, done)
        for name in ('pit', 'bumper/1', 'dock/1', 'gate', 'bay1', 'bay2', 'bay3'):
            self.assertRegex(shown, rf'(?m)^fathom/mill/north/{name}/state {{.*"status":"target"')
        self.assertRegex(shown, r'(?m)^fathom/mill/north/gate/alarm {.*"is_on":true,')
        self.assertRegex(shown, r'(?s)the retained status .*\nfathom/mill/north/status offline\n')
        self.assertEqual(list(self.processes()), [])
        self.assertEqual(os.listdir(self.path('tmp')), [])

    def test_what_is_missing_is_told(self):
        """Of all programs there is only one, and what /usr/sbin has."""
        os.mkdir(self.path('bin'))
        os.symlink(shutil.which('dirname'), self.path('bin/dirname'))
        self.environment['PATH'] = self.path('bin')
        done = self.start(['/bin/sh', 'examples/site.sh'], cwd=self.copy, env=self.environment).finish()
        self.ends(done, 1, 'site: please install: gcc make cmake pkg-config libmosquitto-dev libyaml-dev ', 'mosquitto-clients')


if __name__ == '__main__':
    e2e.main()
