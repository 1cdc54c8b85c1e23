# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the settings and layers that the scripts of this folder write, on config/'s files."""

import json
import re
import unittest
from pathlib import Path

import domains
import leave_one_out

HERE = Path(__file__).resolve().parent
CONFIG = HERE.parents[1] / "config"


def detector_settings():
    """The default of every setting of config/detector.yaml, by its path such as climb.rounds."""
    settings, groups = {}, []
    for line in (CONFIG / "detector.yaml").read_text(encoding="utf-8").splitlines():
        match = re.fullmatch(r"( *)#?(\w+):(?: (\S+))?", line)
        if match:
            groups = [*groups[:len(match[1]) // 2], match[2]]
            if match[3]:
                settings[".".join(groups)] = match[3]
    return settings


def setting_and_value(text):
    """The path and the value of "group: {key: value}" or of "key: value"."""
    group, key, value = re.fullmatch(r"(?:(\w+): \{)?(\w+): (\S+?)\}?", text).groups()
    return (f"{group}.{key}" if group else key), value


class Settings(unittest.TestCase):
    def setUp(self):
        self.defaults = detector_settings()
        self.assertGreater(len(self.defaults), 50)

    def expect_change(self, text):
        """The text names one setting, and a value of its type other than the default."""
        path, value = setting_and_value(text)
        named = [one for one in self.defaults if one == path or one.endswith("." + path)]
        self.assertEqual(len(named), 1, text)
        default = self.defaults[named[0]]
        self.assertEqual(default in ("true", "false"), value in ("true", "false"), text)
        self.assertNotEqual(value, default, text)

    def test_each_part_is_left_out_by_a_setting_that_exists(self):
        for name, (_, settings) in leave_one_out.PARTS.items():
            with self.subTest(name=name):
                self.expect_change(settings)

    def test_the_settings_of_efforts_and_domains_exist(self):
        written = [*domains.EFFORTS.values(), *(domain.settings for domain in domains.DOMAINS)]
        for text in dict.fromkeys("".join(written).splitlines()):
            with self.subTest(text=text):
                self.expect_change(text)

    def test_the_unlearned_layers_have_the_form_of_the_built_in_ones(self):
        built_in = json.loads((CONFIG / "score_layers.json").read_text(encoding="utf-8"))
        unlearned = leave_one_out.unlearned_layers()
        self.assertEqual(unlearned["score_layer_version"], built_in["score_layer_version"])
        self.assertEqual(unlearned.keys(), built_in.keys())
        for name in ("round_two", "round_three", "without_color"):
            self.assertEqual(unlearned[name]["components"].keys(),
                             built_in[name]["components"].keys())
            for component, curve in unlearned[name]["components"].items():
                places = curve["place"]
                self.assertEqual(len(places), len(built_in[name]["components"][component]["place"]))
                self.assertEqual(places, sorted(set(places)), component)


if __name__ == "__main__":
    unittest.main()
