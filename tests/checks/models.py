#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The declarations in include/fathom/models.h and the tables in src/models/README.md are made of the rows in src/models:
a model is added in one file. Each row has a comment with its source above it, and a name that belongs to no other model.

    models.py              fails unless header and page have what the rows say
    models.py --update     writes them

The C compiler reads the rows, and a program that is made of them prints them."""
import os
import re
import sys
import tempfile

from common import ROOT, files, main, read, run

FOLDER, HEADER, PAGE = 'src/models', 'include/fathom/models.h', 'src/models/README.md'
BETWEEN = r'(?s)(?<={0}: kept by tests/checks/models.py --update {1}\n).*?(?={2}end {1})'
PLACES = {HEADER: BETWEEN.format(r'/\* models', r'\*/', r'/\* '), PAGE: BETWEEN.format('<!-- models', '-->', '<!-- ')}

ROW = re.compile(r'^ *ROW\((\w+),', re.M)
SOURCED = re.compile(r'\*/ \\\n *ROW\((\w+),')
TITLES = {'a16_family': 'DYP', 'jsn_family': 'JSN-SR04T, AJ-SR04M, HC-SR04 and their like', 'a05_family': 'A05',
          'hps_family': 'HPS-167S, HPS-167'}
MODES = ('', 'automatic', 'controlled', 'pulse', 'free-running pulse', 'Modbus', '55 AA', '0A')
SPECIAL = ('FFFB', 'FFFD', 'FFFE', 'FFFF', '0')
MEANINGS = {2: 'no target', 3: 'fault', 4: 'too near', 6: 'unknown', 7: 'interference', 8: 'refused'}

PROGRAM = """
#include "fathom/models.h"
#include <stdio.h>
#include <string.h>
%s
static const struct { const char *id; const fathom_model_facts_t *facts; } ids[] = {%s};
int main(void)
{
    const fathom_model_description_t *row;
    for (uint16_t i = 0; (row = fathom_model_at(i)) != NULL; i++) {
        const fathom_model_facts_t *const f = row->facts;
        const fathom_line_settings_t none = {0}, *const l = f->line_settings != NULL ? f->line_settings : &none;
        for (size_t k = 0; k != sizeof ids / sizeof *ids; k++)
            if (ids[k].facts == f) printf("%%s", ids[k].id);
        printf("\\t%%s\\t%%s\\t%%s\\t%%s\\t%%d\\t%%d", row->name, row->aliases, row->maker, row->note, row->mode, row->is_certain);
        printf("\\t%%lu %%d%%c%%d", (unsigned long)l->baud, 8, "NEO"[l->parity], l->stop_bits);
        printf("\\t%%d\\t%%d\\t%%d\\t%%d\\t%%d\\t%%d", f->min_mm, f->max_mm, f->period_ms, f->trigger_us, f->us_per_dm, f->start);
        printf("\\t%%d\\t%%d\\t%%d\\t%%d\\t%%d", f->trigger_byte, f->earliest_ms, f->latest_ms, f->no_target_ms, f->registers);
        printf("\\t%%d %%d %%d %%d %%d\\n", f->value_fffb, f->value_fffd, f->value_fffe, f->value_ffff, f->value_0);
    }
    return 0;
}
"""
COLUMNS = ('id name aliases maker note mode is_certain line min max period trigger scale start byte earliest latest '
           'no_target registers special').split()


def rows(root):
    """(dictionaries in the order of the list, problems)"""
    sources = files(root, FOLDER, ends='.c')
    problems, owner = [], {}
    for path in sources:
        text = read(root, path)
        problems += [f'{path}: {row} has no comment with its source' for row in ROW.findall(text)
                     if row not in SOURCED.findall(text)]
        owner.update(dict.fromkeys(ROW.findall(text), os.path.basename(path)[:-2]))
    with tempfile.TemporaryDirectory() as work:
        program = os.path.join(work, 'rows')
        with open(program + '.c', 'w', encoding='utf-8') as file:
            file.write(PROGRAM % ('\n'.join(f'extern const fathom_model_facts_t fathom_model_{row};' for row in owner),
                                  ', '.join(f'{{"{row}", &fathom_model_{row}}}' for row in owner)))
        good, said = run(['gcc', '-std=c99', '-Iinclude', program + '.c', *sources, 'src/sensor/factory_line.c', '-o',
                          program], root)
        if good:
            good, said = run([program], root)
    if not good:
        return [], [f'{FOLDER}: the rows do not compile:\n{said}']
    found = [dict(zip(COLUMNS, line.split('\t'))) for line in said.splitlines()]
    for row in found:
        row['source'] = owner.get(row['id'], '')
    if len(found) != len(owner):
        problems.append(f'{FOLDER}: {len(owner)} rows, but {len(found)} in the list: a table is not in models.c')
    return found, problems + list(unique(found))


def plain(name):
    return re.sub(r'[^A-Z0-9]', '', name.upper())


def unique(found):
    owners, modes = {}, set()
    for row in found:
        where = f'{FOLDER}/{row["source"]}.c: {row["id"]}'
        if (row['name'], row['mode']) in modes:
            yield f'{where}: {row["name"]} has this mode already'
        modes.add((row['name'], row['mode']))
        for name in filter(None, [row['name'], *row['aliases'].split(', ')]):
            if owners.setdefault(plain(name), row['name']) != row['name']:
                yield f'{where}: {name} is a name of {owners[plain(name)]} too'


def line_of(row):
    return '' if row['line'].startswith('0 ') else row['line']


def start_of(row):
    if row['start'] == '0':
        return ''
    return f'byte {int(row["byte"]):02X}' if row['start'] == '2' else \
        f'{"high" if row["start"] == "3" else "low"} for {row["trigger"]} us'


def more_of(row):
    """What differs from the defaults."""
    parts = [row['note']] if row['note'] else []
    parts += [f'{value} is {MEANINGS.get(int(means), "WRONG")}' for value, means in zip(SPECIAL, row['special'].split())
              if means != '0']
    parts += [f'{int(row["scale"]) / 10:g} us for each cm'] if row['scale'] != '0' else []
    parts += [f'{row["no_target"]} ms is no target'] if row['no_target'] != '0' else []
    return '; '.join(parts + (['temperature'] if row['registers'] != '0' else []))


def declarations(found):
    for row in found:
        line = ', ' + line_of(row) if line_of(row) else ''
        yield (f'/** @brief {row["name"]}, {MODES[int(row["mode"])]}: {row["min"]} to {row["max"]} mm{line}. */\n'
               f'extern const fathom_model_facts_t fathom_model_{row["id"]};\n')


def page(found):
    for source in dict.fromkeys(row['source'] for row in found):
        yield (f'### {TITLES.get(source, source)}\n\n'
               '| name | also called | mode | range in mm | line | trigger | response in ms | period in ms | remarks | certain '
               '| `fathom_model_` |\n' + '|---' * 11 + '|\n')
        for row in [row for row in found if row['source'] == source]:
            window = f'{row["earliest"]} to {row["latest"]}' if row['latest'] != '0' else ''
            yield '| ' + ' | '.join((
                row['name'], row['aliases'], MODES[int(row['mode'])], f'{row["min"]} to {row["max"]}', line_of(row),
                start_of(row), window, row['period'].replace('0', '', row['period'] == '0'), more_of(row),
                'yes' if row['is_certain'] == '1' else 'one source', f'`{row["id"]}`')) + ' |\n'
        yield '\n'


def made(root):
    """({path: text}, problems)"""
    found, problems = rows(root)
    return {HEADER: ''.join(declarations(found)), PAGE: '\n' + ''.join(page(found))}, problems


def check(root):
    wanted, problems = made(root)
    for path, text in wanted.items():
        has = re.findall(PLACES[path], read(root, path))
        if len(has) != 1:
            problems.append(f'{path}: has {len(has)} places for what the rows say')
        elif has[0] != text:
            line = next((line for line in text.split('\n') if line not in has[0].split('\n')), 'less')
            problems.append(f'{path}: the rows say {line!r}: run tests/checks/models.py --update')
    return problems


def update():
    wanted, problems = made(ROOT)
    for path, text in wanted.items() if not problems else ():
        whole = re.sub(PLACES[path], lambda _, text=text: text, read(ROOT, path), count=1)
        with open(os.path.join(ROOT, path), 'w', encoding='utf-8') as file:
            file.write(whole)
    print('\n'.join(problems))
    return 1 if problems else 0


if __name__ == '__main__':
    if sys.argv[1:] == ['--update']:
        sys.exit(update())
    main(check)
