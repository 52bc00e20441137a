#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Cuts the C out of a page of Markdown, for a test that compiles and runs what the page prints.

    cut.py PAGE FILE

A page without one, and a link to a file that is not there, are errors."""
import os
import re
import sys


def main():
    page, target = sys.argv[1:]
    with open(page, encoding='utf-8') as file:
        text = file.read()
    blocks = re.findall(r'^```c\n(.*?)^```$', text, re.M | re.S)
    if not blocks:
        sys.exit(f'{page} has no block of C')
    prose = re.sub(r'^```.*?^```$', '', text, flags=re.M | re.S)
    for link in re.findall(r'\]\(([^)#:]+)\)', prose):
        if not os.path.exists(os.path.join(os.path.dirname(page), link)):
            sys.exit(f'{page} links to {link}, which is not there')
    with open(target, 'w', encoding='utf-8') as file:
        file.write('\n'.join(blocks))
    return 0


if __name__ == '__main__':
    sys.exit(main())
