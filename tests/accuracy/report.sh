#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: report.sh PROGRAMS OUTPUT
# Detects and evaluates on real frames (ycbv/ in the folder BPA_DATA, or in ../shared/data) and on
# simulated ones, and writes OUTPUT/report.md with the commands that anybody can repeat.
set -euo pipefail
readonly programs=$1 output=$2 data=${BPA_DATA:-../shared/data}
readonly report=$output/report.md
mkdir -p "$output"

# step TITLE COMMAND...: runs it, and puts command and output into the report.
step() {
  local title=$1
  shift
  printf '\n%s: %s\n' "$title" "$*"
  "$@" 2>&1 | tee "$output/step.log"
  {
    printf '\n%s:\n\n```\n$ %s\n' "$title" "$*"
    cat "$output/step.log"
    printf '```\n'
  } >>"$report"
  rm "$output/step.log"
}

# evaluate NAME DATASET: library, detection and figures for one data set in the BOP layout.
evaluate() {
  local name=$1 set=$2 folder=$output/$1
  mkdir -p "$folder"
  rm -rf "$folder/library" "$folder/annotated"
  printf '\n## %s\n' "$name" >>"$report"
  step "Models" "$programs/bpa" model from-bop "$set" --library "$folder/library"
  step "Detection" "$programs/bpa" detect --library "$folder/library" --bop "$set" \
    --csv "$folder/result.csv" --json "$folder/result.json" --annotate "$folder/annotated"
  step "Figures" "$programs/bpa" evaluate --bop "$set" --csv "$folder/result.csv"
  step "Figures of all interpretations" "$programs/bpa" evaluate --bop "$set" \
    --json "$folder/result.json"
}

{
  printf '# Accuracy\n\nMachine: %s, %s cores. ' \
    "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$(nproc)"
  printf 'Every model of the library is a candidate in every frame.\n'
} >"$report"

if [[ -d $data/ycbv ]]; then
  evaluate real "$data/ycbv"
else
  printf '\n## real\n\nSkipped: there is no folder %s/ycbv.\n' "$data" >>"$report"
fi
"$programs/bpa" simulate scenes --out "$output/simulated/frames" --scenes 6 --seed 1
evaluate simulated "$output/simulated/frames"
echo "report: $report"
