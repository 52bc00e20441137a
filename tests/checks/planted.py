#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the --self-test of each script of the kinds checks and bench, which plants a fault and has to find it."""
import os
import subprocess
import sys
import time

from common import ROOT

SCRIPTS = [f'tests/checks/{name}.py' for name in (
    'circles', 'count', 'datasheets', 'docs', 'file_lists', 'format', 'headers', 'layers', 'linked', 'lint',
    'minimum', 'misra', 'models', 'names', 'objects', 'package', 'pages', 'registered', 'sources', 'words')]
SCRIPTS += ['tests/bench/run.py', 'tests/bench/lines.py', 'tests/bench/publish.py', 'tests/bench/pictures/pictures.py',
            'tests/firmware/figures.py']


def main():
    failed = 0
    for script in SCRIPTS:
        began = time.monotonic()
        done = subprocess.run([sys.executable, os.path.join(ROOT, script), '--self-test'], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)
        is_found = done.returncode == 0 and done.stdout.endswith('1 passed, 0 failed\n')
        print(f'{script}: {"found" if is_found else "NOT FOUND"}, {time.monotonic() - began:.1f} s')
        if not is_found:
            print(done.stdout)
            failed += 1
    print(f'{len(SCRIPTS) - failed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
