// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The cloud of a result, the models in their places with axes and covariance ellipsoids, tracks.
// Drawn when something changed, not all the time.

import * as THREE from './three.module.js';
import {bytes, on} from './api.js';
import {$, css} from './dom.js';
import {block, eigen, transform} from './geometry.js';
import {pictureHeight, pointsMaterial, pointsOf} from './points.js';
import {interpretation, shown, view} from './view.js';

const kSigmas = 2;        // of the ellipsoids
const kAxisLength = 0.06;  // metres
const kWordsHeight = 0.035;  // share of the picture's height, about
const kSmallest = 0.0005;  // metres, so that an ellipsoid is seen

let renderer = null, scene, camera, cloud;
let objects;
export let tracks;  // what is drawn of them, in the camera's frame
const orbit = {yaw: 0, pitch: 0.25, distance: 1.2, target: new THREE.Vector3(0, 0, -0.9)};
const surfaces = new Map();  // by "name@version": BufferGeometry, or null while it comes
const textures = new Map();  // of words, by their text
let cloudOf = 0, waiting = false, centred = false;

function start() {
  const canvas = $('space');
  try {
    renderer = new THREE.WebGLRenderer({canvas, antialias: true, powerPreference: 'low-power'});
  } catch (_) {
    canvas.replaceWith(Object.assign(document.createElement('p'), {textContent: 'This browser shows no 3-D (WebGL).'}));
    return false;
  }
  scene = new THREE.Scene();
  scene.background = new THREE.Color(0x2a3138);
  camera = new THREE.PerspectiveCamera(50, 16 / 9, 0.02, 50);
  cloud = new THREE.Group();
  objects = new THREE.Group();
  tracks = new THREE.Group();
  // Camera frame (y down, z forward) to three.js (y up, z backward).
  for (const group of [cloud, objects, tracks]) {
    group.rotation.x = Math.PI;
    scene.add(group);
  }
  return true;
}

function render() {
  waiting = false;
  const canvas = renderer.domElement;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width || $('live').hidden) return;
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  pictureHeight.value = canvas.height;
  const {yaw, pitch, distance, target} = orbit;
  camera.position.set(target.x + distance * Math.sin(yaw) * Math.cos(pitch),
    target.y + distance * Math.sin(pitch), target.z + distance * Math.cos(yaw) * Math.cos(pitch));
  camera.lookAt(target);
  renderer.render(scene, camera);
  canvas.dataset.objects = objects.children.length;
  canvas.dataset.points = cloud.children.length ? cloud.children[0].geometry.attributes.position.count : 0;
}

function request() {
  if (renderer && !waiting) {
    waiting = true;
    requestAnimationFrame(render);
  }
}

function empty(group) {
  for (const child of [...group.children]) {
    group.remove(child);
    child.traverse((part) => {
      if (part.geometry && !part.geometry.shared && !part.isSprite) part.geometry.dispose();
      if (part.material) part.material.dispose();
    });
  }
}

async function fetchCloud() {
  const {result} = view;
  if (!result || !$('show-cloud').checked || cloudOf === result.id) return;
  cloudOf = result.id;
  const buffer = await bytes(`/api/results/${result.id}/cloud`).catch(() => null);
  if (!buffer || cloudOf !== result.id) return;
  empty(cloud);
  const geometry = pointsOf(buffer, Int16Array, 0.001, false);
  cloud.add(new THREE.Points(geometry, pointsMaterial(geometry)));
  if (!centred && geometry.attributes.position.count) {
    centre(geometry.attributes.position.array);
    centred = true;
  }
  request();
}

/** Turns about the median of the points. */
function centre(positions) {
  const depths = [];
  for (let i = 2; i < positions.length; i += 60) depths.push(positions[i]);
  depths.sort((a, b) => a - b);
  const depth = depths[depths.length >> 1];
  orbit.target.set(0, 0, -depth);
  orbit.distance = 1.05 * depth;
}

async function fetchSurface(name) {
  const key = `${name}@${view.status?.database_version}`;
  if (surfaces.has(key)) return surfaces.get(key);
  surfaces.set(key, null);
  const buffer = await bytes(`/api/models/${name}/surface`).catch(() => null);
  if (buffer) {
    const geometry = pointsOf(buffer, Float32Array, 1, true);
    geometry.shared = true;
    surfaces.set(key, geometry);
    showObjects();
  }
  return null;
}

function placed(pose) {
  const group = new THREE.Group();
  const [w, x, y, z] = pose.rotation_wxyz;
  group.quaternion.set(x, y, z, w);
  group.position.set(...pose.translation_m);
  return group;
}

function texture(text) {
  if (textures.has(text)) return textures.get(text);
  const tile = document.createElement('canvas'), pen = tile.getContext('2d');
  const font = '600 28px system-ui, sans-serif';
  pen.font = font;
  tile.width = Math.ceil(pen.measureText(text).width) + 12;
  tile.height = 36;
  pen.font = font;
  pen.fillStyle = 'rgb(0 0 0 / 60%)';
  pen.fillRect(0, 0, tile.width, tile.height);
  pen.fillStyle = '#fff';
  pen.fillText(text, 6, 27);
  const map = new THREE.CanvasTexture(tile);
  map.minFilter = THREE.LinearFilter;
  textures.set(text, map);
  return map;
}

/** Text that is seen through all before it, of one size on the screen. */
function words(text, at) {
  const map = texture(text), tile = map.image;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({map, depthTest: false, sizeAttenuation: false}));
  sprite.scale.set(kWordsHeight * tile.width / tile.height, kWordsHeight, 1);
  sprite.position.copy(at);
  sprite.renderOrder = 1;
  return sprite;
}

/** Above the middle of a placed model's box, in the camera's frame. */
function top(pose, {box_min: low, box_max: high}) {
  const middle = transform(pose, low.map((value, i) => (value + high[i]) / 2));
  const half = Math.hypot(...low.map((value, i) => high[i] - value)) / 2;
  return new THREE.Vector3(middle[0], middle[1] - half, middle[2]);
}

/** The surface where twice the standard deviation of the position ends. */
function ellipsoid(placement, color) {
  const {values, vectors} = eigen(block(placement.covariance, 0));
  const mesh = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 20, 12),
    new THREE.MeshBasicMaterial({color, transparent: true, opacity: 0.45, depthTest: false}));
  const scales = values.map((value) => Math.max(kSmallest, kSigmas * Math.sqrt(Math.max(0, value))));
  const basis = new THREE.Matrix4();
  const columns = [0, 1, 2].map((i) => new THREE.Vector3(vectors[0][i], vectors[1][i], vectors[2][i]));
  if (columns[0].clone().cross(columns[1]).dot(columns[2]) < 0) columns[2].negate();
  basis.makeBasis(...columns);
  mesh.quaternion.setFromRotationMatrix(basis);
  mesh.scale.set(...scales);
  mesh.position.set(...placement.pose.translation_m);
  return mesh;
}

function box(pose, model, color) {
  const group = placed(pose);
  const low = new THREE.Vector3(...model.box_min), high = new THREE.Vector3(...model.box_max);
  group.add(new THREE.Box3Helper(new THREE.Box3(low, high), color));
  return group;
}

function addPlacement(placement, i) {
  const model = view.models.get(placement.model);
  if (!model) return;
  const color = new THREE.Color(css(model.color).replaceAll(' ', ','));
  const alternative = view.chosen === i && view.alternative >= 0 ? placement.alternatives[view.alternative] : null;
  const pose = (alternative || placement).pose;
  const group = placed(pose);
  const geometry = surfaces.get(`${model.name}@${view.status?.database_version}`);
  if (geometry) group.add(new THREE.Points(geometry, pointsMaterial(geometry)));
  group.add(new THREE.AxesHelper(kAxisLength));
  if (view.chosen === i) {
    ['x', 'y', 'z'].forEach((name, k) => group.add(words(name, new THREE.Vector3().setComponent(k, 1.15 * kAxisLength))));
  }
  const both = new THREE.Group();
  both.add(group, words(`${i + 1} ${model.name}`, top(pose, model)));
  if (view.chosen === i) both.add(box(pose, model, color));
  if ($('show-ellipsoids').checked && placement.covariance) both.add(ellipsoid(placement, color));
  objects.add(both);
  fetchSurface(model.name);
}

/** A box for each track, with its name; grey, and the state in words, while it is not seen. */
function showTracks() {
  if (!renderer) return;
  empty(tracks);
  request();
  if (!view.tracks || !$('show-tracks').checked) return;
  const fromFixed = placed(view.tracks.frame_from_camera);  // tracks may be in a frame of their own
  fromFixed.updateMatrix();
  const group = new THREE.Group();
  group.applyMatrix(new THREE.Matrix4().getInverse(fromFixed.matrix));
  for (const track of view.tracks.tracks) {
    const model = view.models.get(track.model);
    if (!model) continue;
    const seen = track.state === 'confirmed';
    const one = box(track.pose, model, new THREE.Color(seen ? 0xffe94d : 0x999999));
    one.name = track.name;
    one.add(words(seen ? track.name : `${track.name} ${track.state}`, new THREE.Vector3(...model.box_min)));
    group.add(one);
  }
  tracks.add(group);
}

function showObjects() {
  if (!renderer) return;
  empty(objects);
  (interpretation()?.placements || []).forEach((placement, i) => {
    if (shown(placement)) addPlacement(placement, i);
  });
  showTracks();
}

function turn(yaw, pitch) {
  orbit.yaw += yaw;
  orbit.pitch = Math.min(1.5, Math.max(-1.5, orbit.pitch + pitch));
  request();
}
function zoom(factor) {
  orbit.distance = Math.min(20, Math.max(0.1, orbit.distance * factor));
  request();
}
function move(dx, dy) {
  const step = orbit.distance / renderer.domElement.clientHeight;
  const right = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 0);
  const up = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 1);
  orbit.target.addScaledVector(right, -dx * step).addScaledVector(up, dy * step);
  request();
}

function listen() {
  const canvas = renderer.domElement, pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.x, dy = event.clientY - before.y;
    const width = pointers.size === 2 ? spread() : 0;
    pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (pointers.size === 2) {
      zoom(width / Math.max(1, spread()));
      move(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons === 2) {
      move(dx, dy);
    } else {
      turn(-0.006 * dx, 0.006 * dy);
    }
  });
  for (const name of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(0.001 * event.deltaY));
  }, {passive: false});
  canvas.addEventListener('keydown', (event) => {
    const actions = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.1),
      ArrowDown: () => turn(0, -0.1), '+': () => zoom(0.9), '-': () => zoom(1.1),
      0: () => { Object.assign(orbit, {yaw: 0, pitch: 0.25}); request(); }};
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  });
}

if (start()) {
  listen();
  on('view', () => {
    fetchCloud();
    showObjects();
  });
  on('figures', () => { if (view.tracks || tracks.children.length) showTracks(); });
  on('redraw', request);
  window.addEventListener('resize', request);
  $('show-cloud').addEventListener('change', () => {
    cloud.visible = $('show-cloud').checked;
    fetchCloud();
    request();
  });
  $('show-ellipsoids').addEventListener('change', showObjects);
  on('anew', () => { cloudOf = 0; surfaces.clear(); textures.clear(); });
}
