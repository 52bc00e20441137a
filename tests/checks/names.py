#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A linker that follows C99 to the letter can tell all names apart, and the names of the library are its own.

 1. No two external names of src/ and port/ are equal in their first 31 characters (C99 5.2.4.1). The names are those of
    the object files, so the check sees what a macro defines. Sources that define the same name are alternatives.
 2. Each function and object that a public header declares begins with fathom_. The header of the Arduino port declares
    names of C++ in the namespace fathom instead."""
import re

from circles import compiled
from common import code_of, main, read
from docs import headers

SIGNIFICANT = 31
DECLARED = re.compile(r'^(?!#|typedef\b|struct \w+ *[{;]|enum\b|union\b)[A-Za-z_][\w \t*\n]*?\b(\w+)'
                      r'(?:\([^;{}]*\)\s*[;{]|(?:\[[^\]\n]*\])*;)', re.M)


def external_names(root):
    """({name: (path, line) of a definition}, problems)"""
    places, problems = {}, []
    for path, (names, _, said) in compiled(root).items():
        code = code_of(read(root, path))
        if said:
            problems.append(f'{path}: does not compile:\n{said}')
        for name in names:
            found = re.search(rf'\b{name}\b', code)
            places.setdefault(name, (path, code.count('\n', 0, found.start()) + 1 if found else 1))
    return places, problems


def equal_names(places):
    """The lists of names that are equal as far as a linker has to read them."""
    groups = {}
    for name in sorted(places):
        groups.setdefault(name[:SIGNIFICANT], []).append(name)
    return [names for names in groups.values() if len(names) > 1]


def foreign_names(root):
    """(path, line, name) of what a public header declares without fathom_."""
    for path in headers(root):
        code = code_of(read(root, path))
        for found in DECLARED.finditer(code) if 'namespace fathom' not in code else ():
            if not found[1].startswith('fathom_'):
                yield path, code.count('\n', 0, found.start(1)) + 1, found[1]


def check(root):
    places, problems = external_names(root)
    for names in equal_names(places):
        where = ', '.join('{} ({}:{})'.format(name, *places[name]) for name in names)
        problems.append(f'{where}: equal in their first {SIGNIFICANT} characters, {names[0][:SIGNIFICANT]}')
    problems += [f'{path}:{line}: {name} does not begin with fathom_' for path, line, name in foreign_names(root)]
    return problems


if __name__ == '__main__':
    main(check)
