#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Cuts the C out of a page of Markdown, for a test that compiles and runs what the page prints.

    cut.py PAGE FILE           all blocks of C of the page, one after the other
    cut.py PAGE FILE NUMBER    one of them; the first is 1

A page without such a block is an error."""
import re
import sys


def blocks(text):
    return re.findall(r'^```c\n(.*?)^```$', text, re.M | re.S)


def main():
    page, target, *number = sys.argv[1:]
    with open(page, encoding='utf-8') as file:
        found = blocks(file.read())
    if number:
        found = found[int(number[0]) - 1:int(number[0])]
    if not found:
        sys.exit(f'{page} has no such block of C')
    with open(target, 'w', encoding='utf-8') as file:
        file.write('\n'.join(found))
    return 0


if __name__ == '__main__':
    sys.exit(main())
