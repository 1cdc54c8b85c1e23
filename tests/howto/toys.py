# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The toys NAME.patch beside this file, each made by one list of "How to add" in CONTRIBUTING.md.

toys.py lists SOURCE       each toy touches the files of its list and no other, in a fresh copy
toys.py tree SOURCE TREE   makes TREE a copy of SOURCE with all toys; prints the sources they touch

A file that stays as it is keeps its time, so that what is built of it is built no second time.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "style"))
import tree as project  # noqa: E402

PATCHES = sorted(HERE.glob("*.patch"))
LISTED = re.compile(r"^\d+\. ((?:`[^`]+`(?:, )?)+)")


def lists(source):
    """The files of each list, in its order, by the name of its patch."""
    text = (source / "CONTRIBUTING.md").read_text(encoding="utf-8")
    section = text.split("\n## How to add\n")[1].split("\n## ")[0]
    found = {}
    for line in section.splitlines():
        if patch := re.search(r"\(`tests/howto/(\w+)\.patch`\)", line):
            files = found.setdefault(patch[1], [])
        elif entry := LISTED.match(line):
            files += [name.replace("NAME", "toy") for name in re.findall("`([^`]+)`", entry[1])]
    return found


def git_apply(folder, patch, *options):
    # Whether the folder lies in a repository does not matter.
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(folder.parent)}
    done = subprocess.run(["git", "apply", "-C1", *options, str(patch)], cwd=folder, env=environment,
                          capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{patch.name} does not apply to this tree: make it again\n{done.stderr}")
    return done.stdout


def copy(source, to):
    for path in project.files(source):
        (to / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source / path, to / path)


def touched(folder, patch):
    """The files of a patch with the lines that it adds and removes."""
    rows = [line.split("\t") for line in git_apply(folder, patch, "--numstat").splitlines()]
    return {name: (int(more), int(less)) for more, less, name in rows}


def unbuilt(folder, patch, name):
    """Whether a new source is missing in the CMakeLists.txt beside it."""
    path = folder / name
    if path.suffix != ".cpp" or path.exists():
        return False
    added = re.findall(r"^\+[^+].*", patch.read_text(encoding="utf-8"), re.MULTILINE)
    return not any(path.name in line for line in added)


def check_lists(source):
    problems = []
    listed = lists(source)
    if set(listed) != {patch.stem for patch in PATCHES}:
        problems.append(f"lists: {sorted(listed)}; patches: {[p.stem for p in PATCHES]}")
    with tempfile.TemporaryDirectory() as folder:
        fresh = Path(folder) / "tree"
        copy(source, fresh)
        for patch in PATCHES:
            git_apply(fresh, patch, "--check")
            files = touched(fresh, patch)
            for name in sorted(set(files) ^ set(listed.get(patch.stem, []))):
                problems.append(f"{name}: in one of {patch.name} and its list alone")
            problems += [f"{patch.name}: no CMakeLists.txt names {name}"
                         for name in files if unbuilt(fresh, patch, name)]
            more, less = (sum(column) for column in zip(*files.values()))
            print(f"{patch.stem}: {len(files)} files, {more} lines added, {less} removed")
    return problems


def make_tree(source, to):
    with tempfile.TemporaryDirectory() as folder:
        fresh = Path(folder) / "tree"
        copy(source, fresh)
        names = set()
        for patch in PATCHES:
            names |= set(touched(fresh, patch))
            git_apply(fresh, patch)
        generate = [sys.executable, "-B", "idl/generate.py", "--headers", "generated"]
        subprocess.run(generate, cwd=fresh, check=True)
        now = project.files(fresh)
        for path in set(project.files(to)) - set(now):
            (to / path).unlink()
        for path in now:
            content = (fresh / path).read_bytes()
            if (to / path).is_file() and (to / path).read_bytes() == content:
                continue
            (to / path).parent.mkdir(parents=True, exist_ok=True)
            (to / path).write_bytes(content)
    print(";".join(sorted(n for n in names if n.endswith(".cpp") and not n.startswith("tests/"))))


def main(arguments):
    if arguments[:1] == ["lists"]:
        problems = check_lists(Path(arguments[1]))
        print("\n".join(problems))
        return 1 if problems else 0
    make_tree(Path(arguments[1]), Path(arguments[2]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
