# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the table, the comparison and the counts on figures that are counted by hand."""

import json
import math
import tempfile
import unittest
from pathlib import Path

import accuracy
import table
from domains import DOMAINS


def row(domain="bin", effort="default", chosen_on="held out", **figures):
    return {"domain": domain, "effort": effort, "chosen_on": chosen_on, "frames_digest": "f",
            "frames": 2, "instances": 10, "seeds": [1, 2], "command": "bpa detect",
            "found": [4, 6], "false_positives": [0, 0], "found_in_twenty": [7, 7],
            "seconds": [0.5, 0.7]} | figures


def report(*rows):
    return {"format": table.FORMAT, "version": table.VERSION, "commit": "abc1234", "machine": "m",
            "date": "2026-11-27", "threads": 2, "skipped": [], "rows": list(rows)}


class Verdict(unittest.TestCase):
    def test_it_needs_means_outside_both_ranges_and_two_standard_errors(self):
        # Means 11 and 21: variances 1 and 1, error sqrt(1/3 + 1/3) = 0.82.
        self.assertEqual(table.verdict([10, 11, 12], [20, 21, 22], True), "better")
        self.assertEqual(table.verdict([10, 11, 12], [20, 21, 22], False), "worse")
        self.assertEqual(table.verdict([20, 21, 22], [10, 11, 12], True), "worse")
        # 12.5 lies beyond 12, but 11 lies within 10 to 15.
        self.assertEqual(table.verdict([10, 11, 12], [10, 15], True), "")
        # Means 1 and 3 lie outside 0 to 2 and 2 to 4, but the error is sqrt(1 + 1) = 1.41.
        self.assertEqual(table.verdict([0, 2], [2, 4], True), "")
        self.assertEqual(table.verdict([5, 5], [6, 6], True), "better")
        self.assertEqual(table.verdict([5, 5], [5, 5], True), "")

    def test_one_seed_is_not_judged(self):
        self.assertEqual(table.verdict([1], [9, 9], True), "")


class Table(unittest.TestCase):
    def test_rows_hold_means_and_ranges_and_sums_go_seed_by_seed(self):
        rows = [row(), row("flush", found=[1, 4], false_positives=[2, 1]),
                row("ycbv", chosen_on="development"),
                row("empty", instances=0, found=[0, 0], found_in_twenty=[0, 0])]
        lines = table.markdown(report(*rows)).splitlines()
        self.assertIn("2 at default effort", lines[0])
        self.assertEqual(lines[4:], [
            "| bin | default | held out | 2 | 10 | 5 (4 to 6) | 0 | 7 | 0.60 |",
            "| flush | default | held out | 2 | 10 | 2.5 (1 to 4) | 1.5 (1 to 2) | 7 | 0.60 |",
            "| ycbv | default | development | 2 | 10 | 5 (4 to 6) | 0 | 7 | 0.60 |",
            "| empty | default | held out | 2 | 0 | - | 0 | - | 0.60 |",
            "| all | default | development | 2 | 10 | 5 (4 to 6) | 0 | 7 |  |",
            "| all | default | held out | 6 | 20 | 7.5 (5 to 10) | 1.5 (1 to 2) | 14 |  |"])

    def test_a_comparison_says_what_changed_beyond_the_spread(self):
        before = report(row(), row("flush"), row("gone"))
        now = report(row(found=[9, 9], seconds=[0.3, 0.3]), row("flush", frames_digest="g"),
                     row("new"))
        lines = table.comparison(before, now).splitlines()[4:]
        self.assertEqual(lines[:2], [
            "| bin | default | held out | 5 (4 to 6) → 9 | 0 → 0 | 7 → 7 | 0.50 | found: better |",
            "| flush | default | held out | 5 (4 to 6) → 5 (4 to 6) | 0 → 0 | 7 → 7 | 1.00 "
            "| other frames: not compared |"])
        self.assertEqual(len(lines), 3)  # and the sum
        self.assertIn("other frames", lines[2])

    def test_a_file_is_read_as_it_was_written(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "accuracy.json"
            table.write(report(row(), row("flush")), path)
            self.assertEqual(table.read(path), report(row(), row("flush")))
            path.write_text(json.dumps({"format": table.FORMAT, "version": 2}))
            self.assertRaises(SystemExit, table.read, path)


class Counts(unittest.TestCase):
    def test_an_evaluation_is_counted(self):
        ratio = {"hits": 3, "total": 5}
        evaluation = {"frames": 4, "precision": ratio, "recall": {"hits": 3, "total": 9},
                      "recall_at": {"1": ratio, "20": {"hits": 6, "total": 9}},
                      "seconds": {"median": 0.25}}
        self.assertEqual(accuracy.counts(evaluation), {
            "frames": 4, "instances": 9, "found": 3, "false_positives": 2, "found_in_twenty": 6,
            "seconds": 0.25})

    def test_a_pose_is_right_within_the_tolerances(self):
        def placement(angle, x, model="milk"):
            rotation = [math.cos(angle / 2), math.sin(angle / 2), 0, 0]
            return {"model": model, "pose": {"rotation_wxyz": rotation, "translation_m": [x, 0, 1]}}

        poses = {"milk": ((-1, 0, 0, 0), (0, 0, 1))}  # no turn: q and -q are one rotation
        self.assertTrue(accuracy.is_right(placement(0.19, 0.024), poses))
        self.assertFalse(accuracy.is_right(placement(0.20, 0.024), poses))  # pi/16 = 0.196
        self.assertFalse(accuracy.is_right(placement(0.19, 0.026), poses))
        self.assertFalse(accuracy.is_right(placement(0, 0, "can"), poses))
        ranks = [[placement(0, 1)], [placement(0, 0)]]
        with tempfile.TemporaryDirectory() as folder:
            result = Path(folder) / "result.json"
            result.write_text(json.dumps({"frames": [{"seconds": 2, "interpretations": [
                {"placements": placements} for placements in ranks]}]}))
            self.assertEqual(accuracy.judged(result, poses), {
                "frames": 1, "instances": 1, "found": 0, "false_positives": 1,
                "found_in_twenty": 1, "seconds": 2})


class Kept(unittest.TestCase):
    def test_what_the_same_stamp_made_is_not_made_again(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "in" / "result.json"
            for stamp, made in (("a", "x"), ("a", "x"), ("b", "xx"), ("a", "xxx")):
                accuracy.Bench.made(path, stamp, ["sh", "-c", f"printf x >> {path}"])
                self.assertEqual(path.read_text(), made)


class Domains(unittest.TestCase):
    def test_each_has_a_name_of_its_own_and_one_set_of_options_makes_its_frames(self):
        self.assertEqual(len({domain.name for domain in DOMAINS}), len(DOMAINS))
        made = {}
        for domain in DOMAINS:
            options = (domain.simulate, domain.models)
            self.assertEqual(made.setdefault(domain.folder, options), options)


if __name__ == "__main__":
    unittest.main()
