# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""usage: skips.py JUNIT_FILE. Prints what a run of ctest skipped, with the reason of each.

JUNIT_FILE is what `ctest --output-junit` writes. Exits 1 if a skip was not expected. The environment's
BPA_EXPECTED_SKIPS lists the expected ones, separated by spaces: SUITE.CASE of GoogleTest, or the CTest
name of any other test. If unset, none is expected where the folder of real frames is there, else
REAL_FRAMES.
"""

import os
import re
import sys
import xml.etree.ElementTree
from pathlib import Path

# The cases that read real RGB-D frames.
REAL_FRAMES = ("BopDataset.RealFrames", "CheckFrame.RealDepthThatIsNotRegistered",
               "CheckFrame.SaysNothingOfRealFrames", "Identity.OfARealFrame",
               "KindOfRealFrame.IsStructuredLight", "PcdFile.RealClouds",
               "TexturedScan.ColorsAgreeWithThoseOfTheVertices",
               "Ycbv.ATexturedMeshIsFoundTheRightWayRound",
               "Ycbv.ObjectsOfARealFrameAreFoundWhateverTheThreads")
SKIPPED_CASE = re.compile(r"^skipped: (\S+): (.*)$", re.MULTILINE)


def skips(junit):
    """(name, reason) of each skip in the text of a JUnit file, in order."""
    found = []
    for test in xml.etree.ElementTree.fromstring(junit).iter("testcase"):
        if test.find("skipped") is None:
            continue
        output = test.findtext("system-out") or ""
        reason = output.strip().splitlines()[-1:] or [test.find("skipped").get("message", "")]
        found += SKIPPED_CASE.findall(output) or [(test.get("name"), *reason)]
    return found


def expected(environment, root):
    """The names of the skips that are expected."""
    if "BPA_EXPECTED_SKIPS" in environment:
        return environment["BPA_EXPECTED_SKIPS"].split()
    data = environment.get("BPA_DATA") or root / "../shared/data"
    return () if (Path(data) / "ycbv").is_dir() else REAL_FRAMES


def main(path):
    allowed = expected(os.environ, Path(__file__).resolve().parents[2])
    found = skips(Path(path).read_text(encoding="utf-8"))
    surprises = [name for name, _ in found if name not in allowed]
    print(f"{len(found)} skipped, {len(surprises)} of them not expected")
    for name, reason in found:
        print(f"  {name}{' (not expected)' if name in surprises else ''}: {reason}")
    return 1 if surprises else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
