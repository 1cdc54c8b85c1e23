#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# soak.sh BUILD FOLDER SECONDS SCENES MODELS: simulates scenes of the models (names joined by
# commas), makes a library of them in FOLDER, and runs bpa-soak there.
set -euo pipefail
readonly build=$1 folder=$2 seconds=$3 scenes=$4 models=$5
rm -rf "$folder"
mkdir -p "$folder"
"$build/bin/bpa" simulate scenes --out "$folder/frames" --scenes "$scenes" --seed 6 --objects 3,5 \
  --models "$models" >"$folder/frames.log"
"$build/bin/bpa" model from-bop "$folder/frames" --library "$folder/library" >"$folder/library.log"
# Two minutes for the start and the end: a hang of DDS must not last for ever.
timeout --kill-after=10 $((seconds + 120)) "$build/tests/bpa-soak" "$folder" "$seconds"
