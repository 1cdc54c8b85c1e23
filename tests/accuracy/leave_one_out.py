# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""What leave_one_out.sh needs beside the program:

    leave_one_out.py parts            prints the names of the parts that settings leave out
    leave_one_out.py settings PART    prints the settings (YAML) without this part
    leave_one_out.py layer FILE       writes a score layer that has learned nothing
    leave_one_out.py table FOLDER     prints the Markdown table of FOLDER/*.json

Needs nothing but Debian's python3.
"""

import json
import sys
from pathlib import Path

import table

# Each part, what the table calls it, and the settings that leave it out (config/detector.yaml).
PARTS = {
    "use_orientation": ("orientations (ICP instead of BPA)", "align: {use_orientation: false}"),
    "use_segments": ("sampled segments", "align: {use_segments: false}"),
    "use_edges": ("edge correspondences", "align: {use_edges: false}"),
    "climb": ("climbing the score", "climb: {max_climbed: 0}"),
    "lay": ("thin objects laid flat", "lay: {max_laid: 0}"),
    "rims": ("pairs with rims", "sample: {rim_peaks_per_reference: 0}"),
    "rounds": ("rounds after the first", "rounds: {max_rounds: 1}"),
    "use_round_three": ("components of round three", "score: {use_round_three: false}"),
    "use_texture": ("patterns of surfaces", "features: {use_texture: false}"),
    "use_outline": ("outlines and figure-ground in colour", "features: {use_outline: false}"),
    "given_others": ("what hides what", "scene: {judge_given_others: false}"),
    "use_color": ("colours", "features: {use_color: false}"),
}
ROWS = [("all", "nothing"), *((name, title) for name, (title, _) in PARTS.items()),
        ("layer", "the learned layer (all components weigh the same)")]

BUILT_IN_LAYERS = Path(__file__).resolve().parents[2] / "config/score_layers.json"

# What the score layer reads, from its worst to its best value.
RANGES = {
    "range": (-1, 0), "normal": (-1, 0), "agreeing": (0, 1), "free_space": (1, 0),
    "visibility": (0, 1), "edge": (-1, 0), "edge_support": (0, 1), "edge_visibility": (0, 1),
    "shape": (0, 1), "relative_area": (0, 1), "unknown": (1, 0), "explained": (0, 1),
    "evidence": (0, 10), "range_evidence": (-10, 0), "edge_evidence": (-10, 0),
    "background": (1, 0), "support": (0, 100), "edge_likelihood": (-1, 0),
    "occlusion_edge": (-1, 0), "random_walk": (-1, 0), "segment": (-1, 0),
    "segment_affinity": (-1, 0), "fpfh": (-1, 0), "color": (-1, 0), "tint": (200, 0),
    "texture": (-1, 1), "texture_evidence": (-100, 100), "silhouette": (0, 1),
    "silhouette_contrast": (-1, 1), "below": (1, 0), "gap": (0.2, 0), "balance": (-0.5, 0.5),
    "rivals": (-500, 0), "rivals_color": (-500, 0), "hidden_by_unknown": (1, 0), "left_over": (1, 0),
    "copies": (-2, 2), "relative_exposure": (-1, 1),
}
KNOTS = 8


def line(worst, best):
    """From log odds of -1 at the worst value to 1 at the best; places have to rise."""
    steps = [k / (KNOTS - 1) for k in range(KNOTS)]
    low, high = sorted((worst, best))
    sign = 1 if best > worst else -1
    return {
        "place": [low + (high - low) * step for step in steps],
        "log_odds": [sign * (2 * step - 1) for step in steps],
    }


def unlearned_layers():
    """Layers of the form of the built-in ones, whose components all weigh the same."""
    built_in = json.loads(BUILT_IN_LAYERS.read_text(encoding="utf-8"))
    names = set(built_in["round_three"]["components"])
    if names != set(RANGES):
        sys.exit(f"leave_one_out.py: RANGES and {BUILT_IN_LAYERS.name} differ in "
                 + ", ".join(sorted(names ^ set(RANGES))))
    layer = {
        "provenance": "nothing: each component weighs the same",
        "bias": 0,
        "components": {name: line(*ends) for name, ends in RANGES.items()},
    }
    return {name: layer if isinstance(old, dict) else old for name, old in built_in.items()}


def parts_table(folder):
    """Costs are the mean milliseconds of a frame with everything, less those without the part."""
    rows, all_ms = [], None
    for name, title in ROWS:
        path = folder / f"{name}.json"
        if not path.is_file():
            continue
        run = json.loads(path.read_text(encoding="utf-8"))
        alive, ms = run["alive"], run["mean_milliseconds"]["total"]
        all_ms = ms if name == "all" else all_ms
        shares = [(alive[stage], alive["instances"]) for stage in ("select", "best 20", "best")]
        shares.append((run["right"], run["reported"]))
        rows.append([title,
                     *(table.percent({"hits": hits, "total": total}) for hits, total in shares),
                     f"{ms:.0f}", "" if name == "all" or all_ms is None else f"{all_ms - ms:.0f}"])
    return table.table(["left out", "right pose in the final 50", "in the best 20 interpretations",
                        "in the best", "precision of the best", "ms a frame",
                        "cost of the part, ms"], rows)


def main(command, where=""):
    if command == "parts":
        print(" ".join(PARTS))
    elif command == "settings":
        print(PARTS[where][1])
    elif command == "layer":
        Path(where).write_text(json.dumps(unlearned_layers(), indent=2) + "\n", encoding="utf-8")
    elif command == "table":
        print(parts_table(Path(where)), end="")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(*sys.argv[1:])
