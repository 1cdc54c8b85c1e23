// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Models hold surface points, no mesh. Each is drawn as a disc in its tangent plane, lit from the
// viewer; discs that overlap make a closed surface. Points of the cloud are squares side by side.

import * as THREE from './three.module.js';

const kDiscSpacings = 1.7;  // radius of a surface's disc, so that discs overlap
const kCellSpacings = 0.75;  // half the side of a square of the cloud, so that they overlap
export const pictureHeight = {value: 1};  // of the picture, pixels: for all materials

const kVertexShader = `
uniform float spacing, height;
varying vec3 vColor, vNormal;
varying vec2 vDepth;
varying float vRadius, vForward;
void main() {
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * at;
  vColor = color;
#ifdef CLOUD
  vRadius = ${kCellSpacings.toFixed(2)} * spacing * position.z;
#else
  vRadius = ${kDiscSpacings.toFixed(2)} * spacing;
  vNormal = normalize(normalMatrix * normal);
  if (dot(vNormal, at.xyz) > 0.0) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
#endif
  vForward = at.z;
  vDepth = vec2(projectionMatrix[2][2], projectionMatrix[3][2]);
  gl_PointSize = max(1.0, vRadius * height * projectionMatrix[1][1] / -at.z);
}`;
const kFragmentShader = `
varying vec3 vColor, vNormal;
varying vec2 vDepth;
varying float vRadius, vForward;
void main() {
  float light = 1.0;
#ifndef CLOUD
  vec2 at = vec2(2.0, -2.0) * (gl_PointCoord - 0.5);
  float rise = -dot(vNormal.xy, at) / max(0.2, vNormal.z);
  if (dot(at, at) + rise * rise > 1.0) discard;
  light = 0.4 + 0.6 * abs(vNormal.z);
#ifdef GL_EXT_frag_depth
  float forward = vForward + rise * vRadius;
  gl_FragDepthEXT = 0.5 - 0.5 * (vDepth.x * forward + vDepth.y) / forward;
#endif
#endif
  gl_FragColor = vec4(light * vColor, 1.0);
}`;

/** Points as the server sends them; of those that have no normals, the distance to the next is that at 1 m. */
export function pointsOf(buffer, Values, scale, hasNormals) {
  const head = new DataView(buffer), count = head.getUint32(0, true), start = 8;
  const colorsAt = start + 3 * Values.BYTES_PER_ELEMENT * count, normalsAt = colorsAt + 3 * count;
  const positions = Float32Array.from(new Values(buffer.slice(start, colorsAt)), (value) => scale * value);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(buffer, colorsAt, 3 * count), 3, true));
  if (hasNormals) geometry.setAttribute('normal', new THREE.BufferAttribute(new Int8Array(buffer, normalsAt, 3 * count), 3, true));
  geometry.userData = {spacing: head.getFloat32(4, true)};
  return geometry;
}

export function pointsMaterial(geometry) {
  return new THREE.ShaderMaterial({uniforms: {height: pictureHeight, spacing: {value: geometry.userData.spacing}},
    vertexShader: kVertexShader, fragmentShader: kFragmentShader, vertexColors: THREE.VertexColors,
    defines: geometry.attributes.normal ? {} : {CLOUD: ''},
    extensions: {fragDepth: Boolean(geometry.attributes.normal)}});
}
