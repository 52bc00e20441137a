#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What examples/avr/tank.c takes, and what of it the median and the level are.

    tank.py IMAGE    prints lines "figure NAME VALUE UNIT" for figures.py
"""
import re
import subprocess
import sys

# The functions of each module; what they call of the compiler's own is the program's too.
MODULES = {'median': r'fathom_median_\w+', 'level': r'fathom_(level|tank_\w+)'}


def said(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def main():
    image = sys.argv[1]
    text, data, bss = (int(word) for word in said('avr-size', image).splitlines()[1].split()[:3])
    print(f'figure avr_tank_flash {text + data} B')
    print(f'figure avr_tank_ram {data + bss} B')
    functions = re.findall(r'^\w+ (\w+) [Tt] (\w+)$', said('avr-nm', '-S', image), re.M)
    for name, pattern in MODULES.items():
        sizes = [int(size, 16) for size, function in functions if re.fullmatch(pattern, function)]
        if not sizes:
            sys.exit(f'{image} has nothing of {name}')
        print(f'figure avr_tank_{name} {sum(sizes)} B')


if __name__ == '__main__':
    main()
