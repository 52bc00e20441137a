#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The oldest CMake that will do is said once, in CMakeLists.txt. A project of its own has to say a version too, and it
says that one; nothing else says any: no preset, no script, no page."""
import os
import re

from common import files, main, read

SOURCE = 'CMakeLists.txt'
FOLDERS = ('include', 'src', 'port', 'examples', 'tests', '.github', '.ci')
ENDS = ('CMakeLists.txt', '.cmake', '.cmake.in', '.json', '.md', '.py', '.sh', 'Makefile')
NOT_READ = ('tests/checks/minimum.py',)
REQUIRED = re.compile(r'cmake_minimum_required\s*\(\s*VERSION\s+([\d.]+)', re.I)
PRESET = re.compile(r'"cmakeMinimumRequired"')
PROSE = re.compile(r'\bcmake\s+(?:version\s+)?(?:>=\s*|at least\s+)?(\d+\.\d+[\d.]*\d|\d+\.\d+)', re.I)


def check(root):
    said = REQUIRED.findall(read(root, SOURCE))
    if len(said) != 1:
        return [f'{SOURCE}: says {len(said)} versions of CMake, and has to say one']
    problems = []
    paths = [path for path in files(root, *FOLDERS, ends=ENDS) if path not in NOT_READ]
    paths += [name for name in ('README.md', 'CMakePresets.json') if os.path.exists(os.path.join(root, name))]
    for path in paths:
        text = read(root, path)
        is_project = re.search(r'^\s*project\s*\(', text, re.M) is not None
        for version in REQUIRED.findall(text):
            if not is_project:
                problems.append(f'{path}: is no project of its own, and requires CMake {version}')
            elif version != said[0]:
                problems.append(f'{path}: requires CMake {version}, {SOURCE} {said[0]}')
        if PRESET.search(text):
            problems.append(f'{path}: cmakeMinimumRequired, which {SOURCE} says')
        if path.endswith('.md'):
            problems += [f'{path}: names CMake {version}, which {SOURCE} says' for version in PROSE.findall(text)]
    return problems


if __name__ == '__main__':
    main(check)
