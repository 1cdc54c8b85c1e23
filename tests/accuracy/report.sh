#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: report.sh PROGRAMS OUTPUT
# The accuracy of today's detector: simulates sets by fixed seeds, builds the libraries, detects,
# evaluates, does the same on real frames (ycbv/ and osd_clutter/ in the folder BPA_DATA, or in
# ../shared/data) and writes OUTPUT/report.md. Numbers of simulated scenes: BPA_SCENES (clutter),
# BPA_FREE_SCENES (nothing to find, of each kind), BPA_UNSEEN_SCENES (objects never trained on, of
# each sensor), BPA_AMBIGUOUS_SCENES. BPA_DETECTOR is the program bpa of another build, which makes
# the models and detects in place of this one; 'report.py OUTPUT --baseline COMMIT' keeps its
# figures as those from before.
set -euo pipefail
readonly programs=$1 output=$2 data=${BPA_DATA:-../shared/data}
readonly scenes=${BPA_SCENES:-30} free_scenes=${BPA_FREE_SCENES:-10}
readonly unseen_scenes=${BPA_UNSEEN_SCENES:-60} ambiguous_scenes=${BPA_AMBIGUOUS_SCENES:-40}
readonly detector=${BPA_DETECTOR:-$programs/bpa}
tools=$(dirname "${BASH_SOURCE[0]}")
readonly tools
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

# judge_once NAME LIBRARY SETTINGS SET...: detection and figures of a set in $output/NAME. SETTINGS
# is a YAML file. SET is --bop FOLDER, or --pcd FILE... of frames that hold none of the objects.
judge_once() {
  local name=$1 library=$2 settings=$3 folder=$output/$1
  shift 3
  local truth=("$@") options=(--config "$settings" --json "$folder/result.json")
  [[ $1 == --pcd ]] && truth=(--nothing-there)
  [[ $name == *-everything ]] || options+=(--annotate "$folder/annotated")
  mkdir -p "$folder"
  step "$name-detect" "$detector" detect --library "$library" "$@" "${options[@]}"
  bpa "$name-evaluate" evaluate "${truth[@]}" --json "$folder/result.json" \
    --json-out "$folder/evaluation.json" --plots "$folder/plots"
}

# judge NAME LIBRARY SETTINGS SET...: also in $output/NAME-everything, with a threshold so low that
# what is not reported is seen as well: for the curves over the threshold.
judge() {
  local name=$1 library=$2 settings=$3
  shift 3
  judge_once "$name" "$library" "$settings" "$@"
  cat "$output/everything.yaml" "$settings" >"$output/$name-everything.yaml"
  judge_once "$name-everything" "$library" "$output/$name-everything.yaml" "$@"
}

# simulate SET OPTION...: in $output/sets/SET.
simulate() {
  bpa "$1-simulate" simulate scenes --out "$output/sets/$1" "${@:2}"
}

# What an earlier report of other sets left must not count.
rm -rf "${output:?}"/sets "$output"/library "$output"/real-library "$output"/leave_one_out* \
  "$output"/{clutter,real,unseen,ambiguous,empty,distractors,osd}* "$output/sheet.png"
: >"$output/default.yaml"
printf 'min_probability: 0.05\n' >"$output/everything.yaml"
printf 'use_orientation: false\n' >"$output/icp.yaml"
printf 'use_color: false\n' >"$output/colourless.yaml"
readonly default=$output/default.yaml

# Simulated clutter, BPA and ICP.
readonly clutter=$output/sets/clutter models=$output/library
simulate clutter --scenes "$scenes" --seed 1
step library "$detector" model from-bop "$clutter" --library "$models"
judge clutter "$models" "$default" --bop "$clutter"
judge_once clutter-icp "$models" "$output/icp.yaml" --bop "$clutter"

# A pose that the view leaves open.
simulate ambiguous --scenes "$ambiguous_scenes" --seed 4 --ambiguous 1 --border 0
judge ambiguous "$models" "$default" --bop "$output/sets/ambiguous"

# Nothing to find.
for kind in empty distractors; do
  simulate "$kind" --scenes "$free_scenes" --seed 2 "--$kind" 1
  judge "$kind" "$models" "$default" --bop "$output/sets/$kind"
done

# The paper's second comparison of BPA with ICP, and the sensor.
first_scenes=$(seq -s , 1 $((scenes < 6 ? scenes : 6)))
readonly first_scenes
bpa alignment bench alignment --bop "$clutter" --library "$models" --starts 10 \
  --scenes "$first_scenes" --plots "$output/alignment"
sensor=()

# Real frames, and simulated ones of their objects, which the built-in layers were not trained on.
if [[ -d $data/ycbv ]]; then
  readonly real_models=$output/real-library
  step real-library "$detector" model from-bop "$data/ycbv" --library "$real_models"
  judge real "$real_models" "$default" --bop "$data/ycbv"
  judge real-colourless "$real_models" "$output/colourless.yaml" --bop "$data/ycbv"
  judge_once real-icp "$real_models" "$output/icp.yaml" --bop "$data/ycbv"
  for kind in structured_light active_stereo time_of_flight; do
    # Objects keep their numbers: those of ycbv have no gap.
    simulate "unseen-$kind" --scenes "$unseen_scenes" --seed 3 --meshes "$data/ycbv/models" \
      --sensor "$kind"
    judge "unseen-$kind" "$real_models" "$default" --bop "$output/sets/unseen-$kind"
  done
  sensor+=(--bop "$data/ycbv")
fi
clouds=()
for cloud in "$data"/osd_clutter/*.pcd; do
  # Clouds that are not organised are no images.
  if [[ -f $cloud ]] && ! grep -a -q -m 1 '^HEIGHT 1$' "$cloud"; then clouds+=("$cloud"); fi
done
# Scenes that hold none of the real objects; without these, none of the simulated ones.
readonly osd_models=${real_models:-$models}
if ((${#clouds[@]})); then
  sensor+=(--pcd "${clouds[@]}")
  judge osd "$osd_models" "$default" --pcd "${clouds[@]}"
  judge osd-colourless "$osd_models" "$output/colourless.yaml" --pcd "${clouds[@]}"
fi
((${#sensor[@]})) && sensor+=(--sheet "$output/sheet.png")
bpa sensor bench sensor --json "$output/sensor.json" "${sensor[@]}"

# What each part is worth and what it costs.
step leave-one-out "$tools/leave_one_out.sh" "$programs" "$output/leave_one_out" "$models" \
  "$clutter" --scenes "$first_scenes"
if [[ -n ${real_models:-} ]]; then
  step leave-one-out-real "$tools/leave_one_out.sh" "$programs" "$output/leave_one_out_real" \
    "$real_models" "$data/ycbv"
fi

/usr/bin/python3 "$tools/report.py" "$output"
