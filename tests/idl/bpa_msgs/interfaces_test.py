# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Compares how idl/generator reads the .idl files with how ROS 2's own parser does.

Exits 1 when the two disagree about a struct, or when a broken file is not refused.
"""
import pathlib
import sys
import tempfile

from rosidl_parser.definition import (AbstractSequence, Array, BasicType, BoundedSequence,
                                      BoundedString, IdlLocator, Message, NamespacedType, Service,
                                      UnboundedString)
from rosidl_parser.parser import parse_idl_file

IDL = pathlib.Path(__file__).resolve().parents[3] / 'idl'
sys.path.insert(0, str(IDL))

from generator import interfaces  # noqa: E402


def rosidl_type(type_):
    if isinstance(type_, Array):
        return (*rosidl_type(type_.value_type)[:1], interfaces.ARRAY, type_.size, 0)
    if isinstance(type_, BoundedSequence):
        return (*rosidl_type(type_.value_type)[:1], interfaces.BOUNDED_SEQUENCE,
                type_.maximum_size, 0)
    if isinstance(type_, AbstractSequence):
        return (*rosidl_type(type_.value_type)[:1], interfaces.SEQUENCE, 0, 0)
    if isinstance(type_, BoundedString):
        return 'string', interfaces.PLAIN, 0, type_.maximum_size
    if isinstance(type_, UnboundedString):
        return 'string', interfaces.PLAIN, 0, 0
    if isinstance(type_, NamespacedType):
        return '/'.join([*type_.namespaces, type_.name]), interfaces.PLAIN, 0, 0
    assert isinstance(type_, BasicType), type_
    return type_.typename, interfaces.PLAIN, 0, 0


def rosidl_default(member):
    return float(member.get_annotation_value('default')['value']) \
        if member.has_annotation('default') else None


def rosidl_comment(annotatable):
    return tuple(annotatable.get_comment_lines())


def of_rosidl(root, path):
    """What ROS 2 reads from a file: {struct: (fields, constants, comment)}.

    It forgets the comments of requests and responses.
    """
    content = parse_idl_file(IdlLocator(str(root), str(path.relative_to(root)))).content
    messages = content.get_elements_of_type(Message)
    for service in content.get_elements_of_type(Service):
        messages += [service.request_message, service.response_message]
    return {
        '/'.join([*message.structure.namespaced_type.namespaces,
                  message.structure.namespaced_type.name]): (
            [(member.name, rosidl_type(member.type), rosidl_default(member),
              rosidl_comment(member)) for member in message.structure.members],
            [(constant.name, rosidl_type(constant.type), constant.value,
              rosidl_comment(constant)) for constant in message.constants],
            rosidl_comment(message.structure))
        for message in messages}


def of_ours(path):
    def type_(of):
        return of.element, of.form, of.capacity, of.string_capacity

    def default(value):
        booleans = {'TRUE': True, 'FALSE': False}
        return None if value is None else float(booleans.get(value, value))
    return {
        struct.name: (
            [(field.name, type_(field.type), default(field.value), field.comment)
             for field in struct.fields],
            [(constant.name, type_(constant.type), int(constant.value), constant.comment)
             for constant in struct.constants],
            struct.comment if '/msg/' in struct.name else ())
        for struct in interfaces.read(path)}


def refuses(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / 'Broken.idl'
        path.write_text(text)
        try:
            interfaces.read(path)
        except ValueError as error:
            return 'Broken.idl' in str(error)
    return False


def main():
    compared = 0
    failed = []
    for root in (IDL, IDL / 'ros'):
        for path in sorted(root.glob('*/*/*.idl')):
            ours, theirs = of_ours(path), of_rosidl(root, path)
            if ours != theirs:
                failed.append(f'{path.name}:\n  {ours}\n  {theirs}')
            compared += len(theirs)
    if compared < 80:
        failed.append(f'only {compared} structs were compared')
    whole = 'module a { module msg { struct T { uint8 x; }; }; };'
    failed += [f"'{text}' was not refused" for text in
               [whole[:size] for size in range(1, len(whole))] + [
                   whole.replace('uint8 x', 'map<string, uint8> x'),
                   whole.replace('struct', 'union')]
               if text.strip() and not refuses(text)]
    print('\n'.join(failed) or f'{compared} structs')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
