# SPDX-License-Identifier: MIT
"""Where the syntax tree of a C file can be changed, and how. None of it in a line of the preprocessor; none in the
bound of an array, since what is then written past its end is for the sanitizers, and none in sizeof."""
import os
import re

from clang.cindex import CursorKind as Kind, Index, TranslationUnit, TypeKind

from expressions import NARROWER, Expressions

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
# What stands there includes headers beside it.
LAYERS = ['src/codec', 'src/engine', 'src/models', 'src/processing', 'src/sensor']
INCLUDE = ['include', 'src', *LAYERS, 'port', 'port/posix', 'port/gpio', 'port/libmodbus', '/usr/include/modbus']

JUMPS = (Kind.RETURN_STMT, Kind.BREAK_STMT, Kind.CONTINUE_STMT)


def blanked(text):
    """The text without its comments; offsets stay."""
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', lambda found: found[0] if found[0][0] == '"' else
                  re.sub(r'[^\n]', ' ', found[0]), text, flags=re.S)


def library(ends=('.c', '.h')):
    """The files of src/."""
    return sorted(os.path.relpath(os.path.join(where, name), ROOT)
                  for where, _, names in os.walk(os.path.join(ROOT, 'src')) for name in names if name.endswith(ends))


class Source(Expressions):
    """One file, and the changes that were found in it."""

    def __init__(self, path, root=ROOT, arguments=None):
        with open(os.path.join(root, path), encoding='ascii') as file:
            text = file.read()
        super().__init__(text, blanked(text))
        if arguments is None:
            arguments = ['-std=c99', *(f'-I{os.path.join(root, folder)}' for folder in INCLUDE)]
        self.unit = Index.create().parse(os.path.join(root, path), ['-x', 'c', *arguments],
                                         options=TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD)
        errors = [str(found) for found in self.unit.diagnostics if found.severity >= 3]
        if errors:
            raise SystemExit('\n'.join(errors))
        self.names = {}  # of what is local to each function
        self.returns = False
        self.header = (0, 0)  # where that is what the present statement depends on
        for cursor in self.unit.cursor.get_children():
            if cursor.location.file is None or cursor.location.file.name != os.path.join(root, path):
                continue
            if cursor.kind == Kind.MACRO_INSTANTIATION:
                self.macros.append((cursor.extent.start.offset, cursor.extent.end.offset))
            elif cursor.kind == Kind.FUNCTION_DECL and cursor.is_definition():
                self.function = cursor.spelling
                self.header = (0, 0)
                self.returns = cursor.result_type.kind != TypeKind.VOID
                self.names[self.function] = frozenset(child.spelling for child in cursor.walk_preorder()
                                                      if child.kind in (Kind.PARM_DECL, Kind.VAR_DECL))
                body = list(cursor.get_children())[-1]
                self.statements(body, True)
                self.function = ''
            elif cursor.kind == Kind.VAR_DECL:
                self.variable(cursor)
            elif cursor.kind == Kind.ENUM_DECL:
                self.enumerators(cursor)

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
            self.header = self.context[:2]
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
            is_last_return = kind == Kind.RETURN_STMT and is_tail and self.returns
            is_end = kind == Kind.RETURN_STMT and is_tail and not self.returns
            if kind in JUMPS and not is_last_return and not is_end:  # of those there are many that look alike
                self.context = (start, end, f'{self.code[slice(*self.header)]} {self.code[start:end]}')
                self.make('jump dropped', start, end, '')
            self.context = (start, end, None)
            if kind.is_expression():
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
        outer = self.header
        for body in bodies:
            self.header = (start, self.span(bodies[0])[0])
            self.statement(body, is_tail and kind in (Kind.IF_STMT, Kind.SWITCH_STMT))
        self.header = outer

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
