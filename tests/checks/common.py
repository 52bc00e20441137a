# SPDX-License-Identifier: MIT
"""What the checks share: the tree, the compilers' flags, and how a check reports."""
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# The same as in port/fathom_add_port.cmake; a C++ compiler has no use for the last two.
CXX_WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Wconversion', '-Wsign-conversion', '-Wshadow',
                '-Wmissing-declarations', '-Wcast-align', '-Wvla', '-Werror']
WARNINGS = [*CXX_WARNINGS, '-Wstrict-prototypes']

# The port to the machine that only tests have.
TEST_PORTS = ('tests/firmware/virt/port',)

LIBMODBUS = '-isystem/usr/include/modbus'  # what the port over libmodbus includes


def files(root, *folders, ends=('.c', '.h')):
    """Paths below the folders, relative to root and sorted."""
    found = []
    for folder in folders:
        for where, _, names in os.walk(os.path.join(root, folder)):
            found += [os.path.relpath(os.path.join(where, name), root) for name in names if name.endswith(ends)]
    return sorted(found)


def read(root, path):
    with open(os.path.join(root, path), encoding='utf-8') as file:
        return file.read()


def code_of(text):
    """C without its comments and without what stands in its string and character literals; lines are kept."""
    def blank(match):
        found = match[0]
        return found[0] + found[-1] if found[0] in '"\'' else re.sub(r'[^\n]', ' ', found)
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', blank, text, flags=re.S)


def run(command, root):
    """(succeeded, what it printed)"""
    done = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    return done.returncode == 0, done.stdout


def main(check):
    """check(root): problems as text."""
    problems = check(ROOT)
    for problem in problems:
        print(problem)
    print(f'{len(problems)} problems')
    sys.exit(1 if problems else 0)
