# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks #include lines and USES lists against the two tables of ARCHITECTURE.md.

The table of rooms (columns room, holds, may use) says which room may include which; a room may use
only rooms further up in the table, and headers in a folder `private` are for their own room. The
table of libraries (columns library, headers, only in) says which files may include third-party
headers.
"""

import fnmatch
import re
from pathlib import Path

import tree

CHECKED_FOLDERS = ("core", "idl", "client", "ros", "camera", "server", "tools", "python")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
USES = re.compile(r"\bUSES\b([^)]*?)(?=\b(?:SOURCES|PUBLIC_LIBS|PRIVATE_LIBS)\b|\))")


def table(markdown, first_column):
    """The rows (lists of cells) of the table whose first column has this title."""
    rows = None
    for line in markdown.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            if rows:
                return rows
            rows = None
        elif rows is not None:
            if not set(cells[0]) <= set("-: "):
                rows.append(cells)
        elif cells[0] == first_column:
            rows = []
    return rows or []


def words(cell):
    """The words that stand between backticks in a cell."""
    return [word for quoted in re.findall(r"`([^`]*)`", cell) for word in quoted.split()]


class Rooms:
    """The table of rooms: what each one may use."""

    def __init__(self, markdown):
        self.may_use = {}
        self.problems = []
        for row in table(markdown, "room"):
            room = words(row[0])[0]
            uses = []
            for word in words(row[-1]):
                used = word if word in self.may_use else "core/" + word
                if used not in self.may_use:
                    self.problems.append(
                        f"ARCHITECTURE.md: {room} may use {word}, which is no room further up")
                else:
                    uses.append(used)
            self.may_use[room] = {room, *uses}
        if not self.may_use:
            self.problems.append("ARCHITECTURE.md: no table of rooms")

    def room_of(self, path):
        """The room that holds a file or folder, or None."""
        parts = Path(path).parts
        for length in range(len(parts), 0, -1):
            if "/".join(parts[:length]) in self.may_use:
                return "/".join(parts[:length])
        return None


def included_path(bracket, header):
    """Where an included header of the project lies, relative to the root; None for any other."""
    if bracket == '"' or header.startswith(tuple(folder + "/" for folder in CHECKED_FOLDERS)):
        return header
    if header.startswith("bpa/"):
        return "client/include/" + header
    return None


def check_libraries(libraries, path, header):
    """What the table of libraries has against this include of a third-party header."""
    for library, prefixes, places in libraries:
        if header.startswith(tuple(prefixes)):
            if not any(fnmatch.fnmatch(path.as_posix(), place) for place in places):
                return [f"{path}: includes <{header}>; {library} is allowed only in "
                        + " ".join(places)]
    return []


def check_includes(rooms, libraries, path, content):
    room = rooms.room_of(path)
    if room is None:
        return [f"{path}: lies in no room of ARCHITECTURE.md"]
    problems = []
    for bracket, header in INCLUDE.findall(content):
        target = included_path(bracket, header)
        if target is None:
            problems += check_libraries(libraries, path, header)
            continue
        used = rooms.room_of(target)
        if used is None:
            problems.append(f"{path}: includes {header}, which lies in no room; an include of the "
                            "project is a path from its root")
        elif used not in rooms.may_use[room]:
            problems.append(f"{path}: {room} may not include {header} of {used}")
        elif "/private/" in target and used != room:
            problems.append(f"{path}: {header} is private to {used}")
    return problems


def included_rooms(rooms, content):
    """The rooms whose headers a file includes."""
    targets = (included_path(*include) for include in INCLUDE.findall(content))
    return {rooms.room_of(target) for target in targets if target is not None}


def check_uses(rooms, path, content, included):
    """Each room of USES has to be allowed and `included`, a set of rooms by room, has to have it."""
    room = rooms.room_of(path)
    problems = []
    for names in USES.findall(re.sub(r"#.*", "", content)):
        for name in names.split():
            if room is None or "core/" + name not in rooms.may_use[room]:
                problems.append(f"{path}: {room} may not use {name}")
            elif "core/" + name not in included[room]:
                problems.append(f"{path}: {room} includes nothing of {name}, which it says it USES")
    return problems


def check_unused(rooms, included):
    return [f"ARCHITECTURE.md: {room} may use {used}, but includes nothing of it"
            for room, may_use in rooms.may_use.items()
            for used in sorted(may_use - included[room] - {room})]


def check(root):
    markdown = tree.text(root, "ARCHITECTURE.md")
    rooms = Rooms(markdown)
    libraries = [(row[0], words(row[1]), words(row[2])) for row in table(markdown, "library")]
    problems = list(rooms.problems)
    included = {room: set() for room in rooms.may_use}
    paths = tree.files(root, *CHECKED_FOLDERS)
    for path in paths:
        if path.suffix in (".hpp", ".cpp", ".h"):
            content = tree.text(root, path)
            problems += check_includes(rooms, libraries, path, content)
            included.setdefault(rooms.room_of(path), set()).update(included_rooms(rooms, content))
    for path in paths:
        if path.name == "CMakeLists.txt" and path.parts[0] == "core" and len(path.parts) > 2:
            problems += check_uses(rooms, path, tree.text(root, path), included)
    return problems + check_unused(rooms, included)
