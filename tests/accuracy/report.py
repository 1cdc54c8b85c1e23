# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Writes FOLDER/report.md from what report.sh left there: python3 report.py FOLDER.

    report.py FOLDER --baseline COMMIT

keeps the figures of FOLDER as those of COMMIT in baseline.json beside this file. Later reports give
them as "before". Needs nothing but Debian's python3. What was skipped is said to be skipped.
"""

import argparse
import os
from pathlib import Path

import comparison
import leave_one_out
from comparison import FREE, RUNS
from cells import load, percent, table

# Glover and Popovic, section VII: Clutter data set; RMSE criterion on the Kinect data set.
PAPER = {
    "bpa": {"precision": "83.8 %", "recall": "73.3 %"},
    "icp": {"precision": "73.8 %", "recall": "63.3 %"},
    "recall_at": {1: 73.3, 2: 77.5, 3: 80.0, 5: 80.8, 10: 83.3, 20: 84.2},
}
PLOTS = [
    ("visible_histogram", "how visible the instances of the set are"),
    ("recall", "recall by number of interpretations"),
    ("visible_fraction", "recall by visible fraction"),
    ("distance", "recall by distance"),
    ("objects", "recall by object"),
    ("reports", "right and false reports by probability"),
    ("reliability", "calibration of probabilities"),
    ("coverage", "coverage of credible regions"),
    ("time", "time of frames"),
]


def machine():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {os.cpu_count()} cores"


def headline(runs):
    rows = [
        ["paper, Clutter, BPA", "30", "", PAPER["bpa"]["precision"], PAPER["bpa"]["recall"], "", "",
         "", ""],
        ["paper, Clutter, ICP", "30", "", PAPER["icp"]["precision"], PAPER["icp"]["recall"], "", "",
         "", ""],
    ]
    for name, run in runs:
        bop, rmse = run.get("bop", {}), run["rmse"]
        rows.append([
            name, run["frames"], run["recall"]["total"], percent(run["precision"]),
            percent(run["recall"]), percent(rmse["precision"]), percent(rmse["recall"]),
            f"{bop['average_recall']:.3f}" if bop else "-",
            f"{run['seconds']['median']:.2f}",
        ])
    return table(["set", "frames", "instances", "precision", "recall", "precision, RMSE 1 cm",
                  "recall, RMSE 1 cm", "BOP AR", "s a frame"], rows)


def interpretations(runs):
    counts = [1, 2, 3, 5, 10, 20]
    rows = [["paper, Clutter"] + [f"{PAPER['recall_at'][n]} %" for n in counts]]
    for name, run in runs:
        rows.append([name] + [percent(run["recall_at"][str(n)]) for n in counts])
    return table(["recall of the first"] + [str(n) for n in counts], rows)


def bop_errors(runs):
    rows = []
    for name, run in runs:
        bop = run["bop"]
        rows.append([name, f"{bop['vsd']:.3f}", f"{bop['mssd']:.3f}", f"{bop['mspd']:.3f}",
                     f"{bop['average_recall']:.3f}", percent(bop["add_recall"]),
                     f"{1000 * run['mean_add_m']:.1f}", f"{1000 * run['mean_adds_m']:.1f}"])
    return table(["set", "VSD", "MSSD", "MSPD", "AR", "ADD(-S) < 0.1 d", "ADD of finds, mm",
                  "ADD-S of finds, mm"], rows)


def certainty(runs):
    rows = []
    for name, run in runs:
        levels = [percent(c["covered"]) for c in run["coverage"]]
        rows.append([name, f"{run['calibration']['brier']:.3f}"] + levels
                    + [f"{run['normalised_square']:.3f}"])
    levels = [f"{100 * c['level']:.0f} % region holds" for c in runs[0][1]["coverage"]]
    return table(["set", "Brier score"] + levels + ["mean squared error in standard deviations"],
                 rows)


def times(runs):
    rows = [[name] + [f"{run['seconds'][key]:.2f}" for key in ("median", "mean", "max")]
            for name, run in runs]
    return table(["set", "median, s", "mean", "largest"], rows)


def breakdown(title, key, runs, with_precision):
    names = []
    for _, run in runs:
        names += [g["name"] for g in run[key] if g["name"] not in names]
    if key != "by_object":
        names.sort(key=lambda n: float(n.split("-")[0]))
    header, rows = [title], [[name] for name in names]
    for run_name, run in runs:
        groups = {g["name"]: g for g in run[key]}
        header.append(f"{run_name}: recall")
        if with_precision:
            header.append("precision")
        for row in rows:
            group = groups.get(row[0], {})
            row.append(percent(group.get("recall")))
            if with_precision:
                row.append(percent(group.get("precision")))
    return table(header, rows)


def free_scenes(folder):
    rows = []
    for name, text in FREE:
        run = load(folder / name / "evaluation.json")
        everything = load(folder / f"{name}-everything" / "evaluation.json")
        if run is None or everything is None:
            rows.append([text, "skipped", "", "", ""])
            continue
        false = run["false_reports"]
        counts = [bin_["correct"]["total"] for bin_ in everything["calibration"]["bins"]]
        rows.append([text, false["free_frames"], false["frames_with_report"], false["reports"],
                     " ".join(str(count) for count in counts)])
    return table(["frames", "number", "with a false report", "false reports",
                  "by tenths of probability, least probability 0.05"], rows)


def plane_noise(sensor):
    rows = []
    for plane in sensor["planes"]:
        rows.append([f"{plane['depth_m']:.1f} m", f"{plane['angle_deg']:.0f}°",
                     f"{1000 * plane['axial_m']:.2f}", f"{1000 * plane['published_axial_m']:.2f}",
                     f"{plane['lateral_px']:.2f}", f"{plane['published_lateral_px']:.2f}",
                     f"{100 * plane['missing']:.1f}"])
    return table(["depth", "angle", "axial noise, mm", "published", "edge, pixels", "published",
                  "no depth, %"], rows)


def sensor_frames(sensor):
    frames = sensor.get("frames")
    if not frames or not frames.get("frames"):
        return "Skipped: there are no real frames.\n"
    names = [("missing", "share of pixels without depth"),
             ("small_holes", "small holes for each 10000 pixels"),
             ("left_gap_px", "gap left of edges, pixels"),
             ("right_gap_px", "gap right of edges, pixels"),
             ("roughness", "roughness of planes, pixels of disparity"),
             ("near_correlation", "correlation of noise 1.5 pixels apart"),
             ("far_correlation", "correlation of noise 5 pixels apart")]
    rows = [[text, f"{frames['real'][key]:.3f}", f"{frames['simulated'][key]:.3f}"]
            for key, text in names]
    text = table([f"mean of {frames['frames']} frames", "real", "simulated"], rows)
    return text + "\n![real frames left, simulated ones right](sheet.png)\n"


def pictures(folder, run):
    text = ""
    for name, caption in PLOTS:
        if (folder / run / "plots" / f"{name}.png").is_file():
            text += f"![{caption}]({run}/plots/{name}.png)\n"
    return text


def worst(folder, run):
    path = f"{run}/annotated/worst_frames.png"
    return f"![truth left, result right]({path})\n" if (folder / path).is_file() else ""


def report(folder):
    runs = [(text, load(folder / name / "evaluation.json")) for name, text in RUNS]
    after, baseline = comparison.summaries(folder), load(comparison.BASELINE) or {"sets": {}}
    before = baseline["sets"]
    skipped = [text for name, text in RUNS + FREE if name not in after]
    runs = [(text, run) for text, run in runs if run is not None]
    simulated = [(text, run) for text, run in runs if text.startswith("clutter")]
    real = [(text, run) for text, run in runs if text.startswith("real")]
    sensor = load(folder / "sensor.json")
    visible = simulated[0][1]["visible_fraction"]
    parts = [
        "# Accuracy\n",
        f"Machine: {machine()}, load {os.getloadavg()[2]:.1f} over the last quarter of an hour (times "
        "are wall-clock times). Every model of the library is a candidate in every frame. A find is "
        "within 2.5 cm and π/16 modulo the symmetry; instances of which less than a tenth is "
        "visible neither count nor are false.\n",
        f"Skipped, for want of data: {'; '.join(skipped)}.\n" if skipped else "",
        "## Before and now\n",
        f"Before: commit {baseline['commit']}, {baseline['date']}, {baseline['machine']}.\n"
        if before else "There is no baseline.json to compare with.\n",
        comparison.before_and_after(before, after),
        "## Choosing the threshold\n",
        "All sets with objects, in colour; the ambiguous one is left out.\n",
        comparison.pooled_curve(after),
        "## Poses that the view leaves open\n", comparison.ambiguous(before, after),
        "## Over the threshold\n",
        "One search at a threshold of 0.05; what is less probable than the row is left out. A search "
        "at the row's own threshold can hold a placement less.\n",
        comparison.curves(folder, before, after),
        "## In short\n", headline(runs),
        "The paper's recalls on its Clutter set are multiples of 1/120: some four instances a scene. "
        f"Ours has {simulated[0][1]['recall']['total'] / simulated[0][1]['frames']:.1f} a scene that "
        "count.\n",
        "## Recall by number of interpretations\n", interpretations(runs),
        "## BOP and ADD\n", bop_errors(runs),
        "## How sure\n",
        "Regions are those of the right placements' covariances; a turn that changes nothing does "
        "not count.\n", certainty(runs),
        "## Time\n", times(runs),
        "## Where nothing is to be found\n", free_scenes(folder),
    ]
    parts += ["## What each part is worth, and what it costs\n",
              "Mean milliseconds of a frame's search, and how many more than without the part.\n"]
    for name, title in (("leave_one_out", "Simulated clutter, first scenes"),
                        ("leave_one_out_real", "Real frames")):
        if (folder / name).is_dir():
            parts.append(f"### {title}\n\n{leave_one_out.parts_table(folder / name)}")
    parts += [
        "## The simulated clutter\n",
        f"{sum(visible['tenths'])} instances, median visible fraction {visible['median']:.2f}; by "
        f"tenths {' '.join(str(count) for count in visible['tenths'])}.\n",
        pictures(folder, "clutter"),
        breakdown("visible fraction", "by_visible_fraction", simulated, False),
        breakdown("distance", "by_distance", simulated, True),
        breakdown("object", "by_object", simulated, True),
        "### Worst frames\n", worst(folder, "clutter"),
    ]
    if real:
        parts += [
            "## Real frames\n", pictures(folder, "real"),
            breakdown("visible fraction", "by_visible_fraction", real, False),
            breakdown("distance", "by_distance", real, True),
            breakdown("object", "by_object", real, True),
            "### Worst frames\n", worst(folder, "real"),
        ]
    parts.append("## Alignment alone: BPA against ICP from noisy starts\n")
    for name in ("position", "orientation"):
        if (folder / "alignment" / f"alignment_{name}.png").is_file():
            parts.append(f"![error of {name} by iteration](alignment/alignment_{name}.png)\n")
    if sensor:
        parts += ["## The simulated sensor\n",
                  "Published: Nguyen, Izadi and Lovell 2012.\n", plane_noise(sensor),
                  "Beside real frames:\n", sensor_frames(sensor)]
    commands = (folder / "commands.log").read_text()
    parts.append(f"## Commands\n\n```\n{commands}```\n")
    return "\n".join(part for part in parts if part)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--baseline", metavar="COMMIT")
    arguments = parser.parse_args()
    folder = arguments.folder
    if arguments.baseline:
        comparison.write_baseline(folder, arguments.baseline, machine())
    (folder / "report.md").write_text(report(folder), encoding="utf-8")
    print(f"report: {folder / 'report.md'}")


if __name__ == "__main__":
    main()
