#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plants faults that no operator makes, one at a time, and sees that a test finds each.

    planted.py [-j N] [--build FOLDER [--as-built]] [NAME ...]  plants the rows whose names have a NAME, or all
    planted.py --list [NAME ...]
    planted.py --check                              sees that every row still applies; builds nothing
    planted.py --apply ROW ... --to FOLDER          writes the files with these rows' faults into FOLDER
    planted.py --rename OLD=NEW|FILE ...            renames in the rows; FILE has a line "OLD NEW" for each
    planted.py --self-test

rows/MODULE.py has a row for each fault: its name (MODULE.NAME to the commands), the promise that it breaks, the
tests that are expected to see it (KIND/NAME), and edits: a file, a function (none: outside of all functions),
the old text and the new one. The old text is matched by the tokens of C, so white space, comments, line numbers
and the names of local variables may change; it has to be there exactly once. Of --rename an OLD with a slash is a
path (src/engine/line.c, unit/test_line) or the beginning of one, any other an identifier.

--build: a folder in which the project is built by Unix Makefiles; else one is built in a temporary folder.
--as-built: it is up to date and its tests pass, which is otherwise seen to first."""
import argparse
import ast
import glob
import io
import os
import re
import sys
import tokenize

import c_text

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
ROWS = os.path.join(HERE, 'rows')
FIRMWARE = 'firmware/'


class Bad(Exception):
    """A row, or a call, that cannot be carried out."""


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


class Row:
    def __init__(self, module, fields):
        try:
            name, self.promise, tests, *edits = fields
            self.name, self.tests = f'{module}.{name}', tests.split()
            self.edits = {}  # file: [(function, old, new)]
            for file, function, old, new in edits:
                self.edits.setdefault(file, []).append((function, old, new))
        except (ValueError, AttributeError):
            raise Bad(f'{module}.py: not a row: {fields!r}') from None
        if not self.tests or not self.edits:
            raise Bad(f'{self.name}: no test, or nothing to change')
        self.is_firmware = self.tests[0].startswith(FIRMWARE)

    def machine(self):
        """The folder of its port: whose images a row of firmware changes."""
        return next(iter(self.edits)).split('/')[1]

    def changed(self, root):
        """{file: its text with the fault}"""
        return changed(root, [self])


def changed(root, rows):
    texts = {}
    for file in dict.fromkeys(file for row in rows for file in row.edits):
        edits = [edit for row in rows for edit in row.edits.get(file, ())]
        try:
            texts[file] = c_text.replace(read(os.path.join(root, file)), edits)
        except (c_text.NotThere, OSError) as error:
            names = ' '.join(row.name for row in rows if file in row.edits)
            raise Bad(f'{names}: {file}: {error}') from None
    return texts


def tree_of(path):
    """The tuple ROWS of a file, as a syntax tree."""
    for node in ast.parse(read(path), path).body:
        if isinstance(node, ast.Assign) and node.targets[0].id == 'ROWS':
            return node.value
    raise Bad(f'{path}: there is no ROWS')


def load(folder=ROWS):
    rows = []
    for path in sorted(glob.glob(os.path.join(folder, '*.py'))):
        module = os.path.basename(path)[:-3]
        rows += [Row(module, fields) for fields in ast.literal_eval(tree_of(path))]
    names = [row.name for row in rows]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise Bad(f'there more than once: {" ".join(doubled)}')
    return rows


def test_file(root, test):
    """The source of a test, None where there is none. MACHINE_NAME of firmware is its test_NAME.py."""
    kind, _, name = test.partition('/')
    if kind == 'firmware':
        for path in glob.glob(os.path.join(root, 'tests', kind, '*', 'test_*')):
            stem, machine = os.path.splitext(os.path.basename(path))[0], os.path.basename(os.path.dirname(path))
            if name in (stem, stem.replace('test', machine, 1)):
                return path
        return None
    path = os.path.join(root, 'tests', kind, name + '.c')
    return path if os.path.exists(path) else None


def check(root, rows):
    """What is wrong with each row, as lines."""
    wrong = []
    for row in rows:
        try:
            for file, text in row.changed(root).items():
                if [t.text for t in c_text.tokens(text)] == \
                        [t.text for t in c_text.tokens(read(os.path.join(root, file)))]:
                    wrong.append(f'{row.name}: {file}: it changes nothing')
        except Bad as error:
            wrong.append(str(error))
        wrong += [f'{row.name}: there is no test {test}' for test in row.tests if not test_file(root, test)]
    return wrong


def apply(root, rows, folder):
    for file, text in changed(root, rows).items():
        path = os.path.join(folder, file)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w', encoding='utf-8') as out:
            out.write(text)


def names_of(arguments):
    """{old: new} of OLD=NEW and of files with a line for each."""
    names = {}
    for argument in arguments:
        pairs = [argument.split('=')] if '=' in argument else \
            [line.split() for line in read(argument).splitlines() if line.strip()]
        for pair in pairs:
            if len(pair) != 2:
                raise Bad(f'{argument}: not OLD and NEW: {" ".join(pair)}')
            names[pair[0]] = pair[1]
    return names


def renamings(names):
    """For a word of prose, a path and a text of C: a function that renames in it."""
    def prose(text):
        return re.sub(r'\w+', lambda found: names.get(found[0], found[0]) if '_' in found[0] else found[0], text)

    def path(text):
        for old, new in names.items():
            if '/' in old:
                whole = rf'(?<![\w/]){re.escape(old)}' + r'(?!\w)' * old[-1].isalnum()
                text = re.sub(whole, lambda _, new=new: new, text)
        return text

    return prose, path, lambda text: c_text.rename(text, names)


def renamed(path, names):
    """The text of a file of rows with other names."""
    text, (prose, of_path, code) = read(path), renamings(names)
    how = []  # (first position, last position, function) of each string
    for row in tree_of(path).elts:
        parts = [(row.elts[1], prose), (row.elts[2], of_path)]
        for edit in row.elts[3:]:
            parts += [(edit.elts[0], of_path), *((part, code) for part in edit.elts[1:])]
        how += [((node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset), function)
                for node, function in parts]
    lines = text.splitlines(keepends=True)
    for token in reversed(list(tokenize.generate_tokens(io.StringIO(text).readline))):
        if token.type != tokenize.STRING:
            continue
        for first, last, function in how:
            if first <= token.start and token.end <= last:
                value = ast.literal_eval(token.string)
                new = function(value)
                if new != value:
                    plain = value in token.string  # no escapes: its quotes and its prefix can stay
                    new = token.string.replace(value, new) if plain else repr(new)
                    line = lines[token.start[0] - 1]
                    lines[token.start[0] - 1] = line[:token.start[1]] + new + line[token.end[1]:]
    return ''.join(lines)


def rename(folder, names):
    """Renames in the rows; returns the files that changed."""
    files = []
    for path in sorted(glob.glob(os.path.join(folder, '*.py'))):
        text = renamed(path, names)
        if text != read(path):
            files.append(os.path.basename(path))
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
    return files


def chosen(rows, names, whole=False):
    if whole:
        missing = [name for name in names if name not in [row.name for row in rows]]
        if missing:
            raise Bad(f'there is no row {" ".join(missing)}')
        return [row for row in rows if row.name in names]
    return [row for row in rows if not names or any(name in row.name for name in names)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--list', action='store_true')
    parser.add_argument('--check', action='store_true')
    parser.add_argument('--apply', action='store_true')
    parser.add_argument('--rename', action='store_true')
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--to', metavar='FOLDER')
    parser.add_argument('--build', metavar='FOLDER')
    parser.add_argument('--as-built', action='store_true')
    parser.add_argument('-j', '--jobs', type=int, default=min(4, os.cpu_count() or 1))
    parser.add_argument('names', nargs='*', metavar='NAME')
    options = parser.parse_args()
    if options.self_test:
        import planted_self_test  # which imports this
        return planted_self_test.main()
    try:
        if options.rename:
            print('changed:', *rename(ROWS, names_of(options.names)))
            return 0
        rows = load()
        if options.apply:
            if not options.to:
                raise Bad('--apply needs --to FOLDER')
            apply(ROOT, chosen(rows, options.names, True), options.to)
            return 0
        rows = chosen(rows, options.names)
        if options.list:
            for row in rows:
                print(f'{row.name}: {row.promise}\n    seen by: {" ".join(row.tests)}')
            return 0
        wrong = check(ROOT, rows)
        if wrong or options.check:
            bad = len({line.split(':')[0] for line in wrong})
            print(*wrong, f'{len(rows) - bad} passed, {bad} failed', sep='\n')
            return 1 if wrong else 0
        import planting
        return planting.run_rows(ROOT, rows, options.jobs, options.build, options.as_built)
    except Bad as error:
        print(f'{error}\n0 passed, 1 failed')
        return 1


if __name__ == '__main__':
    import planted  # the module that the others import, too
    sys.exit(planted.main())
