#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Interrupts each call of a microcontroller's port at every instruction boundary: README.md here.

    run.py [MACHINE ...]                 every event alone and two together; in some scenarios all pairs of boundaries
    run.py --quick [MACHINE ...]         every event alone; in some scenarios more
    run.py --only NAME [--depth N]       the scenarios with NAME in their names: 1 alone, 2 together, 3 pairs

MACHINE is avr or rp2040. run.py builds into build-interrupts. The last line is "N passed, M failed"."""
import argparse
import concurrent.futures
import os
import re
import shutil
import subprocess
import sys

import disassembly
import machine_avr
import machine_rp2040

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
BUILD = os.path.join(ROOT, 'build-interrupts')
MACHINES = {machine.NAME: machine for machine in (machine_avr, machine_rp2040)}
COLUMNS = ('boundaries', 'alone', 'deferred', 'together', 'pairs')
SECONDS = 3600  # for one scenario


class Bad(Exception):
    """What cannot be carried out."""


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        raise Bad(f'{" ".join(command)}\n{done.stdout[-4000:]}')
    return done.stdout


class Result:
    """Of a scenario: its lines "figures NAME,N,...", "covered ADDRESS" and "wrong NAME: what"."""

    def __init__(self, name, depth, text, status):
        self.name, self.depth = name, depth
        self.wrong = re.findall(r'^wrong (.*)$', text, re.M)
        self.covered = {int(address, 16) for address in re.findall(r'^covered (\w+)$', text, re.M)}
        found = re.search(fr'^figures {name},([\d,]+)$', text, re.M)
        self.figures = dict(zip(COLUMNS, map(int, found[1].split(',')))) if found else {}
        if not self.wrong and not found:
            self.wrong = [f'{name}: exit status {status}: {text[-500:]}']


def run_process(machine, host, image, depths):
    """[Result] of {name: depth}, by one process; the line "figures" is a scenario's last."""
    words = [str(word) for pair in depths.items() for word in pair]
    done = subprocess.run(machine.command(host, image, *words), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=SECONDS, check=False)
    results, text = [], done.stdout
    for name, depth in depths.items():
        part = re.match(fr'(?ms).*?^figures {name},[\d,]+$', text)
        results.append(Result(name, depth, part[0] if part else text, done.returncode))
        text = text[part.end():] if part else ''
    if done.returncode != 0 and not any(result.wrong for result in results):
        results[-1].wrong = [f'{results[-1].name}: exit status {done.returncode}: {done.stdout[-500:]}']
    return results


def run_scenarios(machine, host, image, depths):
    """[Result], as they come."""
    names = list(depths)
    parts = [{name: depths[name] for name in names[i:i + machine.A_PROCESS]}
             for i in range(0, len(names), machine.A_PROCESS)]
    with concurrent.futures.ThreadPoolExecutor(min(2, os.cpu_count() or 1)) as pool:
        waiting = [pool.submit(run_process, machine, host, image, part) for part in parts]
        for done in concurrent.futures.as_completed(waiting):
            yield from done.result()


def too_few(result):
    """Returns what a scenario of this depth has to reach and did not."""
    figures, wrong = result.figures, []
    if not 0 < figures['boundaries'] <= figures['alone']:
        wrong.append(f'{result.name}: {figures["alone"]} events came at {figures["boundaries"]} boundaries')
    if result.depth >= 2 and not figures['together']:
        wrong.append(f'{result.name}: no two events came together')
    if result.depth >= 3 and not figures['pairs']:
        wrong.append(f'{result.name}: no two events came as a pair')
    return wrong


def objects_of(machine, folder):
    found = [os.path.join(where, name) for where, _, names in os.walk(os.path.join(folder, 'image')) for name in names]
    objects = [path for path in found if path.endswith(machine.OBJECTS)]
    if len(objects) != len(machine.OBJECTS):
        raise Bad(f'{folder}: {len(objects)} objects of the port, not {len(machine.OBJECTS)}')
    return objects


def named(image, text):
    """With each address as its function."""
    return re.sub(r'\bat ([0-9a-f]{4,8})\b', lambda found: f'at {image.where(int(found[1], 16))}', text)


def said(figures):
    return ', '.join(f'{figure} {word}' for word, figure in figures.items())


def check(machine, options):
    folder = os.path.join(BUILD, machine.NAME)
    path = machine.build(run, ROOT, folder)
    host = machine.build_host(run, ROOT, folder)
    image = disassembly.Image(machine, path)
    names = run(*machine.command(host, path, '--list')).split()
    depths = {name: options.depth or (machine.QUICK.get(name, 1) if options.quick else machine.FULL.get(name, 2))
              for name in names if options.only in name}
    unknown = sorted({*machine.QUICK, *machine.FULL} - set(names))
    if not depths or unknown:
        raise Bad(f'there is no scenario {" ".join(unknown) or options.only}')
    passed, failed, covered, results = 0, 0, set(), []
    for result in run_scenarios(machine, host, path, depths):
        results.append(result)
        covered |= result.covered
        wrong = [named(image, line) for line in result.wrong] or too_few(result)
        print(f'{machine.NAME} {result.name}: {said(result.figures)}', flush=True)
        print(''.join(f'    {line}\n' for line in wrong), end='')
        passed, failed = passed + (not wrong), failed + bool(wrong)
    if not options.only:
        count, wrong = image.missed(objects_of(machine, folder), covered)
        print(*wrong[:20], sep='\n', end='\n' if wrong else '')
        total = {word: sum(result.figures.get(word, 0) for result in results) for word in COLUMNS}
        print(f'{machine.NAME}: {len(results)} scenarios, {count} instructions of the port, '
              f'{len(wrong)} of them not broken into; {said(total)}')
        passed, failed = passed + (not wrong), failed + bool(wrong)
    return passed, failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--only', default='', metavar='NAME')
    parser.add_argument('--depth', type=int, choices=(1, 2, 3))
    parser.add_argument('machines', nargs='*', metavar='MACHINE')
    options = parser.parse_args()
    passed = failed = 0
    try:
        for name in options.machines or MACHINES:
            if name not in MACHINES:
                raise Bad(f'there is no machine {name}')
            machine = MACHINES[name]
            missing = [program for program in machine.PROGRAMS if not shutil.which(program)]
            if missing:
                raise Bad(f'{name} needs {" ".join(missing)}')
            good, bad = check(machine, options)
            passed, failed = passed + good, failed + bad
    except (Bad, OSError, subprocess.TimeoutExpired) as error:
        print(error)
        failed += 1
    print(f'{passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
