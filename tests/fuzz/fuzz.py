# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the fuzz targets of the preset fuzz with libFuzzer, one after the other. Prints for each how
often it was called and whether it broke, then for each file that decodes how many of its lines all
inputs reached (llvm-cov; a file's writers, which no target calls, count as lines too).

    fuzz.py BUILD SECONDS [TARGET...]

SECONDS are for each target. BUILD/fuzzing/corpus keeps what was found, so that the next run goes on
from there. Inputs that break a promise are in BUILD/fuzzing/findings; a mended one moves to
tests/fuzz/corpus/TARGET, under a name that says what was wrong. Exits 1 if there is a finding.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RSS_LIMIT_MB = 1500  # an image of 8192 x 8192 pixels, three times
TIMEOUT_S = 10  # of one input
LEAKING = {"mesh"}  # Assimp 5.2.5 leaks what it has read of a file that it then refuses

# Why less than 80 % of a file's lines are reached: the rest does not read foreign bytes. After the
# semicolon: the tests that run it.
LOW = {
    "camera/oni_file.cpp": "its half writes recordings; camera/oni_file",
    "client/src/convert.cpp": "a third makes requests of the program's own data; client/results",
    "server/parameters.cpp": "a quarter lists the server's own settings; server/parameters",
    "server/web/http.cpp": "the rest words refusals; web/http",
    "server/web/to_json.cpp": "all but parameter_from_json writes the server's state; system/web",
}


class Target:
    def __init__(self, build, line):
        name, max_bytes, malloc_mb, *self.sources = line.split()
        self.name, self.max_bytes, self.malloc_mb = name, int(max_bytes), int(malloc_mb)
        self.program = build / "tests/fuzz_targets"
        self.folder = build / "fuzzing"
        self.corpus = self.folder / "corpus" / name
        self.seeds = self.folder / "seeds" / name
        self.corpus.mkdir(parents=True, exist_ok=True)
        (self.folder / "findings").mkdir(exist_ok=True)
        subprocess.run([build / "tests/fuzz_corpus", "--seeds", self.seeds, name], check=True,
                       env={**os.environ, "LLVM_PROFILE_FILE": "/dev/null"})

    def run(self, options, profile):
        """libFuzzer on all inputs that there are; returns its exit code and report."""
        committed = ROOT / "tests/fuzz/corpus" / self.name
        inputs = [self.corpus, self.seeds] + ([committed] if committed.is_dir() else [])
        environment = {**os.environ, "BPA_FUZZ_TARGET": self.name, "LLVM_PROFILE_FILE": profile,
                       "ASAN_OPTIONS": f"detect_leaks={int(self.name not in LEAKING)}"}
        command = ["nice", self.program, f"-max_len={self.max_bytes}", f"-timeout={TIMEOUT_S}",
                   f"-malloc_limit_mb={self.malloc_mb}", f"-rss_limit_mb={RSS_LIMIT_MB}",
                   f"-artifact_prefix={self.folder}/findings/{self.name}-", *options, *inputs]
        done = subprocess.run(command, env=environment, capture_output=True, text=True,
                              errors="replace")
        return done.returncode, done.stderr

    def fuzz(self, seconds):
        """Executions, and whether something was found."""
        code, report = self.run([f"-max_total_time={seconds}", "-print_final_stats=1"], "/dev/null")
        (self.folder / f"{self.name}.log").write_text(report)
        if code != 0:
            print(report[-6000:], file=sys.stderr)
        count = re.search(r"stat::number_of_executed_units:\s*(\d+)", report)
        last = re.findall(r"^#(\d+)\s", report, re.M)
        return int(count[1] if count else last[-1] if last else 0), code != 0

    def profile(self):
        """The file that says what all inputs reached; none after a crash."""
        path = self.folder / f"{self.name}.profraw"
        path.unlink(missing_ok=True)
        self.run(["-runs=0"], str(path))
        return [path] if path.exists() else []


def targets_of(build, wanted):
    listed = subprocess.run([build / "tests/fuzz_corpus"], check=True, capture_output=True, text=True,
                            env={**os.environ, "LLVM_PROFILE_FILE": "/dev/null"})
    lines = listed.stdout.splitlines()
    return [Target(build, line) for line in lines if not wanted or line.split()[0] in wanted]


def print_coverage(targets):
    """The lines of the targets' sources that the inputs of all of them reached."""
    merged = str(targets[0].folder / "all.profdata")
    profiles = [profile for target in targets for profile in target.profile()]
    subprocess.run(["llvm-profdata", "merge", "-o", merged, *profiles], check=True)
    report = subprocess.run(["llvm-cov", "export", "-summary-only", f"-instr-profile={merged}",
                             targets[0].program], check=True, capture_output=True)
    lines = {Path(file["filename"]).resolve(): file["summary"]["lines"]
             for file in json.loads(report.stdout)["data"][0]["files"]}
    print(f"\n{'source':36}{'lines':>7}{'reached':>9}")
    for source in sorted({source for target in targets for source in target.sources}):
        of_file = lines[ROOT / source]
        why = f"  {LOW[source]}" if of_file["percent"] < 80 and source in LOW else ""
        print(f"{source:36}{of_file['count']:7}{of_file['percent']:7.0f} %{why}")


def main():
    build, seconds = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    targets = targets_of(build, sys.argv[3:])
    sum_executions = sum_findings = 0
    print(f"{'target':20}{'executions':>12}  findings", flush=True)
    for target in targets:
        executions, found = target.fuzz(seconds)
        print(f"{target.name:20}{executions:12}  {int(found)}", flush=True)
        sum_executions += executions
        sum_findings += found
    print(f"{'sum':20}{sum_executions:12}  {sum_findings}")
    print_coverage(targets)
    if sum_findings:
        print(f"the inputs are in {build}/fuzzing/findings")
    return 1 if sum_findings else 0


if __name__ == "__main__":
    sys.exit(main())
