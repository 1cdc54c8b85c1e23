# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Turns bpa_msgs into C++ with Debian's ROS 2 interface tools and compiles what comes out.

rosidl_test.py OUTPUT_FOLDER COMPILER. Exits 1 when a tool or the compiler has anything to say.
"""
import json
import pathlib
import shutil
import subprocess
import sys

from rosidl_generator_cpp import generate_cpp

IDL = pathlib.Path(__file__).resolve().parents[3] / 'idl'
TEMPLATES = '/usr/share/rosidl_generator_cpp/resource'
RUNTIME = pathlib.Path('/usr/include')  # here Debian keeps what the generated code includes


def generate(folder, output):
    """The C++ of one package whose .idl files lie in a folder; names of the headers made."""
    package = folder.name
    files = sorted(folder.glob('*/*.idl'))
    arguments = {
        'package_name': package,
        'output_dir': str(output / package),
        'template_dir': TEMPLATES,
        'idl_tuples': [f'{folder}:{path.relative_to(folder)}' for path in files],
        'ros_interface_dependencies': [],
        'target_dependencies': [],
    }
    arguments_file = output / f'{package}.json'
    arguments_file.write_text(json.dumps(arguments))
    generate_cpp(str(arguments_file))
    made = sorted((output / package).glob('*/*.hpp'))
    assert len(made) == len(files), f'{package}: {len(files)} files gave {len(made)} headers'
    return [f'{package}/{path.relative_to(output / package)}' for path in made]


def main():
    output, compiler = pathlib.Path(sys.argv[1]), sys.argv[2]
    shutil.rmtree(output, ignore_errors=True)  # headers of messages that are gone
    output.mkdir(parents=True)
    for folder in sorted((IDL / 'ros').iterdir()):
        generate(folder, output)
    headers = generate(IDL / 'bpa_msgs', output)

    source = output / 'all.cpp'
    source.write_text(''.join(f'#include "{header}"\n' for header in headers))
    includes = [f'-I{output}'] + [f'-isystem{folder}' for folder in RUNTIME.glob('rosidl_*')]
    command = [compiler, '-std=c++17', '-Wall', '-Wextra', '-Wpedantic', '-Werror',
               '-fsyntax-only', *includes, str(source)]
    return subprocess.run(command).returncode


if __name__ == '__main__':
    sys.exit(main())
