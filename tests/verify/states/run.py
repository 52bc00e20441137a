#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Goes through all states of the small worlds below and holds each step against the headers' promises.

    run.py              all worlds; compares their figures with figures.csv
    run.py --quick      those of a few seconds
    run.py --self-test  without each assumption, and with each planted fault, a way to what is broken comes out
    run.py --update     keeps the figures of the worlds that it has gone through
    run.py --only NAME  one world, or one row of the self-test

It builds into build-states/, with FATHOM_CC or gcc. A figure that differs fails: the same code and the same world have
the same states each time."""
import concurrent.futures
import csv
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
BUILD = os.path.join(ROOT, 'build-states')
FIGURES = os.path.join(HERE, 'figures.csv')
sys.path.insert(0, os.path.join(ROOT, 'tests', 'verify', 'mutation'))
import c_text  # noqa: E402

LIBRARY = [f'src/engine/{name}.c' for name in (
    'line', 'line_request', 'line_send', 'line_response', 'line_turns', 'line_find_echo', 'modbus', 'modbus_client',
    'dyp_client')] + [f'src/codec/{name}.c' for name in ('crc16', 'modbus_rtu', 'dyp_55aa', 'dyp_stream')] + [
    'src/status_name.c']
WORLD = [f'tests/verify/states/{name}.c' for name in (
    'main', 'search', 'ends', 'world', 'packed', 'steps', 'rules', 'described')]

# What is as it is where a world does not say otherwise: world.c has the same.
DEFAULTS = dict(transactions=15, retries1a=0, retries1b=1, retries2a=0, retries2b=0, timeout1=3, timeout2=3, silence=2,
                gap=2, leave=1, poll=1)
WRONG = dict(exception=1, damaged=1, unexpected=1)
PORT = dict(read_fails=1, write_fails=1, write_busy=1, set_line=1)
TWO = dict(transactions=5)  # one of each unit
QUICK = {
    'two of each unit, cancelled': dict(cancel=1, watched=3),
    'wrong responses and noise': dict({**TWO, **WRONG}, cancel=1, piece=1, leave=2),
    'a port with faults': dict({**TWO, **PORT}, cancel=1, cancel_unit=1, retries1a=1),
    'a port with a queue': dict(TWO, cancel=1, takes=1, leave=2, retries2a=1),
    'another host': dict(TWO, foreign=1, cancel=1, piece=1),
    'a device that sends by itself': dict(TWO, stream=1, retries1a=1),
    'an adapter that echoes': dict(TWO, echo=1, cancel=1, retries1a=1),
    'an adapter of unknown echo': dict(TWO, echo=2, cancel=1, retries1a=1),
    '55 AA': dict(TWO, dyp=1, cancel=1, damaged=1, unexpected=1, retries1a=1),
    '55 AA, echoed': dict(TWO, dyp=1, echo=2, cancel=1),
    'time-outs that differ': dict(TWO, timeout1=2, timeout2=4, cancel=1, damaged=1, retries1a=1),
}
FULL = {
    'three, wrong responses': dict(WRONG, transactions=7, watched=2),
    'two of each unit, retries': dict(retries1a=1, retries2a=1, retries2b=1, exception=1, watched=3),
    'a slow loop': dict(TWO, poll=2, cancel=1, damaged=1),
    'in halves': dict(transactions=3, halves=1, timeout1=2, leave=1),
    'two of each unit, 55 AA': dict(dyp=1, damaged=1, watched=3),
    'two of each unit, port': dict(read_fails=1, write_fails=1, watched=3),
}

SMALL = dict(transactions=3, cancel=1, damaged=1)
ASSUMPTIONS = {  # without it: the world, what is broken
    'no response later than twice the time-out': (dict(SMALL, over=2), 'after its own was given up'),
    'a gap behind noise that begins like a response': (
        dict(TWO, piece=1, crowd=1, foreign=1), 'late response may still come'),
}
REQUEST, RESPONSE, SEND, LINE = (
    f'src/engine/{name}.c' for name in ('line_request', 'line_response', 'line_send', 'line'))
FAULTS = {  # a world, what is broken; file, function, old text, new text
    'a quarantine of half the time': (SMALL, 'late response may still come', REQUEST, 'quarantine',
        'longest_us += transaction->timeout_us;', 'longest_us += transaction->timeout_us / 2;'),
    'a quarantine of one unit at a time': (dict(TWO, cancel=1), 'late response may still come', REQUEST, 'quarantine',
        'line->quarantined |= quarantine_bits(transaction->address);',
        'line->quarantined = quarantine_bits(transaction->address);'),
    'a shorter quarantine cuts a longer one': (dict(TWO, timeout1=4, timeout2=1, cancel=1),
        'late response may still come', REQUEST, 'quarantine',
        '(line->quarantine_left_us < longest_us)', '(longest_us != 0)'),
    'a damaged frame ends a quarantine': (dict(TWO, piece=1), 'late response may still come', RESPONSE, 'judge',
        'if (is_frame) return fathom_line_deliver(line) ? (length | TAKEN) : length;',
        'if (is_frame) return fathom_line_deliver(line) ? (length | TAKEN) : length;'
        'if (length != 0) line->quarantined = 0;'),
    'cancel quarantines none': (SMALL, 'late response may still come', REQUEST, 'fathom_line_cancel',
        'quarantine(line);', ''),
    'a frame of another unit ends a quarantine': (dict(TWO, foreign=1), 'late response may still come', REQUEST,
        'fathom_line_deliver', 'line->quarantined & (uint16_t)~quarantine_bits(address)', '0'),
    'a quarantine begins when a request is cancelled': (dict(SMALL, leave=3), 'late response may still come', LINE,
        'look',
        '&& (line->state != LEAVING)', ''),
    'a cancelled request lets the line go': (dict(TWO, cancel=1), 'without the silence', REQUEST, 'fathom_line_cancel',
        'line->state = LEAVING;', ';'),
    'no silence after a port that broke': (dict(TWO, read_fails=1), 'without the silence', REQUEST, 'give_up',
        'line->silent_us = 0;', ''),
    'retries without end': (dict(TWO, retries1a=1), 'never ends', SEND, 'fathom_line_send', 'x->attempts++;',
        'x->attempts = 1;'),
    'one retry too many': (dict(TWO, retries1a=1), 'more attempts', REQUEST, 'fathom_line_end_attempt',
        'line->head->attempts > line->head->retries', 'line->head->attempts > line->head->retries + 1'),
    'a response serves who has not asked': (SMALL, 'another transaction', REQUEST, 'fathom_line_deliver',
        '(x->attempts == 0u) ||', ''),
    'last in, first out': (dict(transactions=7, watched=0), 'more pass than its bound', REQUEST, 'fathom_line_submit',
        '*link = transaction; transaction->link.next = NULL;',
        'if (!is_busy(line)) { transaction->link.next = line->head; line->head = transaction; } '
        'else { *link = transaction; transaction->link.next = NULL; }'),
    'a quarantined unit stops the others': (TWO, 'could leave was not sent', REQUEST, 'next', 'x = x->link.next;',
        'return NULL;'),
    'the second in the queue goes first': (TWO, 'before one that could', REQUEST, 'next', 'return x;',
        'return x != NULL && x->link.next != NULL && line->quarantined == 0 ? x->link.next : x;'),
    'a time-out too short by one': (TWO, 'before its time-out', REQUEST, 'go_on',
        'line->left_us = line->head->timeout_us;', 'line->left_us = line->head->timeout_us - 1;'),
    'due too late by one': (TWO, 'before it was due', REQUEST, 'due_us', 'return line->quarantine_left_us;',
        'return line->quarantine_left_us + 1;'),
    'a damaged response is none': (SMALL, 'NO_RESPONSE, and something came', REQUEST, 'fathom_line_end_attempt',
        'error = FATHOM_ERR_CHECKSUM;', 'error = FATHOM_ERR_NO_RESPONSE;'),
    'a time-out is a checksum': (SMALL, 'CHECKSUM, and nothing damaged came', REQUEST, 'fathom_line_end_attempt',
        'fathom_status_t error = FATHOM_ERR_NO_RESPONSE;', 'fathom_status_t error = FATHOM_ERR_CHECKSUM;'),
    'what has ended is written to': (SMALL, 'not the line\'s was written to', SEND, 'fathom_line_send',
        'x->attempts++;',
        'x->attempts++; { static fathom_transaction_t *last; if (last != NULL) last->retries = 1; last = x; }'),
    'the first response in time is left': (TWO, 'was not taken', REQUEST, 'fathom_line_deliver',
        '(x->attempts == 0u) ||', '(x->attempts < 2) ||'),
}


def planted(fault):
    """The source with a fault."""
    with open(os.path.join(ROOT, fault[0]), encoding='utf-8') as file:
        return c_text.replace(file.read(), [tuple(fault[1:])])


def lost_faults():
    """Those whose text the sources do not have any more."""
    for name, (_, _, *fault) in FAULTS.items():
        try:
            planted(fault)
        except c_text.NotThere as error:
            yield f'planted: {name}: {error}'


def build(name, fault=None):
    """The program, of the sources with this fault; its path."""
    folder = os.path.join(BUILD, re.sub(r'\W+', '_', name))
    os.makedirs(folder, exist_ok=True)
    sources = []
    for path in LIBRARY:
        at = os.path.join(ROOT, path)
        if fault and fault[0] == path:
            at = os.path.join(folder, os.path.basename(path))
            with open(at, 'w', encoding='utf-8') as file:
                file.write(planted(fault))
        sources.append(at)
    program = os.path.join(folder, 'states')
    subprocess.run([os.environ.get('FATHOM_CC', 'gcc'), '-std=c99', '-O2',
                    *(('-w',) if fault else ('-Wall', '-Wextra', '-Werror')),
                    *(f'-I{os.path.join(ROOT, path)}' for path in ('include', 'src/engine', 'tests/verify/states')), '-o',
                    program,
                    *sources, *(os.path.join(ROOT, path) for path in WORLD)], check=True)
    return program


def run(program, words, most=24000000):
    done = subprocess.run([program, str(most), *(f'{word}={number}' for word, number in words.items())],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def bound_of_ticks(words):
    """Until all have ended: each attempt waits for a quarantine, a silence, its request, a time-out, and a gap where
    something damaged came at the end of it; and each poll may be late for each of these."""
    world = {**DEFAULTS, **words}
    longest = max(world['timeout1'], world['timeout2'])
    late = world['poll'] - 1
    attempt = 2 * longest + world['silence'] + world['leave'] + longest + 2 * world['gap'] + 5 * late
    names = [name for bit, name in enumerate(('1a', '1b', '2a', '2b')) if world['transactions'] >> bit & 1]
    return sum(1 + world[f'retries{name}'] for name in names) * attempt + 2 * longest


def figures_of(output):
    words = output.split()
    return dict(zip(words[::2], map(int, words[1::2])))


def kept():
    with open(FIGURES, encoding='utf-8', newline='') as file:
        return {row['world']: {key: int(value) for key, value in row.items() if key != 'world' and value}
                for row in csv.DictReader(file)}


def keep(measured):
    columns = list(dict.fromkeys(key for figures in measured.values() for key in figures))
    with open(FIGURES, 'w', encoding='utf-8', newline='') as file:
        table = csv.DictWriter(file, ['world', *columns], restval='', lineterminator='\n')
        table.writeheader()
        table.writerows({'world': name, **figures} for name, figures in measured.items())


def go_through(worlds, update):
    program = build('as it is')
    before = {} if update or not os.path.exists(FIGURES) else kept()
    measured, failed = {}, 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        runs = {name: pool.submit(run, program, words) for name, words in worlds.items()}
    for name, words in worlds.items():
        status, output = runs[name].result()
        if status != 0:
            print(f'{name}:\n{output}')
            failed += 1
            continue
        measured[name] = figures_of(output)
        print(f'{name}: {output}', end='')
        if measured[name]['longest'] > bound_of_ticks(words):
            print(f'  the longest is over {bound_of_ticks(words)} ticks')
            failed += 1
        elif not update and measured[name] != before.get(name):
            print(f'  figures.csv has other figures: {before.get(name)}')
            failed += 1
    for key in ('states', 'transitions'):
        print(f'{key} of {len(measured)} worlds: {sum(figures[key] for figures in measured.values())}')
    if update and not failed:
        rows = {**(kept() if os.path.exists(FIGURES) else {}), **measured}
        keep({name: rows[name] for name in {**QUICK, **FULL} if name in rows})
    return len(worlds) - failed, failed


def see_it_fail(only):
    rows = [(name, words, text, None) for name, (words, text) in ASSUMPTIONS.items()]
    rows += [(name, words, text, fault) for name, (words, text, *fault) in FAULTS.items()]
    rows = [row for row in rows if only in (None, row[0])]

    def plant(row):
        name, words, _, fault = row
        try:
            return run(build(name, fault), words, 3000000)
        except (c_text.NotThere, subprocess.CalledProcessError) as error:
            return 2, f'{error}\n'

    failed = 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for row, (status, output) in zip(rows, pool.map(plant, rows)):
            print(f'\n{"without" if row[3] is None else "planted"}: {row[0]}\n{output}', end='')
            if status != 1 or f'{row[2]}' not in output.splitlines()[-1]:
                print(f'  NOT SEEN as "{row[2]}"')
                failed += 1
    return len(rows) - failed, failed


def main(arguments):
    only = arguments[arguments.index('--only') + 1] if '--only' in arguments else None
    if '--self-test' in arguments:
        passed, failed = see_it_fail(only)
    else:
        worlds = QUICK if '--quick' in arguments else {**QUICK, **FULL}
        if only:
            worlds = {only: {**QUICK, **FULL}[only]}
        lost = list(lost_faults())
        print(''.join(f'{line}\n' for line in lost), end='')
        passed, failed = go_through(worlds, '--update' in arguments)
        failed += len(lost)
    print(f'{passed} passed, {failed} failed')
    return 0 if passed and not failed else 1


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
