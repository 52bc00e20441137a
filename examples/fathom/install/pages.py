#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the pages of man and the completions of bash, zsh and fish from what the tool says of itself.

    pages.py TOOL VERSION CHANGES FOLDER

TOOL is the built program, CHANGES the file that has the day of VERSION in a heading, if it is there. In FOLDER there
are man1/*.1.gz and bash/fathom, zsh/_fathom, fish/fathom.fish then, byte for byte the same each time."""
import gzip
import os
import re
import shutil
import sys

sys.dont_write_bytecode = True

import completion  # noqa: E402
import man  # noqa: E402
import tool_help  # noqa: E402


def day_of(version, changes):
    if not os.path.exists(changes):
        return '""'
    with open(changes, encoding='utf-8') as file:
        match = re.search(rf'^## \[{re.escape(version)}\] - (\d{{4}}-\d\d-\d\d)$', file.read(), re.M)
    if not match:
        raise SystemExit(f'{changes} has no day for version {version}')
    return match[1]


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    data = text.encode()
    with open(path, 'wb') as file:
        file.write(gzip.compress(data, 9, mtime=0) if path.endswith('.gz') else data)


def main(path, version, changes, folder):
    tool = tool_help.Tool(path)
    shutil.rmtree(folder, ignore_errors=True)  # a page of a command that is gone
    for name, text in man.pages(tool, version, day_of(version, changes)).items():
        write(os.path.join(folder, 'man1', name + '.gz'), text)
    for name, text in completion.files(tool).items():
        write(os.path.join(folder, name), text)


if __name__ == '__main__':
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
