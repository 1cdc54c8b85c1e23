# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the table of limits in SECURITY.md against the code.

Each row names a constant and its file, or a setting and config/server.yaml; its first number between
backticks has to be the value there. Every constant of a room that reads foreign input whose name says
that it is a limit has to be in the table.
"""

import re
from pathlib import Path

import arrows
import tree

READERS = ("idl/wire/", "server/", "camera/", "client/src/", "core/io/", "ros/")
DEFINITION = re.compile(r"\bconstexpr\s+[\w:]+\s+(k(?:Max|Most|Longest|Largest)\w*)\s*"
                        r"(?:=\s*|(?=\{))([^;]+);")
# Of nothing that comes from outside.
NO_INPUTS = {
    ("core/io/model_parts.cpp", "kMost"),                     # of an integer
    ("core/io/model_parts.cpp", "kMostSigned"),
    ("core/io/organised_cloud.cpp", "kMaxMeanResidual"),      # of a fit, in pixels
    ("ros/compressed.cpp", "kMaxPixels"),                    # kMaxImageSide squared
    ("ros/images.cpp", "kMaxSide"),                          # kMaxImageSide
    ("server/log_filter.cpp", "kLongest"),                    # of what tells causes apart
    ("server/ros_clock.cpp", "kLongestStandstill"),           # until it is reported
}


def value_of(expression):
    """The number of a constant of C++; None for what this cannot compute."""
    text = re.sub(r"\b(?:std::)?(?:size_t|u?int\d+_t|milliseconds|seconds)\b|\bstd::chrono::", "",
                  expression)
    text = re.sub(r"(?<=\d)'(?=\d)", "", text)
    text = re.sub(r"(?<=[\da-fA-F])[uUlLfF]+\b", "", text).replace("{", "(").replace("}", ")")
    if not re.fullmatch(r"[\d\sxa-fA-F.()*+<>-]+", text):
        return None
    return eval(text)  # digits and operators alone


def text_of(root, path):
    """The text of a file; empty where there is none."""
    return tree.text(root, path) or "" if (Path(root) / path).exists() else ""


def constants(content):
    """{name: text of its value} of a file."""
    return dict(DEFINITION.findall(content))


def named_constant(content, name):
    found = re.search(rf"\b{name}\s*(?:=\s*|(?=\{{))([^;,]+)[;,]", content)
    return value_of(found[1]) if found else None


def setting(content, path):
    """The number that a file as config/server.yaml has for "group.key"."""
    group, key = path.split(".")
    found = re.search(rf"^{group}:\n((?:[ #].*\n|\n)*)", content, re.MULTILINE)
    line = re.search(rf"^  {key}: (\S+)$", found[1], re.MULTILINE) if found else None
    return float(line[1]) if line else None


def check_row(root, row):
    said = re.search(r"`([\d.]+)`", row[1])
    path, name = arrows.words(row[-1])
    content = text_of(root, Path(path))
    value = (setting if path.endswith(".yaml") else named_constant)(content, name)
    if value is None or not said:
        return [f"SECURITY.md: {row[0]}: {path} has no {name} that is a number"]
    if float(said[1]) != value:
        return [f"SECURITY.md: {row[0]}: the limit is {said[1]}, {name} of {path} is {value:g}"]
    return []


def check(root):
    markdown = text_of(root, Path("SECURITY.md"))
    rows = arrows.table(markdown, "input")
    if not rows:
        return ["SECURITY.md: no table of limits"]
    problems = [problem for row in rows for problem in check_row(root, row)]
    known = {tuple(arrows.words(row[-1])) for row in rows} | NO_INPUTS
    for path in tree.files(root):
        if not path.as_posix().startswith(READERS) or path.suffix not in (".hpp", ".cpp"):
            continue
        for name in constants(text_of(root, path)):
            if (path.as_posix(), name) not in known:
                problems.append(f"{path}: {name} is a limit that SECURITY.md does not have")
    return problems
