#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""clang-format would change nothing in any C file."""
import os
import re

from common import files, main, run

FOLDERS = ('include', 'src', 'port', 'examples', 'tests')


def check(root):
    paths = files(root, *FOLDERS, ends=('.c', '.h', '.cpp', '.hpp', '.ino'))
    _, said = run(['clang-format-14', '--dry-run', '--Werror', *paths], root)
    problems = re.findall(r'^\S+: error: .*$', said, re.M)
    if said and not problems:
        problems = [f'clang-format: {said}']
    return [problem.replace(root + os.sep, '') for problem in problems]


if __name__ == '__main__':
    main(check)
