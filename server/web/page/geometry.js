// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Poses as results have them: {rotation_wxyz, translation_m}, camera frame: x right, y down, z forward.

/** The rotation matrix, row by row. */
export function matrix([w, x, y, z]) {
  return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
    2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
}

export function transform(pose, [x, y, z]) {
  const r = matrix(pose.rotation_wxyz), t = pose.translation_m;
  return [0, 1, 2].map((i) => r[3 * i] * x + r[3 * i + 1] * y + r[3 * i + 2] * z + t[i]);
}

/** The pixel of a point; null behind the camera. */
export function project(camera, [x, y, z]) {
  if (!(z > 0)) return null;
  return [camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy];
}

/** Eigenvalues and eigenvectors (columns) of a symmetric 3 x 3 matrix, by Jacobi rotations. */
export function eigen(a) {
  const m = [[a[0], a[1], a[2]], [a[3], a[4], a[5]], [a[6], a[7], a[8]]];
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 20; ++sweep) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (Math.abs(m[p][q]) < 1e-18) continue;
      const theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
      const t = Math.sign(theta || 1) / (Math.abs(theta) + Math.hypot(theta, 1));
      const c = 1 / Math.hypot(t, 1), s = t * c;
      for (let k = 0; k < 3; ++k) {
        [m[k][p], m[k][q]] = [c * m[k][p] - s * m[k][q], s * m[k][p] + c * m[k][q]];
      }
      for (let k = 0; k < 3; ++k) {
        [m[p][k], m[q][k]] = [c * m[p][k] - s * m[q][k], s * m[p][k] + c * m[q][k]];
        [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
      }
    }
  }
  return {values: [m[0][0], m[1][1], m[2][2]], vectors: v};
}

/** A 3 x 3 block of a covariance, 6 x 6 row by row. */
export function block(covariance, at) {
  return [0, 1, 2].flatMap((i) => [0, 1, 2].map((j) => covariance[6 * (at + i) + at + j]));
}

/** Axis, about the camera's axes, and standard deviation in radians of the turn that the
 * distribution leaves freest. A concentration of 0 leaves it free. */
function freest(placement) {
  const {axes, concentrations} = placement.bingham;
  let column = 0;
  for (let i = 1; i < 3; ++i) if (concentrations[i] > concentrations[column]) column = i;
  const [w, x, y, z] = placement.pose.rotation_wxyz;
  const [aw, ax, ay, az] = [0, 1, 2, 3].map((row) => axes[3 * row + column]);
  // The vector part of a * conjugate(q).
  const axis = [-aw * x + ax * w - ay * z + az * y, -aw * y + ax * z + ay * w - az * x,
    -aw * z - ax * y + ay * x + az * w];
  const length = Math.hypot(...axis) || 1;
  const sigma = Math.sqrt(2 / Math.max(1e-9, -concentrations[column]));
  return {axis: axis.map((value) => value / length), sigma};
}

/** Which way an axis points, in words for somebody who looks through the camera. */
function direction([x, y, z]) {
  const most = Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
  if (most < 0.8) return `(${[x, y, z].map((value) => value.toFixed(2)).join(', ')})`;
  if (Math.abs(x) === most) return 'left to right';
  return Math.abs(y) === most ? 'up and down' : 'away from the camera';
}

/** What is not known of a pose, in words. `model` may be undefined. */
export function uncertainty(placement, model) {
  if (!placement.covariance) return 'The result does not say how sure the pose is.';
  const mm = (variance) => (1000 * Math.sqrt(Math.max(0, variance))).toFixed(1);
  const position = block(placement.covariance, 0);
  const across = Math.max(position[0], position[4]);
  const turns = eigen(block(placement.covariance, 3)).values;
  const degrees = 180 / Math.PI * Math.sqrt(Math.max(0, ...turns));
  let words = `Position ± ${mm(across)} mm across, ± ${mm(position[8])} mm in depth.`;
  const free = placement.bingham ? freest(placement) : null;
  if (model && model.symmetry_axes.length) {
    words += ` Orientation ± ${degrees.toFixed(1)}°; it looks the same however it turns about its own axis.`;
  } else if (free && free.sigma > Math.PI / 4) {
    words += ` Free to turn about the axis ${direction(free.axis)}.`;
  } else {
    words += ` Orientation ± ${degrees.toFixed(1)}°`;
    words += free && free.sigma * 180 / Math.PI > 1.5 ? `, least known about the axis ${direction(free.axis)}.` : '.';
  }
  if (model && model.symmetry_turns_wxyz.length) {
    words += ` ${model.symmetry_turns_wxyz.length + 1} orientations look alike.`;
  }
  return words;
}
