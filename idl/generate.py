#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the files that follow from the message definitions.

bpa_msgs/*/*.idl   from the .msg and .srv files beside them, as a ROS 2 build does
dds.idl            every type of bpa_msgs/ and ros/ in one file under the names that ROS 2 gives them
                   in DDS, for the IDL compilers of DDS vendors
C++ headers        the structs of all types, their fields and type hashes: wire/msg/PACKAGE.hpp,
                   wire/messages.hpp

generate.py                   rewrites the .idl files
generate.py --verify          exits 1 and names the .idl files that are not what would be written
generate.py --headers FOLDER  writes the headers below FOLDER/idl; the build does that

The .idl files need rosidl_adapter (Debian package python3-rosidl), the headers nothing but Python.
"""
import pathlib
import sys
import tempfile

from generator.dds import dds_idl
from generator.headers import headers
from generator.interfaces import read_all

IDL = pathlib.Path(__file__).resolve().parent
PACKAGE = IDL / 'bpa_msgs'


def generate(output):
    """Writes all .idl files below `output` as they lie below idl/."""
    from rosidl_adapter.msg import convert_msg_to_idl
    from rosidl_adapter.srv import convert_srv_to_idl
    for source in sorted(PACKAGE.glob('*/*.[ms][sr][gv]')):
        convert = convert_msg_to_idl if source.suffix == '.msg' else convert_srv_to_idl
        folder = output / PACKAGE.name / source.parent.name
        folder.mkdir(parents=True, exist_ok=True)
        convert(PACKAGE, PACKAGE.name, source.relative_to(PACKAGE), folder)
    structs = read_all([output, IDL / 'ros'])
    (output / 'dds.idl').write_text(dds_idl(structs.values()))


def generate_headers(output):
    for name, text in headers(read_all([IDL, IDL / 'ros'])).items():
        path = output / 'idl' / 'wire' / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def verify():
    """Names of the .idl files that are not what would be written."""
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder)
        generate(output)
        fresh = contents(output, output.glob('**/*.idl'))
    committed = contents(IDL, [IDL / 'dds.idl', *PACKAGE.glob('*/*.idl')])
    return [name for name in sorted(fresh.keys() | committed.keys())
            if fresh.get(name) != committed.get(name)]


def contents(root, paths):
    """The bytes of some files, by their names relative to a folder."""
    return {str(p.relative_to(root)): p.read_bytes() for p in paths if p.exists()}


def main(arguments):
    if not arguments:
        generate(IDL)
        return 0
    if arguments == ['--verify']:
        stale = verify()
        for name in stale:
            print(f'idl/{name} is stale: run idl/generate.py', file=sys.stderr)
        return 1 if stale else 0
    if len(arguments) == 2 and arguments[0] == '--headers':
        generate_headers(pathlib.Path(arguments[1]))
        return 0
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
