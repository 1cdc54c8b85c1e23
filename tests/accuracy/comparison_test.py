# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the tables over the threshold on evaluations whose figures are counted by hand."""

import json
import tempfile
import unittest
from pathlib import Path

import comparison


def ratio(hits, total):
    return {"hits": hits, "total": total, "value": hits / total if total else None}


def evaluation(frames, instances, placements):
    """Of (probability, right) pairs, with the keys of 'bpa evaluate --json-out' that are read."""
    curve = []
    for step in range(1, 20):
        left = [right for probability, right in placements if probability >= step / 20]
        curve.append({"threshold": step / 20, "precision": ratio(sum(left), len(left)),
                      "recall": ratio(sum(left), instances),
                      "false_positives_per_frame": (len(left) - sum(left)) / frames})
    right = sum(right for _, right in placements)
    return {"frames": frames, "precision": ratio(right, len(placements)),
            "recall": ratio(right, instances), "recall_at": {"20": ratio(right, instances)},
            "among_alternatives_at": {"1": ratio(right, instances), "20": ratio(right, instances)},
            "seconds": {"median": 1.5}, "calibration": {"expected_error": 0.25, "brier": 0.5},
            "threshold_curve": curve}


class Comparison(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.write("real", evaluation(2, 4, [(0.95, 1), (0.6, 1), (0.4, 0)]))
        self.write("clutter", evaluation(3, 5, [(0.8, 1), (0.2, 1), (0.1, 0)]))
        self.write("osd", evaluation(5, 0, [(0.5, 0), (0.35, 0), (0.15, 0)]))
        self.write("ambiguous", evaluation(1, 1, [(0.99, 0)]))

    def write(self, name, run):
        for of in (name, f"{name}-everything"):
            (self.folder / of).mkdir()
            (self.folder / of / "evaluation.json").write_text(json.dumps(run))

    def test_the_pooled_curve_sums_counts(self):
        rows = comparison.pooled_curve(comparison.summaries(self.folder)).splitlines()[2:]
        self.assertEqual(rows, [
            "| 0.1 | 4/6 | 4/9 | 3 in 5 frames |",
            "| 0.3 | 3/4 | 3/9 | 2 in 5 frames |",
            "| 0.4 | 3/4 | 3/9 | 1 in 5 frames |",
            "| 0.5 (default) | 3/3 | 3/9 | 1 in 5 frames |",
            "| 0.7 | 2/2 | 2/9 | 0 in 5 frames |",
            "| 0.9 | 1/1 | 1/9 | 0 in 5 frames |"])

    def test_what_was_skipped_is_in_no_table(self):
        after = comparison.summaries(self.folder)
        self.assertEqual(set(after), {"real", "clutter", "osd", "ambiguous"})
        self.assertNotIn("time of flight", comparison.curves(self.folder, {}, after))

    def test_a_baseline_gives_the_same_rows_as_the_run_it_keeps(self):
        comparison.BASELINE = self.folder / "baseline.json"
        comparison.write_baseline(self.folder, "abc1234", "a machine")
        kept = comparison.load(comparison.BASELINE)
        self.assertEqual((kept["commit"], kept["machine"]), ("abc1234", "a machine"))
        after = comparison.summaries(self.folder)
        for name, now in after.items():
            for row in comparison.curve_rows(kept["sets"][name], now):
                self.assertEqual(row[1::2], row[2::2])
        rows = comparison.before_and_after(kept["sets"], after).splitlines()[2:]
        self.assertEqual(len(rows), 8)
        for before, now in zip(rows[::2], rows[1::2]):
            self.assertEqual(before.replace("| before |", "| now |"), now)

    def test_the_ambiguous_set_is_a_row(self):
        after = comparison.summaries(self.folder)
        self.assertIn("| ambiguous: a mug, its handle out of sight | now | 0/1 | 0.0 % (0/1) | "
                      "0.0 % (0/1) |", comparison.ambiguous({}, after).splitlines())


if __name__ == "__main__":
    unittest.main()
