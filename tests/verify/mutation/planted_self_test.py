# SPDX-License-Identifier: MIT
"""planted.py --self-test: a small project of its own, and rows that fit and that do not."""
import contextlib
import io
import os
import tempfile

import planted
import planting
from planted import Bad, Row

FILES = {
    'src/a.h': 'int twice(int n);\nint larger(int a, int b);\nint unused(void);\n',
    'src/a.c': '''#include "a.h"
enum { LEAST = 2, MOST = 5 };
#define KEPT(n) { if ((n) > MOST) { return 0; } }
/* return value + value; */
int twice(int value)
{
    const char *const text = "value + value";
    (void)text;
    return value   +  /* not times */
           value;
}
int larger(int a, int b) { if (a > b) return a; return b; }
int unused(void) { return LEAST + LEAST; }
''',
    'tests/unit/test_a.c': '''#include "a.h"
#include <stdio.h>
#include <string.h>
static int fails(const char *name, int is_right)
{
    if (!is_right) printf("[  FAILED  ] %s\\n", name);
    return !is_right;
}
int main(int argc, char **argv)
{
    int failed = 0;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "test_a") == 0) failed += fails("two_and_two", twice(2) == 4);
        if (strcmp(argv[i], "test_b") == 0) failed += fails("the_larger", larger(1, 2) == 2 && larger(2, 1) == 2);
    }
    return failed;
}
''',
    'tests/unit/test_b.c': '',
    'CMakeLists.txt': '''cmake_minimum_required(VERSION 3.21)
project(a C)
enable_testing()
add_library(a STATIC src/a.c)
target_include_directories(a PUBLIC src)
add_executable(test_unit tests/unit/test_a.c)
target_link_libraries(test_unit PRIVATE a)
foreach(name IN ITEMS test_a test_b)
    add_test(NAME unit.${name} COMMAND test_unit ${name})
endforeach()
''',
    'include/a': '', 'port/a': '', 'examples/a': '',
}
A, TWICE, LARGER = 'src/a.c', ('src/a.c', 'twice'), ('src/a.c', 'larger')
SUM = 'return value + value;'

TEXTS = [  # edit, what the file has afterwards, or what is said
    ((*TWICE, SUM, 'return value;'), '"value + value";\n    (void)text;\n    return value;\n}', ''),
    ((*TWICE, 'return   value+value ;', 'return 0;'), 'return 0;', ''),
    ((*TWICE, 'return gone + gone;', 'return gone;'), '    return value;\n}', ''),  # a local variable was renamed
    ((*TWICE, 'return gone + other;', 'return gone;'), None, "'return gone + other;' is gone in twice"),
    ((*TWICE, 'return value - value;', ''), None, 'is gone in twice'),
    ((*TWICE, 'value', '0'), None, 'is ambiguous in twice: it is there 3 times'),
    ((*LARGER, SUM, ''), None, 'is gone in larger'),  # it is in another function
    ((*LARGER, 'if (gone > b) return gone;', 'if (gone < b) return gone;'), 'if (a < b) return a;', ''),
    ((A, 'smaller', SUM, ''), None, 'the function smaller is there 0 times'),
    ((A, '', 'LEAST = 2', 'LEAST = 3'), 'LEAST = 3,', ''),
    ((A, 'unused', 'GONE + GONE', '0'), None, 'is gone in unused'),  # no local variable
    ((A, '', 'LEAST = gone', ''), None, 'is gone outside of functions'),
    ((A, '', SUM, ''), None, 'is gone outside of functions'),  # a comment is no text
    (('src/b.c', '', SUM, ''), None, 'No such file'),
]
RUNS = [  # name, tests, edits, what is said of it
    ('sees', 'unit/test_a', [(*TWICE, '+', '-')], 'seen by unit/test_a: two_and_two'),
    ('another-sees', 'unit/test_a', [(*LARGER, '>', '<')], 'seen by test_unit: the_larger (not by unit/test_a)'),
    ('nothing-sees', 'unit/test_a unit/test_b', [(A, 'unused', 'LEAST + LEAST', 'MOST')],
     'FAILED, no test sees it (the promise)'),
    ('two-places', 'unit/test_b', [(*LARGER, 'if (a > b) return a;', ''), (*LARGER, 'return b;', 'return 1;')],
     'seen by unit/test_b: the_larger'),
    ('header', 'unit/test_a', [('src/a.h', '', 'int twice(int n);', '#define twice(n) 5')],
     'FAILED, it does not compile'),
    ('header-of-tests', 'unit/test_b',
     [('src/a.h', '', 'int unused(void);', 'int unused(void);\n#define larger(a, b) a'),
      (A, '', '#include "a.h"', '')], 'seen by unit/test_b: the_larger'),
]
ROWS = """ROWS = (
    ('a', 'a.h: twice_it of "src/a.c"', 'unit/test_a',
     ('src/a.c', 'twice', 'return value + '
      'value;', 'return "value" + \\'v\\' + value;')),
)
"""
RENAMED = """ROWS = (
    ('a', 'a.h: times_2 of "src/a.c"', 'unit/test_new',
     ('lib/a.c', 'times_2', 'return number + '
      'number;', 'return "value" + \\'v\\' + number;')),
)
"""


class Judge:
    def __init__(self):
        self.right = self.wrong = 0

    def see(self, is_right, *words):
        self.right += bool(is_right)
        self.wrong += not is_right
        if not is_right:
            print('WRONG:', *words)


def row(name, tests, edits):
    return Row('rows', (name, 'the promise', tests, *edits))


def texts(judge, root):
    for edit, after, words in TEXTS:
        try:
            text = row('x', 'unit/test_a', [edit]).changed(root)[edit[0]]
            judge.see(after is not None and after in text, edit, 'makes', text)
        except Bad as error:
            judge.see(after is None and words in str(error) and 'rows.x' in str(error), edit, 'says', error)
    twice = [row('x', 'unit/test_a', [(*LARGER, 'if (a > b)', ''), (*LARGER, 'a > b', 'b')])]
    judge.see('overlap' in ' '.join(planted.check(root, twice)), 'two edits overlap')
    judge.see('changes nothing' in ' '.join(planted.check(root, [row('x', 'unit/test_a', [(*TWICE, SUM, SUM)])])),
              'a row that changes nothing')
    judge.see('no test unit/test_c' in ' '.join(planted.check(root, [row('x', 'unit/test_c', [(*TWICE, SUM, '')])])),
              'a row whose test is gone')


def renames(judge, root):
    path = os.path.join(root, 'rows.py')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(ROWS)
    names = planted.names_of(['twice=times_2', 'twice_it=times_2', 'value=number', 'a.h=b.h',
                              'unit/test_a=unit/test_new', 'src/=lib/'])
    text = planted.renamed(path, names)
    # The promise is prose: names with an underscore alone are renamed in it.
    judge.see(text == RENAMED, 'renamed:', text)


def runs(judge, root, folder):
    rows = [row(name, tests, edits) for name, tests, edits, _ in RUNS]
    with contextlib.redirect_stdout(io.StringIO()) as said:
        status = planting.run_rows(root, rows, 2)
    for name, _, _, words in RUNS:
        judge.see(f'rows.{name}: {words}' in said.getvalue(), name, 'is said to be', said.getvalue())
    judge.see(status == 1 and said.getvalue().endswith('4 passed, 2 failed\n'), 'a fault that is missed is a failure')
    planted.apply(root, rows[:1], folder)
    with open(os.path.join(folder, A), encoding='utf-8') as file:
        judge.see('return value   -' in file.read(), 'a file of --apply')


def main():
    judge = Judge()
    with tempfile.TemporaryDirectory(prefix='fathom-planted.') as folder:
        root = os.path.join(folder, 'root')
        for name, text in FILES.items():
            os.makedirs(os.path.dirname(os.path.join(root, name)), exist_ok=True)
            with open(os.path.join(root, name), 'w', encoding='utf-8') as file:
                file.write(text)
        texts(judge, root)
        renames(judge, root)
        runs(judge, root, os.path.join(folder, 'applied'))
    print(f'{judge.right} passed, {judge.wrong} failed')
    return 1 if judge.wrong else 0
