#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The pages (*.md): their links lead somewhere, prose wraps at 120 columns, each folder that has code has a README.md,
no paragraph stands twice. The first page has at most 12 KB and two whole programs of a screen each, formatted like the
sources; the first of them is C++17 and C++20 too, without a warning."""
import os
import re
import sys
import tempfile

import common
from common import ROOT, files, main, read, run

sys.path.insert(0, os.path.join(ROOT, 'tests', 'support'))
from cut import blocks  # noqa: E402: as the tests that run the programs cut them out

common.COPIED = (*common.COPIED, '.github', 'tests', 'README.md', 'CHANGELOG.md', 'CMakeLists.txt', 'LICENSE')

COLUMNS, SCREEN, FIRST_PAGE = 120, 45, 12 * 1024
FOLDERS = ('.', 'include', 'src', 'src/codec', 'src/engine', 'src/sensor', 'port', 'port/sim', 'examples',
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


def programs(root):
    found = blocks(read(root, 'README.md'))
    if len(found) != 2:
        yield f'README.md: {len(found)} programs, not 2'
        return
    with tempfile.TemporaryDirectory() as work:
        for number, text in enumerate(found, 1):
            lines = text.count('\n')
            if lines > SCREEN:
                yield f'README.md: program {number} has {lines} lines, more than {SCREEN}'
            source = os.path.join(work, 'program.c')
            with open(source, 'w', encoding='utf-8') as file:
                file.write(text)
            style = '--style=file:' + os.path.join(root, '.clang-format')
            good, said = run(['clang-format-14', '--dry-run', '--Werror', style, source], work)
            if not good:
                yield f'README.md: program {number} is not formatted:\n{said}'
            for compiler in COMPILERS if number == 1 else ():
                include = [f'-I{os.path.join(root, folder)}' for folder in ('include', 'port/posix')]
                good, said = run([*compiler, *include, '-x', 'c++', '-fsyntax-only', source], work)
                if not good:
                    yield f'README.md: program 1 with {" ".join(compiler[:2])}:\n{said}'


def check(root, only):
    problems, seen = [], {}
    for path in (only if only and only[0] != 'README.md' else pages(root)):
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
    return [*problems, *programs(root)]


FAULT = ('README.md', '(src/README.md)', '(src/READER.md)', 'which is not there')

if __name__ == '__main__':
    main(check, FAULT)
