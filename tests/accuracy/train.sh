#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: train.sh PROGRAMS OUTPUT
# Learns the built-in score layers anew, from simulated scenes alone, and writes them as
# OUTPUT/default_score_layer.cpp (the source core/score/default_score_layer.cpp). The objects are not
# exactly their models and the sensor is not exactly calibrated: real ones are not either. In half of
# the scenes lie things that look like the objects and are none of them. The placements to learn from
# are those that the detector finds with the layers that are built in so far, so that a change of the
# detector is followed by running this once or twice. BPA_SCENES is how many of each half (100).
set -euo pipefail
readonly programs=$1 output=$2
readonly scenes=${BPA_SCENES:-100}
mkdir -p "$output"
rm -rf "$output/piles" "$output/look_alikes" "$output/library"
simulate() { # FOLDER SEED [OPTION...]
  "$programs/bpa" simulate scenes --out "$output/$1" --seed "$2" --scenes "$scenes" \
    --model-error 0.015 --calibration-error 0.12 --clutter 0.3,1 --objects 6,14 "${@:3}"
}
simulate piles 7000
simulate look_alikes 8000 --look-alikes 6
"$programs/bpa" model from-bop "$output/piles" --library "$output/library"
"$programs/bpa" train --bop "$output/piles" --bop "$output/look_alikes" \
  --library "$output/library" --source "$output/default_score_layer.cpp"
