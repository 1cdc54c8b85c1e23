# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The accuracy report's file, its Markdown table, and the comparison of two of them."""

import json
import math
import statistics
import sys

FORMAT, VERSION = "bpa accuracy", 1
# What is counted, what the table calls it, and whether more is better.
COUNTS = {"found": ("found", True), "false_positives": ("false positives", False),
          "found_in_twenty": ("found in twenty interpretations", True)}
RULE = """A domain is better or worse where both hold: the mean of each lies outside the other's
range over the seeds, and the means differ by more than two standard errors of their difference.
One seed is never judged. With five, chance alone makes one comparison in twenty so."""


def percent(ratio):
    if not ratio or not ratio["total"]:
        return "-"
    return f"{100 * ratio['hits'] / ratio['total']:.1f} % ({ratio['hits']}/{ratio['total']})"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def read(path):
    report = json.loads(path.read_text(encoding="utf-8"))
    if (report.get("format"), report.get("version")) != (FORMAT, VERSION):
        sys.exit(f"{path} is no {FORMAT} of version {VERSION}")
    return report


def write(report, path):
    """A row on each line."""
    head = json.dumps(report | {"rows": None})
    rows = ",\n ".join(json.dumps(row) for row in report["rows"])
    path.write_text(head.replace('"rows": null', '"rows": [\n ' + rows + "\n]") + "\n",
                    encoding="utf-8")


def number(value):
    """With one decimal, unless it is whole."""
    return f"{value:.0f}" if value == round(value) else f"{value:.1f}"


def spread(values):
    """The mean, and the range if there is one."""
    mean = number(statistics.fmean(values))
    low, high = min(values), max(values)
    return mean if low == high else f"{mean} ({number(low)} to {number(high)})"


def sums(rows):
    """A row for each effort and kind of domain: counts of all of them, seed by seed."""
    found = []
    for effort in dict.fromkeys(row["effort"] for row in rows):
        for chosen_on in ("development", "held out"):
            group = [row for row in rows
                     if row["effort"] == effort and row["chosen_on"] == chosen_on]
            if not group:
                continue
            whole = {"domain": "all", "effort": effort, "chosen_on": chosen_on,
                     "frames_digest": " ".join(f"{row['domain']} {row['frames_digest']}"
                                               for row in group)}
            for key in ("frames", "instances"):
                whole[key] = sum(row[key] for row in group)
            for key in (*COUNTS, "seconds"):
                whole[key] = [sum(of_seed) for of_seed in zip(*(row[key] for row in group))]
            found.append(whole)
    return found


def cells(row):
    found = [spread(row[key]) for key in COUNTS]
    if not row["instances"]:
        found[0] = found[2] = "-"
    seconds = "" if row["domain"] == "all" else f"{statistics.fmean(row['seconds']):.2f}"
    return [row["domain"], row["effort"], row["chosen_on"], row["frames"], row["instances"], *found,
            seconds]


def progress(row):
    return " | ".join(str(cell) for cell in cells(row))


def markdown(report):
    rows = report["rows"]
    seeds = {row["effort"]: len(row["seeds"]) for row in rows}
    text = (f"Commit {report['commit']}, {report['date']}, {report['machine']}. Seeds of the "
            "search: " + ", ".join(f"{count} at {effort} effort" for effort, count in seeds.items())
            + ". Means, and the range over seeds.\n\n")
    if report["skipped"]:
        text += f"Skipped, for want of data: {'; '.join(report['skipped'])}.\n\n"
    header = ["domain", "effort", "frames are", "frames", "instances",
              *(name for name, _ in COUNTS.values()), "s a frame"]
    return text + table(header, [cells(row) for row in rows + sums(rows)])


def verdict(before, now, more_is_better):
    """better, worse, or nothing where seeds alone may explain the difference."""
    if min(len(before), len(now)) < 2:
        return ""
    means = statistics.fmean(before), statistics.fmean(now)
    error = math.sqrt(statistics.variance(before) / len(before)
                      + statistics.variance(now) / len(now))
    outside = (not min(before) <= means[1] <= max(before)
               and not min(now) <= means[0] <= max(now))
    if not outside or abs(means[1] - means[0]) <= 2 * error:
        return ""
    return "better" if (means[1] > means[0]) == more_is_better else "worse"


def comparison(before, now):
    """A row for each domain and effort that both reports have."""
    key = ("domain", "effort", "chosen_on")
    old = {tuple(row[name] for name in key): row for row in before["rows"] + sums(before["rows"])}
    rows = []
    for row in now["rows"] + sums(now["rows"]):
        earlier = old.get(tuple(row[name] for name in key))
        if earlier is None:
            continue
        cells_of_row = [row["domain"], row["effort"], row["chosen_on"]]
        same = earlier["frames_digest"] == row["frames_digest"]
        said = [] if same else ["other frames: not compared"]
        for name, (title, more_is_better) in COUNTS.items():
            cells_of_row.append(f"{spread(earlier[name])} → {spread(row[name])}")
            judged = verdict(earlier[name], row[name], more_is_better) if same else ""
            if judged:
                said.append(f"{title}: {judged}")
        ratio = statistics.fmean(row["seconds"]) / max(1e-9, statistics.fmean(earlier["seconds"]))
        rows.append([*cells_of_row, f"{ratio:.2f}", "; ".join(said)])
    header = ["domain", "effort", "frames are", *(title for title, _ in COUNTS.values()),
              "times the seconds", "beyond the seeds' spread"]
    machines = "" if before["machine"] == now["machine"] else " Machines differ: so do times."
    return (f"Before: commit {before['commit']}, {before['date']}. Now: commit {now['commit']}. "
            f"{' '.join(RULE.split())}{machines}\n\n" + table(header, rows))
