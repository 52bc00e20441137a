#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds the Debian packages and sees that they are what they ought to be: by lintian, and in a clean system.

    run.py                builds them by the documented command and checks them, and their figures against figures.csv
    run.py --quick        without the clean system, and without root
    run.py --update       keeps the figures

It needs root, for the clean system (sudo, if it is not), and the packages lintian, debootstrap, mandoc, groff, man-db,
strace, dpkg-dev and systemd."""
import csv
import os
import re
import shutil
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'support'))
import booted
import installed
import syscalls
import unpacked
from bounds import judge
from clean import Base, must

ROOT = installed.ROOT
FIGURES = os.path.join(ROOT, 'tests', 'tool', 'package', 'figures.csv')
PACKAGES, WORK = (os.path.join(ROOT, folder) for folder in ('build-debian', 'build-package'))
failed = passed = 0


def report(name, problems, began):
    """A case: its problems are printed."""
    global failed, passed
    problems = list(problems)
    print(f'{name}: {"FAILED" if problems else "ok"}, {time.monotonic() - began:.1f} s', flush=True)
    for problem in problems:
        print(f'    {problem}', flush=True)
    failed, passed = failed + bool(problems), passed + (not problems)


def build():
    """By the command that the page of the tool names."""
    for package in [name for name in os.listdir(PACKAGES) if name.endswith('.deb')] if os.path.isdir(PACKAGES) else []:
        os.remove(os.path.join(PACKAGES, package))
    must(['cmake', '--preset', 'debian'], cwd=ROOT)
    must(['cmake', '--build', '--preset', 'debian', '--parallel', str(os.cpu_count())], cwd=ROOT)
    return unpacked.packages_in(PACKAGES)


def version():
    with open(os.path.join(ROOT, 'include/fathom/version.h'), encoding='utf-8') as file:
        return re.search('VERSION_STRING +"(.*)"', file.read())[1]


def extracted(packages, folder):
    shutil.rmtree(folder, ignore_errors=True)
    for package in packages:
        must(['dpkg-deb', '-x', package, folder])
    return folder


def kept():
    """{(what, of): value}, [(package, tag)]"""
    with open(FIGURES, encoding='utf-8', newline='') as file:
        rows = list(csv.DictReader(file))
    return ({(row['what'], row['of']): float(row['value']) for row in rows if row['what'] != 'lintian'},
            {(row['of'], row['value']): row['why'] for row in rows if row['what'] == 'lintian'})


def measured(packages, root):
    figures = {('size_bytes', unpacked.name_of(package)): float(os.path.getsize(package)) for package in packages}
    figures['exposure', os.path.basename(unpacked.UNIT)] = unpacked.exposure(root)
    return figures


def compared(figures):
    before, _ = kept()
    if set(before) != set(figures):
        yield f'figures.csv has {sorted(before)}, not {sorted(figures)}'
    for name in set(before) & set(figures):
        unit = 'B' if name[0] == 'size_bytes' else 'points'
        if judge(' '.join(name), figures[name], before[name], unit, percent=5 if unit == 'B' else 0):
            yield f'{" ".join(name)}: {figures[name]:g}, {before[name]:g} at the last release'


def compared_tags(found):
    _, named = kept()
    yield from (f'{package}: {tag}, which figures.csv does not name' for package, tag in found
                if (package, tag) not in named)
    yield from (f'{package}: {tag} stands in figures.csv, and is gone' for package, tag in named
                if (package, tag) not in found)
    yield from (f'{package}: {tag} has no reason in figures.csv' for (package, tag), why in named.items() if not why)
    yield from (f'{package}: {tag}: no error may stay' for package, tag in found if tag.startswith('E'))


def update(figures, found):
    _, named = kept()
    with open(FIGURES, 'w', encoding='utf-8', newline='') as file:
        rows = csv.writer(file, lineterminator='\n')
        rows.writerow(['what', 'of', 'value', 'why'])
        rows.writerows([*name, f'{value:g}' if name[0] == 'exposure' else int(value), '']
                       for name, value in figures.items())
        rows.writerows(['lintian', *row, named.get(row, '')] for row in found)


def check(packages):
    root = extracted(packages, os.path.join(WORK, 'extracted'))
    began = time.monotonic()
    figures, found = measured(packages, root), unpacked.tags(packages)
    if '--update' in sys.argv:
        update(figures, found)
    for (what, of), value in figures.items():
        print(f'{what} of {of}: {value:g}')
    for package, tag in found:
        print(f'lintian of {package}: {tag}')
    report('lintian', compared_tags(found), began)
    report('figures', compared(figures), began)
    began = time.monotonic()
    report('places and modes', unpacked.places(packages), began)
    began = time.monotonic()
    report('man pages', unpacked.pages(root), began)
    began = time.monotonic()
    report("the unit's filter", syscalls.problems(root, unpacked.UNIT), began)
    if '--quick' not in sys.argv:
        check_installed(packages)


def check_installed(packages):
    began = time.monotonic()
    base = Base(WORK)
    base.make()
    base.fetch(packages)
    report('the clean system', [], began)
    began = time.monotonic()
    report('installed, used, compiled with, removed', installed.in_clean_system(base, packages, version()), began)
    began = time.monotonic()
    report('the service under systemd', booted.problems(base, packages, version()), began)


def main():
    if os.geteuid() != 0 and '--quick' not in sys.argv:
        os.execvp('sudo', ['sudo', '--preserve-env', sys.executable, *sys.argv])
    os.environ['PYTHONDONTWRITEBYTECODE'] = '1'
    os.makedirs(WORK, exist_ok=True)
    began = time.monotonic()
    packages = build()
    report('built', [], began)
    check(packages)
    print(f'{passed} passed, {failed} failed')
    return 1 if failed or not passed else 0


if __name__ == '__main__':
    sys.dont_write_bytecode = True
    sys.exit(main())
