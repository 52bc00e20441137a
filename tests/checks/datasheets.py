#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""include/README.md's table of the datasheets: a row for each section of tests/unit/sections.csv, and what a row names
is there: functions and headers, commands of the tool, a link to a test. The headers that the pages name elsewhere are
there too, and the first page's table of sensors and modes has every driver."""
import os
import re

import common
from common import code_of, files, main, read

common.COPIED = (*common.COPIED, 'tests', 'README.md')

LIST = 'tests/unit/sections.csv'
PAGE, FIRST = 'include/README.md', 'README.md'
DRIVER = re.compile(r'(a16|a05|hps167s)(_|\.h$)(?!registers)')
BEGIN, END = '<!-- datasheets: ', '<!-- end -->'


def sections(text):
    lines = [line for line in text.splitlines() if line and not line.startswith('#')]
    return [line.split(',', 1)[0] for line in lines[1:]]


def rows(text):
    """(section, API, tool, tests) of each row."""
    begin = text.index(BEGIN)
    found = []
    for line in text[begin:text.index(END, begin)].splitlines():
        cells = [cell.strip() for cell in line.strip('|').split('|')]
        if line.startswith('|') and len(cells) == 5 and not cells[0].startswith('-') and cells[0] != 'datasheet':
            found.append((cells[0], cells[2], cells[3], cells[4]))
    return found


def quoted(cell):
    return re.findall(r'`([^`]+)`', cell)


class Tree:
    def __init__(self, root):
        self.root = root
        code = '\n'.join(code_of(read(root, path)) for path in files(root, 'include'))
        self.names = set(re.findall(r'\b[A-Za-z_]\w*\b', code))
        self.commands = set(re.findall(r'&(\w+)_command\b', read(root, 'examples/fathom/commands/commands.c')))

        self.headers = files(root, 'include', ends='.h')

    def has_header(self, name):
        return os.path.exists(os.path.join(self.root, name)) or any(
            f'/{path}'.endswith(f'/{name}') for path in self.headers)

    def has_api(self, name):
        return self.has_header(name) if name.endswith('.h') else name in self.names


def check(root, only):
    tree = Tree(root)
    wanted = sections(read(root, LIST))
    found = rows(read(root, PAGE))
    names = [row[0] for row in found]
    problems = [f'{PAGE}: no row for {name} of {LIST}' for name in wanted if name not in names]
    problems += [f'{PAGE}: {name} is no section of {LIST}' for name in names if name not in wanted]
    problems += [f'{PAGE}: {name} stands there twice' for name in set(names) if names.count(name) > 1]
    for name, api, tool, tests in found:
        if not quoted(api):
            problems.append(f'{PAGE}: {name}: no function or header')
        problems += [f'{PAGE}: {name}: {word} is not in include/fathom'
                     for word in quoted(api) if not tree.has_api(word)]
        for words in quoted(tool):
            if words.split()[0] not in tree.commands:
                problems.append(f'{PAGE}: {name}: the tool has no command {words.split()[0]}')
        if not re.search(r'\]\(\.\./tests/', tests): # pages.py follows the link
            problems.append(f'{PAGE}: {name}: no link to a test')
    first = set()
    for page in (FIRST, PAGE):
        prose = set(quoted(re.sub(r'^```.*?^```', '', read(root, page), flags=re.S | re.M)))
        first = first or prose
        problems += [f'{page}: {word} is not in include/fathom' for word in prose
                     if re.fullmatch(r'[\w/]+\.h', word) and not tree.has_header(word)]
    problems += [f'{FIRST}: no row for {path}' for path in tree.headers
                 if DRIVER.match(os.path.basename(path)) and os.path.basename(path) not in first]
    return [problem for problem in problems if only is None or any(path in problem for path in only)]


FAULT = (PAGE, '`fathom_a16_modbus_set_address`', '`fathom_a16_modbus_set_adress`', 'is not in include/fathom')

if __name__ == '__main__':
    main(check, FAULT)
