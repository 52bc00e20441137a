#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Mutants of C sources: copies with one small change each, which a good test sees.

    mutants.py [FILE ...]        lists those of the files, or counts those of src/ by file and operator
"""
import collections
import dataclasses
import os
import re
import sys

from syntax import ROOT, Source, library

TOKEN = re.compile(r'[A-Za-z_]\w*|\d[\w.]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|'
                   r'<<=|>>=|->|\+\+|--|<<|>>|[-+*/%&|^=!<>]=|&&|\|\||\S')


@dataclasses.dataclass(frozen=True)
class Mutant:
    file: str
    function: str  # '' outside of any
    operator: str
    start: int  # old is what stands there
    end: int
    old: str
    new: str
    line: int
    first_line: int  # of what has to be executed
    last_line: int
    statement: str  # its tokens; of a switch or a loop those before its body
    ordinal: int  # among those that are the same in all that the identity has
    names: frozenset = frozenset()  # of what is local to the function

    @property
    def change(self):
        old, new = tokens(self.old), tokens(self.new)
        is_all = old == self.statement or self.operator == 'jump dropped'
        return f'{"it" if is_all else shown(old)} -> {shown(new) or "nothing"}'

    @property
    def identity(self):
        """Stays the same when lines move and comments change."""
        identity = f'{self.file} | {self.function} | {self.operator}: {self.change} | {shown(self.statement)}'
        return f'{identity} | {self.ordinal}' if self.ordinal > 1 else identity

    def applied(self, text):
        assert text[self.start:self.end] == self.old
        return text[:self.start] + self.new + text[self.end:]


def tokens(code):
    return ' '.join(TOKEN.findall(code))


def shown(code):
    """Tokens with about as much space as a reader is used to."""
    code = re.sub(r' ?(->|\.|\[) ?', r'\1', code)
    code = re.sub(r'([(!~]) ', r'\1', re.sub(r' (?=[)\],;])', '', code))
    return re.sub(r'\b(?<!if)(?<!for)(?<!while)(?<!return)(?<!switch) (?=\()', '', code)


def mutants_of(path, root=ROOT, arguments=None):
    """In the order of the text. A table of models has none: a test that kills one would repeat the table."""
    if path.endswith('_family.c'):
        return []
    source = Source(path, root, arguments)
    counts = collections.Counter()
    found = []
    for (start, end, new), (operator, function, (first, last, name)) in sorted(
            source.made.items(), key=lambda item: (item[0], item[1][0])):
        mutant = Mutant(path, function, operator, start, end, source.text[start:end], new, source.line(start),
                        source.line(first), source.line(last - 1), tokens(name or source.code[first:last]), 0,
                        source.names.get(function, frozenset()))
        number = counts[mutant.identity] = counts[mutant.identity] + 1
        found.append(dataclasses.replace(mutant, ordinal=number))
    return found


def main():
    for path in sys.argv[1:]:
        for mutant in mutants_of(path):
            print(f'{mutant.line}: {mutant.identity}')
    if not sys.argv[1:]:
        total = collections.Counter()
        for path in library():
            of_file = collections.Counter(mutant.operator for mutant in mutants_of(path))
            print(f'{os.path.basename(path):24} {sum(of_file.values()):5}')
            total += of_file
        for operator, count in sorted(total.items()):
            print(f'{operator:24} {count:5}')
        print(f'{"all":24} {sum(total.values()):5}')


if __name__ == '__main__':
    main()
