#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what Fathom costs and prints it beside its bounds.

    run.py              prints the tables; fails only if something could not be measured
    run.py --check      also fails if a figure is over that of the last release, by tests/support/bounds.py, or if the
                        tables of include/COST.md and of the first page have other rows or columns
    run.py --update     for a release: also writes figures.csv, sizes.csv and these tables
    run.py --csv FILE   also writes the figures as CSV
    run.py --functions  also prints what each function of the job costs
    run.py --chains     also prints the calls that lead to the worst stack of each row

The first table is the job's (job.py). The second one has flash, RAM and stack of each part of the library on each
microcontroller (sizes.py).
"""
import argparse
import sys
import tempfile

import report
from job import ROWS, measure_arm, measure_avr, measure_units, measure_x86
from sizes import measure_sizes
from tools import Failed, versions


def measure(work):
    """Figures, functions, sizes, variables and chains; what could not be measured is missing."""
    figures, functions, of_sizes = {}, {}, ({}, {}, {})
    for part in (measure_arm, measure_avr, measure_x86, measure_units):
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
    parser.add_argument('--check', action='store_true', help='fail if a figure is over that of the last release')
    parser.add_argument('--update', action='store_true', help='write the figures of a release')
    parser.add_argument('--functions', action='store_true', help='print which function costs what')
    parser.add_argument('--chains', action='store_true', help='print which calls take the worst stack')
    parser.add_argument('--csv', metavar='FILE', help='write the tables there as CSV')
    options = parser.parse_args()

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
    before, compilers = report.kept_figures()
    lines = report.problems(report.all_figures(figures, sizes), before, compilers, versions())
    lines += report.not_in_pages(figures, sizes)
    print(*lines, f'{len(lines)} problems', sep='\n')
    return 1 if lines else 0


if __name__ == '__main__':
    sys.exit(main())
