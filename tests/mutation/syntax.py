# SPDX-License-Identifier: MIT
"""Where the syntax tree of a C file can be changed, and how. None of it in a line of the preprocessor; none in the
bound of an array, since what is then written past its end is for the sanitizers, and none in sizeof."""
import os
import re

from clang.cindex import CursorKind as Kind, Index, TranslationUnit, TypeKind

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
INCLUDE = ['include', 'src', 'port', 'port/posix', 'port/libmodbus', '/usr/include/modbus']

BINARY = {
    '<': ('relational', ['<=', '>=']), '<=': ('relational', ['<', '>']),
    '>': ('relational', ['>=', '<=']), '>=': ('relational', ['>', '<']),
    '==': ('relational', ['!=']), '!=': ('relational', ['==']),
    '&&': ('logical', ['||']), '||': ('logical', ['&&']), ',': ('logical', []),
    '+': ('arithmetic', ['-']), '-': ('arithmetic', ['+']), '*': ('arithmetic', ['/']),
    '/': ('arithmetic', ['*']), '%': ('arithmetic', ['/']),
    '+=': ('arithmetic', ['-=']), '-=': ('arithmetic', ['+=']), '*=': ('arithmetic', ['/=']),
    '/=': ('arithmetic', ['*=']), '%=': ('arithmetic', ['/=']),
    '&': ('bitwise', ['|']), '|': ('bitwise', ['&']), '^': ('bitwise', ['|']),
    '<<': ('bitwise', ['>>']), '>>': ('bitwise', ['<<']),
    '&=': ('bitwise', ['|=']), '|=': ('bitwise', ['&=']), '^=': ('bitwise', ['|=']),
    '<<=': ('bitwise', ['>>=']), '>>=': ('bitwise', ['<<=']),
}
UNARY = {'++': ('arithmetic', '--'), '--': ('arithmetic', '++'), '!': ('unary', ''), '~': ('unary', ''),
         '-': ('unary', '')}
NARROWER = {'uint32_t': 'uint16_t', 'uint16_t': 'uint8_t', 'int32_t': 'int16_t', 'int16_t': 'int8_t',
            'uint64_t': 'uint32_t', 'int64_t': 'int32_t', 'size_t': 'uint8_t', 'unsigned': 'uint8_t', 'int': 'int8_t'}
JUMPS = (Kind.RETURN_STMT, Kind.BREAK_STMT, Kind.CONTINUE_STMT)
NAME = re.compile(r'[A-Za-z_]\w*')


def blanked(text):
    """The text without its comments; offsets stay."""
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', lambda found: found[0] if found[0][0] == '"' else
                  re.sub(r'[^\n]', ' ', found[0]), text, flags=re.S)


class Source:
    """One file, and the changes that were found in it."""

    def __init__(self, path, root=ROOT, arguments=None):
        self.path = path
        with open(os.path.join(root, path), encoding='ascii') as file:
            self.text = file.read()
        self.code = blanked(self.text)
        if arguments is None:
            arguments = ['-std=c99', *(f'-I{os.path.join(root, folder)}' for folder in INCLUDE)]
        self.unit = Index.create().parse(os.path.join(root, path), ['-x', 'c', *arguments],
                                         options=TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD)
        errors = [str(found) for found in self.unit.diagnostics if found.severity >= 3]
        if errors:
            raise SystemExit('\n'.join(errors))
        self.macros = []
        self.made = {}  # (start, end, new): (operator, function, context)
        self.function = ''
        self.context = (0, 0, None)  # from, to, and what to say in place of the tokens
        self.returns = False
        for cursor in self.unit.cursor.get_children():
            if cursor.location.file is None or cursor.location.file.name != os.path.join(root, path):
                continue
            if cursor.kind == Kind.MACRO_INSTANTIATION:
                self.macros.append((cursor.extent.start.offset, cursor.extent.end.offset))
            elif cursor.kind == Kind.FUNCTION_DECL and cursor.is_definition():
                self.function = cursor.spelling
                self.returns = cursor.result_type.kind != TypeKind.VOID
                body = list(cursor.get_children())[-1]
                self.statements(body, True)
                self.function = ''
            elif cursor.kind == Kind.VAR_DECL:
                self.variable(cursor)
            elif cursor.kind == Kind.ENUM_DECL:
                self.enumerators(cursor)

    # ---- what is where ----

    def span(self, cursor):
        return cursor.extent.start.offset, cursor.extent.end.offset

    def of(self, cursor):
        start, end = self.span(cursor)
        return self.code[start:end]

    def is_macro(self, cursor):
        """True for one that a macro stands for, None for what is only a part of that."""
        start, end = self.span(cursor)
        for first, last in self.macros:
            if first <= start < last:
                return True if (first, last) == (start, end) and NAME.fullmatch(self.code[first:last]) else None
        return False

    def line(self, offset):
        return self.text.count('\n', 0, offset) + 1

    def make(self, operator, start, end, new):
        old = self.text[start:end]
        if old != new and (start, end, new) not in self.made:
            self.made[start, end, new] = (operator, self.function, self.context)

    def between(self, left, right):
        """Where the operator between two operands is, and which one."""
        start, end = self.span(left)[1], self.span(right)[0]
        found = self.code[start:end].strip()
        start = self.code.index(found, start) if found else start
        return start, found

    # ---- declarations ----

    def enumerators(self, cursor):
        for constant in cursor.get_children():
            self.context = (*self.span(constant), None)
            for value in constant.get_children():
                self.expression(value)

    def variable(self, cursor):
        name = cursor.spelling
        if self.function:
            self.declared_type(cursor)
        values = [child for child in cursor.get_children() if child.kind.is_expression()]
        is_array = cursor.type.kind in (TypeKind.CONSTANTARRAY, TypeKind.INCOMPLETEARRAY)
        for value in values:
            if is_array and value.kind not in (Kind.INIT_LIST_EXPR, Kind.STRING_LITERAL):
                continue
            if not self.function:
                self.context = (*self.span(cursor), name)
            self.value(value, name)

    def value(self, cursor, path):
        if cursor.kind == Kind.INIT_LIST_EXPR and not self.is_macro(cursor):
            for number, child in enumerate(cursor.get_children()):
                self.value(child, f'{path}[{number}]')
        else:
            if not self.function:
                self.context = (*self.span(cursor), path)
            self.expression(cursor)

    def declared_type(self, cursor):
        if cursor.type.kind in (TypeKind.POINTER, TypeKind.CONSTANTARRAY):
            return
        start = self.span(cursor)[0]
        found = re.match(r'(?:(?:static|const|volatile)\s+)*(\w+)', self.code[start:])
        if found and found[1] in NARROWER:
            self.make('type', start + found.start(1), start + found.end(1), NARROWER[found[1]])

    # ---- statements ----

    def statements(self, cursor, is_tail=False):
        """A compound statement; is_tail: nothing of the function comes after it."""
        children = list(cursor.get_children())
        for child in children:
            self.statement(child, is_tail and child is children[-1])

    def statement(self, cursor, is_tail=False):
        kind = cursor.kind
        if kind == Kind.COMPOUND_STMT:
            self.statements(cursor, is_tail)
        elif kind in (Kind.IF_STMT, Kind.SWITCH_STMT, Kind.WHILE_STMT, Kind.DO_STMT, Kind.FOR_STMT):
            self.with_body(cursor, is_tail)
        elif kind in (Kind.CASE_STMT, Kind.DEFAULT_STMT):
            *values, body = cursor.get_children()
            self.context = (self.span(cursor)[0], self.span(body)[0], None)
            for value in values:
                self.expression(value)
            self.statement(body, is_tail)
        elif kind == Kind.DECL_STMT:
            for child in cursor.get_children():
                if child.kind == Kind.VAR_DECL:
                    self.context = (*self.span(child), None)
                    self.variable(child)
                elif child.kind == Kind.ENUM_DECL:
                    self.enumerators(child)
        elif kind != Kind.NULL_STMT and self.is_macro(cursor) is not None:
            start, end = self.span(cursor)
            self.context = (start, end, None)
            is_last_return = kind == Kind.RETURN_STMT and is_tail and self.returns
            is_end = kind == Kind.RETURN_STMT and is_tail and not self.returns
            if kind in JUMPS and not is_last_return and not is_end:
                self.make('jump dropped', start, end, '')
            elif kind.is_expression():
                self.make('statement dropped', start, end, '')
            self.expression(cursor)

    def with_body(self, cursor, is_tail):
        children = list(cursor.get_children())
        start, end = self.span(cursor)
        kind = cursor.kind
        if kind == Kind.DO_STMT:
            body, condition = children
            self.statement(body)
            self.context = (self.span(body)[1], end, None)
            self.condition(condition)
            return
        bodies = children[1:] if kind == Kind.IF_STMT else children[-1:]
        self.context = (start, self.span(bodies[0])[0], None)
        if kind == Kind.FOR_STMT:
            self.for_head(start, children[:-1], self.span(bodies[0])[0])
        elif kind == Kind.SWITCH_STMT:
            self.expression(children[0])
        else:
            self.condition(children[0])
        for body in bodies:
            self.statement(body, is_tail and kind in (Kind.IF_STMT, Kind.SWITCH_STMT))

    def for_head(self, start, parts, end):
        context = self.context
        first = self.code.index(';', start)
        second = self.code.index(';', first + 1)
        for part in parts:
            begin = self.span(part)[0]
            if part.kind == Kind.DECL_STMT:
                for variable in part.get_children():
                    self.context = (*self.span(variable), None)
                    self.variable(variable)
                self.context = context
            elif first < begin < second:
                self.condition(part)
            else:
                if second < begin < end:
                    self.make('statement dropped', *self.span(part), '')
                self.expression(part)

    # ---- expressions ----

    def condition(self, cursor):
        if self.is_macro(cursor) is None:
            return
        start, end = self.span(cursor)
        inner = self.inside(cursor)
        is_turned_elsewhere = inner.kind == Kind.UNARY_OPERATOR and self.of(inner)[0] == '!'
        if inner.kind == Kind.BINARY_OPERATOR:
            operator = self.between(*inner.get_children())[1]
            is_turned_elsewhere = BINARY.get(operator, ('',))[0] == 'relational'
        if not is_turned_elsewhere:
            self.make('condition', start, end, f'!({self.text[start:end]})')
        for constant in ('1', '0'):
            self.make('condition', start, end, constant)
        self.expression(cursor)

    @staticmethod
    def inside(cursor):
        while cursor.kind in (Kind.UNEXPOSED_EXPR, Kind.PAREN_EXPR):
            cursor = next(iter(cursor.get_children()))
        return cursor

    def expression(self, cursor):
        kind = cursor.kind
        macro = self.is_macro(cursor)
        if macro is None or kind == Kind.CXX_UNARY_EXPR:  # sizeof
            return
        children = list(cursor.get_children())
        if macro or kind in (Kind.INTEGER_LITERAL, Kind.CHARACTER_LITERAL):
            self.constant(cursor)
            return
        if kind == Kind.DECL_REF_EXPR:
            self.name(cursor)
        elif kind in (Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.binary(cursor, *children)
        elif kind == Kind.UNARY_OPERATOR:
            self.unary(cursor, children[0])
        elif kind == Kind.CALL_EXPR:
            self.call(cursor)
        elif kind == Kind.CSTYLE_CAST_EXPR:
            found = re.match(r'\(\s*(\w+)\s*\)', self.of(cursor))
            if found and found[1] in NARROWER:
                start = self.span(cursor)[0]
                self.make('type', start + found.start(1), start + found.end(1), NARROWER[found[1]])
        elif kind == Kind.CONDITIONAL_OPERATOR:
            self.condition(children[0])
            children = children[1:]
        for child in children:
            if not child.kind.is_reference():
                self.expression(child)

    def binary(self, cursor, left, right):
        at, operator = self.between(left, right)
        name, others = BINARY.get(operator, ('', []))
        for other in others:
            is_pointer = TypeKind.POINTER in (side.type.get_canonical().kind for side in (left, right))
            if not (is_pointer and name == 'arithmetic' and operator == '+' and left.type.kind != TypeKind.POINTER):
                self.make(name, at, at + len(operator), other)
        if name == 'logical':  # one side alone
            for side in (left, right):
                start, end = self.span(side)
                self.make(name, *self.span(cursor), self.text[start:end])

    def unary(self, cursor, operand):
        (start, end), (first, last) = self.span(cursor), self.span(operand)
        at, after = (last, end) if first == start else (start, first)
        operator = self.code[at:after].strip()
        if operator in UNARY:
            at = self.code.index(operator, at)
            self.make(UNARY[operator][0], at, at + len(operator), UNARY[operator][1])

    def call(self, cursor):
        arguments = [argument for argument in cursor.get_arguments() if self.is_macro(argument) is not None]
        kinds = [argument.type.get_canonical().spelling.removeprefix('const ') for argument in arguments]
        for number, first in enumerate(arguments):
            for other in range(number + 1, len(arguments)):
                if kinds[other] != kinds[number]:
                    continue
                (start, middle), (after, end) = self.span(first), self.span(arguments[other])
                if self.of(first) != self.of(arguments[other]):
                    self.make('arguments', start, end,
                              self.text[after:end] + self.text[middle:after] + self.text[start:middle])

    def constant(self, cursor):
        start, end = self.span(cursor)
        text = self.text[start:end]
        number = re.fullmatch(r'(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)', text)
        if text in ('true', 'false'):
            self.make('constant', start, end, 'false' if text == 'true' else 'true')
        elif number:
            digits = number[1].lower()
            base, form = (16, f'0x{{:0{len(digits) - 2}X}}') if digits[:2] == '0x' else \
                (8, '0{:o}') if digits[0] == '0' and len(digits) > 1 else (10, '{}')
            value = int(digits, base)
            for other in (value + 1, value - 1, 0):
                if other >= 0:
                    self.make('constant', start, end, form.format(other) + number[2])
        elif NAME.fullmatch(text) and text != 'NULL' and cursor.type.get_canonical().kind not in (
                TypeKind.POINTER, TypeKind.RECORD, TypeKind.FUNCTIONPROTO):
            for other in (f'({text} + 1)', f'({text} - 1)', '0'):
                self.make('constant', start, end, other)

    def name(self, cursor):
        """An enumerator's neighbour in its place."""
        found = cursor.referenced
        if found is None or found.kind != Kind.ENUM_CONSTANT_DECL:
            return
        all_of_them = [each for each in found.semantic_parent.get_children() if each.kind == found.kind]
        others = [each for each in all_of_them if each.enum_value != found.enum_value]
        after = [each for each in others if each.enum_value > found.enum_value]
        if others:
            neighbour = min(after or others, key=lambda each: each.enum_value)
            self.make('name', *self.span(cursor), neighbour.spelling)
