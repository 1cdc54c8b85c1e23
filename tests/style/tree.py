# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The files of the project, for the style checks. Needs nothing but Debian's python3."""

import os
from pathlib import Path

SKIPPED_FOLDERS = {".git", ".cache", "build", "__pycache__"}


def files(root, *folders):
    """Every file under root (or under these folders of it), as sorted paths relative to root."""
    found = []
    for folder in folders or (".",):
        for here, subfolders, names in os.walk(Path(root) / folder):
            subfolders[:] = [name for name in subfolders if name not in SKIPPED_FOLDERS]
            found += [(Path(here) / name).relative_to(root) for name in names]
    return sorted(path for path in found if path.name != ".git")


def text(root, path):
    """The file's text, or None if it is not text."""
    try:
        return (Path(root) / path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def is_generated(content):
    """Whether the head of a file says that a tool made it."""
    head = "\n".join(content.split("\n", 12)[:12]).lower()
    return "generated" in head and "do not edit" in head
