#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: train.sh PROGRAMS OUTPUT
# Learns the built-in score layer anew, from simulated scenes alone, and writes it as
# OUTPUT/default_score_layer.cpp (the source core/score/default_score_layer.cpp). The objects are not
# exactly their models and the sensor is not exactly calibrated: real ones are not either. The
# placements to learn from are those that the detector finds with the layer that is built in so far,
# so that a change of the detector is followed by running this once or twice. BPA_TRAIN_OPTIONS adds
# options of `bpa simulate scenes`: with "--look-alikes 6" the layer takes fewer things for objects
# that only look like them, and finds fewer of the objects.
set -euo pipefail
readonly programs=$1 output=$2
mkdir -p "$output"
rm -rf "$output/training" "$output/library"
"$programs/bpa" simulate scenes --out "$output/training" --scenes "${BPA_SCENES:-100}" --seed 7000 \
  --model-error 0.015 --calibration-error 0.12 --clutter 0.3,1 --objects 6,14 \
  ${BPA_TRAIN_OPTIONS:-}
"$programs/bpa" model from-bop "$output/training" --library "$output/library"
"$programs/bpa" train --bop "$output/training" --library "$output/library" \
  --source "$output/default_score_layer.cpp"
