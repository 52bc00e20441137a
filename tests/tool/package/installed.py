# SPDX-License-Identifier: MIT
"""What is seen of the packages in a clean system: they bring what they need, work, and leave nothing behind. Each check
is of a copy in which they are installed, and gives problems as text."""
import os
import re

from clean import Copy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
CONSUMER = os.path.join(ROOT, 'tests', 'checks', 'consumer')
EXAMPLE = '''cmake_minimum_required(VERSION 3.21)
project(example C)
find_package(fathom REQUIRED)
add_executable(bus bus.c)
target_link_libraries(bus PRIVATE fathom::posix fathom::sim)
'''
# What Debian's own programs keep of any package: their data bases, logs and caches.
KEPT = re.compile(r'/(var/lib/(dpkg|apt|systemd)|var/log|var/cache|tmp|srv|root|run|dev|proc|sys|var/tmp)(/|$)|'
                  r'/etc/ld\.so\.cache$')


def said_of(step, done):
    return f'{step}: exit status {done[0]}: {done[1].strip()[-600:]}'


def works(copy, version):
    done = copy.run('fathom', '--version')
    if done != (0, f'fathom {version}\n'):
        yield said_of('fathom --version', done)
    # A simulated sensor and the tool that reads it, over a pseudo terminal of the copy.
    done = copy.run('fathom sim a16 --link /tmp/tank --distance 1234 >/dev/null & '
                    'for try in $(seq 100); do [ -e /tmp/tank ] || sleep 0.1; done; '
                    'fathom read a16 --port /tmp/tank --count 3 --format csv --no-header 2>&1; '
                    'status=$?; kill %1; exit $status', seconds=30)
    if done[0] != 0 or len(re.findall(r',target,.*\b1234\b', done[1])) != 3:
        yield said_of('fathom sim and fathom read', done)


def manual(copy, _):
    for page in ('fathom', 'fathom-read', 'fathom read'):
        done = copy.run(f'MANPAGER=cat MANWIDTH=80 man {page}')
        if done[0] != 0 or 'EXIT STATUS' not in done[1]:
            yield said_of(f'man {page}', done)
    done = copy.run('mandb -c >/dev/null 2>&1; apropos -e fathom')
    if 'reads the range sensors' not in done[1]:
        yield said_of('apropos fathom', done)


def completes(copy, _):
    done = copy.run('bash', '-c', '. /usr/share/bash-completion/bash_completion; _completion_loader fathom; '
                    'complete -p fathom')
    if done != (0, 'complete -F _fathom fathom\n'):
        yield said_of('bash-completion', done)


def unit(copy, _):
    has_page = copy.run('man', '-w', 'fathom-publish')[0] == 0  # which the unit names
    done = copy.run('systemd-analyze', 'verify', f'--man={"yes" if has_page else "no"}', 'fathom-publish.service')
    if done != (0, ''):
        yield said_of('systemd-analyze verify', done)
    done = copy.run('dpkg -i /srv/fathom_*.deb')  # as an update is
    if done[0] != 0:
        yield said_of('installed once more', done)
    done = copy.run('systemctl', 'is-enabled', 'fathom-publish.service')
    if done != (1, 'disabled\n'):
        yield said_of('systemctl is-enabled', done)


def compiles(copy, version):
    """A program for each .pc file, and all of them by find_package; an example by both."""
    sources = [os.path.join(CONSUMER, name) for name in os.listdir(CONSUMER)]
    copy.put(*sources, os.path.join(ROOT, 'examples', 'bus.c'), to='srv/consumer')
    done = copy.run('pkg-config --list-all | sed -n "s/^\\(fathom[a-z_]*\\) .*/\\1/p"')
    modules = sorted(done[1].split())
    if 'fathom' not in modules or 'fathom_posix' not in modules:
        yield said_of('pkg-config --list-all', done)
    for module in modules:
        source = 'main.c' if module == 'fathom' else module[len('fathom_'):] + '.c'
        done = copy.run(f'cd /srv/consumer && test "$(pkg-config --modversion {module})" = {version} && '
                        f'cc -std=c99 {source} $(pkg-config --cflags --libs {module}) -o /tmp/program && '
                        '/tmp/program')
        if done[0] != 0:
            yield said_of(f'{source} by pkg-config {module}', done)
    done = copy.run('cd /srv/consumer && cmake -DFATHOM_WANTED= -S . -B /tmp/build && cmake --build /tmp/build && '
                    'for program in $(find /tmp/build -maxdepth 1 -type f -perm -u=x); do "$program" || exit; done')
    if done[0] != 0:
        yield said_of('the programs by find_package', done)
    done = copy.run('cd /srv/consumer && cc bus.c $(pkg-config --cflags --libs fathom_posix fathom_sim) -o /tmp/bus && '
                    '/tmp/bus')
    if done[0] != 0 or 'HPS-167S' not in done[1]:
        yield said_of('examples/bus.c by pkg-config', done)
    os.makedirs(os.path.join(copy.upper, 'srv/example'))
    with open(os.path.join(copy.upper, 'srv/example/CMakeLists.txt'), 'w', encoding='utf-8') as file:
        file.write(EXAMPLE)
    done = copy.run('cd /srv/example && cp ../consumer/bus.c . && cmake -S . -B /tmp/example && '
                    'cmake --build /tmp/example && /tmp/example/bus')
    if done[0] != 0 or 'HPS-167S' not in done[1]:
        yield said_of('examples/bus.c by find_package', done)


def paths(copy):
    status, said = copy.run("find / -xdev -printf '%y%m %p %l\\n'")
    if status != 0:
        raise SystemExit(said)
    return {line for line in said.splitlines() if not KEPT.match(line.split(' ')[1])}


def in_clean_system(base, packages, version, checks=None):
    """All of it: installed, looked at (by the checks that are named, or all), removed."""
    with Copy(base, os.path.join(base.folder, 'copy')) as copy:
        copy.put(*packages)
        before = paths(copy)
        tool, library = (f'/srv/{os.path.basename(package)}' for package in packages)
        done = copy.apt('install', tool)
        if done[0] != 0:
            yield said_of('apt-get install', done)
            return
        for check in (works, manual, completes, unit):
            if checks is None or check.__name__ in checks:
                yield from check(copy, version)
        if checks is None or 'compiles' in checks:
            done = copy.apt('install', library)
            if done[0] == 0:
                yield from compiles(copy, version)
            else:
                yield said_of('apt-get install', done)
        done = copy.apt('purge', 'fathom', 'libfathom-dev', '--auto-remove')
        if done[0] != 0:
            yield said_of('apt-get purge', done)
        after = paths(copy)
        yield from (f'left behind: {line}' for line in sorted(after - before))
        yield from (f'taken away: {line}' for line in sorted(before - after))
        done = copy.run('find / -xdev -name "*fathom*" -not -path "/srv/*" -not -path "/tmp/*" '
                        '-not -path "/var/log/*" -not -path "/var/cache/*"')
        if done[1]:
            yield said_of('after apt-get purge there is', done)
