#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what Fathom costs and prints it against its bounds.

    run.py            prints the tables; exit status 0 unless something could not be measured
    run.py --check    also fails when a figure is worse than the one kept in figures.csv or sizes.csv, or when the
                      tables of README.md here and of the first page are not what is kept
    run.py --update   also keeps today's figures there, and in those tables
    run.py --csv FILE also writes the tables as CSV
    run.py --functions
                      also prints which function of the job costs what
    run.py --chains   also prints the calls that take each row's worst stack, and what each of them takes

The first table is the job's (job.py), against the bounds; the second has flash, RAM and stack of each part of the
library on each microcontroller (sizes.py).
"""
import argparse
import sys
import tempfile

import report
import self_test
from job import ROWS, measure_arm, measure_avr, measure_x86
from sizes import measure_sizes
from tools import Failed, versions


def measure(work):
    """Figures, functions, sizes, variables and chains; what could not be measured is missing."""
    figures, functions, of_sizes = {}, {}, ({}, {}, {})
    for part in (measure_arm, measure_avr, measure_x86):
        try:
            part(work, figures, functions)
        except Failed as why:
            print(f'{part.__name__}: {why}', file=sys.stderr)
    try:
        of_sizes = measure_sizes(work)
    except Failed as why:
        print(f'measure_sizes: {why}', file=sys.stderr)
    return figures, functions, *of_sizes


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--check', action='store_true', help='fail when a figure is worse than the kept one')
    parser.add_argument('--update', action='store_true', help='keep the figures')
    parser.add_argument('--functions', action='store_true', help='print which function costs what')
    parser.add_argument('--chains', action='store_true', help='print which calls take the worst stack')
    parser.add_argument('--self-test', action='store_true', help='show that the comparison works')
    parser.add_argument('--csv', metavar='FILE', help='write the tables there as CSV')
    options = parser.parse_args()

    if options.self_test:
        return self_test.run()
    with tempfile.TemporaryDirectory() as work:
        figures, functions, sizes, variables, chains = measure(work)
    report.show(figures, sizes)
    if options.functions:
        report.show_functions(functions)
    if sizes:
        report.show_sizes(sizes, variables)
    if options.chains:
        report.show_chains(chains)
    if options.csv:
        report.write_csv(options.csv, figures, sizes)
    if len(figures) != len(ROWS) or not sizes:
        return 1
    if options.update:
        report.keep(figures, sizes)
    if not options.check:
        return 0
    made_with, kept_figures, kept_sizes = report.kept()
    lines = report.worse(figures, kept_figures, made_with, versions())
    if made_with == versions():
        lines += report.worse_sizes(sizes, kept_sizes)
    lines += report.not_in_pages(kept_figures, kept_sizes)
    print('\n'.join(lines))
    return 1 if lines else 0


if __name__ == '__main__':
    sys.exit(main())
