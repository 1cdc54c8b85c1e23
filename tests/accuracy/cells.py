# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Cells and tables of the accuracy report."""

import json


def load(path):
    return json.loads(path.read_text()) if path.is_file() else None


def percent(ratio):
    if not ratio or not ratio["total"]:
        return "-"
    return f"{100 * ratio['hits'] / ratio['total']:.1f} % ({ratio['hits']}/{ratio['total']})"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def fraction(ratio):
    return f"{ratio['hits']}/{ratio['total']}" if ratio and ratio["total"] else "-"


def number(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"
