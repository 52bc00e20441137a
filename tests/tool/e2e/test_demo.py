#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/demo.sh and site.sh in a copy of the repository: demo.sh reads all three sensors, site.sh publishes eight lines;
each ends by itself, leaves nothing behind, and names what is missing. They build without optimization, to be quick."""
import os
import re
import shutil

import e2e


class Case(e2e.Case):
    """A copy of the repository, whose scripts are run."""

    def setUp(self):
        super().setUp()
        self.copy = self.path('repository')
        os.mkdir(self.path('tmp'))
        os.mkdir(self.copy)
        for name in ('CMakeLists.txt', 'CMakePresets.json'):
            shutil.copy(os.path.join(e2e.ROOT, name), self.copy)
        for name in ('include', 'src', 'port', 'examples', 'tests'):
            shutil.copytree(os.path.join(e2e.ROOT, name), os.path.join(self.copy, name))
        with open(self.path('cc'), 'w', encoding='ascii', opener=lambda *of: os.open(*of, 0o755)) as compiler:
            compiler.write(f'#!/bin/sh\nexec {os.environ.get("CC", "cc")} "$@" -O0\n')
        self.environment = {**os.environ, 'TMPDIR': self.path('tmp'), 'CC': self.path('cc')}
        self.environment.pop('FATHOM', None)

    def run_script(self, path, cwd):
        """The script builds the tool, which takes 25 s on an idle machine."""
        return self.start(['sh', path], cwd=cwd, env=self.environment).finish(300)

    def processes(self):
        """Those that run the copy's tool."""
        tool = os.path.join(self.copy, 'build', 'fathom')
        for pid in filter(str.isdigit, os.listdir('/proc')):
            try:
                if os.readlink(f'/proc/{pid}/exe').startswith(tool):
                    yield pid
            except OSError:
                pass


class Demo(Case):
    def test_all_three_sensors_are_read_and_nothing_is_left_behind(self):
        done = self.ends(self.run_script('examples/demo.sh', self.copy), 0)
        for name, count in (('a16', 10), *((f'a05 probe {probe}', 4) for probe in range(1, 5)),
                            ('hps167s', 10)):
            self.assertEqual(len(re.findall(rf'^ +\d+\.\d{{3}} s  {name} +\d+ mm', done.out, re.M)), count,
                             done)
        self.assertEqual(done.out.count('"model":"hps167s",'), 1)
        self.assertEqual(list(self.processes()), [])
        self.assertEqual(os.listdir(self.path('tmp')), [])

    def test_what_fails_is_told_and_fails_the_demo(self):
        with open(os.path.join(self.copy, 'include/fathom/hal.h'), 'a', encoding='ascii') as file:
            file.write('#error planted\n')
        done = self.run_script(os.path.join(self.copy, 'examples', 'demo.sh'), '/')
        self.ends(done, 1, '#error planted', 'demo: cmake failed')
        self.assertEqual(os.listdir(self.path('tmp')), [])


class Site(Case):
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
