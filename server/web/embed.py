# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a C++ file that holds the files of the page, each compressed by gzip.

usage: embed.py OUTPUT.cpp FILE...
"""

import gzip
import sys
from pathlib import Path

TYPES = {".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8",
         ".js": "text/javascript; charset=utf-8", ".svg": "image/svg+xml",
         ".txt": "text/plain; charset=utf-8"}


def literal(data):
    """Bytes as lines of a C++ string literal."""
    text = "".join(f"\\{byte:03o}" for byte in data)
    return "\n".join(f'    "{text[i:i + 96]}"' for i in range(0, len(text), 96))


def main(output, *paths):
    entries, arrays = [], []
    for number, path in enumerate(map(Path, paths)):
        data = gzip.compress(path.read_bytes(), 9, mtime=0)
        name = "/" if path.name == "index.html" else "/" + path.name
        arrays.append(f"const char kFile{number}[] =\n{literal(data)};\n")
        entries.append(f'    {{"{name}", "{TYPES[path.suffix]}", {{kFile{number}, {len(data)}}}}},')
    Path(output).write_text(
        '#include "server/web/assets.hpp"\n\nnamespace bpa::server::web {\nnamespace {\n\n'
        + "\n".join(arrays) + "\nconstexpr Asset kAssets[] = {\n" + "\n".join(entries)
        + "\n};\n\n}  // namespace\n\nstd::span<const Asset> assets() { return kAssets; }\n\n"
        "}  // namespace bpa::server::web\n")


main(*sys.argv[1:])
