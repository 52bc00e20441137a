#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""include/README.md's table of the datasheets: a row for each section of tests/unit/sections.csv, and what a row names
is there: functions and headers, commands of the tool, a link to a test. The headers that the pages name elsewhere are
there too, and the first page's table of sensors and modes has every driver. The tool covers the sections of its modes:

  datasheets.py --update    writes the command of a mode into each row of its section that has none
"""
import os
import re
import sys

from common import code_of, files, main, read

LIST = 'tests/unit/sections.csv'
MODELS = 'examples/fathom/sensors'
NONE = '–'
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


def modes(root):
    """{section: the command that reads the mode} of the rows of the tool, in the tables SENSOR_modes."""
    pins = {'TRIGGER': 'trigger=17', 'ECHO': 'echo=27', 'IN': 'in=5'}
    text = '\n'.join(read(root, path) for path in files(root, MODELS))
    found = {}
    for sensor, table in re.findall(r'^const model_mode_t (\w+)_modes\[MODEL_MODES\] = \{\n(.*?)^\};', text, re.M | re.S):
        for name, section, row in re.findall(r'\{"(\w+)", "([^"]*)"([^}]*)\}', table):
            needs = re.search(r'\.pins = ([^,}]*)', row)
            keys = [pins[pin] for pin in re.findall(r'MODEL_PIN_(\w+)', needs[1])] if needs else []
            port = f'@{",".join(["gpiochip0", *keys])}' if keys else ' --port P'
            found[section] = f'read {sensor}:{name}{port}'
    return found


def mode_of(section, commands):
    """The command of the mode that a section describes; None: it describes none."""
    for name, command in commands.items():
        if section.startswith(name) and not section[len(name):][:1].isdigit():
            return command
    return None


def update(root):
    text = read(root, PAGE)
    commands = modes(root)
    lines = text.split('\n')
    for number, line in enumerate(lines):
        cells = line.split('|')
        if len(cells) == 7 and cells[4].strip() == NONE and mode_of(cells[1].strip(), commands):
            cells[4] = f' `{mode_of(cells[1].strip(), commands)}` '
            lines[number] = '|'.join(cells)
    with open(os.path.join(root, PAGE), 'w', encoding='utf-8') as file:
        file.write('\n'.join(lines))


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


def check(root):
    tree = Tree(root)
    wanted = sections(read(root, LIST))
    found = rows(read(root, PAGE))
    names = [row[0] for row in found]
    commands = modes(root)
    problems = [f'{PAGE}: no row for {name} of {LIST}' for name in wanted if name not in names]
    problems += [f'{PAGE}: {name} is no section of {LIST}' for name in names if name not in wanted]
    problems += [f'{MODELS}: {name} is no section of {LIST}' for name in commands
                 if not any(section.startswith(name) for section in wanted)]
    problems += [] if commands else [f'{MODELS}: no modes']
    problems += [f'{PAGE}: {name} stands there twice' for name in set(names) if names.count(name) > 1]
    for name, api, tool, tests in found:
        if not quoted(api):
            problems.append(f'{PAGE}: {name}: no function or header')
        problems += [f'{PAGE}: {name}: {word} is not in include/fathom'
                     for word in quoted(api) if not tree.has_api(word)]
        for words in quoted(tool):
            if words.split()[0] not in tree.commands:
                problems.append(f'{PAGE}: {name}: the tool has no command {words.split()[0]}')
        if tool == NONE and mode_of(name, commands):
            problems.append(f'{PAGE}: {name}: the tool reads it by {mode_of(name, commands)} (datasheets.py --update)')
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
    return problems


if __name__ == '__main__':
    if sys.argv[1:] == ['--update']:
        sys.exit(update('.'))
    main(check)
