# SPDX-License-Identifier: MIT
"""What the checks share: the tree, the compilers' flags, and a planted fault that shows that a check can fail."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# The same as in port/fathom_add_port.cmake; a C++ compiler has no use for the last two.
CXX_WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Wconversion', '-Wsign-conversion', '-Wshadow',
                '-Wmissing-declarations', '-Wcast-align', '-Wvla', '-Werror']
WARNINGS = [*CXX_WARNINGS, '-Wstrict-prototypes']

# The ports to machines that only tests have.
TEST_PORTS = ('tests/firmware/mps2/port', 'tests/firmware/virt/port')

LIBMODBUS = '-isystem/usr/include/modbus'  # what the port over libmodbus includes

COPIED = ('include', 'src', 'port', 'examples', 'CMakeLists.txt', 'CMakePresets.json', '.clang-tidy', '.clang-format')


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


def plant(root, path, old, new):
    """Replaces the first `old` (None: the end) of a file, which is made if need be."""
    target = os.path.join(root, path)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    text = read(root, path) if os.path.exists(target) else ''
    if old is None:
        text += new
    elif old in text:
        text = text.replace(old, new, 1)
    else:
        raise SystemExit(f'self-test: {old!r} is not in {path}')
    with open(target, 'w', encoding='utf-8') as file:
        file.write(text)


def self_test(check, fault):
    """Returns 0 if the check finds the fault when it is planted in a copy of the tree."""
    path, old, new, words = fault
    with tempfile.TemporaryDirectory() as copy:
        for name in COPIED:
            source = os.path.join(ROOT, name)
            if os.path.isdir(source):
                shutil.copytree(source, os.path.join(copy, name))
            elif os.path.exists(source):
                shutil.copy(source, copy)
        plant(copy, path, old, new)
        is_found = any(words in problem and path in problem for problem in check(copy, [path]))
    if not is_found:
        print(f'not found: {new.strip()!r} in {path} ({words})')
    print(f'{int(is_found)} passed, {int(not is_found)} failed')
    return 0 if is_found else 1


def main(check, fault):
    """check(root, only): problems as text; `only` may narrow it to some paths, for speed."""
    if sys.argv[1:] == ['--self-test']:
        sys.exit(self_test(check, fault))
    problems = check(ROOT, None)
    for problem in problems:
        print(problem)
    print(f'{len(problems)} problems')
    sys.exit(1 if problems else 0)
