# SPDX-License-Identifier: MIT
"""The instructions of an image, and which of them have to be broken into."""
import re
import subprocess


def said(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def leave_out_padding(code):
    """The nop that stands only for the address of what comes behind a jump or a return."""
    addresses = sorted(code)
    for before, address in zip(addresses, addresses[1:]):
        if code[address] == 'nop' and re.match(r'bx\s|b\.n\s|pop\s.*pc', code[before]):
            del code[address]


class Image:
    def __init__(self, machine, path):
        """functions: [(name, {address: instruction})]; two may have one name."""
        self.functions, self.machine = [], machine
        for line in said(machine.OBJDUMP, '-d', path).splitlines():
            head = re.match(r'[0-9a-f]+ <(.+)>:$', line)
            code = re.match(r' *([0-9a-f]+):\t(?:[0-9a-f]+ )+\s*([^;@]*)', line)
            if head:
                self.functions.append((head[1], {}))
            elif code and self.functions and not code[2].startswith('.'):  # literals of a Cortex-M
                self.functions[-1][1][int(code[1], 16)] = ' '.join(code[2].split())
        for _, instructions in self.functions:
            leave_out_padding(instructions)

    def where(self, address):
        for name, code in self.functions:
            if address in code:
                return f'{name}+0x{address - min(code):x} ({code[address]})'
        return f'0x{address:x}'

    def wanted(self, objects):
        """(names of the port's functions, [what is wrong with the lists of the machine])"""
        defined = set()
        for path in objects:
            defined |= set(re.findall(r'^[0-9a-f]+ [tT] (\w+)$', said(self.machine.NM, path), re.M))
        gone = sorted(set(self.machine.LEFT_OUT) - defined)
        return defined - set(self.machine.LEFT_OUT), [f'{name} is left out, and is no function of the port'
                                                      for name in gone]

    def missed(self, objects, covered):
        """(instructions that have to be broken into, [those that were not, and what else is wrong])"""
        names, wrong = self.wanted(objects)
        reasons, count = dict(self.machine.UNREACHED), 0
        for name in sorted(names):
            codes = [code for function, code in self.functions if function == name]
            if not codes:
                wrong.append(f'{name} of the port is not in the image: no scenario calls it')
            for code in codes:
                count += len(code)
                for address, text in code.items():
                    if address not in covered and not reasons.pop((name, text), None):
                        wrong.append(f'no interrupt came before {self.where(address)}')
        return count, wrong + [f'{key}: was broken into after all, or is not there' for key in reasons]
