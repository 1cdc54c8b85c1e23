#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""usage: tutorial.py TUTORIAL.md BUILD_FOLDER FOLDER BEGIN

Runs the `sh` blocks of a tutorial, in order, as one bash script in FOLDER, which is made anew: a copy of
the folder BEGIN, or empty where both are the same. The programs of BUILD_FOLDER are on the PATH, its
Python package is on PYTHONPATH. A `text` block that follows is what the block before prints: each of
its lines must appear in the output, in order. Numbers may differ, and `...` stands for any text. Prints
the transcript.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

TIME_LIMIT_S = 300
NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(text):
    """Pairs of commands and the output that the tutorial shows for them ("" if none)."""
    pairs = []
    for language, content in FENCE.findall(text):
        if language == "sh":
            pairs.append([content, ""])
        elif language == "text" and pairs:
            pairs[-1][1] += content
    return pairs


def as_pattern(line):
    """The line as a regular expression in which numbers and spaces are free."""
    parts = re.split(r"(" + NUMBER + r"|\.\.\.|\s+)", line.strip())
    pattern = ""
    for i, part in enumerate(parts):
        if i % 2 == 0:
            pattern += re.escape(part)
        elif part == "...":
            pattern += ".*"
        else:
            pattern += r"\s+" if part.isspace() else NUMBER
    return re.compile(pattern)


def missing_line(shown, printed):
    """The first shown line that is not printed after those before it, or None."""
    rest = iter(printed.splitlines())
    for line in filter(str.strip, shown.splitlines()):
        pattern = as_pattern(line)
        if not any(pattern.search(candidate) for candidate in rest):
            return line
    return None


def script_of(pairs):
    lines = ["set -euo pipefail", "trap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT"]
    for i, (commands, _) in enumerate(pairs):
        lines += [f"echo '=== block {i + 1}'", commands]
    return "\n".join(lines)


def main():
    tutorial, build, folder, begin = (pathlib.Path(a).resolve() for a in sys.argv[1:])
    pairs = blocks(tutorial.read_text())
    shutil.rmtree(folder, ignore_errors=True)
    if folder == begin:
        folder.mkdir(parents=True)
    else:
        shutil.copytree(begin, folder)
    path = (str(build / "bin"), os.path.dirname(sys.executable), os.environ["PATH"])
    environment = dict(os.environ, PATH=":".join(path), PYTHONPATH=str(build / "python"),
                       BPA=str(tutorial.parent.parent))
    run = subprocess.run(["bash", "-c", script_of(pairs)], cwd=folder, env=environment, text=True,
                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, timeout=TIME_LIMIT_S)
    print(run.stdout)
    if run.returncode != 0:
        sys.exit(f"{tutorial.name}: a command failed with {run.returncode}; see above")
    printed = re.split(r"^=== block \d+\n", run.stdout, flags=re.MULTILINE)[1:]
    for (_, shown), output in zip(pairs, printed):
        line = missing_line(shown, output)
        if line is not None:
            sys.exit(f"{tutorial.name}: this line was not printed: {line}")


if __name__ == "__main__":
    main()
