#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the .idl files of bpa_msgs from its .msg and .srv files, as a ROS 2 build does.

generate.py            rewrites the .idl files beside their sources
generate.py --verify   exits 1 and names the files that are not what would be written

Needs rosidl_adapter (Debian package python3-rosidl).
"""
import pathlib
import sys
import tempfile

from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.srv import convert_srv_to_idl

PACKAGE = pathlib.Path(__file__).resolve().parent / 'bpa_msgs'


def generate(output):
    """Writes msg/*.idl and srv/*.idl below `output`."""
    for source in sorted(PACKAGE.glob('*/*.[ms][sr][gv]')):
        convert = convert_msg_to_idl if source.suffix == '.msg' else convert_srv_to_idl
        folder = output / source.parent.name
        folder.mkdir(parents=True, exist_ok=True)
        convert(PACKAGE, PACKAGE.name, source.relative_to(PACKAGE), folder)


def verify():
    """Names of committed files that differ from what `generate` writes."""
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder)
        generate(output)
        fresh = {p.relative_to(output): p.read_bytes() for p in output.glob('*/*.idl')}
    committed = {p.relative_to(PACKAGE): p.read_bytes() for p in PACKAGE.glob('*/*.idl')}
    return sorted(
        str(name) for name in fresh.keys() | committed.keys()
        if fresh.get(name) != committed.get(name))


def main():
    if sys.argv[1:] == ['--verify']:
        stale = verify()
        for name in stale:
            print(f'{PACKAGE.name}/{name} is stale: run idl/generate.py', file=sys.stderr)
        return 1 if stale else 0
    if sys.argv[1:]:
        print(__doc__, file=sys.stderr)
        return 2
    generate(PACKAGE)
    return 0


if __name__ == '__main__':
    sys.exit(main())
