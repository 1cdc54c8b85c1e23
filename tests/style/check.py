# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""usage: check.py arrows|sources|formatting|limits ROOT. Exits 1 with one line for each thing wrong."""

import importlib
import sys

SKIPPED = 77


def main(name, root):
    problems = importlib.import_module(name).check(root)
    if problems is None:
        print(f"{name}: skipped, the tool is not installed")
        return SKIPPED
    print("\n".join(problems) if problems else f"{name}: nothing wrong")
    return 1 if problems else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
