#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# usage: train.sh PROGRAMS OUTPUT
# Learns the built-in score layers from simulated scenes alone and writes OUTPUT/score_layers.json, the
# file config/score_layers.json. Seeds are fixed: the same program makes the same file.
#
# Real objects are not exactly their models, and real sensors are not exactly calibrated: nor are these.
# Each scene has one of the three kinds of depth camera. Sets differ in what score components depend on:
#   heaps, heaps_white       piles seen from afar, with and without another white balance than the models'
#   close, close_tinted      few objects by a longer lens: ragged edges, and another exposure than the models'
#   table        objects apart on tables
#   foreign      no known object, but look-alikes
#   far          small in the image, among foreign objects
#   wrong, wrong_close, wrong_heaps   models that are off by up to 5 % along each axis, as scans of users are
#   rough        large errors of calibration, registration and colour
#   bins_equal, bins_kinds, bins_mixed   packed bins of one part, of few and of many: wrong models find surface
#                everywhere, so they are searched for all models
#   close_look_alikes        more look-alikes, for round two alone, which orders placements
#   prints, close_prints     objects of the same shape with another print, for the layer of colours alone
#   in_use, in_use_bins      small errors, all models: with these probabilities are made to agree with frequencies
# From more look-alikes, right placements in real frames are disbelieved. Each frame of the other sets is
# searched for five of the models: more frames are worth more than more models.
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
simulate() { # FOLDER SEED SCENES [OPTION...]
  rm -rf "${output:?}/$1"
  "$programs/bpa" simulate scenes --out "$output/$1" --seed "$2" --scenes $(((scenes * $3 + 399) / 400)) \
    --models "$objects" --sensor mixed "${errors[@]}" "${@:4}"
}
readonly heaps=(--clutter 0.3,1 --objects 6,14)
readonly close=(--clutter 0,0.7 --objects 3,8 --distance 0.5,1.1 --focal 525,1067 --lateral-noise 2)
readonly ragged=(--edge-gaps 1.5 --exposure-spread 0.5)
readonly tinted=(--white-balance-spread 0.15)
readonly bins=(--clutter 1,1 --border 0 --foreign 0,0 --distance 0.5,1.0 --elevation 55,85 --objects 8,16)
errors=(--model-error 0.015 --calibration-error 0.12 --white-balance-spread 0.1)
simulate bins_equal 17000 120 "${bins[@]}" --equal 1
simulate bins_kinds 18500 120 "${bins[@]}" --equal 1 --kinds 5
simulate bins_mixed 18000 80 "${bins[@]}"
simulate heaps 7000 400 "${heaps[@]}"
simulate close 9000 400 "${close[@]}" "${ragged[@]}"
simulate close_look_alikes 10000 200 "${close[@]}" "${ragged[@]}" --look-alikes 6
simulate heaps_look_alikes 8000 200 "${heaps[@]}" --look-alikes 6
simulate prints 11000 160 --clutter 0,1 --objects 3,10 --other-prints 6
simulate close_prints 12000 160 "${close[@]}" "${ragged[@]}" --other-prints 6
simulate table 13000 200 --clutter 0,0.3 --objects 4,10
simulate foreign 14000 60 --distractors 1 --look-alikes 8
simulate far 19000 120 --objects 3,6 --foreign 6,12 --clutter 0.2,0.7 --distance 0.9,1.8 --focal 525,900
errors=(--model-error 0.015 --calibration-error 0.12)
simulate heaps_white 33000 200 "${heaps[@]}"
simulate close_tinted 34000 200 "${close[@]}" "${ragged[@]}" "${tinted[@]}"
errors=(--model-error 0.05 --calibration-error 0.3 --misregistration 2)
simulate wrong_close 20000 120 "${close[@]}" "${ragged[@]}" "${tinted[@]}" --foreign 0,6
simulate wrong_heaps 21000 120 --clutter 0.3,1 --objects 5,14 --distance 0.5,1.4 --focal 525,900 \
  --exposure-spread 0.5 "${tinted[@]}"
errors=(--model-error 0.05 --calibration-error 0.2 --misregistration 1 --white-balance-spread 0.1)
simulate wrong 20000 120 --clutter 0,1 --objects 3,10 --distance 0.5,1.3 --focal 525,900 --foreign 0,6
errors=(--model-error 0.02 --calibration-error 0.3 --misregistration 1.5 --white-balance-spread 0.2)
simulate rough 15000 250 "${close[@]}" --edge-gaps 2 --exposure-spread 0.8
errors=(--model-error 0.008 --calibration-error 0.06)
readonly in_use=$((scenes < 20 ? 1200 : 80)) # six scenes at least: calibration needs ten right placements
simulate in_use 16000 "$in_use" --clutter 0.3,1 --objects 5,14
simulate in_use_bins 16500 30 "${bins[@]}" --equal 0.5
rm -rf "${output:?}/library"
"$programs/bpa" model from-bop "$output/heaps" --library "$output/library"
"$programs/bpa" train --bop \
  "$output"/{heaps,heaps_white,heaps_look_alikes,close,close_tinted,rough,table,foreign,far,wrong,wrong_close,wrong_heaps} \
  --all-models-bop "$output"/{bins_equal,bins_mixed} --round-two-bop "$output/close_look_alikes" \
  --color-bop "$output"/{prints,close_prints} --calibration-bop "$output"/{in_use,in_use_bins} \
  --models-per-frame 5 --held-out 0 --library "$output/library" \
  --made-by "tests/accuracy/train.sh, up to $scenes scenes of each data set"
# Copies depend on what is found, which depends on what copies say.
for _ in 1 2; do
  "$programs/bpa" train --only copies --bop "$output"/{heaps,far} \
    --all-models-bop "$output"/{bins_equal,bins_kinds,bins_mixed} --held-out 0 --library "$output/library" \
    --made-by "tests/accuracy/train.sh"
done
mv "$output/library/score_layer.json" "$output/score_layers.json"
