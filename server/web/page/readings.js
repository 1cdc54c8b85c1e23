// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Which placements are nearly the same, and which interpretations hold the same placements. An object
// may have several poses that differ by less than a sensor can tell: the interpretations with them
// share the probability of what they have in common.

import {transform} from './geometry.js';

export const kSamePlace = 0.01;       // metres
export const kSameDegrees = 11;
const kSameDot = Math.cos(kSameDegrees / 2 * Math.PI / 180);  // of quaternions
const kSameAxis = Math.cos(kSameDegrees * Math.PI / 180);

const times = ([a, b, c, d], [w, x, y, z]) => [a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y,
  a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w];
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);

const turned = (rotation, axis) => transform({rotation_wxyz: rotation, translation_m: [0, 0, 0]}, axis);

/** Whether two rotations look the same but for kSameDegrees, given the model's symmetries. */
function sameTurn(a, b, model) {
  const turns = [[1, 0, 0, 0], ...(model?.symmetry_turns_wxyz || [])];
  const axes = model?.symmetry_axes || [];
  return turns.some((turn) => {
    const to = times(b, turn);
    if (!axes.length) return Math.abs(dot(a, to)) > kSameDot;
    return axes.some((axis) => dot(turned(a, axis), turned(to, axis)) > kSameAxis);
  });
}

/** Whether two placements are of one model in nearly one pose. `models`: Map of the models by name. */
export function samePlacement(a, b, models) {
  if (a.model !== b.model) return false;
  const model = models.get(a.model);
  const middle = model ? model.box_min.map((low, i) => (low + model.box_max[i]) / 2) : [0, 0, 0];
  const from = transform(a.pose, middle), to = transform(b.pose, middle);
  return Math.hypot(...from.map((value, i) => value - to[i])) < kSamePlace
    && sameTurn(a.pose.rotation_wxyz, b.pose.rotation_wxyz, model);
}

function samePlacements(one, other, models) {
  return one.length === other.length
    && one.every((placement) => other.some((candidate) => samePlacement(placement, candidate, models)));
}

/** Interpretations with the same placements put together: {probability, members}, members by rank. That of
 * rank 1 comes first, the others by falling probability. `shown` tells which placements count. */
export function readings(interpretations, models, shown = () => true) {
  const all = [];
  for (const one of interpretations) {
    const placements = one.placements.filter(shown);
    const same = all.find((reading) => samePlacements(reading.placements, placements, models));
    if (same) {
      same.members.push(one);
      same.probability += one.probability;
    } else {
      all.push({placements, probability: one.probability, members: [one]});
    }
  }
  return [...all.slice(0, 1), ...all.slice(1).sort((a, b) => b.probability - a.probability)];
}
