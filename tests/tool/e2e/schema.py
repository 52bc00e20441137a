# SPDX-License-Identifier: MIT
"""JSON of the tool against examples/fathom/schema.json: the keywords of JSON Schema that this file uses."""
import functools
import json
import os
import re

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, '..', '..', '..', 'examples', 'fathom', 'schema.json')
TYPES = {'null': type(None), 'boolean': bool, 'string': str, 'array': list, 'object': dict, 'integer': int,
         'number': (int, float)}
# Not applied to values: words for people, and places for references.
SILENT = {'$schema', '$defs', 'title', 'description'}


@functools.cache
def schema():
    with open(FILE, encoding='utf-8') as file:
        return json.load(file)


def is_of(value, name):
    return isinstance(value, TYPES[name]) and not (isinstance(value, bool) and name in ('integer', 'number'))


def object_problems(value, rule):
    properties = rule.get('properties', {})
    yield from (f'{key} is missing' for key in rule.get('required', ()) if key not in value)
    for key, member in value.items():
        other = rule.get('additionalProperties', True)
        if key not in properties and other is False:
            yield f'{key} is unknown'
        elif key in properties or other is not True:
            yield from (f'{key}: {problem}' for problem in problems(member, properties.get(key, other)))


def problems(value, rule):
    """Yields what does not fit. A keyword that this function does not know is an error of the schema."""
    known = {'$ref', 'anyOf', 'type', 'enum', 'pattern', 'minimum', 'maximum', 'items', 'required', 'properties',
             'additionalProperties'}
    assert set(rule) <= known | SILENT, set(rule) - known - SILENT
    names = rule.get('type', [])
    names = [names] if isinstance(names, str) else names
    if '$ref' in rule:
        yield from problems(value, schema()['$defs'][rule['$ref'].split('/')[-1]])
    if 'anyOf' in rule and not any(next(problems(value, one), None) is None for one in rule['anyOf']):
        yield 'fits no kind of record'
    if names and not any(is_of(value, name) for name in names):
        yield f'{value!r} is no {" or ".join(names)}'
    elif 'enum' in rule and value not in rule['enum']:
        yield f'{value!r} is none of {rule["enum"]}'
    elif isinstance(value, str) and re.search(rule.get('pattern', ''), value) is None:
        yield f'{value!r} does not match {rule["pattern"]}'
    elif is_of(value, 'number') and not rule.get('minimum', value) <= value <= rule.get('maximum', value):
        yield f'{value} is out of range'
    elif isinstance(value, list):
        yield from (problem for one in value for problem in problems(one, rule.get('items', {})))
    elif isinstance(value, dict):
        yield from object_problems(value, rule)


def names():
    """All kinds of records."""
    return [one['$ref'].split('/')[-1] for one in schema()['anyOf']]


def kinds(value):
    """The kinds of records that a value is."""
    return [name for name in names() if next(problems(value, schema()['$defs'][name]), None) is None]


def expect_record(line):
    """Fails unless the line is a record of one kind."""
    value = json.loads(line)
    if len(kinds(value)) == 1:
        return
    wrong = {name: [*problems(value, schema()['$defs'][name])] for name in names()}
    nearest = min(wrong, key=lambda name: len(wrong[name]))
    raise AssertionError(f'{line}\nis {kinds(value)} by {FILE}; the nearest kind is {nearest}: {wrong[nearest]}')


def expect_records(text):
    """The same for every line of a text that is a whole object."""
    for line in text.splitlines(keepends=True):
        if line.startswith('{') and line.endswith('}\n'):
            expect_record(line)
