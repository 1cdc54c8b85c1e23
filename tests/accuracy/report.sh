#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: report.sh PROGRAMS OUTPUT
# The accuracy of today's detector: simulates scenes by fixed seeds, builds the library, detects with
# BPA and with ICP in its place, evaluates, does the same on real frames (ycbv/ and osd_clutter/ in
# the folder BPA_DATA, or in ../shared/data) and writes OUTPUT/report.md. BPA_SCENES and
# BPA_FREE_SCENES say how many scenes are simulated with objects and without.
set -euo pipefail
readonly programs=$1 output=$2 data=${BPA_DATA:-../shared/data}
readonly scenes=${BPA_SCENES:-30} free_scenes=${BPA_FREE_SCENES:-10}
mkdir -p "$output/logs"
: >"$output/commands.log"

# step LOG COMMAND...: runs it; the command goes into the report, what it prints into a log.
step() {
  local log=$output/logs/$1.log
  shift
  printf '%s\n' "$*" | tee -a "$output/commands.log"
  "$@" >"$log" 2>&1 || {
    tail -n 5 "$log" >&2
    exit 1
  }
}

bpa() {
  local log=$1
  shift
  step "$log" "$programs/bpa" "$@"
}

# judge NAME DATASET LIBRARY CONFIG...: detection and figures of a data set in $output/NAME.
judge() {
  local name=$1 set=$2 library=$3 folder=$output/$1
  shift 3
  rm -rf "${folder:?}"
  mkdir -p "$folder"
  bpa "$name-detect" detect --library "$library" --bop "$set" --csv "$folder/result.csv" \
    --json "$folder/result.json" --annotate "$folder/annotated" "$@"
  bpa "$name-evaluate" evaluate --bop "$set" --json "$folder/result.json" \
    --json-out "$folder/evaluation.json" --plots "$folder/plots"
}

printf 'use_orientation: false\n' >"$output/icp.yaml"
# So low that the distribution of what is just not reported is seen as well.
printf 'min_probability: 0.05\n' >"$output/everything.yaml"

# Simulated clutter, BPA and ICP.
readonly clutter=$output/sets/clutter models=$output/library
rm -rf "$output/sets" "$models"
bpa clutter-simulate simulate scenes --out "$clutter" --scenes "$scenes" --seed 1
bpa library model from-bop "$clutter" --library "$models"
judge clutter-bpa "$clutter" "$models"
judge clutter-icp "$clutter" "$models" --config "$output/icp.yaml"

# Nothing to find.
for kind in empty distractors; do
  bpa "$kind-simulate" simulate scenes --out "$output/sets/$kind" --scenes "$free_scenes" --seed 2 \
    --"$kind" 1
  judge "$kind-bpa" "$output/sets/$kind" "$models"
  judge "$kind-everything" "$output/sets/$kind" "$models" --config "$output/everything.yaml"
done

# The paper's second comparison of BPA with ICP, and the sensor.
bpa alignment bench alignment --bop "$clutter" --library "$models" --starts 10 \
  --scenes "$(seq -s , 1 $((scenes < 6 ? scenes : 6)))" --plots "$output/alignment"
sensor=()

# Real frames.
if [[ -d $data/ycbv ]]; then
  rm -rf "$output/real-library"
  bpa real-library model from-bop "$data/ycbv" --library "$output/real-library"
  judge real-bpa "$data/ycbv" "$output/real-library"
  judge real-icp "$data/ycbv" "$output/real-library" --config "$output/icp.yaml"
  sensor+=(--bop "$data/ycbv")
else
  rm -rf "$output/real-bpa" "$output/real-icp"
fi
clouds=()
for cloud in "$data"/osd_clutter/*.pcd; do
  # Clouds that are not organised are no images.
  if [[ -f $cloud ]] && ! grep -a -q -m 1 '^HEIGHT 1$' "$cloud"; then clouds+=("$cloud"); fi
done
rm -rf "$output/osd-bpa" "$output/osd-everything"
# Scenes that hold none of the real objects; without these, none of the simulated ones.
osd_models=$models
[[ -d $data/ycbv ]] && osd_models=$output/real-library
if ((${#clouds[@]})); then
  sensor+=(--pcd "${clouds[@]}")
  for config in bpa everything; do
    folder=$output/osd-$config
    mkdir -p "$folder"
    options=()
    [[ $config == everything ]] && options=(--config "$output/everything.yaml")
    bpa "osd-$config-detect" detect --library "$osd_models" --pcd "${clouds[@]}" \
      --json "$folder/result.json" --annotate "$folder/annotated" "${options[@]}"
    bpa "osd-$config-evaluate" evaluate --nothing-there --json "$folder/result.json" \
      --json-out "$folder/evaluation.json" --plots "$folder/plots"
  done
fi
rm -f "$output/sheet.png"
((${#sensor[@]})) && sensor+=(--sheet "$output/sheet.png")
bpa sensor bench sensor --json "$output/sensor.json" "${sensor[@]}"

/usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/report.py" "$output"
