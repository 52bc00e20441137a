#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Enumerates every state of the small worlds below and checks each step against the promises of the headers.

    run.py              all worlds
    run.py --quick      the worlds that take some seconds
    run.py --only NAME  one world

run.py compiles into build-states/ with FATHOM_CC, or with gcc. A world with fewer states than its least number fails:
it no longer reaches what it is for."""
import concurrent.futures
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
BUILD = os.path.join(ROOT, 'build-states')

LIBRARY = [f'src/engine/{name}.c' for name in (
    'line', 'line_attempt', 'line_due', 'line_echo', 'line_request', 'line_response', 'line_senders', 'line_masters',
    'line_options', 'line_turns', 'line_round', 'modbus_client', 'dyp_client')] + [
    f'src/codec/{name}.c' for name in ('crc16', 'modbus_rtu', 'dyp_55aa', 'dyp_stream')] + ['src/status_name.c']
WORLD = [f'tests/verify/states/{name}.c' for name in (
    'main', 'search', 'ends', 'world', 'packed', 'steps', 'rules', 'described')]

MOST = 24000000  # states of a world

# What is as it is where a world does not say otherwise: world.c has the same.
DEFAULTS = dict(transactions=15, retries1a=0, retries1b=1, retries2a=0, retries2b=0, timeout1=3, timeout2=3, silence=2,
                gap=2, leave=1, poll=1, busy=6)
WRONG = dict(exception=1, damaged=1, unexpected=1)
PORT = dict(read_fails=1, write_fails=1, write_busy=1, set_line=1)
TWO = dict(transactions=5)  # one of each unit
QUICK = {  # a world: the least number of its states, four fifths of today's, and its words
    'two of each unit, cancelled': (440000, dict(cancel=1, watched=3)),
    'wrong responses and noise': (120000, dict({**TWO, **WRONG}, cancel=1, piece=1, leave=2)),
    'a port with faults': (92000, dict({**TWO, **PORT}, cancel=1, cancel_unit=1, retries1a=1)),
    'a port with a queue': (8900, dict(TWO, cancel=1, takes=1, leave=2, retries2a=1)),
    'another host': (110000, dict(TWO, foreign=1, cancel=1, piece=1)),
    'a device that sends by itself': (160000, dict(TWO, stream=1, senders=1, retries1a=1)),
    'a unit that sends by itself': (27000, dict(TWO, own=1, senders=1)),
    'a slow loop among frames': (190000, dict(TWO, own=1, senders=1, poll=2, silence=1)),
    'noise without end': (110000, dict(TWO, noise=1, retries1a=1, cancel=1)),
    'another master': (140000, dict(TWO, asks=1, masters=1, retries1a=1)),
    'an adapter that echoes': (17000, dict(TWO, echo=1, cancel=1, retries1a=1)),
    'an adapter of unknown echo': (26000, dict(TWO, echo=2, cancel=1, retries1a=1)),
    '55 AA among frames': (290000, dict(TWO, dyp=1, cancel=1, damaged=1, unexpected=1, retries1a=1, senders=1)),
    '55 AA': (89000, dict(TWO, dyp=1, cancel=1, damaged=1, unexpected=1, retries1a=1)),
    '55 AA, echoed': (27000, dict(TWO, dyp=1, echo=2, cancel=1)),
    'time-outs that differ': (85000, dict(TWO, timeout1=2, timeout2=4, cancel=1, damaged=1, retries1a=1)),
}
FULL = {
    'three, wrong responses': (150000, dict(WRONG, transactions=7, watched=2)),
    'two of each unit, retries': (320000, dict(retries1a=1, retries2a=1, retries2b=1, exception=1, watched=3)),
    'a slow loop and another master': (340000, dict(TWO, asks=1, masters=1, poll=2, retries1a=1)),
    'another master and unsolicited frames': (
        47000, dict(transactions=1, asks=1, masters=1, own=1, senders=1, retries1a=1)),
    'a slow loop, noise and frames': (
        170000, dict(transactions=1, own=1, senders=1, noise=1, poll=2, silence=1, retries1a=1)),
    'a slow loop': (180000, dict(TWO, poll=2, cancel=1, damaged=1)),
    'in halves': (9200, dict(transactions=3, halves=1, timeout1=2, leave=1)),
    'two of each unit, 55 AA': (410000, dict(dyp=1, damaged=1, watched=3)),
    'two of each unit, port': (1600000, dict(read_fails=1, write_fails=1, watched=3)),
}


def build():
    """Compiles the sources. Returns the path of the program."""
    os.makedirs(BUILD, exist_ok=True)
    program = os.path.join(BUILD, 'states')
    subprocess.run([os.environ.get('FATHOM_CC', 'gcc'), '-std=c99', '-O2', '-Wall', '-Wextra', '-Werror',
                    *(f'-I{os.path.join(ROOT, path)}' for path in ('include', 'src/engine', 'tests/verify/states')),
                    '-o', program, *(os.path.join(ROOT, path) for path in LIBRARY + WORLD)], check=True)
    return program


def run(program, words):
    done = subprocess.run([program, str(MOST), *(f'{word}={number}' for word, number in words.items())],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def bound_of_ticks(words):
    """Until all have ended (line.h, rule 13): each attempt waits for a quarantine, at most busy_us for a silence, its
    request, a time-out, and a gap where something damaged came at the end of it; and each poll may be late for each of
    these."""
    world = {**DEFAULTS, **words}
    longest = max(world['timeout1'], world['timeout2'])
    late = world['poll'] - 1
    attempt = 2 * longest + world['busy'] + world['leave'] + longest + 2 * world['gap'] + 5 * late
    names = [name for bit, name in enumerate(('1a', '1b', '2a', '2b')) if world['transactions'] >> bit & 1]
    return sum(1 + world[f'retries{name}'] for name in names) * attempt + 2 * longest


def figures_of(output):
    words = output.split()
    return dict(zip(words[::2], map(int, words[1::2])))


def go_through(worlds):
    program = build()
    measured, failed = [], 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        runs = {name: pool.submit(run, program, words) for name, (_, words) in worlds.items()}
    for name, (least, words) in worlds.items():
        status, output = runs[name].result()
        if status != 0:
            print(f'{name}:\n{output}')
            failed += 1
            continue
        measured.append(figures_of(output))
        print(f'{name}: {output}', end='')
        if measured[-1]['longest'] > bound_of_ticks(words):
            print(f'  FAILED: the longest way to the end is over {bound_of_ticks(words)} ticks')
            failed += 1
        elif measured[-1]['states'] < least:
            print(f'  FAILED: the world had at least {least} states')
            failed += 1
    for key in ('states', 'transitions'):
        print(f'{key} of {len(measured)} worlds: {sum(figures[key] for figures in measured)}')
    return len(worlds) - failed, failed


def main(arguments):
    worlds = QUICK if '--quick' in arguments else {**QUICK, **FULL}
    if '--only' in arguments:
        only = arguments[arguments.index('--only') + 1]
        worlds = {only: {**QUICK, **FULL}[only]}
    try:
        passed, failed = go_through(worlds)
    except subprocess.CalledProcessError as error:
        print(error)
        passed, failed = 0, 1
    print(f'{passed} passed, {failed} failed')
    return 0 if passed and not failed else 1


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
