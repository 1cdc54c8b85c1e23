# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Type hashes of ROS 2 (REP 2011, as rosidl_generator_type_description computes them).

ROS 2 peers from Iron on announce them and warn about a peer that announces none or another.
"""
import hashlib
import json

from generator.interfaces import PLAIN

# type_description_interfaces/msg/FieldType; arrays, bounded and unbounded sequences add 48, 96, 144.
NESTED, STRING, BOUNDED_STRING, FORM_STEP = 1, 17, 21, 48
SCALARS = {'int8': 2, 'uint8': 3, 'int16': 4, 'uint16': 5, 'int32': 6, 'uint32': 7, 'int64': 8,
           'uint64': 9, 'float': 10, 'double': 11, 'boolean': 15, 'octet': 16}


def type_hash(struct, structs):
    """"RIHS01_" and 64 hex digits. `structs` holds every struct by its name."""
    description = full_description(struct, structs)
    return 'RIHS01_' + hashlib.sha256(json.dumps(description).encode()).hexdigest()


def full_description(struct, structs, with_defaults=False):
    """The JSON value of a struct and of all that it refers to; defaults are not part of the hash."""
    return {
        'type_description': describe(struct, with_defaults),
        'referenced_type_descriptions': [describe(structs[name], with_defaults)
                                         for name in references_of(struct, structs)],
    }


def references_of(struct, structs):
    """The sorted names of all that a struct refers to, itself or through others."""
    referenced = set()

    def refer(name):
        if name not in referenced:
            referenced.add(name)
            for below in structs[name].references():
                refer(below)

    for name in struct.references():
        refer(name)
    return sorted(referenced)


def describe(struct, with_defaults):
    """The JSON value of one struct; its keys and their order are part of the hash."""
    fields = [{'name': field.name, 'type': describe_type(field.type)} for field in struct.fields]
    if with_defaults:
        for description, field in zip(fields, struct.fields):
            value = field.value or ''
            boolean = value in ('TRUE', 'FALSE')
            description['default_value'] = value.capitalize() if boolean else value  # as Python's
    return {'type_name': struct.name, 'fields': fields}


def describe_type(type_):
    if type_.is_struct:
        type_id = NESTED
    elif type_.element == 'string':
        type_id = BOUNDED_STRING if type_.string_capacity else STRING
    else:
        type_id = SCALARS[type_.element]
    return {
        'type_id': type_id + FORM_STEP * (type_.form - PLAIN),
        'capacity': type_.capacity,
        'string_capacity': type_.string_capacity,
        'nested_type_name': type_.element if type_.is_struct else '',
    }
