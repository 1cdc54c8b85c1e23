#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: train.sh PROGRAMS OUTPUT
# Learns the built-in score layers from simulated scenes alone and writes OUTPUT/score_layers.json, the
# file config/score_layers.json. Seeds are fixed: the same program makes the same file.
#
# Real objects are not exactly their models, and real sensors are not exactly calibrated: nor are these.
# Each scene has one of the three kinds of depth camera. Several kinds of scenes cover what score components
# depend on. Heaps are seen from afar. Few objects are seen closely by a longer lens: edges are more ragged, depth
# ends further from them (bpa-experiments sensor), and exposure and white balance differ from the models' colours. The
# same with large errors of calibration, registration and models. Objects lie apart on tables, or there are
# none of them. Some sets hold look-alikes. Round two learns to order placements from all of them. Probabilities are
# learned from a third with look-alikes: from more, right placements in real frames are disbelieved. Two sets hold
# objects of the same shape with another print, from which only the layer for colours learns. Each frame is
# searched for five of the models: more frames are worth more than more models. So many look-alikes and errors make
# probabilities too low for most frames. The last set is of piles with small errors and without look-alikes. It is
# searched for all models, and probabilities are made to agree with frequencies there.
#
# The placements to learn from are those that the detector finds with the layers built in so far: after a
# change of the detector, run this once, copy the file to config/, build, and run it again. Two cores take two
# hours. BPA_SCENES is the number of scenes of the largest sets (400); the others shrink with it. BPA_OBJECTS limits the
# models, such as milk_carton,bowl.
set -euo pipefail
readonly programs=$1 output=$2
readonly scenes=${BPA_SCENES:-400}
readonly objects=${BPA_OBJECTS:-mug,bowl,bottle,can,cup,tube,funnel,plate,milk_carton,cereal_box,snack_box,\
spray_bottle,jug,cube,l_brick,stud_block,gear,banana,pen,screwdriver,wrench,scissors,clamp,spatula,tin,battery,phone,\
remote,book,soap,sponge,matchbox}
mkdir -p "$output"
rm -rf "$output"/{heaps,heaps_look_alikes,close,close_look_alikes,rough,table,foreign,prints,close_prints} \
  "$output"/{in_use,library}
simulate() { # FOLDER SEED SCENES [OPTION...]
  "$programs/bpa" simulate scenes --out "$output/$1" --seed "$2" --scenes $(((scenes * $3 + 399) / 400)) \
    --models "$objects" --sensor mixed "${errors[@]}" "${@:4}"
}
readonly heaps=(--clutter 0.3,1 --objects 6,14)
readonly close=(--clutter 0,0.7 --objects 3,8 --distance 0.5,1.1 --focal 525,1067 --lateral-noise 2)
errors=(--model-error 0.015 --calibration-error 0.12)
simulate heaps 7000 400 "${heaps[@]}"
simulate close 9000 400 "${close[@]}" --edge-gaps 1.5 --exposure-spread 0.5
simulate heaps_look_alikes 8000 300 "${heaps[@]}" --look-alikes 6
simulate close_look_alikes 10000 300 "${close[@]}" --edge-gaps 1.5 --exposure-spread 0.5 --look-alikes 6
simulate prints 11000 200 --clutter 0,1 --objects 3,10 --other-prints 6
simulate close_prints 12000 200 "${close[@]}" --edge-gaps 1.5 --exposure-spread 0.5 --other-prints 6
simulate table 13000 250 --clutter 0,0.3 --objects 4,10
simulate foreign 14000 60 --distractors 1 --look-alikes 8
errors=(--model-error 0.02 --calibration-error 0.3 --misregistration 1.5)
simulate rough 15000 300 "${close[@]}" --edge-gaps 2 --exposure-spread 0.8
errors=(--model-error 0.008 --calibration-error 0.06)
readonly in_use=$((scenes < 20 ? 1200 : 120)) # six scenes at least: calibration needs ten right placements
simulate in_use 16000 "$in_use" --clutter 0.3,1 --objects 5,14
"$programs/bpa" model from-bop "$output/heaps" --library "$output/library"
"$programs/bpa" train --bop "$output"/{heaps,heaps_look_alikes,close,rough,table,foreign} \
  --round-two-bop "$output/close_look_alikes" --color-bop "$output"/{prints,close_prints} \
  --calibration-bop "$output/in_use" --models-per-frame 5 --held-out 0 \
  --library "$output/library" --output "$output/score_layers.json" \
  --made-by "tests/accuracy/train.sh, up to $scenes scenes of each data set"
