# SPDX-License-Identifier: MIT
"""The deepest stack below a function, out of the disassembly of a linked image.

Every path through a function is walked with the depth of the stack at each instruction: push and pop, the pointer's
own arithmetic, and calls, on AVR with the return address that they push. It is exact but for two things: at the jump
table of a switch any instruction behind it may come next; and a call through a pointer leads wherever INDIRECT says,
of what is linked. What it does not know makes it fail. Nothing of the user or the HAL is counted.
"""
import os
import re

from tools import LIBRARY, ROOT, Failed, run

# Where the indirect calls of src/ lead, by the text of the call: file:function of the library.
SENSORS = ('a05_auto', 'a16_auto', 'a16_controlled', 'a16_pwm', 'contact', 'dyp_modbus', 'hps167s', 'hps167s_auto',
           'hps167_uart')
INDIRECT = {
    'transport.submit': ('modbus_client.c:fathom_modbus_client_submit', 'dyp_client.c:fathom_dyp_client_submit',
                          'modbus_client_zero.c:fathom_modbus_client_submit_with_zero', 'a05_dyp.c:submit_either',
                          'hps167_uart.c:submit_frame'),
}
# The same for those that may also lead to the user's code, or nowhere; then nothing is added.
PERHAPS = {
    'setting->read': ('a05_dyp.c:read_address', 'dyp_modbus.c:read', 'hps167s_settings.c:look'),
    'kind->fail_all': ('line_request.c:fail_all',),
    'kind->next': ('line_request.c:next', 'line_turns.c:next'),
    'kind->due_us': ('line_request.c:due_us', 'line_turns.c:due_us'),
    'plain->advance': ('line_request.c:advance',),
    'plain->due_us': ('line_request.c:due_us',),
    'protocol->encode': ('modbus_client.c:fathom_modbus_client_encode', 'dyp_client.c:encode',
                         'hps167_uart.c:encode'),
    'protocol->length': ('modbus_client.c:length', 'modbus_rtu.c:fathom_modbus_rtu_response_length',
                         'dyp_55aa.c:fathom_dyp_55aa_frame_length', 'hps167_frames.c:fathom_hps167_frame_length'),
    'protocol->check': ('crc16.c:fathom_crc16', 'crc16_small.c:fathom_crc16', 'dyp_client.c:check',
                        'hps167_uart.c:check'),
    'protocol->is_request': ('modbus_client.c:fathom_modbus_client_is_request', 'dyp_client.c:is_request',
                             'hps167_uart.c:is_request'),
    'protocol->parse_response': ('modbus_client.c:fathom_modbus_client_parse_response', 'dyp_client.c:parse_response',
                                 'hps167_uart.c:parse_response'),
    'kind->scan': ('line_response.c:fathom_line_scan', 'line_listening.c:scan'),
    'kind->advance': ('line_request.c:advance', 'line_turns.c:advance', 'line_listening.c:advance'),
    'senders->note': ('line_senders.c:note',),
    'senders->slot_in_us': ('line_senders.c:slot_in_us',),
    'senders->take_slot': ('line_senders.c:take_slot',),
    'masters->find_request': ('line_masters.c:find_request',),
    'masters->take_answer': ('line_masters.c:take_answer',),
    'masters->note_unrequested': ('line_masters.c:note_unrequested',),
    'masters->note_lost_bytes': ('line_masters.c:note_lost_bytes',),
    'protocol->may_collide': ('modbus_client.c:fathom_modbus_client_may_collide', 'hps167_uart.c:may_collide'),
    'parts->find_echo': ('line_options.c:fathom_line_find_echo',),
    'parts->marks': ('line_options.c:fathom_line_marks',),
    'parts->count': ('line_options.c:fathom_line_count',),
    'sensor->poll': tuple(f'{name}.c:fathom_{name}_sensor_poll' for name in SENSORS),
    'sensors->due_us': tuple(f'{name}.c:fathom_{name}_sensor_due_us' for name in SENSORS),
    'listener->receive': ('stream.c:fathom_stream_receive', 'a16_controlled.c:receive', 'hps167s_auto.c:receive',
                          'hps167_uart.c:receive'),
    **{f'commands->{name}': (f'modbus_command.c:{name}',) for name in ('is_occupied', 'forget', 'due_us')},
    'sensor->is_new': ('hps167s_info.c:is_new',),
    'sensor->follow': ('hps167s_settings.c:follow',),
    **{f'guard->{name}': (f'line_pins.c:{name}',) for name in ('poll', 'is_clear', 'due_us')},
    'output->set': ('output.c:fathom_output_set_pin', 'output.c:fathom_output_set_break',
                    'line_pins.c:fathom_output_set_line_break'),
    'sensor->heard': ('hps167s_info.c:fathom_hps167s_accept_unsolicited',),
    'capture->arm': ('edges.c:arm',),
    'capture->take': ('edges.c:take',),
    'config->volume': tuple(f'level.c:fathom_tank_{shape}' for shape in ('upright', 'horizontal_cylinder', 'table')),
    **dict.fromkeys(('uart->read', 'uart->write', 'uart->sent', 'uart->set_line', 'uart->set_break',
                     'uart->leaves_in_us', 'turns->asked', 'turns->ended', 'turns->next', 'clock->now_us', 'pin->get',
                     'pin->set'), ()),
}
CALL = re.compile(r'\w+(?:->|\.)\w+(?=\()')
COMMON = os.path.join(ROOT, 'src', 'common.h')
OUTPUT = os.path.join(ROOT, 'include', 'fathom', 'engine', 'output.h')
MOST = 4096  # deeper is a loop that pushes


class Instruction:
    """What an instruction does to the stack, and where it goes on."""

    def __init__(self, text):
        self.text = text
        self.grow = 0         # of the stack, in bytes
        self.target = None    # address that it jumps to or calls
        self.calls = False    # and comes back
        self.indirect = False
        self.goes_on = True   # with the next one
        self.skips = False    # or with the one after it
        self.frame = None     # AVR: how it moves Y, or takes it for the stack pointer


def arm(op, args):
    it = Instruction(f'{op} {args}')
    op = re.sub(r'\.[nw]$', '', op)
    registers = 0
    if '{' in args:
        for part in args[args.index('{') + 1:args.index('}')].split(','):
            first, _, last = part.strip().partition('-')
            registers += 1 if not last else int(last[1:]) - int(first[1:]) + 1
    if op in ('push', 'stmdb') and (op == 'push' or args.startswith('sp!')):
        it.grow = 4 * registers
    elif op in ('pop', 'ldmia') and (op == 'pop' or args.startswith('sp!')):
        it.grow, it.goes_on = -4 * registers, 'pc' not in args
    elif re.match(r'(sub|subw|add|addw)$', op) and re.match(r'sp, (sp, )?#\d+', args):
        size = int(re.search(r'#(\d+)', args)[1])
        it.grow = size if op.startswith('sub') else -size
    elif re.search(r'\[sp, #-?\d+\]!|\[sp\], #-?\d+', args):
        moved = int(re.search(r'#(-?\d+)', args)[1])
        it.grow, it.goes_on = -moved, not args.startswith('pc')
    elif op == 'bl':
        it.target, it.calls = int(args.split()[0], 16), True
    elif op == 'blx':
        it.indirect = it.calls = True
    elif re.match(r'bx', op):
        it.goes_on = op != 'bx'
        it.indirect = args.strip() != 'lr'
    elif op in ('tbb', 'tbh') or (op == 'mov' and args.startswith('pc')):
        it.goes_on, it.indirect = False, True
    elif re.match(r'b(|eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)$|cbn?z$', op):
        it.target, it.goes_on = int(re.search(r'([0-9a-f]+) <', args)[1], 16), op != 'b'
    elif re.match(r'(sp\b|\[sp\]!)', args) and op not in ('cmp', 'str', 'tst'):
        raise Failed(f'what does this do to the stack? {it.text}')
    return it


def riscv(op, args):
    it = Instruction(f'{op} {args}')
    address = re.search(r'([0-9a-f]+) <', args)
    if op in ('add', 'addi') and args.startswith('sp,sp,'):
        it.grow = -int(args.split(',')[2].split()[0])
    elif op in ('jal', 'j') or (op in ('jalr', 'jr') and address):
        it.target, it.calls = int(address[1], 16), op.startswith('jal')
        it.goes_on = it.calls
    elif op in ('jalr', 'jr'):
        it.indirect, it.calls = True, op == 'jalr'
        it.goes_on = it.calls
    elif op == 'ret':
        it.goes_on = False
    elif re.match(r'b(eq|ne|lt|ge|gt|le)u?z?$', op):
        it.target = int(address[1], 16)
    elif re.match(r'sp,', args) and not op.startswith('s'):
        raise Failed(f'what does this do to the stack? {it.text}')
    return it


def avr(op, args, address, size):
    it = Instruction(f'{op} {args}')
    target = re.search(r'; 0x([0-9a-f]+)', args)
    plain = args.split(';')[0].strip()
    if op == 'push':
        it.grow = 1
    elif op == 'pop':
        it.grow = -1
    elif op == 'rcall' and int(target[1], 16) == address + size:
        it.grow = 2  # makes room, as "rcall .+0"
    elif op in ('call', 'rcall', 'icall'):
        it.calls, it.indirect = True, op == 'icall'
        it.target = int(target[1], 16) if target else None
    elif op == 'ijmp':
        it.indirect, it.goes_on = True, False
    elif op in ('jmp', 'rjmp') or op.startswith('br'):
        it.target, it.goes_on = int(target[1], 16), op.startswith('br')
    elif op in ('ret', 'reti'):
        it.goes_on = False
    elif op in ('sbrc', 'sbrs', 'sbic', 'sbis', 'cpse'):
        it.skips = True
    elif plain.replace(' ', '') in ('r28,0x3d', '0x3d,r28'):  # SPL
        it.frame = (op, 0)
    elif op in ('sbiw', 'adiw', 'subi', 'sbci') and plain.startswith(('r28', 'r29')):
        it.frame = (op, int(plain.split(',')[1], 16))
    elif op == 'out' and plain.startswith('0x3d'):
        raise Failed(f'what does this do to the stack? {it.text}')
    return it


DECODERS = {'arm': arm, 'riscv': riscv, 'avr': avr}


def statement(path, number):
    """What begins in that line of a source, up to a sign that ends it; '' where there is none."""
    with open(path, encoding='utf-8') as file:
        lines = file.read().splitlines()[number - 1:]
    ends = [i for i, line in enumerate(lines) if re.search('[;{}]', line)]
    return ' '.join(lines[:1 + ends[0]]) if ends else ''


def only_line(path, number):
    with open(path, encoding='utf-8') as file:
        return dict(enumerate(file.read().splitlines(), 1)).get(number, '')


def body(path, number):
    """The function around that line of a source."""
    with open(path, encoding='utf-8') as file:
        lines = file.read().splitlines()
    begins = [i for i, line in enumerate(lines[:number]) if line == '{']
    return ' '.join(lines[begins[-1]:lines.index('}', number)]) if begins else ''


def defines(path, function):
    with open(path, encoding='utf-8') as file:
        return re.search(rf'^\w[^;{{}}()]*\b{function}\([^;{{}}]*\)\n{{', file.read(), re.M)


class Image:
    """The functions of an ELF file, and how deep each of them goes."""

    def __init__(self, prefix, elf):
        self.kind = next(kind for kind in DECODERS if prefix.startswith(kind))
        self.returns = 2 if self.kind == 'avr' else 0  # bytes that a call pushes
        self.instructions, self.next, self.where = {}, {}, {}
        self.owner = {}  # address of an instruction: that of its function
        self.names = {}  # address of a function: file:function, or the function's name alone
        self.depths = {}
        self.deep = {}   # address of a function: its own stack where it goes deepest, and whom it calls there
        self.prefix = prefix
        self.read(self.list(elf))
        self.by_name = {name: address for address, name in self.names.items()}

    def list(self, elf):
        return run(self.prefix + 'objdump', '-dl', elf)

    def read(self, text):
        function = where = before = None
        for line in text.splitlines():
            label = re.match(r'([0-9a-f]+) <([^>]+)>:$', line)
            code = re.match(r' *([0-9a-f]+):\t([0-9a-f ]+)\t(\S+)\s*(.*)', line)
            source = re.match(r'(/\S+):(\d+)', line)
            if label and not label[2].startswith('.L'):
                function, where = int(label[1], 16), None
                self.names[function] = label[2]
            elif source:
                where = (source[1], int(source[2]))
                if function is not None:
                    file, _, name = self.names[function].rpartition(':')
                    # A function may begin with lines of an inline function of a header.
                    if function not in self.owner and not file or file.endswith('.h') and where[0].endswith('.c'):
                        self.names[function] = f'{self.file(where)}:{name}'
            elif code:
                address, size = int(code[1], 16), len(code[2].replace(' ', '')) // 2
                if before is not None:
                    self.next[before] = address
                self.instructions[address] = (code[3], code[4], size)
                self.where[address], self.owner[address], before = where, function, address

    @staticmethod
    def file(where):
        """Sources of the library by their name, all others by their path."""
        folder, name = os.path.split(os.path.normpath(where[0]))
        return name if folder.startswith(os.path.join(ROOT, 'src')) else os.path.relpath(where[0], ROOT)

    def decode(self, address):
        op, args, size = self.instructions[address]
        if self.kind == 'avr':
            return avr(op, args, address, size)
        return DECODERS[self.kind](op, args)

    def lead_to(self, address):
        """Where the indirect call or jump there may go to."""
        if self.where[address] is None:
            raise Failed(f'an indirect call without a source: {self.names[self.owner[address]]}')
        path, number = self.where[address]
        line = statement(path, number)
        known = [call for call in CALL.findall(line) if call in INDIRECT or call in PERHAPS]
        if not known:  # avr-objdump 2.26 names the header of an inline function for the file around it
            name = self.names[self.owner[address]].split(':')[-1]
            for other in LIBRARY.values():
                if defines(other, name) and CALL.search(statement(other, number)):
                    line = statement(other, number)
            known = [call for call in CALL.findall(line) if call in INDIRECT or call in PERHAPS]
        if not known and line.strip() == '{':  # what was inlined may count as its function's first line
            known = list({call for call in CALL.findall(body(path, number)) if call in INDIRECT or call in PERHAPS})
        if not known and 'output->set(' in only_line(OUTPUT, number):  # an inline function of output.h, like clock_us()
            known = ['output->set']
        if len(known) == 1:
            targets = INDIRECT.get(known[0]) or PERHAPS[known[0]]
            found = [self.by_name[name] for name in targets if name in self.by_name]
            if not found and known[0] in INDIRECT:
                raise Failed(f'{known[0]} leads to none of {", ".join(targets)}')
            return found
        if 'switch' in line and not known:
            return [a for a in self.owner if a > address and self.owner[a] == self.owner[address]]
        # clock_us() of common.h, inlined: by the line that calls it, or by its own line in the file around it
        if not known and ('clock_us(' in line or 'now_us(' in only_line(COMMON, number)):
            return []
        raise Failed(f'{path}:{number}: where does this indirect call lead? {line.strip()}')

    def deepest(self, function, path=()):
        """Bytes below the call of the function at this address; its return address, where it is pushed, included."""
        if function in path:
            names = [self.names[f] for f in (*path, function)]
            raise Failed('recursion: ' + ' > '.join(names))
        if function not in self.depths:
            self.depths[function] = self.walk(function, (*path, function))
        return self.depths[function]

    def walk(self, function, path):
        deepest, seen = (self.returns, None), set()
        todo = [(function, self.returns, None)]  # address, depth, and on AVR the depth that Y stands for
        while todo:
            state = todo.pop()
            if state in seen:
                continue
            seen.add(state)
            address, depth, y = state
            it = self.decode(address)
            if it.frame is not None:
                depth, y = self.move(it.frame, depth, y)
            depth += it.grow
            deepest = max(deepest, (depth, None), key=lambda found: found[0])
            if depth > MOST:
                raise Failed(f'{self.names[function]}: the stack grows for ever')
            goals = [] if it.target is None else [it.target]
            if it.indirect:
                goals = self.lead_to(address)
            onward = []
            if it.calls:
                below = [(depth + self.deepest(goal, path), (depth, goal)) for goal in goals]
                deepest = max([deepest, *below], key=lambda found: found[0])
            else:  # a jump: within the function, or a tail call, which comes back to our caller
                onward = goals
            if it.goes_on:
                onward.append(self.next[address])
                if it.skips:
                    onward.append(self.next[self.next[address]])
            todo += [(a, depth, y) for a in onward]
        self.deep[function] = deepest[1] or (deepest[0], None)
        return deepest[0]

    @staticmethod
    def move(frame, depth, y):
        """Y as the frame pointer of avr-gcc: taken from SP, moved, given back to it."""
        op, value = frame
        if op == 'in':
            return depth, depth
        if y is None:
            return depth, None  # Y is any other register
        if op == 'out':
            return (y + 0x8000) % 0x10000 - 0x8000, y
        if op in ('sbiw', 'adiw'):
            return depth, y + (value if op == 'sbiw' else -value)
        return depth, (y + (value if op == 'subi' else value << 8)) % 0x10000

    def chain(self, functions):
        """Returns the deepest path: [(function, bytes of its own with its return address), ...]"""
        function, found = max(functions, key=self.deepest, default=None), []
        while function is not None:
            frame, goes_to = self.deep[function]
            found.append((self.names[function], frame))
            function = goes_to
        return found

    def users_calls(self, is_user):
        """The functions of the library that the user's call."""
        for address, function in self.owner.items():
            if not is_user(self.names[function]):
                continue
            it = self.decode(address)
            if it.target is None or self.owner.get(it.target) == function:
                continue
            if not is_user(self.names[self.owner[it.target]]):
                yield it.target

    def address_of(self, function):
        """Of a function by its name alone."""
        found = [address for address, name in self.names.items() if name.split(':')[-1] == function]
        if len(found) != 1:
            raise Failed(f'{function} stands in the image {len(found)} times')
        return found[0]
