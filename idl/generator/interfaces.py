# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Reads .idl files of ROS 2 messages and services, as rosidl_adapter writes them.

That is a small part of IDL: modules, constants, structs of plain fields, typedefs of arrays, and the
annotations @verbatim (comments) and @default. Anything else is a ValueError that names the file.
Needs the standard library only, so that a build needs nothing else.
"""
import ast
import dataclasses
import re

PLAIN, ARRAY, BOUNDED_SEQUENCE, SEQUENCE = range(4)

TOKEN = re.compile(r'//.*|#include\s+"(?P<include>[^"]*)"|(?P<string>"(?:[^"\\\n]|\\.)*")'
                   r'|(?P<word>[\w.:+-]+)|(?P<sign>[{}()\[\]<>;,=@])|\s+|(?P<other>.)')


@dataclasses.dataclass(frozen=True)
class Type:
    """The type of a field. `element` is IDL's word or "pkg/msg/Name"."""
    element: str
    form: int = PLAIN
    capacity: int = 0          # of an array or bounded sequence
    string_capacity: int = 0   # of a bounded string

    @property
    def is_struct(self):
        return '/' in self.element


@dataclasses.dataclass(frozen=True)
class Member:
    """A field or a constant; `value` is a field's default or the constant's value, None without."""
    name: str
    type: Type
    value: str
    comment: tuple


@dataclasses.dataclass(frozen=True)
class Struct:
    name: str                  # "pkg/msg/Name" or "pkg/srv/Name_Request"
    fields: tuple
    constants: tuple
    comment: tuple             # lines
    source: str = dataclasses.field(default='', compare=False)  # text of the file

    @property
    def package(self):
        return self.name.split('/')[0]

    @property
    def short_name(self):
        return self.name.split('/')[-1]

    def references(self):
        """Names of the structs among its fields."""
        return [field.type.element for field in self.fields if field.type.is_struct]


def read(path):
    """The structs of one file, in its order."""
    try:
        text = path.read_text()
        return [dataclasses.replace(struct, source=text) for struct in Parser(text).structs()]
    except (IndexError, ValueError) as error:
        raise ValueError(f'{path}: {error}') from error


def read_all(roots):
    """{name: struct} of all files below some folders: each struct behind those it refers to."""
    ordered = {}

    def add(path):
        structs = read(path)
        for name in sorted({name for struct in structs for name in struct.references()}):
            if name not in ordered:
                add(path_of(name))
        for struct in structs:
            ordered.setdefault(struct.name, struct)

    def path_of(name):
        found = [root / f'{name}.idl' for root in roots if (root / f'{name}.idl').exists()]
        if not found:
            raise ValueError(f'no file {name}.idl')
        return found[0]

    for root in roots:
        for path in sorted(root.glob('*/*/*.idl')):
            add(path)
    return ordered


class Parser:
    def __init__(self, text):
        matches = [match for match in TOKEN.finditer(text) if match.lastgroup]
        self.tokens = [match[0] for match in matches if match.lastgroup != 'include']
        self.arrays = {}       # typedefs: name -> Type
        self.constants = {}    # of a struct, by its name
        self.found = []

    def structs(self):
        while self.tokens:
            self.definition([])
        return self.found

    def take(self, expected=None):
        token = self.tokens.pop(0)
        if expected is not None and token != expected:
            raise ValueError(f"'{token}' where '{expected}' was expected")
        return token

    def definition(self, modules):
        """A module, typedef or struct in modules of these names."""
        annotations = self.annotations()
        word = self.take()
        if word == 'module':
            name = self.take()
            self.block(lambda: self.constant(name) if name.endswith('_Constants')
                       else self.definition([*modules, name]))
        elif word == 'typedef':
            element, name = self.type(), self.take()
            self.take('[')
            self.arrays[name] = dataclasses.replace(element, form=ARRAY, capacity=int(self.take()))
            self.take(']')
        elif word == 'struct':
            name, fields = self.take(), []
            self.block(lambda: fields.append(self.field()))
            self.found.append(Struct('/'.join([*modules, name]), tuple(fields),
                                     tuple(self.constants.get(name, ())),
                                     annotations.get('text', ())))
        else:
            raise ValueError(f"unknown definition '{word}'")
        self.take(';')

    def block(self, read_one):
        self.take('{')
        while self.tokens[0] != '}':
            read_one()
        self.take('}')

    def annotations(self):
        """{'text': lines of the comment, 'value': default}, what there is of them."""
        result = {}
        while self.tokens[0] == '@':
            self.take('@')
            self.take()
            self.take('(')
            while self.tokens[0] != ')':
                key = self.take()
                if key == ',':
                    continue
                self.take('=')
                values = [self.take()]
                while self.tokens[0] not in ',)':
                    values.append(self.take())
                result[key] = values
            self.take(')')
        comment = ''.join(ast.literal_eval(part) for part in result.get('text', []))
        return {'text': tuple(comment.split('\n')) if comment else (),
                'value': result.get('value', [None])[0]}

    def constant(self, module):
        comment = self.annotations()['text']
        self.take('const')
        type_, name = self.type(), self.take()
        self.take('=')
        self.constants.setdefault(module.removesuffix('_Constants'), []).append(
            Member(name, type_, self.take(), comment))
        self.take(';')

    def field(self):
        annotations = self.annotations()
        type_, name = self.type(), self.take()
        self.take(';')
        return Member(name, type_, annotations['value'], annotations['text'])

    def type(self):
        word = self.take()
        if word in self.arrays:
            return self.arrays[word]
        if word == 'sequence':
            self.take('<')
            element, bound = self.type(), self.bound(',')
            self.take('>')
            return dataclasses.replace(element, form=BOUNDED_SEQUENCE if bound else SEQUENCE,
                                       capacity=bound)
        if word == 'string' and self.tokens[0] == '<':
            bound = self.bound('<')
            self.take('>')
            return Type(word, string_capacity=bound)
        return Type(word.replace('::', '/'))

    def bound(self, before):
        """The number behind this sign; 0 where the sign is not there."""
        if self.tokens[0] != before:
            return 0
        self.take(before)
        return int(self.take())
