#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Shows by Frama-C's WP, with CVC4 and Z3, that the codecs do what their headers say, for every input.

    wp.py [UNIT ...]          each goal by each prover, in minutes; figures are compared with wp/figures.csv
    wp.py --quick [UNIT ...]  a few of the units, each goal by the first prover that can
    wp.py --update [UNIT ...] keeps better figures, and those of a new unit
    wp.py --self-test [ROW ...]  plants the faults of wp/faults.py, one at a time, and sees that each is found

Read are src/codec/CODEC.c, wp/CODEC.h with its contracts and wp/loops.py with the invariants of its loops, which are
put before the loops as comments, in a copy whose tokens are seen to be the source's. crc_step.c runs through all steps
of the CRC. What a prover may spend is counted in its own steps, so that the load of the machine decides nothing. See
wp/README.md."""
import argparse
import csv
import os
import re
import shutil
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
WP = os.path.join(HERE, 'wp')
sys.path[:0] = [os.path.join(ROOT, 'tests', 'verify', 'mutation'), WP]
import c_text  # noqa: E402
import faults  # noqa: E402
import loops  # noqa: E402
import remaining  # noqa: E402

FOLDER = os.path.join(ROOT, 'build-wp')
OF_BITS = ('facts.h', 'hps167s_registers.h')  # their axioms are lemmas of bits.c and words.c, each on a line
ENUMERATED = ('crc16', 'crc16_small')
FIGURES = os.path.join(WP, 'figures.csv')
FIELDS = ('unit', 'function', 'goals', 'by qed', 'by both', 'by one', 'by none')
TACTICS = {'bits': 'wp:range', 'words': 'wp:bitshift,wp:bitwised,wp:split,wp:range'}  # of WP, before provers
UNITS = ('bits', 'words', 'dyp_stream', 'dyp_55aa', 'pulse_width', 'crc16', 'crc16_small', 'modbus_rtu',
         'hps167s_registers', 'round_dyp', 'round_modbus')
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
    return path if os.path.exists(os.path.join(ROOT, path)) else os.path.join('tests', 'verify', 'proof', 'wp', unit + '.c')


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


def function_of(unit, goal):
    found = re.match(r'(?:wp_smoke_\w*?_in_)?(fathom_\w+?|[a-z_0-9]+?)_(?:ensures|assigns|requires|loop|assert|call|'
                     r'terminates|wp_smoke|exits|assigns)\w*$', goal)
    return '(lemmas)' if goal.startswith('lemma_') else found[1] if found else unit


def tabulate(unit, by):
    """Rows of figures; `by` is {prover: goals}."""
    rows = {}
    for goal in sorted(set().union(*by.values())):
        row = rows.setdefault(function_of(unit, goal), dict.fromkeys(FIELDS, 0))
        found = [goals.get(goal, '') for goals in by.values()]
        row['goals'] += 1
        if 'Qed' in found:
            row['by qed'] += 1
        else:
            row[('by none', 'by one', 'by both')[sum(map(bool, found))]] += 1
    return [{**row, 'unit': unit, 'function': name} for name, row in sorted(rows.items())]


def kept():
    if not os.path.exists(FIGURES):
        return {}
    with open(FIGURES, encoding='utf-8', newline='') as file:
        return {(row['unit'], row['function']): row for row in csv.DictReader(file)}


def keep(rows):
    with open(FIGURES, 'w', encoding='utf-8', newline='') as file:
        table = csv.DictWriter(file, FIELDS, lineterminator='\n')
        table.writeheader()
        table.writerows(rows[key] for key in sorted(rows))


def worse(row, before):
    if before is None:
        return ['not in figures.csv: --update']
    wrong = [f'{name}: {row[name]}, {before[name]} before' for name in ('by none',) if row[name] > int(before[name])]
    if row['goals'] < int(before['goals']):
        wrong.append(f'goals: {row["goals"]}, {before["goals"]} before')
    return wrong


def prove(options):
    for name in options.names:
        if name not in UNITS:
            raise Bad(f'{name}: no such unit')
    units = options.names or [unit for unit in UNITS if unit in QUICK or not options.quick]
    lost, failed, before, total = unproved_facts(), 0, kept(), dict.fromkeys(FIELDS[2:], 0)
    print(''.join(f'{fact} is no lemma of bits.c or words.c: FAILED\n' for fact in lost), end='')
    for unit in units:
        begin = time.monotonic()
        sets = [PROVERS] if options.quick else [(prover,) for prover in PROVERS]
        if unit in ENUMERATED:
            print(f'{unit}: {enumerate_steps(unit, ROOT)}')
        without = QUICK.get(unit, '') if options.quick else ''
        by = {each: run(unit, each, os.path.join(FOLDER, f'{unit}-{"-".join(each)}'), without=without) for each in sets}
        open_goals = sorted(goal for goal in set().union(*by.values()) if not any(g.get(goal) for g in by.values()))
        wrong = [f'{goal}: not proved' for goal in open_goals if (unit, goal) not in remaining.ARGUED]
        if not options.quick:
            wrong += [f'{goal}: contradiction' for goal in run(unit, PROVERS[:1], os.path.join(FOLDER, f'{unit}-smoke'),
                                                               smoke=True)]
            wrong += [f'{goal}: proved now, strike it from remaining.py' for of, goal in remaining.ARGUED
                      if of == unit and goal not in open_goals]
            found_now = {}
            for row in tabulate(unit, by):
                key = unit, row['function']
                found = worse(row, row if options.update and key not in before else before.get(key))
                wrong += [f'{row["function"]}: {line}' for line in found]
                found_now[key] = row
                for name in total:
                    total[name] += row[name]
            if options.update and not wrong:
                before.update(found_now)
                keep(before)
        failed += bool(wrong)
        count = len(set().union(*by.values()))
        print(f'{unit}: {count - len(open_goals)} of {count} goals, {time.monotonic() - begin:.0f} s'
              f'{": FAILED" if wrong else ""}', flush=True)
        print(''.join(f'    {line}\n' for line in wrong), end='')
    if not options.quick:
        print(', '.join(f'{number} {name}' for name, number in total.items()))
    known = {unit for unit, _ in before}
    longer = (sum(unit in known for unit, _ in remaining.ARGUED) >
              sum(int(row['by none']) for row in before.values()))
    print(f'{len(remaining.ARGUED)} goals not discharged are argued in remaining.py'
          f'{": FAILED, more than figures.csv has" if longer else ""}')
    failed += len(lost) + longer
    print(f'{len(units) + len(lost) + longer - failed} passed, {failed} failed')
    return failed


def plant(row):
    """The goals that a fault, planted in a copy, leaves open and that were proved before."""
    name, unit, file, function, old, new, sees = row
    root = os.path.join(FOLDER, 'planted')
    shutil.rmtree(root, ignore_errors=True)
    for part in ('include', os.path.join('src', 'codec'), os.path.join('tests', 'verify', 'proof', 'wp')):
        shutil.copytree(os.path.join(ROOT, part), os.path.join(root, part))
    path = os.path.join(root, file)
    text = read(path)
    if file.endswith('.c'):
        text = c_text.replace(text, [(function, old, new)])
    elif text.count(old) == 1:
        text = text.replace(old, new)
    else:
        raise Bad(f'{name}: not there once: {old}')
    write(path, text)
    if sees == 'enumeration':
        try:
            enumerate_steps(unit, root)
        except Bad as error:
            return [str(error)]
        return []
    goals = run(unit, PROVERS, os.path.join(root, 'build'), root, sees, smoke=not file.endswith('.c'))
    return sorted(goal for goal, who in goals.items() if not who and (unit, goal) not in remaining.ARGUED)


def self_test(names):
    rows = [row for row in faults.ROWS if not names or any(name in row[0] for name in names)]
    if not rows:
        raise Bad('no such row')
    failed = 0
    for row in rows:
        seen = plant(row)
        failed += not seen
        print(f'{row[0]}: {" ".join(seen[:3]) if seen else "FAILED: not seen"}', flush=True)
    print(f'{len(rows) - failed} passed, {failed} failed')
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--update', action='store_true')
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('names', nargs='*')
    options = parser.parse_args()
    try:
        return 1 if (self_test(options.names) if options.self_test else prove(options)) else 0
    except (Bad, c_text.NotThere) as error:
        print(f'wp.py: {error}\n0 passed, 1 failed')
        return 1


if __name__ == '__main__':
    sys.exit(main())
