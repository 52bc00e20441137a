# SPDX-License-Identifier: MIT
"""What can be changed in an expression, and how."""
import re

from clang.cindex import CursorKind as Kind, TypeKind

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
NAME = re.compile(r'[A-Za-z_]\w*')


class Expressions:
    """A text, and the changes that were found in it."""

    def __init__(self, text, code):
        self.text = text
        self.code = code  # the text without its comments; offsets are the same
        self.macros = []  # where they are used
        self.made = {}  # (start, end, new): (operator, function, context)
        self.function = ''
        self.context = (0, 0, None)  # from, to, and what to say in place of the tokens

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
