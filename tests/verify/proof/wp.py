#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Shows by Frama-C's WP, with CVC4 and Z3, that the codecs do what their headers promise, for every input.

    wp.py [UNIT ...]          each goal by each prover, and that no contract contradicts itself; minutes
    wp.py --quick [UNIT ...]  some of the units, each goal by the first prover that can prove it

A unit is src/codec/UNIT.c with the contracts of wp/UNIT.h and the loop invariants of wp/loops.py. wp.py puts the
invariants as comments into a copy, and checks that the tokens of the copy are those of the source. A prover's limit
counts its own steps, so that the load of the machine decides nothing. See wp/README.md.

These fail: a goal that no prover proves and remaining.py does not argue, a function without a goal, and a unit with
fewer goals than its least number: a contract may be lost."""
import argparse
import os
import re
import shutil
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
WP = os.path.join(HERE, 'wp')
sys.path[:0] = [os.path.dirname(HERE), WP]
import c_text  # noqa: E402
import loops  # noqa: E402
import remaining  # noqa: E402

FOLDER = os.path.join(ROOT, 'build-wp')
OF_BITS = ('facts.h', 'hps167s_registers.h')  # their axioms are lemmas of bits.c and words.c, each on a line
ENUMERATED = ('crc16', 'crc16_small')
TACTICS = {'bits': 'wp:range', 'words': 'wp:bitshift,wp:bitwised,wp:split,wp:range'}  # of WP, before provers
# The units, each with the least number of its goals: nine tenths of today's.
UNITS = {'bits': 12, 'words': 4, 'dyp_stream': 83, 'dyp_55aa': 107, 'pulse_width': 30, 'crc16': 19, 'crc16_small': 20,
         'modbus_rtu': 316, 'hps167s_registers': 303, 'round_dyp': 37, 'round_modbus': 78}
QUICK = {'dyp_55aa': '', 'pulse_width': 'fathom_pulse_width_mm_in_air', 'crc16': '',
         'crc16_small': ''}  # and the functions that are left out
PROVERS = ('cvc4', 'z3')
STEPS = {'cvc4': 450000, 'z3': 1500000}  # about twice, and four times, what any goal needed
SMOKE_STEPS = 150000  # of CVC4, for a contradiction, which is mostly found soon
TIMEOUT_S = 60  # s; the steps end a prover before it, on a loaded machine too
LIMIT_S = 1800  # for one run of Frama-C
GOAL = re.compile(r'^\[wp\] \[([^\]]+)\] Goal (?:typed_)?(\w+) : (\w+)|^\[wp\] \[(Failed)\] Goal (?:typed_)?(\w+)',
                  re.M)
# What would make a proof worthless: no definition, an invariant that nothing assumes, a goal left out.
SERIOUS = re.compile(r'^.*(?:Warning: (?!Missing RTE|.*hypotheses)(?:No definition|.*[Uu]nsupported|.*[Ii]gnor)|'
                     r'User Error|annot-error).*$', re.M)
MACHINE = 'gcc_x86_32'


class Bad(Exception):
    """A call, or a file, that cannot be carried out."""


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)


def source_of(unit):
    path = os.path.join('src', 'codec', unit + '.c')
    return path if os.path.exists(os.path.join(ROOT, path)) else f'tests/verify/proof/wp/{unit}.c'


def without_goal(unit, goals, left_out):
    """Returns the functions of a unit that have no goal."""
    text = read(os.path.join(ROOT, source_of(unit)))
    names = {name for name, _, _ in c_text.functions(text, c_text.tokens(text))} - {left_out}
    return sorted(name for name in names if not any(goal.startswith(name + '_') for goal in goals))


def annotated(unit, text):
    """The source with what stands before its loops; its tokens are the same."""
    places = [(c_text.find(text, function, loop)[0], words) for name, function, loop, words in loops.ROWS
              if name == unit]
    result = text
    for start, words in sorted(places, reverse=True):
        # Assertions are an annotation each, a loop's clauses one.
        notes = re.findall(r'assert .*?;', words, re.S) or [words.strip()]
        result = result[:start] + ''.join(f'/*@ {note} */\n    ' for note in notes) + result[start:]
    if [token.text for token in c_text.tokens(result)] != [token.text for token in c_text.tokens(text)]:
        raise Bad(f'{unit}: an invariant changes the program')
    return result


def configuration():
    """Why3's, with the provers of this machine."""
    for program in ('frama-c', 'why3', 'cvc4', 'z3'):
        if shutil.which(program) is None:
            raise Bad(f'{program} is missing: apt-get install frama-c-base why3 cvc4 z3')
    path = os.path.join(FOLDER, 'why3.conf')
    if not os.path.exists(path):
        os.makedirs(FOLDER, exist_ok=True)
        subprocess.run(['why3', '-C', path, 'config', 'detect'], check=False, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, env={**os.environ, 'WHY3CONFIG': path})
    text = read(path) if os.path.exists(path) else ''
    if 'CVC4' not in text or 'Z3' not in text:
        raise Bad(f'why3 found no CVC4 or no Z3: {path}')
    return path


def unproved_facts():
    """What headers have of bits as axioms, and bits.c and words.c do not prove."""
    lemmas = re.findall(r'lemma (.*)$', ''.join(read(os.path.join(WP, unit + '.c')) for unit in TACTICS), re.M)
    return [f'{name}: {fact.split(":")[0]}' for name in OF_BITS
            for fact in re.findall(r'axiom (.*)$', read(os.path.join(WP, name)), re.M) if fact not in lemmas]


def run(unit, provers, folder, root=ROOT, only=None, smoke=False, without=''):
    """{goal: who proved it, '' where nothing did}; smoke: only those that show
    that what is required, or an invariant, contradicts itself."""
    shutil.rmtree(folder, ignore_errors=True)
    code = os.path.join(folder, unit + '.c')
    write(code, annotated(unit, read(os.path.join(root, source_of(unit)))))
    proof = os.path.join(root, 'tests', 'verify', 'proof', 'wp')
    session = os.path.join(folder, 'session')
    shutil.copytree(os.path.join(proof, 'script'), os.path.join(session, 'script'))
    flags = f'-I{os.path.join(root, "include")} -I{proof}'
    contracts = os.path.join(proof, unit + '.h')
    if os.path.exists(contracts):
        flags += f' -include {contracts}'
    words = ['frama-c', '-no-unicode', '-machdep', MACHINE, f'-cpp-extra-args={flags}', code, '-wp', '-wp-rte',
             '-wp-session', session, '-wp-cache', 'none', '-wp-par', '2', '-wp-timeout',
             str(3 if unit == 'words' else TIMEOUT_S),
             '-wp-steps', str(SMOKE_STEPS if smoke else max(STEPS[each] for each in provers)),
             '-wp-prover', ','.join(['tip', *provers])]
    if unit in TACTICS:
        words += ['-wp-auto', TACTICS[unit], '-wp-auto-width', '300']  # each case of a range
    if unit.startswith('crc16'):
        words += ['-wp-no-init-const']  # see crc16.h
    if smoke:
        words += ['-wp-smoke-tests']
    if only:
        words += ['-wp-fct', only]
    if without:
        words += ['-wp-skip-fct', without]
    log = os.path.join(folder, 'log')
    with open(log, 'w', encoding='utf-8') as file:
        try:
            done = subprocess.run(words, cwd=folder, env={**os.environ, 'WHY3CONFIG': configuration()}, stdout=file,
                                  stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=LIMIT_S, check=False)
        except subprocess.TimeoutExpired:
            raise Bad(f'{unit}: frama-c ended not within {LIMIT_S} s') from None
    said = read(log)
    serious = SERIOUS.findall(said)
    if done.returncode != 0 or serious:
        raise Bad(f'{unit}: {serious[0] if serious else "frama-c failed"}: {folder}/log')
    if smoke:
        return {name: '' for name in re.findall(r'\[Failed\] Smoke-test (?:typed_)?(\w+)', said)}
    goals = {}
    for who, goal, verdict, failed, lost in GOAL.findall(said):
        name = goal or lost
        proved = not failed and verdict in ('Valid', 'Passed')
        goals[name] = ('Qed' if who == 'Qed' else who) if proved else ''
    scheduled = re.search(r'(\d+) goals? scheduled', said)
    if not goals or not scheduled or int(scheduled[1]) > len(goals):
        raise Bad(f'{unit}: {len(goals)} goals of {scheduled[1] if scheduled else 0}: {folder}/log')
    return goals


def enumerate_steps(unit, root):
    """What crc_step.c says of a table, which is what crc.h and the unit's header have as axioms."""
    if shutil.which('cc') is None:
        raise Bad('cc is missing: apt-get install gcc')
    proof, program = os.path.join(root, 'tests', 'verify', 'proof', 'wp'), os.path.join(FOLDER, f'{unit}-step')
    os.makedirs(FOLDER, exist_ok=True)
    subprocess.run(['cc', '-std=c99', '-O2', f'-I{os.path.join(root, "include")}', f'-I{proof}', f'-I{root}',
                    f'-DCONTRACTS="{unit}.h"', f'-DSOURCE="{source_of(unit)}"', os.path.join(proof, 'crc_step.c'),
                    '-o', program], check=True, timeout=LIMIT_S)
    done = subprocess.run([program], stdout=subprocess.PIPE, text=True, timeout=LIMIT_S, check=False)
    if done.returncode != 0 or done.stdout != '16777216 steps\n':
        raise Bad(f'{unit}: {done.stdout.strip() or "the check value is wrong"}')
    return done.stdout.strip()


def prove(options):
    for name in options.names:
        if name not in UNITS:
            raise Bad(f'{name}: no such unit')
    units = options.names or [unit for unit in UNITS if unit in QUICK or not options.quick]
    lost, failed, total, proved = unproved_facts(), 0, 0, 0
    print(''.join(f'{fact} is no lemma of bits.c or words.c: FAILED\n' for fact in lost), end='')
    for unit in units:
        begin = time.monotonic()
        sets = [PROVERS] if options.quick else [(prover,) for prover in PROVERS]
        if unit in ENUMERATED:
            print(f'{unit}: {enumerate_steps(unit, ROOT)}')
        without = QUICK.get(unit, '') if options.quick else ''
        by = [run(unit, each, os.path.join(FOLDER, f'{unit}-{"-".join(each)}'), without=without) for each in sets]
        goals = set().union(*by)
        open_goals = sorted(goal for goal in goals if not any(each.get(goal) for each in by))
        wrong = [f'{goal}: not proved' for goal in open_goals if (unit, goal) not in remaining.ARGUED]
        wrong += [f'{name}: no goal is about it' for name in without_goal(unit, goals, without)]
        if not without and len(goals) < UNITS[unit]:
            wrong.append(f'{len(goals)} goals, and at least {UNITS[unit]} before')
        if not options.quick:
            wrong += [f'{goal}: contradiction' for goal in run(unit, PROVERS[:1], os.path.join(FOLDER, f'{unit}-smoke'),
                                                               smoke=True)]
            wrong += [f'{goal}: proved now, strike it from remaining.py' for of, goal in remaining.ARGUED
                      if of == unit and goal not in open_goals]
        failed += bool(wrong)
        total, proved = total + len(goals), proved + len(goals) - len(open_goals)
        print(f'{unit}: {len(goals) - len(open_goals)} of {len(goals)} goals, {time.monotonic() - begin:.0f} s'
              f'{": FAILED" if wrong else ""}', flush=True)
        print(''.join(f'    {line}\n' for line in wrong), end='')
    print(f'{proved} of {total} goals proved; remaining.py argues {len(remaining.ARGUED)}')
    failed += len(lost)
    print(f'{len(units) + len(lost) - failed} passed, {failed} failed')
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('names', nargs='*')
    options = parser.parse_args()
    try:
        return 1 if prove(options) else 0
    except (Bad, c_text.NotThere) as error:
        print(f'wp.py: {error}\n0 passed, 1 failed')
        return 1


if __name__ == '__main__':
    sys.exit(main())
