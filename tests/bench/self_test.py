# SPDX-License-Identifier: MIT
"""The comparison of the figures and the walk along the stack see what they are there for."""
import os
import tempfile

from job import ROWS
from report import (FOOTPRINTS, PLACES, all_figures, beside_bound, bounds, pattern, tables, verdict, worse,
                    worse_sizes)
from sizes import HEAD, rows
from stack import Image, arm, avr, riscv
from tools import MACHINES, ROOT, Failed


def figures():
    same = dict.fromkeys(ROWS, 100)
    assert worse(same, same, 'gcc 1', 'gcc 1') == []
    assert len(worse(same, same, 'gcc 1', 'gcc 2')) == 1
    for name in same:
        assert len(worse(dict(same, **{name: 101}), same, 'gcc 1', 'gcc 1')) == 1
        assert len(worse(same, {k: v for k, v in same.items() if k != name}, 'gcc 1', 'gcc 1')) == 1
    assert verdict(101, 100) == 'MISSED by 1' and verdict(100, 100) == 'met' and verdict(100, None) == ''
    assert beside_bound(101, 'B', 100) == '101 B, over 100' and beside_bound(100, 'B', 100) == '100 B, 100'


def sizes():
    same = {(row, machine.name): dict.fromkeys(HEAD, 100) for row in rows() for machine in MACHINES}
    costs = dict.fromkeys(ROWS, 100)
    assert worse_sizes(same, same) == []

    def found(*measured):
        """What is found in pages that keep what was measured"""
        return [pattern(name).findall(f'<!-- {name}: kept by tests/bench/run.py --update -->\n{table}<!-- end -->')
                for (_, name), table in zip(PLACES, tables(*measured))]

    kept = [[table] for table in tables(costs, same)]
    assert found(costs, same) == kept
    for name in ROWS:
        assert found(dict(costs, **{name: 101}), same)[0] != kept[0], name
    assert found(dict(costs, **{'job.m0_flash_256': 101}), same)[2] != kept[2]
    for row in FOOTPRINTS:
        assert found(costs, {**same, (row, 'm0'): dict.fromkeys(HEAD, 101)})[3] != kept[3], row
    for place, size in same.items():
        for what in HEAD:
            other = {**same, place: dict(size, **{what: 101})}
            assert len(worse_sizes(other, same)) == 1
            assert found(costs, other) != kept
        less = {key: value for key, value in same.items() if key != place}
        assert len(worse_sizes(same, less)) == len(HEAD)
        assert len(worse_sizes(less, same)) == 1
    # The worst of all drivers is of one of them, and each bound is of something that is measured.
    assert all_figures(costs, {**same, ('a16_auto', 'm0'): dict.fromkeys(HEAD, 102)})['any driver.m0.stack'] == 102
    assert all_figures(costs, {**same, ('everything', 'm0'): dict.fromkeys(HEAD, 102)})['any driver.m0.stack'] == 100
    assert set(bounds()) <= set(all_figures(costs, same))
    # Each sensor's header has a row of its own name.
    for name in os.listdir(os.path.join(ROOT, 'include', 'fathom')):
        if name.startswith(('a16_', 'a05_', 'hps167s')):
            assert name[:-2] in rows(), name


class Disassembly(Image):
    """An image of a listing instead of a file."""

    def __init__(self, prefix, text):
        self.text = text
        super().__init__(prefix, text)

    def list(self, elf):
        return self.text


def depth(prefix, text, source='', chain=False):
    """Below the function at 0, or the calls that lead so deep; or why that is not known."""
    with tempfile.NamedTemporaryFile('w', suffix='.c') as file:
        file.write(source)
        file.flush()
        try:
            image = Disassembly(prefix, text.replace('SOURCE', file.name))
            return image.chain([0]) if chain else image.deepest(0)
        except Failed as why:
            return str(why)


def listing(*functions):
    """(address, name, [instruction, ...]): each instruction of two bytes"""
    lines = []
    for address, name, instructions in functions:
        lines.append(f'{address:08x} <{name}>:')
        for text in instructions:
            if text.startswith('/') or text.startswith('SOURCE'):
                lines.append(text)
            else:
                lines.append(f'   {address:x}:\t00 00 \t' + text.replace(' ', '\t', 1))
                address += 2
    return '\n'.join(lines)


def stack():
    leaf = (0x40, 'leaf', ['push {r4, r5, r6, lr}', 'sub sp, #8', 'add sp, #8', 'pop {r4, r5, r6, pc}'])
    caller = ['push {r4, lr}', 'bl 40 <leaf>', 'pop {r4, pc}']
    assert depth('arm-', listing((0, 'f', caller), leaf)) == 8 + 24
    assert depth('arm-', listing((0, 'f', caller), leaf), chain=True) == [('f', 8), ('leaf', 24)]
    # A tail call has given back its frame; a branch that skips the push does not count it.
    assert depth('arm-', listing((0, 'f', ['push {r4, lr}', 'pop {r4, lr}', 'b.n 40 <leaf>']), leaf)) == 24
    assert depth('arm-', listing((0, 'f', ['beq.n 4 <f+0x4>', 'push {r4, lr}', 'bl 40 <leaf>']), (6, 'g', ['bx lr']),
                                 leaf)) == 8 + 24
    assert 'recursion' in depth('arm-', listing((0, 'f', ['push {r4, lr}', 'bl 0 <f>', 'pop {r4, pc}'])))
    assert 'for ever' in depth('arm-', listing((0, 'f', ['push {r4, lr}', 'b.n 0 <f>'])))
    assert 'what does this do' in depth('arm-', listing((0, 'f', ['mov sp, r3'])))
    assert depth('riscv64-', listing((0, 'f', ['add sp,sp,-32', 'jal 40 <leaf>', 'add sp,sp,32', 'ret']),
                                     (0x40, 'leaf', ['add sp,sp,-16', 'add sp,sp,16', 'ret']))) == 32 + 16
    # AVR: the return address, two pushes, Y for a frame of 12, and a call that pushes another return address.
    frame = ['push r28', 'push r29', 'in r28, 0x3d', 'in r29, 0x3e', 'sbiw r28, 0x0c', 'out 0x3e, r29',
             'out 0x3d, r28', 'call 0x40 ; 0x40 <leaf>', 'adiw r28, 0x0c', 'out 0x3d, r28', 'pop r29', 'pop r28',
             'ret']
    assert depth('avr-', listing((0, 'f', frame), (0x40, 'leaf', ['push r1', 'pop r1', 'ret']))) == 2 + 2 + 12 + 3
    assert depth('avr-', listing((0, 'f', ['rcall .+0 ; 0x2 <f+0x2>', 'pop r0', 'pop r0', 'ret']))) == 2 + 2
    # Indirect calls: to what the table says of what is linked, to the user, to nowhere that is known.
    there = ['push {r4, lr}', 'SOURCE:1', 'blx r3', 'pop {r4, pc}']
    target = (0x40, 'poll', [os.path.join(ROOT, 'src', 'engine', 'modbus.c') + ':16', *leaf[2]])
    assert depth('arm-', listing((0, 'f', there), target), 'transport->poll(transport->ctx);') == 8 + 24
    assert 'leads to none of' in depth('arm-', listing((0, 'f', there)), 'transport->poll(transport->ctx);')
    assert depth('arm-', listing((0, 'f', there)), 'uart->sent(uart->ctx);') == 8
    assert 'where does this' in depth('arm-', listing((0, 'f', there)), 'x->whatever(x);')
    assert depth('arm-', listing((0, 'f', there)), 'const uint32_t now = clock_us(line->clock);') == 8
    inside = ['push {r4, lr}', 'SOURCE:4', 'blx r3', 'pop {r4, pc}']
    assert depth('arm-', listing((0, 'f', inside), target), 'int f(void)\n{\nint x;\n{\ntransport->poll(0);\n}\n') == 8 + 24
    for decode, text in ((arm, ('sub', 'sp, r1')), (riscv, ('mv', 'sp,a0'))):
        try:
            decode(*text)
            raise AssertionError(text)
        except Failed:
            pass
    try:
        avr('out', '0x3d, r30', 0, 2)
        raise AssertionError('SPL')
    except Failed:
        pass


def run():
    figures()
    sizes()
    stack()
    print('self-test passed')
    return 0
