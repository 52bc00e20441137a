# SPDX-License-Identifier: MIT
"""What is seen of the packages without installing them: lintian, which files there are, where and with which mode, the
man pages, the unit. Each check gives problems as text."""
import glob
import os
import re
import tempfile

from clean import must, run

# Every path that a package may have, by its mode. A folder is 755.
PLACES = {
    'fathom': [
        ('-rwxr-xr-x', r'usr/bin/fathom'),
        ('-rw-r--r--', r'usr/share/man/man1/fathom(-[a-z]+)?\.1\.gz'),
        ('-rw-r--r--', r'usr/share/bash-completion/completions/fathom'),
        ('-rw-r--r--', r'usr/share/zsh/vendor-completions/_fathom'),
        ('-rw-r--r--', r'usr/share/fish/vendor_completions\.d/fathom\.fish'),
        ('-rw-r--r--', r'usr/lib/systemd/system/fathom-publish\.service'),
        ('-rw-r--r--', r'usr/share/doc/fathom/copyright'),
        ('-rw-r--r--', r'usr/share/doc/fathom/changelog\.gz'),
        ('-rw-r--r--', r'usr/share/doc/fathom/changelog\.Debian\.gz')],
    'libfathom-dev': [
        ('-rw-r--r--', r'usr/include/fathom/([a-z]+/)?(internal/)?[a-z0-9_]+\.h(pp)?'),
        ('-rw-r--r--', r'usr/include/fathom_serial\.h'),
        ('-rw-r--r--', r'usr/include/fathom_(conformance|gpio|libmodbus|posix)/fathom_[a-z]+\.h'),
        ('-rw-r--r--', r'usr/include/fathom_sim/sim/[a-z0-9]+\.h'),
        ('-rw-r--r--', r'usr/lib/[a-z0-9_-]+/libfathom(_[a-z]+)?\.a'),
        ('-rw-r--r--', r'usr/lib/[a-z0-9_-]+/pkgconfig/fathom(_[a-z]+)?\.pc'),
        ('-rw-r--r--', r'usr/lib/[a-z0-9_-]+/cmake/fathom/fathom[a-z_-]+\.cmake'),
        ('-rw-r--r--', r'usr/share/doc/libfathom-dev/copyright'),
        ('-rw-r--r--', r'usr/share/doc/libfathom-dev/changelog\.Debian\.gz')],
}
SECTIONS = ['NAME', 'SYNOPSIS', 'DESCRIPTION', 'COMMANDS', 'EXIT STATUS', 'FILES', 'EXAMPLES', 'SEE ALSO']
SECTIONS_OF_A_COMMAND = ['NAME', 'SYNOPSIS', 'DESCRIPTION', 'OPTIONS', 'EXIT STATUS', 'SEE ALSO']
UNIT = 'usr/lib/systemd/system/fathom-publish.service'


def name_of(package):
    return os.path.basename(package).split('_')[0]


def tags(packages):
    """Of lintian: (package, severity and tag), each once."""
    said = run(['lintian', '--tag-display-limit', '0', '--allow-root', '-I', *packages])[1]
    found = sorted({(match[2], f'{match[1]} {match[3]}')
                    for match in re.finditer(r'^([EWI]): (\S+): (\S+)', said, re.M)})
    strange = [line for line in said.splitlines() if not re.match(r'[EWINPXO]: ', line)]
    if strange:
        raise SystemExit('lintian: ' + '\n'.join(strange))
    return found


def places(packages):
    for package in packages:
        name, seen = name_of(package), set()
        for line in must(['dpkg-deb', '-c', package]).splitlines():
            mode, owner, _, _, _, path = line.split(None, 5)
            path = path[2:]
            if owner != 'root/root':
                yield f'{name}: /{path} is of {owner}'
            if mode[0] == 'd':
                if mode != 'drwxr-xr-x':
                    yield f'{name}: /{path} is {mode}'
                continue
            rows = [number for number, (_, form) in enumerate(PLACES[name]) if re.fullmatch(form, path)]
            seen.update(rows)
            if not rows:
                yield f'{name}: /{path} has no place in it'
            elif mode != PLACES[name][rows[0]][0]:
                yield f'{name}: /{path} is {mode}, not {PLACES[name][rows[0]][0]}'
        for number, (_, form) in enumerate(PLACES[name]):
            if number not in seen:
                yield f'{name}: no file is {form}'


def sections(page):
    """The headings of a page as a terminal of 80 columns shows it."""
    said = must(['man', '--local-file', page],
                env={**os.environ, 'MANWIDTH': '80', 'MANPAGER': 'cat', 'LC_ALL': 'C.UTF-8', 'TERM': 'dumb'})
    return re.findall(r'^([A-Z][A-Z ]+)$', said, re.M)


def pages(root):
    """A page for each command that the help names, with its sections, and mandoc and groff find nothing in it."""
    tool = os.path.join(root, 'usr/bin/fathom')
    commands = re.findall(r'^  (\w+) +\S', must([tool, '--help']).split('\nFirst steps:')[0], re.M)
    folder = os.path.join(root, 'usr/share/man/man1')
    wanted = {'fathom.1.gz', *(f'fathom-{command}.1.gz' for command in commands)}
    there = set(os.listdir(folder))
    for name in sorted(wanted - there):
        yield f'{name} is missing'
    for name in sorted(there - wanted):
        yield f'{name} is of no command'
    for name in sorted(wanted & there):
        page = os.path.join(folder, name)
        found = sections(page)
        missing = [one for one in (SECTIONS if name == 'fathom.1.gz' else SECTIONS_OF_A_COMMAND) if one not in found]
        if missing:
            yield f'{name} has no section {", ".join(missing)}'
        text = must(['gzip', '-dc', page])
        with tempfile.NamedTemporaryFile('w', suffix=name[:-3], encoding='utf-8') as file:
            file.write(text)
            file.flush()
            for check in (['mandoc', '-T', 'lint', '-W', 'style', file.name],
                          ['groff', '-man', '-Tutf8', '-ww', '-rCHECKSTYLE=3', '-z', file.name]):
                said = run(check)[1]
                if said:
                    yield f'{name}: {check[0]} says {said.strip()[-300:]}'


def exposure(root):
    """The figure of systemd-analyze for the unit, from 0 (locked) to 10."""
    with tempfile.TemporaryDirectory() as folder:
        unit = os.path.join(folder, os.path.basename(UNIT))
        with open(os.path.join(root, UNIT), encoding='utf-8') as file, open(unit, 'w', encoding='utf-8') as copy:
            copy.write(file.read())
        said = must(['systemd-analyze', 'security', '--no-pager', '--offline=true', '--threshold=100', unit])
    return float(re.search(r'Overall exposure level for \S+: (\d+\.\d+)', said)[1])


def packages_in(folder):
    found = sorted(glob.glob(os.path.join(folder, '*.deb')))
    if [name_of(package) for package in found] != ['fathom', 'libfathom-dev']:
        raise SystemExit(f'{folder} has {found}')
    return found
