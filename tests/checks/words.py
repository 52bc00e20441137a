#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One word for one thing, and the field's: no name, comment, message or page has a word of the table below.

    words.py           every place: file, line, the word, and what to use instead
    words.py --list    how many of each word in each folder

A name in C is what stands in its code, a file's name, and any word with an underscore elsewhere; prose is all other
text. Both are compared in lower case, names with a space for each underscore."""
import os
import re
import sys

from common import ROOT, code_of, files, main, read

FOLDERS = ('include', 'src', 'port', 'examples', 'tests')
C = ('.c', '.h', '.cpp', '.ino')
LEFT_OUT = ('.csv', '.svg', '.json')  # figures
NOT_READ = ('tests/checks/words.py',)  # this table. CHANGELOG.md, which has the old names, is in none of the folders

TABLE = [  # the word, as it is in names (None: allowed there), as it is in prose, what to use instead
    ('owes', r'owe[ds]?|owing', r'owe[ds]?|owing', 'quarantined, quarantine_left_us'),
    ('torn', r'torn', r'torn', 'truncated'),
    ('spoilt', r'spoil(t|ed|s)?', r'spoil(t|ed|s)?', 'corrupt, damaged'),
    ('answered wrong', r'answered wrong', r'answered wrong', 'unexpected response'),
    ('alone_us', r'alone us', None, 'backoff_left_us'),
    ('silences', r'(^|unit )silences$', None, 'timeouts_in_row'),
    ('seam', r'seams?', r'seams?', 'transport'),
    ('carrier', r'carriers?', r'carriers?', 'transport'),
    ('room', r'^room$', None, 'frame_size; space'),
    ('begun_request', r'begun request', None, 'match_echo'),
    ('look_there', r'look there', None, 'PROBE_NEW'),
    ('go_home', r'go home', None, 'restore_address'),
    ('ear', r'ears?', r'ears?', 'listener'),
    ('talk', r'talks?', None, 'session'),
    ('tally', r'tally|tallies', r'tally|tallies', 'counters'),
    ('scenery', r'scenery', r'scenery', 'scene'),
    ('plug', r'plug(?! in\b)', None, 'adapter'),
    ('dyp_frame', r'dyp frame', None, 'dyp_stream'),
    ('dyp_protocol', r'dyp protocol', None, 'dyp_55aa'),
    ('told', r'^told$', None, 'last_configuration; what was reported'),
    ('said', r'^said$', None, 'last_kind; what was reported'),
    ('looked_us', r'looked us', None, 'sampled_us'),
    ('asking', r'asking', None, 'driver'),
    ('somebody', r'(some|any|no)(body|one)s?|whoever', r"(some|any)(body|one)('s)?|no(body|-one)('s)?|whoever",
     "the subject's name"),
    ('question', r'questions?(?! mark)', r'questions?(?! mark)', 'request'),
    ('exchange', r'exchanges?', r'exchanges?|exchanged', 'transaction'),
    ('company', r'company', r'company', 'other units on the line, other drivers of the unit'),
    # the verb is left alone
    ('answer', None, r'(an?|the|its|late|whole|first|good) answers?', 'response'),
]
CHANGES = 'CHANGELOG.md'
RENAMED = re.compile(r'^\| `(fathom/[\w/]+\.h|\w+)` \| `(fathom[\w/.]+|FATHOM_\w+)` \|$', re.M)
# The one definition of quarantine may say what a unit owes.
DEFINITION = ('owes', 'quarantine')

NAME = re.compile(r'[A-Za-z_]\w*')
UNDERSCORED = re.compile(r'\w*[A-Za-z]_\w*|\w*_[A-Za-z]\w*')


def patterns(column):
    """The column as one expression each, whole words only."""
    return [(row[0], re.compile(rf'\b(?:{row[column]})\b'), row[3]) for row in TABLE if row[column] is not None]


NAMES, PROSE = patterns(1), patterns(2)
ANY_NAME = re.compile('|'.join(expression.pattern for _, expression, _ in NAMES))
ANY_PROSE = re.compile('|'.join(expression.pattern for _, expression, _ in PROSE))


def pages(root):
    """All text: README.md, and what stands in the folders."""
    for folder in FOLDERS:
        for where, below, names in os.walk(os.path.join(root, folder)):
            below[:] = [name for name in below if name != '__pycache__']
            yield from (os.path.relpath(os.path.join(where, name), root) for name in names)
    if os.path.exists(os.path.join(root, 'README.md')):
        yield 'README.md'


def in_names(names):
    """(word, the name that has it, instead)"""
    for name in names:
        plain = name.lower().replace('_', ' ').strip()
        if ANY_NAME.search(plain):
            yield from ((word, name, instead) for word, expression, instead in NAMES if expression.search(plain))


def in_prose(line):
    plain = UNDERSCORED.sub(' ', line).lower()
    if ANY_PROSE.search(plain):
        for word, expression, instead in PROSE:
            if word != DEFINITION[0] or DEFINITION[1] not in plain:
                yield from ((word, found[0], instead) for found in expression.finditer(plain))


def findings(root):
    """(path, line number, word, what was found, instead)"""
    for path in sorted(pages(root)):
        if path in NOT_READ or path.endswith(LEFT_OUT):
            continue
        try:
            text = read(root, path)
        except UnicodeDecodeError:
            continue  # no text
        is_c = path.endswith(C)
        code = code_of(text).split('\n') if is_c else None
        stem = os.path.splitext(path)[0]
        for found in in_names(re.split(r'[/.-]', stem)):
            yield (path, 0, *found)
        for at, line in enumerate(text.split('\n')):
            names = NAME.findall(code[at]) if is_c else []
            prose = prose_of(line, code[at]) if is_c else line
            for found in in_names(names + UNDERSCORED.findall(prose)):
                yield (path, at + 1, *found)
            for found in in_prose(prose):
                yield (path, at + 1, *found)


def prose_of(line, code):
    """Comments and literals: what code_of blanked. It may have shortened the line, in literals."""
    if len(line) == len(code):
        return ''.join(' ' if letter == kept else letter for letter, kept in zip(line, code))
    return ' '.join(re.findall(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'|/\*.*?(?:\*/|$)|//.*|^.*?\*/', line))


def renamed(root):
    """Checks the tables of renamed names in CHANGELOG.md: no header has an old name, and a new name stands in a header
    or was renamed again."""
    if not os.path.exists(os.path.join(root, CHANGES)):
        return
    headers = files(root, 'include', 'port', ends='.h')
    names = {name for path in headers for name in NAME.findall(code_of(read(root, path)))}
    names |= {path[len('include/'):] for path in headers}
    rows = RENAMED.findall(read(root, CHANGES))
    renamed_again = {old for old, _ in rows}
    for old, new in rows:
        if old in names:
            yield f'{CHANGES}: {old} has become {new}, and is there still'
        if new not in names | renamed_again:
            yield f'{CHANGES}: {old} has become {new}, which is in no header'


def check(root):
    return [f'{path}:{number}: {found!r}: use {instead}' for path, number, _, found, instead
            in findings(root)] + list(renamed(root))


def folder_of(path):
    part = path.split('/')
    return '/'.join(part[:2]) if len(part) > 2 else part[0]


def print_list():
    counts = {}
    for path, _, word, _, _ in findings(ROOT):
        row = counts.setdefault(word, {})
        row[folder_of(path)] = row.get(folder_of(path), 0) + 1
    for word, row in sorted(counts.items(), key=lambda item: -sum(item[1].values())):
        print(f'{sum(row.values()):5} {word:15}', *(f'{folder} {count}' for folder, count in sorted(row.items())))
    print(f'{sum(sum(row.values()) for row in counts.values()):5} in all')


if __name__ == '__main__':
    if sys.argv[1:] == ['--list']:
        print_list()
        sys.exit(0)
    main(check)
