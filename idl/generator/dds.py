# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The text of dds.idl: all types in one file under the names that ROS 2 gives them in DDS."""
from generator.interfaces import ARRAY, BOUNDED_SEQUENCE, SEQUENCE

# Keywords of IDL that a ROS constant is called by in capitals; case does not tell names apart in IDL.
KEYWORDS = {f'{sign}int{bits}' for sign in ('', 'u') for bits in (8, 16, 32, 64)}

HEAD = """\
// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Made by generate.py; what the fields mean is said in bpa_msgs/ and by ROS 2.
"""


def dds_idl(structs):
    """One module for each struct; a request and its response share one."""
    text = HEAD
    for struct in structs:
        package, kind, name = struct.name.split('/')
        definition = constants(struct) + f'    struct {name}_ {{\n' + ''.join(
            f'      {declaration(field)};\n' for field in struct.fields) + '    };\n'
        tail = '  }; };\n};\n'
        if name.endswith('_Response'):
            text = text.removesuffix(tail) + definition + tail
        else:
            text += f'\nmodule {package} {{\n  module {kind} {{ module dds_ {{\n{definition}{tail}'
    return text


def constants(struct):
    if not struct.constants:
        return ''
    lines = [f'      const {constant.type.element} {escaped(constant.name)} = {constant.value};\n'
             for constant in struct.constants]
    return f'    module {struct.short_name}_Constants {{\n' + ''.join(lines) + '    };\n'


def escaped(name):
    """IDL's way to write a name that is a keyword otherwise."""
    return f'_{name}' if name.lower() in KEYWORDS else name


def declaration(field):
    """Such as "sequence<string, 4> names" or "double k[9]"."""
    type_ = field.type
    element = type_.element
    if type_.is_struct:
        package, kind, name = element.split('/')
        element = f'{package}::{kind}::dds_::{name}_'
    if type_.string_capacity:
        element += f'<{type_.string_capacity}>'
    if type_.form == ARRAY:
        return f'{element} {field.name}[{type_.capacity}]'
    if type_.form == BOUNDED_SEQUENCE:
        return f'sequence<{element}, {type_.capacity}> {field.name}'
    if type_.form == SEQUENCE:
        return f'sequence<{element}> {field.name}'
    return f'{element} {field.name}'
