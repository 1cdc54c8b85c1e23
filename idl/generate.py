#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the .idl files that follow from others.

bpa_msgs/*/*.idl   from the .msg and .srv files beside them, as a ROS 2 build does
dds.idl            every type of bpa_msgs/ and ros/ in one file under the names that ROS 2 gives them
                   in DDS, for the IDL compilers of DDS vendors

generate.py            rewrites them
generate.py --verify   exits 1 and names the files that are not what would be written

Needs rosidl_adapter (Debian package python3-rosidl).
"""
import pathlib
import re
import sys
import tempfile

from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.srv import convert_srv_to_idl

IDL = pathlib.Path(__file__).resolve().parent
PACKAGE = IDL / 'bpa_msgs'

DDS_HEAD = """\
// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Made by generate.py; what the fields mean is said in bpa_msgs/ and by ROS 2.
"""


def generate(output):
    """Writes all files below `output` as they lie below idl/."""
    for source in sorted(PACKAGE.glob('*/*.[ms][sr][gv]')):
        convert = convert_msg_to_idl if source.suffix == '.msg' else convert_srv_to_idl
        folder = output / PACKAGE.name / source.parent.name
        folder.mkdir(parents=True, exist_ok=True)
        convert(PACKAGE, PACKAGE.name, source.relative_to(PACKAGE), folder)
    (output / 'dds.idl').write_text(one_file([output, IDL / 'ros']))


def one_file(roots):
    """The text of dds.idl, from the ROS-style .idl files below some folders."""
    text = DDS_HEAD
    written = set()

    def add(name):
        nonlocal text
        if name in written:
            return
        written.add(name)
        path = next(root / name for root in roots if (root / name).exists())
        source = path.read_text()
        for include in re.findall(r'#include "(.*)"', source):
            add(include)
        text += '\n' + dds_module(source)

    for root in roots:
        for path in sorted(root.glob('*/*/*.idl')):
            add(str(path.relative_to(root)))
    return text


def dds_module(source):
    """One file's module, without includes, comments and typedefs, in DDS's names."""
    source = re.sub(r'//.*\n|#include.*\n', '', source)
    # An annotation ends in a string and a parenthesis; the comments in it may have both, apart.
    source = re.sub(r' *@verbatim \(language="comment", text=\n(?: *"(?:[^"\\\n]|\\.)*"(?: "\\n")?\n?)+\)\n',
                    '', source)
    for element, alias, count in re.findall(r'typedef (\S+) (\S+)\[(\d+)\];', source):
        source = re.sub(rf'\b{alias} (\w+);', rf'{element} \1[{count}];', source)
    source = re.sub(r' *typedef .*\n', '', source)
    source = re.sub(r'\b(msg|srv)::(\w+)', r'\1::dds_::\2_', source)
    source = re.sub(r'struct (\w+)', r'struct \1_', source)
    source = re.sub(r'module (msg|srv) \{', r'module \1 { module dds_ {', source)
    source = re.sub(r'\n\s*\n', '\n', source.strip())
    return re.sub(r'\n  \};\n\};$', '\n  }; };\n};\n', source)


def main():
    if sys.argv[1:] == ['--verify']:
        with tempfile.TemporaryDirectory() as folder:
            output = pathlib.Path(folder)
            generate(output)
            fresh = contents(output, output.glob('**/*.idl'))
        committed = contents(IDL, [IDL / 'dds.idl', *PACKAGE.glob('*/*.idl')])
        stale = [n for n in sorted(fresh.keys() | committed.keys())
                 if fresh.get(n) != committed.get(n)]
        for name in stale:
            print(f'idl/{name} is stale: run idl/generate.py', file=sys.stderr)
        return 1 if stale else 0
    if sys.argv[1:]:
        print(__doc__, file=sys.stderr)
        return 2
    generate(IDL)
    return 0


def contents(root, paths):
    """The bytes of some files, by their names relative to a folder."""
    return {str(p.relative_to(root)): p.read_bytes() for p in paths if p.exists()}


if __name__ == '__main__':
    sys.exit(main())
