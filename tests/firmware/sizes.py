#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The flash and RAM of an example, as lines "figure NAME VALUE UNIT" for figures.py.

    sizes.py first CHIP SIZE IMAGE BY_HAND    a complete first program, and what of it the bus of the port costs: BY_HAND
                                              is the image of the same program whose parts are set up by hand
    sizes.py avr_tank SIZE IMAGE              examples/avr/tank.c, and the functions of median and level in it

SIZE is the `size` of the binutils."""
import re
import subprocess
import sys

MODULES = {'median': r'fathom_median_\w+', 'level': r'fathom_(level|tank_\w+)'}


def said(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def print_sizes(name, tool, *images):
    """The flash and the RAM without the stack of the first image; of a second one, what the first has more."""
    sizes = [[int(word) for word in said(tool, image).splitlines()[1].split()[:3]] for image in images]
    pairs = [(text + data, data + bss) for text, data, bss in sizes]
    for what, first, *others in zip(('flash', 'ram'), *pairs):
        print(f'figure {name}_{what} {first} B')
        for other in others:
            print(f'figure {name}_bus_{what} {first - other} B')


def main(what, *arguments):
    if what == 'first':
        print_sizes(f'{arguments[0]}_first', *arguments[1:])
        return
    tool, image = arguments
    print_sizes(what, tool, image)
    functions = re.findall(r'^\w+ (\w+) [Tt] (\w+)$', said('avr-nm', '-S', image), re.M)
    for name, pattern in MODULES.items():
        found = [int(size, 16) for size, function in functions if re.fullmatch(pattern, function)]
        if not found:
            sys.exit(f'{image} has nothing of {name}')
        print(f'figure {what}_{name} {sum(found)} B')


main(*sys.argv[1:])
