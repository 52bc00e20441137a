#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The pages (*.md): their links lead somewhere, prose wraps at 120 columns, each folder that has code has a README.md,
no paragraph stands twice. The first page has at most 12 KB and two whole programs, which are those of COMPLETE, without
their first line. Those fit on a screen, and the first of them is C++17 and C++20 too, without a warning. The table of
first programs has a cell for each mode and machine, and the file of each cell is there."""
import os
import re
import sys
import tempfile

from common import ROOT, files, main, read, run

sys.path.insert(0, os.path.join(ROOT, 'tests', 'support'))
from cut import blocks  # noqa: E402: as the tests that run the programs cut them out

COLUMNS, FIRST_PAGE = 120, 12 * 1024
# The complete first programs, and how many lines each may have without that of the licence. The first page has the
# first two.
COMPLETE = {'examples/linux/first.c': 28, 'examples/avr/first.c': 35, 'examples/rp2040/first.c': 35,
            'examples/stm32f4/first.c': 35}
LICENCE = '/* SPDX-License-Identifier: MIT */\n'
FOLDERS = ('.', 'include', 'src', 'src/codec', 'src/engine', 'src/models', 'src/sensor', 'port', 'port/sim', 'examples',
           'examples/fathom', 'tests', 'tests/unit', 'tests/devices', 'tests/port', 'tests/firmware', 'tests/tool',
           'tests/verify', 'tests/bench', 'tests/checks', 'tests/support')
WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Werror']
COMPILERS = [[compiler, f'-std=c++{year}', *WARNINGS] for compiler in ('g++', 'clang++-14') for year in (17, 20)]
NOT_WRAPPED = ('CHANGELOG.md',)
SECURITY = '.github/SECURITY.md'


def pages(root):
    return [path for path in files(root, '.', ends='.md')
            if path == SECURITY or not re.match(r'(\./)?(build|\.)[^/]*/', path) and 'node_modules' not in path]


def prose(text):
    return re.sub(r'^```.*?^```$', lambda found: re.sub(r'[^\n]', '', found[0]), text, flags=re.M | re.S)


def anchors(text):
    """What GitHub and others make of its headings."""
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-')
            for heading in re.findall(r'^#+ (.*)$', text, re.M)}


def links(root, path, text):
    for target in re.findall(r'\]\(([^)\s]+)\)', text.replace('\n', ' ')):
        if '://' in target:
            continue
        name, _, anchor = target.partition('#')
        there = os.path.normpath(os.path.join(root, os.path.dirname(path), name)) if name else os.path.join(root, path)
        if not os.path.exists(there):
            yield f'{path}: links to {target}, which is not there'
        elif anchor and anchor not in anchors(read(root, os.path.relpath(there, root))):
            yield f'{path}: links to {target}, which has no such heading'


def paragraphs(text):
    """Prose of some length, each by its words."""
    for part in re.split(r'\n\s*\n', prose(text)):
        words = ' '.join(part.split())
        if len(words) > 80 and not words.startswith(('|', '<!--', '#')):
            yield words


def complete(root):
    """{path: text without the licence} of the complete first programs."""
    return {path: read(root, path).removeprefix(LICENCE) for path in COMPLETE}


def programs(root):
    sources = complete(root)
    for path, text in sources.items():
        lines = text.count('\n')
        if lines > COMPLETE[path]:
            yield f'{path}: {lines} lines without that of the licence, more than {COMPLETE[path]}'
    found = blocks(read(root, 'README.md'))
    if len(found) != 2:
        yield f'README.md: {len(found)} programs, not 2'
    for number, (path, text) in enumerate(zip(sources, found), 1):
        if text != sources[path]:
            yield f'README.md: program {number} is not {path}'
    include = [f'-I{os.path.join(root, folder)}' for folder in ('include', 'port/posix')]
    for compiler in COMPILERS:
        source = os.path.join(root, next(iter(sources)))
        with tempfile.TemporaryDirectory() as work:
            good, said = run([*compiler, *include, '-x', 'c++', '-fsyntax-only', source], work)
        if not good:
            yield f'{source} with {" ".join(compiler[:2])}:\n{said}'


def first_programs(root):
    """The table of examples/README.md: a row for each examples/first/MODE.c, whose cells are that file, a complete
    program, or a sketch."""
    page, machines = 'examples/README.md', ('linux', 'avr', 'rp2040', 'stm32f4')
    section = read(root, page).partition('\n## First programs\n')[2].partition('\n## ')[0]
    rows = [line.split('|')[1:-1] for line in section.splitlines() if re.match(r'\| (A16|A05|HPS-167S) ', line)]
    modes = {os.path.basename(path)[:-2] for path in files(root, 'examples/first', ends='.c')
             if os.path.dirname(path) == 'examples/first'} - {'print'}
    for row in rows:
        cells = [re.findall(r'\]\((\S+)\)', cell) for cell in row[2:]]
        found = [re.fullmatch(r'(?:first|arduino/\w+)/(\w+)\.(?:c|ino)', link) for cell in cells for link in cell]
        named = {match[1] for match in found if match and match[1] != 'first'}
        if len(named) != 1 or not named <= modes:
            yield f'{page}: the row {"|".join(row[:2])} names {sorted(named)}, not one of {sorted(modes)}'
            continue
        mode = named.pop()
        modes.remove(mode)
        for machine, cell in zip(machines, cells):
            if cell not in ([f'first/{mode}.c'], [f'{machine}/first.c']):
                yield f'{page}: {mode} on {machine} is {cell}'
    for mode in sorted(modes):
        yield f'{page}: the table of first programs has no row of {mode}'


def check(root):
    problems, seen = [], {}
    for path in pages(root):
        text = read(root, path)
        problems += links(root, path, prose(text))
        for number, line in enumerate(prose(text).split('\n'), 1):
            if len(line) > COLUMNS and not line.startswith(('|', '![')) and path not in NOT_WRAPPED:
                problems.append(f'{path}:{number}: {len(line)} columns, more than {COLUMNS}')
    for path in pages(root):
        for words in paragraphs(read(root, path)):
            if words in seen:
                problems.append(f'{path}: this stands in {seen[words]} too: {words[:60]}...')
            seen[words] = path
    problems += [f'{folder}/README.md: is not there' for folder in FOLDERS
                 if os.path.isdir(os.path.join(root, folder)) and
                 not os.path.exists(os.path.join(root, folder, 'README.md'))]
    size = len(read(root, 'README.md').encode())
    if size > FIRST_PAGE:
        problems.append(f'README.md: {size} bytes, more than {FIRST_PAGE}')
    return [*problems, *programs(root), *first_programs(root)]


if __name__ == '__main__':
    main(check)
