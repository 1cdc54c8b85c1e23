# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""One table of the detector's accuracy: a row for each domain (domains.py) and effort.

Each row holds means over seeds of the search, and the range. Frames are the same for all seeds.
Simulates and builds libraries where they are missing in OUTPUT, detects, evaluates, and writes
OUTPUT/accuracy.json after each row, OUTPUT/accuracy.md at the end. Searches that the same detector
has made there are kept. Needs nothing but Debian's python3.
"""

import argparse
import datetime
import fnmatch
import functools
import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import table
from domains import DOMAINS, EFFORTS

HERE = Path(__file__).resolve().parent
TOLERANCE_M, TOLERANCE_RAD = 0.025, math.pi / 16  # of bpa evaluate


def run(*command):
    """Runs a program quietly; what it said is shown where it fails."""
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(done.args)}\n{done.stdout[-2000:]}")


def machine():
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {os.cpu_count()} cores"


def commit():
    done = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], text=True,
                          capture_output=True, check=False)
    return done.stdout.strip() or "unknown"


@functools.cache
def digest(path):
    """Of a file, or of all files of a folder: frames that differ cannot be compared."""
    whole = hashlib.sha256()
    files = [path] if path.is_file() else sorted(one for one in path.rglob("*") if one.is_file())
    for file in files:
        whole.update(file.read_bytes())
    return whole.hexdigest()[:16]


class Bench:
    """Frames, libraries and results of one folder."""

    def __init__(self, arguments):
        self.output, self.data = arguments.output, arguments.data
        self.bpa, self.detector = arguments.programs / "bpa", arguments.detector
        self.threads, self.detector_digest = arguments.threads, digest(arguments.detector)

    @staticmethod
    def made(path, stamp, command):
        """Runs the command that makes a file or folder, unless it is there with this stamp."""
        mark = path.with_name(path.name + ".made_by")
        if path.exists() and mark.exists() and mark.read_text(encoding="utf-8") == stamp:
            return path
        mark.unlink(missing_ok=True)
        if path.is_dir():
            shutil.rmtree(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        run(*command)
        mark.write_text(stamp, encoding="utf-8")
        return path

    def is_there(self, domain):
        """Whether the data that the domain needs are there."""
        needs = [] if "," in domain.models else [domain.models]
        if not domain.simulate:
            needs.append(domain.folder)
        return all((self.data / need).exists() for need in needs if need)

    def frames(self, domain):
        if not domain.simulate:
            return self.data / domain.folder
        folder = self.output / "sets" / domain.folder
        options = domain.simulate.split()
        if "," in domain.models:
            options += ["--models", domain.models]
        elif domain.models:
            models = self.data / domain.models
            options += ["--meshes", models / "models" if (models / "models").exists() else models]
        return self.made(folder, domain.simulate + domain.models,
                         [self.bpa, "simulate", "scenes", "--out", folder, *options])

    def library(self, domain):
        """One for each choice of models; made anew by another detector."""
        models, name = self.data / domain.models, domain.models or "household"
        name = "workshop" if "," in name else name.replace("/", "_")
        folder = self.output / "libraries" / name
        if models.suffix == ".pcd":
            command = ["from-mesh", models, "--name", models.stem]
        else:
            command = ["from-bop", models if domain.models and (models / "models").exists()
                       else self.frames(domain)]
        return self.made(folder, self.detector_digest,
                         [self.detector, "model", *command, "--library", folder])

    def search(self, domain, effort, seed):
        """The figures of one seed, and the command that made them."""
        frames, library = self.frames(domain), self.library(domain)
        folder = self.output / "results" / domain.name.replace(" ", "_") / effort
        folder.mkdir(parents=True, exist_ok=True)
        config, settings = folder / "detector.yaml", EFFORTS[effort] + domain.settings
        config.write_text(settings, encoding="utf-8")
        clouds = [frames] if frames.is_file() else organised_clouds(frames)
        source = ["--pcd", *clouds] if clouds else ["--bop", frames]
        report = folder / f"{seed}_evaluation.json"
        result = folder / f"{seed}.json"
        command = [self.detector, "detect", "--library", library, *source, "--config", config,
                   "--seed", seed, "--threads", self.threads, "--json", result]
        words = " ".join(str(word) for word in command)
        stamp = f"{words}\n{settings}{self.detector_digest} {digest(frames)}"
        self.made(result, stamp, command)
        if domain.poses:
            return judged(result, domain.poses), words
        truth = ["--nothing-there"] if domain.nothing_known else ["--bop", frames]
        run(self.bpa, "evaluate", *truth, "--json", result, "--json-out", report)
        return counts(json.loads(report.read_text(encoding="utf-8"))), words

    def row(self, domain, effort, seeds):
        searched = [self.search(domain, effort, seed) for seed in seeds]
        figures = [one for one, _ in searched]
        row = {"domain": domain.name, "effort": effort,
               "frames_digest": digest(self.frames(domain)),
               "chosen_on": "development" if domain.chosen_on else "held out",
               "frames": figures[0]["frames"], "instances": figures[0]["instances"],
               "seeds": list(seeds), "command": searched[0][1]}
        return row | {key: [one[key] for one in figures] for key in (*table.COUNTS, "seconds")}


def organised_clouds(folder):
    """Clouds of one row are no images."""
    return [path for path in sorted(folder.glob("*.pcd"))
            if b"HEIGHT 1\n" not in path.read_bytes()[:1000]]


def counts(report):
    """Of an evaluation."""
    precision, recall = report["precision"], report["recall"]
    return {"frames": report["frames"], "instances": recall["total"], "found": recall["hits"],
            "false_positives": precision["total"] - precision["hits"],
            "found_in_twenty": report["recall_at"].get("20", {"hits": 0})["hits"],
            "seconds": report["seconds"]["median"]}


def is_right(placement, poses):
    """Within the tolerances of one of the poses, which have no symmetries."""
    truth = poses.get(placement["model"])
    if truth is None:
        return False
    rotation, translation = placement["pose"]["rotation_wxyz"], placement["pose"]["translation_m"]
    cosine = abs(sum(a * b for a, b in zip(rotation, truth[0])))
    return (math.dist(translation, truth[1]) <= TOLERANCE_M
            and 2 * math.acos(min(1, cosine)) <= TOLERANCE_RAD)


def judged(result, poses):
    """Counts of a result on one cloud with known poses."""
    frames = json.loads(result.read_text(encoding="utf-8"))["frames"]
    ranks = [frame_ranks["placements"] for frame_ranks in frames[0]["interpretations"]]
    right = [sum(is_right(placement, poses) for placement in rank) for rank in ranks] or [0]
    return {"frames": 1, "instances": len(poses), "found": min(right[0], len(poses)),
            "false_positives": len(ranks[0]) - right[0] if ranks else 0,
            "found_in_twenty": min(max(right), len(poses)), "seconds": frames[0]["seconds"]}


def chosen(pattern_list):
    patterns = pattern_list.split(",")
    found = [domain for domain in DOMAINS
             if any(fnmatch.fnmatch(domain.name, pattern) for pattern in patterns)]
    return found or sys.exit(f"no domain is called {pattern_list}; there are "
                             + ", ".join(domain.name for domain in DOMAINS))


def measure(arguments):
    bench = Bench(arguments)
    report = {"format": table.FORMAT, "version": table.VERSION,
              "commit": arguments.commit or commit(), "machine": machine(),
              "date": datetime.date.today().isoformat(),
              "threads": arguments.threads, "skipped": [], "rows": []}
    arguments.output.mkdir(parents=True, exist_ok=True)
    for effort in arguments.effort.split(","):
        seeds = arguments.exhaustive_seeds if effort == "exhaustive" else arguments.seeds
        for domain in chosen(arguments.domains):
            if effort not in domain.efforts:
                continue
            if not bench.is_there(domain):
                report["skipped"].append(f"{domain.name}, {effort}")
                continue
            report["rows"].append(bench.row(domain, effort, range(1, seeds + 1)))
            print(table.progress(report["rows"][-1]), flush=True)
            table.write(report, arguments.output / "accuracy.json")
    return report


def options():
    parser = argparse.ArgumentParser(prog="./run accuracy", description=__doc__.split("\n\n")[0],
                                     epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--domains", default="*", metavar="A,B", help="only these; * stands for anything")
    add("--effort", default=",".join(EFFORTS), help="default, exhaustive or both, the default")
    add("--seeds", type=int, default=5, metavar="N", help="seeds of the search (5)")
    add("--exhaustive-seeds", type=int, metavar="N", help="at exhaustive effort (those of --seeds)")
    add("--compare", type=Path, metavar="JSON", help="say what is better or worse than there")
    add("--only-compare", type=Path, metavar="JSON",
        help="measure nothing: this file is the new one")
    add("--threads", type=int, default=0, help="of bpa detect; 0 = one for each core")
    add("--data", type=Path, default=Path(os.environ.get("BPA_DATA", "../shared/data")),
        metavar="DIR", help="ycbv/, real/ and so on; BPA_DATA or ../shared/data if not given")
    add("--programs", type=Path, default=Path("build/release/bin"), metavar="DIR",
        help="that simulate and evaluate")
    add("--detector", type=Path, metavar="FILE",
        help="bpa of another build, for models and detection")
    add("--commit", metavar="NAME", help="of the detector; this tree's if not given")
    add("--output", type=Path, default=Path("build/accuracy"), metavar="DIR")
    arguments = parser.parse_args()
    arguments.exhaustive_seeds = arguments.exhaustive_seeds or arguments.seeds
    arguments.detector = arguments.detector or arguments.programs / "bpa"
    return arguments


EPILOG = """default effort: the detector's defaults. exhaustive effort: rounds go on until no
surface is left.

All domains and five seeds take up to an hour at default effort on two cores, frames and models
included.

Frames, models and results are kept in OUTPUT. Another detector makes models and results again.

""" + table.RULE


def main():
    arguments = options()
    report = table.read(arguments.only_compare) if arguments.only_compare else measure(arguments)
    text = table.markdown(report)
    if arguments.compare:
        text += "\n" + table.comparison(table.read(arguments.compare), report)
    print(text)
    if not arguments.only_compare:
        (arguments.output / "accuracy.md").write_text(text, encoding="utf-8")
        print(f"written: {arguments.output}/accuracy.json, accuracy.md")


if __name__ == "__main__":
    main()
