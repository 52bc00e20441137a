# SPDX-License-Identifier: MIT
"""The unit's SystemCallFilter lets the tool do its work: what it asks of the kernel while it reads a simulated sensor,
and while it publishes, is in the groups that systemd-analyze lists."""
import os
import re
import subprocess
import tempfile

from clean import must

SITE = '''site: plant
broker:
  host: localhost
  port: 9
lines:
  - port: ./tank
    sensors:
      - name: tank
        sensor: a16:1:modbus
'''
SECONDS = 4  # for which it publishes, to a broker that is not there; then SIGTERM
NEVER = {'execve'}  # strace's own, before the tool begins
SPARED = {'AF_NETLINK'}  # by which glibc asks whether there is IPv6; where it may not, it takes both as there


def group(name):
    calls = set()
    for line in must(['systemd-analyze', '--no-pager', 'syscall-filter', name]).splitlines()[1:]:
        word = line.strip()
        if word and not word.startswith('#'):
            calls |= group(word) if word.startswith('@') else {word}
    return calls


def allowed(unit):
    """As systemd reads it: the first line says what is let through, ~ takes away from it."""
    calls = set()
    for line in re.findall(r'^SystemCallFilter=(.*)$', unit, re.M):
        for word in line.lstrip('~').split():
            named = group(word) if word.startswith('@') else {word}
            calls = calls - named if line.startswith('~') else calls | named
    return calls


def families(unit):
    return set(re.search(r'^RestrictAddressFamilies=(.*)$', unit, re.M)[1].split())


def traced(tool, folder, *words, seconds=20):
    """The calls, and the families of sockets that were opened."""
    log = os.path.join(folder, 'log')
    subprocess.run(['timeout', str(seconds), 'strace', '-f', '-o', log, tool, *words], cwd=folder, check=False,
                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with open(log, encoding='utf-8') as file:
        text = file.read()
    return (set(re.findall(r'^\d+ +([a-z_0-9]+)\(', text, re.M)) - NEVER,
            {family for family in re.findall(r' socket\((AF_[A-Z0-9]+)', text)} - SPARED)


def problems(root, unit_path):
    tool = os.path.join(root, 'usr/bin/fathom')
    with open(os.path.join(root, unit_path), encoding='utf-8') as file:
        unit = file.read()
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, 'site.yaml'), 'w', encoding='ascii') as file:
            file.write(SITE)
        lines = [('read', 'a16:1:modbus', '--port', './tank', '--count', '3'),
                 ('read', 'hps167s', '--port', 'tcp:localhost:9', '--count', '1')]
        if re.search(r'^  publish ', must([tool, '--help']), re.M):
            lines.append(('publish', 'site.yaml'))
        with subprocess.Popen([tool, 'sim', 'a16:1:modbus', '--link', './tank'], cwd=folder, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL) as simulated:
            simulated.stdout.readline()
            for line in lines:
                calls, opened = traced(tool, folder, *line, seconds=SECONDS if line[0] == 'publish' else 20)
                if 'ioctl' not in calls and 'connect' not in calls:
                    yield f'fathom {" ".join(line)}: it did nothing'
                for call in sorted(calls - allowed(unit)):
                    yield f'fathom {" ".join(line)}: the unit does not let {call} through'
                for family in sorted(opened - families(unit)):
                    yield f'fathom {" ".join(line)}: the unit has no {family}'
            simulated.terminate()
