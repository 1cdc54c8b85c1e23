#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: train.sh PROGRAMS OUTPUT
# Learns the built-in score layers from simulated scenes alone and writes OUTPUT/score_layers.json, the
# file config/score_layers.json. Seeds are fixed: the same program makes the same file. The objects
# are not exactly their models and the sensor is not exactly calibrated: real ones are not either.
# Half of the scenes hold look-alikes of the objects. The placements to learn from are those that the
# detector finds with the layers built in so far: after a change of the detector, run this once, copy
# the file to config/, build, and run it again. BPA_SCENES is the number of scenes of each half (100).
# BPA_OBJECTS limits the models, such as milk_carton,bowl.
set -euo pipefail
readonly programs=$1 output=$2
readonly scenes=${BPA_SCENES:-100}
mkdir -p "$output"
rm -rf "$output/piles" "$output/look_alikes" "$output/library"
simulate() { # FOLDER SEED [OPTION...]
  "$programs/bpa" simulate scenes --out "$output/$1" --seed "$2" --scenes "$scenes" \
    ${BPA_OBJECTS:+--models "$BPA_OBJECTS"} --model-error 0.015 --calibration-error 0.12 --clutter 0.3,1 --objects 6,14 "${@:3}"
}
simulate piles 7000
simulate look_alikes 8000 --look-alikes 6
"$programs/bpa" model from-bop "$output/piles" --library "$output/library"
"$programs/bpa" train --bop "$output/piles" --bop "$output/look_alikes" \
  --library "$output/library" --output "$output/score_layers.json" \
  --made-by "tests/accuracy/train.sh, $scenes scenes of each half"
