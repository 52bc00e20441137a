# SPDX-License-Identifier: MIT
"""Shows that run.py makes the mutants that it should, and that it can fail: in a project of one small file, whose test
misses some of them."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

import mutants

HERE = os.path.dirname(os.path.abspath(__file__))

BY_HAND = '''\
#define MOST 9u
enum { STEP = 2 };
static int least(int a, int b) { return a < b ? a : b; }
int f(unsigned char x, int n);
int f(unsigned char x, int n)
{
    const int y = least(n, STEP); /* x + 1 */
    if (x == 0 && !n) return -y;
    while (x > MOST) x -= 2;
    return y | x;
}
'''
# Function, operator and change; the order is that of the text.
EXPECTED = [
    ('', 'constant', '2 -> 0'), ('', 'constant', '2 -> 1'), ('', 'constant', '2 -> 3'),
    ('least', 'condition', 'a < b -> 0'), ('least', 'condition', 'a < b -> 1'),
    ('least', 'relational', '< -> <='), ('least', 'relational', '< -> >='),
    ('f', 'type', 'int -> int8_t'), ('f', 'arguments', 'n, STEP -> STEP, n'),
    ('f', 'logical', 'x == 0 && !n -> !n'), ('f', 'condition', 'x == 0 && !n -> !(x == 0 && !n)'),
    ('f', 'condition', 'x == 0 && !n -> 0'), ('f', 'condition', 'x == 0 && !n -> 1'),
    ('f', 'logical', 'x == 0 && !n -> x == 0'), ('f', 'relational', '== -> !='), ('f', 'constant', '0 -> 1'),
    ('f', 'logical', '&& -> ||'), ('f', 'unary', '! -> nothing'),
    ('f', 'jump dropped', 'it -> nothing'), ('f', 'unary', '- -> nothing'),
    ('f', 'condition', 'x > MOST -> 0'), ('f', 'condition', 'x > MOST -> 1'),
    ('f', 'relational', '> -> <='), ('f', 'relational', '> -> >='),
    ('f', 'constant', 'MOST -> (MOST + 1)'), ('f', 'constant', 'MOST -> (MOST - 1)'),
    ('f', 'constant', 'MOST -> 0'),
    ('f', 'statement dropped', 'it -> nothing'), ('f', 'arithmetic', '-= -> +='),
    ('f', 'constant', '2 -> 0'), ('f', 'constant', '2 -> 1'), ('f', 'constant', '2 -> 3'),
    ('f', 'bitwise', '| -> &'),
]

TINY = '''\
#include "tiny.h"
int tiny_is_far(int x) { return x > 100; }
unsigned tiny_log(unsigned x)
{
    unsigned n = 0;
    while (x > 1) {
        x >>= 1;
        n++;
    }
    return n;
}
int tiny_limit(int x) { return x > 9 ? 9 : x; }
'''
PROJECT = {
    'CMakeLists.txt': '''\
cmake_minimum_required(VERSION 3.21)
project(tiny C)
enable_testing()
include_directories(include)
add_library(tiny src/tiny.c)
add_subdirectory(tests)
''',
    'include/tiny.h': 'int tiny_is_far(int x);\nunsigned tiny_log(unsigned x);\nint tiny_limit(int x);\n',
    'src/tiny.c': TINY,
    'tests/CMakeLists.txt': '''\
add_executable(test_tiny unit/test_tiny.c)
target_link_libraries(test_tiny tiny)
add_test(NAME unit.test_tiny COMMAND test_tiny)
''',
    'tests/unit/test_tiny.c': '''\
#include "tiny.h"
int main(void)
{
    return !(tiny_is_far(200) && !tiny_is_far(50) && tiny_log(64) == 6 && tiny_log(1) == 0 && tiny_log(0) == 0 &&
             tiny_limit(8) == 8 && tiny_limit(10) == 9 && tiny_limit(12) == 9);
}
''',
}
FAR = ('no test is at the limit', *(f'src/tiny.c | tiny_is_far | {change} | return x > 100' for change in (
    'relational: > -> >=', 'constant: 100->101', 'constant: 100 -> 99')))
GONE = ('was once', 'src/tiny.c | tiny_is_far | relational: > -> >= | return x > 300')
KILLED = ('says who?', 'src/tiny.c | tiny_is_far | relational: > -> <= | return x > 100')


class Checks:
    def __init__(self):
        self.passed = self.failed = 0

    def check(self, name, good, shown=''):
        print(f'{"ok" if good else "FAILED"}: {name}')
        if good:
            self.passed += 1
        else:
            self.failed += 1
            print(shown)


def made_of(text, root):
    with open(os.path.join(root, 'by_hand.c'), 'w', encoding='ascii') as file:
        file.write(text)
    return mutants.mutants_of('by_hand.c', root)


def generator(checks, root):
    made = made_of(BY_HAND, root)
    found = [(mutant.function, mutant.operator, mutant.change) for mutant in made]
    wrong = [f'    made: {each}' for each in found if each not in EXPECTED] + \
        [f'    not made: {each}' for each in EXPECTED if each not in found]
    checks.check('the mutants of a small file are those made by hand', sorted(found) == sorted(EXPECTED),
                 '\n'.join(wrong))
    checks.check('no two mutants have one identity', len({mutant.identity for mutant in made}) == len(made))
    moved = BY_HAND.replace('/* x + 1 */', '/* elsewhere */').replace('enum', '\n/* two */\nenum')
    moved = moved.replace('x == 0', 'x  ==\n0')
    same = [mutant.identity for mutant in made_of(moved, root)] == [mutant.identity for mutant in made]
    checks.check('an identity outlives lines that move, comments and space', same)
    changed = made_of(BY_HAND.replace('return y | x', 'return x | y'), root)
    checks.check('and not a change of its statement',
                 [mutant.identity for mutant in changed] != [mutant.identity for mutant in made])


def run(root, rows, *options):
    with open(os.path.join(root, 'tests', 'verify', 'mutation', 'survivors.py'), 'w', encoding='ascii') as file:
        file.write(f'ROWS = {rows!r}\n')
    done = subprocess.run([sys.executable, os.path.join(root, 'tests', 'verify', 'mutation', 'run.py'), *options],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def change(root, name, old, new):
    with open(os.path.join(root, name), 'r+', encoding='ascii') as file:
        text = file.read()
        assert old in text
        file.seek(0)
        file.write(text.replace(old, new))
        file.truncate()


def runner(checks, root):
    for name, text in PROJECT.items():
        path = os.path.join(root, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w', encoding='ascii') as file:
            file.write(text)
    shutil.copytree(HERE, os.path.join(root, 'tests', 'verify', 'mutation'),
                    ignore=shutil.ignore_patterns('__pycache__', '*.csv'))

    status, said = run(root, [], '--all')
    survivors = sorted(re.findall(r'SURVIVED.*\n.*\| (\w+: .*?) \|', said))
    checks.check('what the test misses fails, and nothing else', status == 1 and said.endswith(' 3 failed\n') and
                 survivors == ['constant: 100 -> 101', 'constant: 100 -> 99', 'relational: > -> >='], said)
    checks.check('with the lines that differ', '    -int tiny_is_far(int x) { return x > 100; }\n'
                 '    +int tiny_is_far(int x) { return x >= 100; }\n' in said, said)
    counted = re.search(r'^all +(\d+) +(\d+) +(\d+) +(\d+)', said, re.M)
    made, same, killed, survived = (int(count) for count in counted.groups()) if counted else (0, 0, 0, 0)
    checks.check('the table adds up, with the ones that are the same code',
                 made == same + killed + survived and same >= 1 and survived == 3, said)

    began = time.monotonic()
    status, said = run(root, [], '--only', 'src/tiny.c:7')
    checks.check('a mutant that hangs is ended by its limit', 'killed by test_tiny, which hangs: src/tiny.c | tiny_log '
                 '| statement dropped' in said and time.monotonic() - began < 30 and status == 0, said)
    status, said = run(root, [FAR], '--all')
    checks.check('what is listed passes', status == 0 and said.endswith(' 0 failed\n'), said)
    status, said = run(root, [FAR, GONE], '--all')
    checks.check('a listed one that is not made any more fails', status == 1 and said.endswith(' 1 failed\n') and
                 'made any more:\n    src/tiny.c | tiny_is_far | relational: > -> >= | return x > 300' in said, said)
    change(root, 'src/tiny.c', 'int x) { return x > 100', 'int mm) { return mm > 100')
    status, said = run(root, [FAR], '--all')
    checks.check('a listed one outlives a new name for what is local', status == 0, said)
    change(root, 'src/tiny.c', 'int mm) { return mm > 100', 'int x) { return x > 100')
    status, said = run(root, [FAR, KILLED], '--all')
    checks.check('a listed one that a test kills fails', status == 1 and said.endswith(' 1 failed\n') and
                 'survivors.py lists it, but: test_tiny fails' in said, said)
    said = run(root, [FAR], '--sample', '4', '--seed', '7')[1], run(root, [FAR], '--sample', '4', '--seed', '7')[1]
    first, second = (re.sub(r' +\d+\n|.* s( of the processors)?\n', '\n', text) for text in said)
    checks.check('one seed makes one sample', 'a sample of 4 of' in first and first == second and
                 re.search(r'^all +4 ', first, re.M) is not None, first + second)
    change(root, 'tests/unit/test_tiny.c', '== 6', '== 7')
    status, said = run(root, [FAR], '--all')
    checks.check('a test that fails without a mutant is told', status == 1 and
                 'without a mutant: test_tiny fails\n0 passed, 1 failed\n' in said, said)


def main():
    checks = Checks()
    with tempfile.TemporaryDirectory(prefix='fathom-mutation.') as root:
        generator(checks, root)
        runner(checks, os.path.join(root, 'tiny'))
    print(f'{checks.passed} passed, {checks.failed} failed')
    return 1 if checks.failed else 0
