# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that C++ files are as clang-format 14 leaves them. Other versions differ in taste."""

import re
import shutil
import subprocess

import tree

CHECKED_FOLDERS = ("core", "idl", "client", "ros", "camera", "server", "tools", "tests")


def clang_format():
    """The program, or None where there is none of the right version."""
    for name in ("clang-format-14", "clang-format"):
        program = shutil.which(name)
        if program:
            version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
            if re.search(r"version 14\.", version):
                return program
    return None


def check(root):
    program = clang_format()
    if program is None:
        return None
    paths = [str(path) for path in tree.files(root, *CHECKED_FOLDERS)
             if path.suffix in (".hpp", ".cpp") and not tree.is_generated(tree.text(root, path))]
    if not paths:
        return []
    result = subprocess.run([program, "--dry-run", "--ferror-limit=1", *paths], cwd=root,
                            capture_output=True, text=True)
    wrong = sorted(set(re.findall(r"^(\S+?):\d+:\d+: (?:warning|error)", result.stderr, re.M)))
    return [f"{path}: not formatted; clang-format -i {path}" for path in wrong]
