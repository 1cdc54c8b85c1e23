# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""What leave_one_out.sh needs beside the program:

    leave_one_out.py layer FILE       writes a score layer that has learned nothing
    leave_one_out.py table FOLDER     prints the Markdown table of FOLDER/*.json

Needs nothing but Debian's python3.
"""

import json
import sys
from pathlib import Path

ROWS = [
    ("all", "everything"),
    ("use_orientation", "orientations (ICP instead of BPA)"),
    ("use_segments", "sampled segments"),
    ("use_edges", "edge correspondences"),
    ("climb", "climbing the score"),
    ("use_round_three", "components of round three"),
    ("use_color", "colours"),
    ("layer", "the learned layer (all components weigh the same)"),
]

# What the score layer reads, from its worst to its best value.
RANGES = {
    "range": (-1, 0), "normal": (-1, 0), "agreeing": (0, 1), "free_space": (1, 0),
    "visibility": (0, 1), "edge": (-1, 0), "edge_support": (0, 1), "edge_visibility": (0, 1),
    "shape": (0, 1), "relative_area": (0, 1), "unknown": (1, 0), "explained": (0, 1),
    "evidence": (0, 10), "range_evidence": (-10, 0), "edge_evidence": (-10, 0),
    "background": (1, 0), "support": (0, 100), "edge_likelihood": (-1, 0),
    "occlusion_edge": (-1, 0), "random_walk": (-1, 0), "segment": (-1, 0),
    "segment_affinity": (-1, 0), "fpfh": (-1, 0), "color": (-1, 0),
    "rivals": (-500, 0),
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


def write_layer(path):
    layer = {
        "provenance": "nothing: each component weighs the same",
        "bias": 0,
        "components": {name: line(*ends) for name, ends in RANGES.items()},
    }
    layers = {"score_layer_version": 3, "round_two": layer, "round_three": layer,
              "without_color": layer}
    path.write_text(json.dumps(layers, indent=2) + "\n")


def share(hits, total):
    return f"{100 * hits / total:.1f} % ({hits}/{total})" if total else "-"


def print_table(folder):
    print("| left out | right pose in the final 50 | in the best 20 interpretations "
          "| in the best | precision of the best |")
    print("|---|---|---|---|---|")
    for name, title in ROWS:
        path = folder / f"{name}.json"
        if not path.is_file():
            continue
        run = json.loads(path.read_text())
        alive = run["alive"]
        cells = [share(alive[stage], alive["instances"]) for stage in ("final", "best 20", "best")]
        cells.append(share(run["right"], run["reported"]))
        print(f"| {'nothing' if name == 'all' else title} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    command, where = sys.argv[1], Path(sys.argv[2])
    write_layer(where) if command == "layer" else print_table(where)
