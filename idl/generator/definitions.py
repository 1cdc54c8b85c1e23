# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Message definitions as recordings hold them (MCAP's schema encoding "ros2msg"): the .msg text of a
type, without comments, and of all that it refers to.
"""
from generator.type_hash import references_of

WORDS = {'boolean': 'bool', 'octet': 'byte', 'float': 'float32', 'double': 'float64'}
SUFFIXES = ('', '[{}]', '[<={}]', '[]')  # by form


def definition(struct, structs):
    text = own_lines(struct)
    for name in references_of(struct, structs):
        text += f"{'=' * 80}\nMSG: {short(name)}\n{own_lines(structs[name])}"
    return text


def own_lines(struct):
    lines = [f'{type_text(one.type)} {one.name}={value_text(one)}' for one in struct.constants]
    lines += [f'{type_text(one.type)} {one.name} {value_text(one)}'.rstrip() for one in struct.fields]
    return ''.join(f'{line}\n' for line in lines)


def short(name):
    """"pkg/Name" of "pkg/msg/Name"."""
    return name.replace('/msg/', '/')


def type_text(type_):
    bound = f'<={type_.string_capacity}' if type_.string_capacity else ''
    return (WORDS.get(type_.element, short(type_.element)) + bound
            + SUFFIXES[type_.form].format(type_.capacity))


def value_text(member):
    value = member.value or ''
    return value.lower() if value in ('TRUE', 'FALSE') else value
