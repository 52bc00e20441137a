# SPDX-License-Identifier: MIT
"""Shows that each gate can fail: faults in a copy of the tree, each of which has to be told by that gate, and figures."""
import collections
import contextlib
import io
import os
import shutil

import c_code
import machine_code
import run

Fault = collections.namedtuple('Fault', 'what path old new told')  # new None: the file is deleted

FAULTS = (
    Fault('a condition in src/ that never decides', 'src/sensor/median.c', '|| !is_full(median)) return false;',
          '|| !is_full(median) || (median->have > median->config.count)) return false;', ('src/sensor/median.c', 'condition 3')),
    Fault('a decision that clang cannot instrument', 'src/engine/modbus_unit.c', '&& !is_anothers)',
          '&& !(is_command && is_kept_out))', ('src/engine/modbus_unit.c', 'unsupported MC/DC')),
    Fault('a branch in port/posix that nothing takes', 'port/posix/uart.c',
          'if (port == NULL) return FATHOM_POSIX_ERR_ARGUMENT;',
          'if (port == NULL) return FATHOM_POSIX_ERR_ARGUMENT;\n    if (settings == (const void *)port) return FATHOM_POSIX_OK;',
          ('branch true', 'settings == (const void *)port')),
    Fault('a line of port/serial that nothing reaches', 'port/serial/fathom_serial.h',
          '    const uint8_t at = serial->at;\n',
          '    const uint8_t at = serial->at;\n    if (at == 251)\n        serial->lost = true;\n',
          ('port/serial/fathom_serial.h', 'the line of', 'serial->lost = true')),
    Fault('a test is deleted: the rule of the relay', 'tests/unit/test_a05_relay_rule.c', '', None,
          ('src/sensor/a05_relay_rule.c', 'no test executes')),
    Fault('a test is deleted: refused settings', 'tests/port/test_posix_refused.c', '', None,
          ('port/posix/settings.c', 'no test executes')),
)

COPIED = ('CMakeLists.txt', 'CMakePresets.json', 'README.md', 'include', 'src', 'port', 'examples', 'tests')


def copy(root, tree):
    for name in COPIED:
        source, target = os.path.join(root, name), os.path.join(tree, name)
        if os.path.isdir(source):
            shutil.copytree(source, target, dirs_exist_ok=True)
        else:
            os.makedirs(tree, exist_ok=True)
            shutil.copy2(source, target)
    for fault in FAULTS:  # those of the last run are in objects that are newer
        os.utime(os.path.join(tree, fault.path))


def plant(tree, fault):
    path = os.path.join(tree, fault.path)
    with open(path, encoding='utf-8') as file:
        text = file.read()
    if fault.new is None:
        os.remove(path)
        return
    if fault.old not in text:
        raise c_code.Broken(f'{fault.path} has no "{fault.old}" any more')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text.replace(fault.old, fault.new, 1))


def profile_of_another_build(tree, built, profile):
    """What is said of these programs with the profile of others."""
    programs = [name for name in os.listdir(os.path.join(built, 'tests')) if name in ('test_unit', 'test_port')]
    try:
        c_code.files_of(tree, built, programs, profile)
    except c_code.Broken as error:
        return str(error).strip()
    return ''


def problems_of(tree, folder, jobs):
    verdict = run.Verdict()
    files, unsupported = c_code.measure(tree, folder, jobs)
    with contextlib.redirect_stdout(io.StringIO()):
        run.judge_c(verdict, files, unsupported)
    return verdict.problems, files, unsupported


def self_test(verdict, root, jobs):
    folder = os.path.join(root, 'build-mcdc-self')
    tree = os.path.join(folder, 'tree')
    shutil.rmtree(tree, ignore_errors=True)
    copy(root, tree)
    built = os.path.join(folder, 'build')
    whole = os.path.join(root, 'build-mcdc')
    problems, files, unsupported = problems_of(root, whole, jobs)
    if not verdict.check('without a fault all is well', problems):
        return
    # All at once: each is told by itself, and one of these runs takes as long as all of the tests in C.
    for fault in FAULTS:
        plant(tree, fault)
    problems, _, _ = problems_of(tree, built, jobs)
    for fault in FAULTS:
        told = [problem for problem in problems if all(text in problem for text in fault.told)]
        verdict.check(f'seen: {fault.what}: {told[0] if told else ""}',
                      [] if told else [f'{fault.told} is not told, but: {problems}'])
    told = profile_of_another_build(tree, built, os.path.join(whole, 'profiles', 'all.profdata'))
    verdict.check(f'seen: counters of another build: {told}', [] if 'profile data' in told else ['it is not told'])
    # Gates on lists and figures.
    again = run.Verdict()
    with contextlib.redirect_stdout(io.StringIO()):
        run.judge_c(again, files, unsupported, {('src/sensor/median.c', 'line', 'gone'): 'none'})
    verdict.check('seen: an entry of impossible.py that is not needed',
                  [] if any('gone' in problem for problem in again.problems) else ['it is not told'])
    for name, missed in (('figures.csv', run.c_missed), ('machines.csv', run.machine_missed)):
        kept = run.read_rows(os.path.join(run.HERE, name))
        for path, row in list(kept.items())[:1]:
            worse = tuple(value + (i % 2 == 1 if missed is run.c_missed else -(i % 2 == 1)) for i, value in enumerate(row))
            told, _ = run.compare(kept, {**kept, path: worse}, missed)
            verdict.check(f'seen: a figure of {name} that is worse', [] if told else ['it is not told'])
            told, _ = run.compare(kept, {other: kept[other] for other in kept if other != path}, missed)
            verdict.check(f'seen: a file that is gone from {name}', [] if told else ['it is not told'])
    traces = os.path.join(root, 'build-mcdc-traces')
    build = os.path.join(root, 'build-gcc')
    if not os.path.isdir(traces):
        verdict.check('the firmware tests have been traced', [f'run --machines first: {traces} is not there'])
        return
    # A firmware test is deleted: what it left is, and so the ports that only it has run.
    kept = run.read_rows(os.path.join(run.HERE, 'machines.csv'))
    fewer = os.path.join(folder, 'traces')
    shutil.rmtree(fewer, ignore_errors=True)
    shutil.copytree(traces, fewer)
    for name in os.listdir(fewer):
        with open(os.path.join(fewer, name), errors='replace', encoding='utf-8') as file:
            if name.endswith('.trace') and file.readline().strip().endswith('/settings.elf'):
                os.remove(os.path.join(fewer, name))
    told, _ = run.compare(kept, machine_code.measure(root, build, fewer), run.machine_missed)
    verdict.check(f'seen: the tests of the images "settings" are deleted: {told[0] if told else ""}',
                  [] if told else ['it is not told'])
