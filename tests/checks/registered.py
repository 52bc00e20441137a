#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""No test is lost unseen: each file tests/**/test_*.{c,py,js,sh} belongs to a test of CTest's, and each kind has tests.

    registered.py BUILD    asks CTest which tests the build folder BUILD has

A script is registered if a command contains its path. A C file is registered if a test's name or its command has the
file's name without the ending as a word."""
import json
import os
import re
import subprocess
import sys
from fnmatch import fnmatch

from common import ROOT

KINDS = ('unit', 'devices', 'port', 'firmware', 'tool', 'verify', 'bench', 'checks')


def test_files(root):
    """Returns the paths of all files of tests/ that have the name of a test."""
    found = []
    for where, folders, names in os.walk(os.path.join(root, 'tests')):
        folders[:] = [name for name in folders if name not in ('node_modules', '__pycache__')]
        found += [os.path.relpath(os.path.join(where, name), root) for name in names
                  if any(fnmatch(name, f'test_*{end}') for end in ('.c', '.py', '.js', '.sh'))]
    return sorted(found)


def registered(build):
    """Returns {name: command} of all tests that CTest knows in this build folder."""
    done = subprocess.run(['ctest', '--test-dir', build, '--show-only=json-v1'], stdout=subprocess.PIPE, text=True,
                          check=True)
    return {test['name']: ' '.join(test.get('command', ())) for test in json.loads(done.stdout)['tests']}


def problems(paths, tests):
    words = set(re.findall(r'\w+', ' '.join(' '.join(item) for item in tests.items())))
    commands = ' '.join(tests.values())
    for path in paths:
        stem, end = os.path.splitext(os.path.basename(path))
        if stem not in words if end == '.c' else path not in commands:
            yield f'{path}: no test of CTest runs it'
    for kind in KINDS:
        if not any(name.startswith(kind + '.') for name in tests):
            yield f'tests/{kind}: CTest has no test of this kind'


def main():
    paths, tests = test_files(ROOT), registered(sys.argv[1])
    found = list(problems(paths, tests))
    print(*found, f'{len(paths)} files, {len(tests)} tests, {len(found)} problems', sep='\n')
    return 1 if found or not paths else 0


if __name__ == '__main__':
    sys.exit(main())
