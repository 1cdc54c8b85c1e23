#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: train.sh PROGRAMS OUTPUT
# Learns the built-in score layers from simulated scenes alone and writes OUTPUT/score_layers.json, the
# file config/score_layers.json. Seeds are fixed: the same program makes the same file.
#
# Real objects are not exactly their models, and real sensors are not exactly calibrated: nor are these.
# Two kinds of scenes cover what score components depend on. Heaps are seen from afar by a Kinect. Few
# objects are seen closely by an Xtion of longer focal length: its edges are more ragged, depth ends further
# from them (bpa bench sensor), and exposure and white balance differ from the models' colours. Half of the
# scenes hold look-alikes of the objects. Round two learns to order placements from all of them. Probabilities
# are learned from a third with look-alikes: from more, right placements in real frames are disbelieved. Two sets
# hold objects of the same shape with another print, from which only the layer for colours learns. Each frame is
# searched for a third of the models: more frames are worth more than more models.
#
# The placements to learn from are those that the detector finds with the layers built in so far: after a
# change of the detector, run this once, copy the file to config/, build, and run it again.
# BPA_SCENES is the number of scenes of each data set (120). BPA_OBJECTS limits the models, such as
# milk_carton,bowl.
set -euo pipefail
readonly programs=$1 output=$2
readonly scenes=${BPA_SCENES:-120}
mkdir -p "$output"
rm -rf "$output"/{heaps,heaps_look_alikes,close,close_look_alikes,prints,close_prints,library}
simulate() { # FOLDER SEED [OPTION...]
  "$programs/bpa" simulate scenes --out "$output/$1" --seed "$2" --scenes "$scenes" \
    ${BPA_OBJECTS:+--models "$BPA_OBJECTS"} --model-error 0.015 --calibration-error 0.12 "${@:3}"
}
readonly heaps=(--clutter 0.3,1 --objects 6,14)
readonly close=(--clutter 0,0.7 --objects 3,8 --distance 0.5,1.1 --focal 525,1067 --lateral-noise 2
  --edge-gaps 1.5 --exposure-spread 0.5)
simulate heaps 7000 "${heaps[@]}"
simulate heaps_look_alikes 8000 "${heaps[@]}" --look-alikes 6
simulate close 9000 "${close[@]}"
simulate close_look_alikes 10000 "${close[@]}" --look-alikes 6
simulate prints 11000 --clutter 0,1 --objects 3,10 --other-prints 6
simulate close_prints 12000 "${close[@]}" --other-prints 6
"$programs/bpa" model from-bop "$output/heaps" --library "$output/library"
"$programs/bpa" train --bop "$output"/{heaps,heaps_look_alikes,close} \
  --round-two-bop "$output/close_look_alikes" --color-bop "$output"/{prints,close_prints} \
  --models-per-frame 6 \
  --library "$output/library" --output "$output/score_layers.json" \
  --made-by "tests/accuracy/train.sh, $scenes scenes of each data set"
