#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a Debian package has to have in /usr/share/doc, from what the project has.

    documents.py LICENSE CHANGES MAINTAINER FOLDER

Makes in FOLDER: copyright, in the form of https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/; the
project's changes as changelog.gz; and changelog.Debian.gz, an entry for each version."""
import datetime
import gzip
import os
import re
import sys

HEADING = re.compile(r'^## \[(\d[\d.]*)\] - (\d{4}-\d\d-\d\d)$', re.M)


def copyright_of(text):
    name, holder, rest = re.fullmatch(r'MIT (License)\n\nCopyright \(c\) (.*)\n\n(.*)\n', text, re.S).groups()
    lines = [f' {line}' if line else ' .' for line in rest.split('\n')]
    return '\n'.join(['Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/',
                      'Upstream-Name: fathom', '', 'Files: *', f'Copyright: {holder}', f'{name}: Expat', *lines, ''])


def changelog_of(text, maintainer):
    entries = []
    headings = HEADING.findall(text)
    for at, (version, day) in enumerate(headings):
        hour = sum(other == day for _, other in headings[at + 1:])  # of a day with several versions each has its own
        date = datetime.datetime.fromisoformat(day).strftime(f'%a, %d %b %Y {hour:02}:00:00 +0000')
        entries.append(f'fathom ({version}-1) unstable; urgency=medium\n\n'
                       f'  * Version {version}; changelog.gz of the package fathom has what changed.\n\n'
                       f' -- {maintainer}  {date}\n')
    if not entries:
        raise SystemExit('there is no heading of a version, such as ## [0.5.0] - 2026-11-23')
    return '\n'.join(entries)


def main(license_path, changes_path, maintainer, folder):
    with open(license_path, encoding='utf-8') as file:
        license_text = file.read()
    with open(changes_path, encoding='utf-8') as file:
        changes = file.read()
    os.makedirs(folder, exist_ok=True)
    made = {'copyright': copyright_of(license_text), 'changelog.gz': changes,
            'changelog.Debian.gz': changelog_of(changes, maintainer)}
    for name, text in made.items():
        data = text.encode()
        with open(os.path.join(folder, name), 'wb') as file:
            file.write(gzip.compress(data, 9, mtime=0) if name.endswith('.gz') else data)


if __name__ == '__main__':
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
