#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a complete first program takes, and what of it the bus of the port costs.

    first_sizes.py CHIP SIZE IMAGE BY_HAND    prints lines "figure NAME VALUE UNIT" for figures.py

SIZE is the `size` of the binutils. BY_HAND is the image of the same program whose parts are set up by hand.
"""
import subprocess
import sys


def sizes(tool, image):
    """(flash, RAM without the stack), in bytes."""
    done = subprocess.run([tool, image], stdout=subprocess.PIPE, text=True, check=True)
    text, data, bss = (int(word) for word in done.stdout.splitlines()[1].split()[:3])
    return text + data, data + bss


def main():
    chip, tool, image, by_hand = sys.argv[1:]
    flash, ram = sizes(tool, image)
    other_flash, other_ram = sizes(tool, by_hand)
    print(f'figure {chip}_first_flash {flash} B')
    print(f'figure {chip}_first_ram {ram} B')
    print(f'figure {chip}_first_bus_flash {flash - other_flash} B')
    print(f'figure {chip}_first_bus_ram {ram - other_ram} B')


if __name__ == '__main__':
    main()
