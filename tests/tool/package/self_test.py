# SPDX-License-Identifier: MIT
"""Faults, each planted alone into a package that was built: the check that is named has to say the words."""
import os
import shutil
import time

import booted
import run as runner
import syscalls
import unpacked
from clean import Base, must
from installed import in_clean_system

TOOL, DEV = 'fathom', 'libfathom-dev'
MAN = 'usr/share/man/man1'
UNIT = unpacked.UNIT


def edit_page(sed):
    return f'gunzip {MAN}/fathom.1.gz && sed -i "{sed}" {MAN}/fathom.1 && gzip -9n {MAN}/fathom.1'


FAULTS = [  # what; the package; a script of sh in its tree; the check; words that it says
    ('a page of man is missing', TOOL, f'rm {MAN}/fathom-read.1.gz', 'pages', 'fathom-read.1.gz is missing'),
    ('a page of a command that is gone', TOOL, f'cp {MAN}/fathom-read.1.gz {MAN}/fathom-reed.1.gz', 'pages',
     'fathom-reed.1.gz is of no command'),
    ('a page without a section', TOOL, edit_page('/^.SH FILES/d'), 'pages', 'fathom.1.gz has no section FILES'),
    ('a page with an unknown macro', TOOL, edit_page(r'$ a .XX'), 'pages', 'mandoc says'),
    ('a page in another folder', TOOL, f'mkdir usr/share/man/man8 && mv {MAN}/fathom-set.1.gz usr/share/man/man8',
     'places', 'man8/fathom-set.1.gz has no place'),
    ('a mode of a file', TOOL, 'chmod 600 usr/share/bash-completion/completions/fathom', 'places',
     'is -rw-------, not'),
    ('a mode of a folder', DEV, 'chmod 777 usr/include/fathom', 'places', '/usr/include/fathom/ is drwxrwxrwx'),
    ('no completion of fish', TOOL, 'rm -r usr/share/fish', 'places', 'no file is usr/share/fish'),
    ('no copyright', DEV, f'rm usr/share/doc/{DEV}/copyright', 'tags', 'E no-copyright-file'),
    ('a unit that is less locked', TOOL, f'sed -i /^SystemCallFilter/d {UNIT}', 'figures', 'exposure'),
    ('a unit without a call that the tool needs', TOOL,
     f'sed -i "/^SystemCallErrorNumber/i SystemCallFilter=~flock" {UNIT}', 'syscalls',
     'does not let flock through'),
    ('a unit without sockets', TOOL,
     f'sed -i "s/^RestrictAddressFamilies=.*/RestrictAddressFamilies=AF_UNIX/" {UNIT}', 'syscalls',
     'the unit has no AF_INET'),
    ('a larger package', DEV, 'dd if=/dev/urandom of=usr/include/fathom/large.h bs=1k count=20 2>&1', 'figures',
     f'size_bytes {DEV}'),
    ('a unit with an unknown key', TOOL, f'sed -i s/^ExecReload/ExecReloads/ {UNIT}', 'unit',
     'systemd-analyze verify'),
    ('a unit of a program that is not there', TOOL, f'sed -i s,/usr/bin/fathom,/usr/bin/phathom, {UNIT}', 'unit',
     'systemd-analyze verify'),
    ('a unit that is enabled', TOOL,
     f'd=etc/systemd/system/multi-user.target.wants; mkdir -p $d && ln -s /{UNIT} $d', 'unit', 'systemctl is-enabled'),
    ('a dependency of the tool is missing', TOOL, 'sed -i "s/, libmodbus5[^,]*//" DEBIAN/control', 'works',
     'fathom --version: exit status 127'),
    ('a dependency of the library is missing', DEV, 'sed -i "s/, libmodbus-dev//" DEBIAN/control', 'compiles',
     'libmodbus.c by pkg-config'),
    ('a header is missing', DEV, 'rm usr/include/fathom/engine/line_turns.h', 'compiles', 'by pkg-config'),
    ('no CMake package', DEV, 'rm -r usr/lib/*/cmake', 'compiles', 'by find_package'),
    ('a completion of another name', TOOL, 'sed -i "s/_fathom fathom$/_fathom phathom/" '
     'usr/share/bash-completion/completions/fathom', 'completes', 'bash-completion'),
    ('an update that fails', TOOL, 'echo "test -z \\"\\$2\\"" >>DEBIAN/postinst', 'unit', 'installed once more'),
    ('a service without its password', TOOL, f'sed -i /^LoadCredential/d {UNIT}', 'booted', "['password: ', "),
    ('a service that may not open ports', TOOL, f'sed -i /^SupplementaryGroups/d {UNIT}', 'booted', "'group: ', "),
    ('a file that stays', TOOL,
     'echo "mkdir -p /etc/fathom; touch /etc/fathom/publish.yaml" >>DEBIAN/postinst', 'leaves',
     'left behind: f644 /etc/fathom/publish.yaml'),
    ('a removal that fails', TOOL, 'echo false >>DEBIAN/prerm', 'leaves', 'apt-get purge: exit status 100'),
]
IN_CLEAN_SYSTEM = ('works', 'unit', 'compiles', 'completes', 'leaves')


def planted(packages, which, script, folder):
    """The packages, of which one has been taken apart, altered and put together."""
    tree = os.path.join(folder, 'tree')
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    made = []
    for package in packages:
        if unpacked.name_of(package) != which:
            made.append(shutil.copy(package, folder))
            continue
        must(['dpkg-deb', '-R', package, tree])
        must(['sh', '-c', script], cwd=tree)
        made.append(os.path.join(folder, os.path.basename(package)))
        must(['dpkg-deb', '--root-owner-group', '-b', tree, made[-1]])
    return made


def found_by(check, packages, base, version):
    if check in IN_CLEAN_SYSTEM:
        return list(in_clean_system(base, packages, version, {check}))
    if check == 'booted':
        return list(booted.problems(base, packages, version))
    if check == 'places':
        return list(unpacked.places(packages))
    if check == 'tags':
        return list(runner.compared_tags(unpacked.tags(packages)))
    root = runner.extracted(packages, os.path.join(base.folder, 'extracted'))
    if check == 'syscalls':
        return list(syscalls.problems(root, UNIT))
    return list(unpacked.pages(root) if check == 'pages' else runner.compared(runner.measured(packages, root)))


def run(packages, work, version, report):
    base = Base(work)
    base.make()
    base.fetch(packages)
    for what, which, script, check, words in FAULTS:
        began = time.monotonic()
        found = found_by(check, planted(packages, which, script, os.path.join(work, 'planted')), base, version)
        seen = any(words in problem for problem in found)
        report(what, [] if seen else [f'{check} does not say {words!r}, but {found}'], began)
