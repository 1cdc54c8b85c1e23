# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The sets of the accuracy report over the threshold, before and now."""

import datetime
import json
from pathlib import Path

from cells import load, number, percent, fraction, table

BASELINE = Path(__file__).resolve().parent / "baseline.json"

RUNS = [
    ("clutter", "clutter, BPA"),
    ("clutter-icp", "clutter, ICP"),
    ("unseen-structured_light", "objects never trained on, structured light"),
    ("unseen-active_stereo", "objects never trained on, active stereo"),
    ("unseen-time_of_flight", "objects never trained on, time of flight"),
    ("ambiguous", "ambiguous: a mug, its handle out of sight"),
    ("real", "real, BPA"),
    ("real-colourless", "real, BPA without colours"),
    ("real-icp", "real, ICP"),
]
FREE = [
    ("empty", "simulated empty tables"),
    ("distractors", "simulated distractors only"),
    ("osd", "real tables, nothing known on them"),
    ("osd-colourless", "the same without colours"),
]
# Sets of the curve that says how to choose the threshold: all with objects that are in colour and
# not made to be ambiguous, and the frames that hold none of the objects.
POOLED = ["real", "clutter", "unseen-structured_light", "unseen-active_stereo",
          "unseen-time_of_flight"]
POOLED_FREE = ["empty", "distractors", "osd"]
DEFAULT_THRESHOLD = 0.5
SHOWN_THRESHOLDS = [0.1, 0.3, 0.4, 0.5, 0.7, 0.9]


def summary(folder, name):
    """What baseline.json keeps of a set; None if it was skipped."""
    run = load(folder / name / "evaluation.json")
    everything = load(folder / f"{name}-everything" / "evaluation.json")
    if run is None:
        return None
    kept = {key: run[key] for key in ("frames", "precision", "recall")}
    kept["recall_at_20"] = run["recall_at"].get("20")
    kept["seconds"] = run["seconds"]["median"]
    kept["false_positives_per_frame"] = (
        run["precision"]["total"] - run["precision"]["hits"]) / max(1, run["frames"])
    if everything:
        kept["expected_error"] = everything["calibration"]["expected_error"]
        kept["brier"] = everything["calibration"]["brier"]
        kept["among_alternatives_at"] = everything["among_alternatives_at"]
        kept["threshold_curve"] = everything["threshold_curve"]
    return kept


def summaries(folder):
    found = {name: summary(folder, name) for name, _ in RUNS + FREE}
    return {name: kept for name, kept in found.items() if kept}


def before_and_after(before, after):
    """A row for each set and time."""
    rows = []
    for name, text in RUNS + FREE:
        for when, sets in (("before", before), ("now", after)):
            kept = sets.get(name)
            if kept is None:
                continue
            rows.append([
                text, when, kept["frames"], fraction(kept["precision"]),
                fraction(kept["recall"]), fraction(kept["recall_at_20"]),
                number(kept["false_positives_per_frame"], 2),
                number(kept.get("expected_error"), 3), number(kept["seconds"], 2)])
    return table(["set", "", "frames", "right of those reported", "found",
                  "found in twenty interpretations", "false positives a frame",
                  "expected calibration error", "s a frame"], rows)


def point_at(curve, threshold):
    return min(curve, key=lambda point: abs(point["threshold"] - threshold))


def curve_rows(before, after):
    rows = []
    for threshold in SHOWN_THRESHOLDS:
        row = [f"{threshold:.1f}"]
        for key in ("precision", "recall"):
            for kept in (before, after):
                row.append(percent(point_at(kept["threshold_curve"], threshold)[key])
                           if kept else "-")
        for kept in (before, after):
            row.append(number(point_at(kept["threshold_curve"], threshold)
                              ["false_positives_per_frame"] if kept else None, 2))
        rows.append(row)
    return rows


def curves(folder, before, after):
    """The curve and the reliability diagram of each set."""
    text = ""
    for name, title in RUNS + FREE:
        now = after.get(name, {})
        if "threshold_curve" not in now:
            continue
        old = before.get(name)
        text += f"### {title[0].upper()}{title[1:]}\n\n"
        text += table(["least probability", "precision, before", "now", "recall, before", "now",
                       "false positives a frame, before", "now"], curve_rows(old, now))
        text += (f"\nExpected calibration error {number(now['expected_error'], 3)}, before "
                 f"{number(old and old.get('expected_error'), 3)}; Brier score "
                 f"{number(now['brier'], 3)}, before {number(old and old.get('brier'), 3)}.\n\n")
        plots = (("false_positives", "false positives by threshold"), ("reports", "reports"))
        if now["recall"]["total"]:
            plots = (("precision_recall", "precision and recall"), ("reliability", "reliability"))
        for plot, caption in plots:
            text += f"![{title}: {caption}]({name}-everything/plots/{plot}.png)\n"
        text += "\n"
    return text


def pooled_curve(sets):
    """The rows of the README's table: counts over several sets at each threshold."""
    rows = []
    found = [sets[name] for name in POOLED if name in sets]
    free = [sets[name] for name in POOLED_FREE if name in sets]
    for threshold in SHOWN_THRESHOLDS:
        points = [point_at(kept["threshold_curve"], threshold) for kept in found]
        free_points = [point_at(kept["threshold_curve"], threshold) for kept in free]
        sums = [sum(point[key][part] for point in points)
                for key in ("precision", "recall") for part in ("hits", "total")]
        false_positives = sum(point["precision"]["total"] for point in free_points)
        rows.append([f"{threshold:.1f}" + (" (default)" if threshold == DEFAULT_THRESHOLD else ""),
                     f"{sums[0]}/{sums[1]}", f"{sums[2]}/{sums[3]}",
                     f"{false_positives} in {sum(kept['frames'] for kept in free)} frames"])
    return table(["`scene.min_probability`", "right of those reported", "found",
                  "false positives where nothing known is there"], rows)


def ambiguous(before, after):
    """Truth among the alternatives, of the best and of twenty interpretations."""
    rows = []
    for name, text in RUNS:
        for when, sets in (("before", before), ("now", after)):
            among = sets.get(name, {}).get("among_alternatives_at")
            if among:
                rows.append([text, when, fraction(sets[name]["recall"]), percent(among["1"]),
                             percent(among["20"])])
    return table(["set", "", "found, default threshold", "truth is the placement or an alternative of "
                  "the best interpretation, threshold 0.05", "of twenty interpretations"], rows)


def write_baseline(folder, commit, machine):
    """Keeps the figures of a folder, and of the curves what the report shows."""
    sets = summaries(folder)
    for kept in sets.values():
        if "threshold_curve" in kept:
            kept["threshold_curve"] = [point_at(kept["threshold_curve"], threshold)
                                       for threshold in SHOWN_THRESHOLDS]
    kept = {"format": "bpa accuracy baseline", "version": 1, "commit": commit,
            "date": datetime.date.today().isoformat(), "machine": machine, "sets": {}}
    lines = ",\n".join(f" {json.dumps(name)}: {json.dumps(of)}" for name, of in sets.items())
    BASELINE.write_text(json.dumps(kept)[:-2] + "\n" + lines + "\n}}\n", encoding="utf-8")
    print(f"baseline: {BASELINE}")
