# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that code files say their licence, are not too long, and name no folder of one machine."""

import re

import tree

CODE_SUFFIXES = {".hpp", ".cpp", ".h", ".py", ".cmake", ".sh"}
CODE_NAMES = {"CMakeLists.txt", "run"}
MAX_LINES = 600
SPDX_LINES = ("SPDX-FileCopyrightText: ", "SPDX-License-Identifier: Apache-2.0")
MACHINE_PATH = re.compile(r"(?<![\w.}\])*~])/(?:work|home|root|farm|Users)/")


def is_code(path):
    return path.suffix in CODE_SUFFIXES or path.name in CODE_NAMES


def check_spdx(path, content):
    head = "\n".join(content.split("\n", 4)[:4])
    return [f"{path}: the first lines lack '{line.strip()}'"
            for line in SPDX_LINES if line not in head]


def check_length(path, content):
    lines = content.count("\n")
    if lines <= MAX_LINES or tree.is_generated(content):
        return []
    return [f"{path}: {lines} lines; at most {MAX_LINES}: split it"]


def check_machine_paths(path, content):
    return [f"{path}:{number}: names a folder of one machine"
            for number, line in enumerate(content.splitlines(), 1) if MACHINE_PATH.search(line)]


def check(root):
    problems = []
    for path in tree.files(root):
        content = tree.text(root, path)
        if content is None:
            continue
        problems += check_machine_paths(path, content)
        if is_code(path):
            problems += check_spdx(path, content) + check_length(path, content)
    return problems
