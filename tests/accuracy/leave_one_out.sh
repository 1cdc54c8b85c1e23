#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: leave_one_out.sh PROGRAMS OUTPUT LIBRARY DATASET [OPTION...]
# What each part of the detector is worth: runs 'bpa bench accuracy' on a BOP data set with all of
# them and with each left out in turn, and prints a Markdown table. Figures of runs go to
# OUTPUT/PART.json; those that are there already are not made again. OPTIONs go to the benchmark,
# such as --scenes 1,2 or --min-visible 0.3. LIBRARY and DATASET are only read.
set -euo pipefail
readonly programs=$1 output=$2 library=$3 dataset=$4
shift 4
tools=$(dirname "${BASH_SOURCE[0]}")
readonly tools
mkdir -p "$output"

# run NAME LIBRARY OPTION...
run() {
  local name=$1 models=$2
  shift 2
  [[ -f $output/$name.json ]] && return
  "$programs/bpa" bench accuracy --bop "$dataset" --library "$models" --json "$output/$name.json" \
    "$@" >"$output/$name.log" 2>&1 || {
    tail -n 5 "$output/$name.log" >&2
    exit 1
  }
}

run all "$library" "$@"
for part in $(/usr/bin/python3 "$tools/leave_one_out.py" parts); do
  /usr/bin/python3 "$tools/leave_one_out.py" settings "$part" >"$output/$part.yaml"
  run "$part" "$library" --config "$output/$part.yaml" "$@"
done

# The same models, and a score layer that has learned nothing.
readonly unlearned=$output/unlearned_library
rm -rf "$unlearned"
mkdir "$unlearned"
for model in "$(realpath "$library")"/*/; do ln -s "$model" "$unlearned/$(basename "$model")"; done
/usr/bin/python3 "$tools/leave_one_out.py" layer "$unlearned/score_layer.json"
run layer "$unlearned" "$@"

/usr/bin/python3 "$tools/leave_one_out.py" table "$output"
