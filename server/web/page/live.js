// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Colour and depth with outlines, the figures above them and the time line below.

import {blob, emit, on} from './api.js';
import {$, choosable, css, make, percent} from './dom.js';
import {project, transform} from './geometry.js';
import {choosePlacement, interpretation, show, shown, view} from './view.js';

// Lines differ by their pattern as well, for those who cannot tell colours apart.
const kDashes = [[], [12, 5], [3, 4], [14, 4, 3, 4], [6, 3], [18, 6]];
const kAxes = [['#d55e00', 'x'], ['#009e73', 'y'], ['#56b4e9', 'z']];  // Okabe and Ito's

const images = {color: {key: '', bitmap: null}, depth: {key: '', bitmap: null}};
export const drawing = {corners: null, box: null};  // what the user draws, in pixels of the image

/** Where the pictures to show now are. */
function source() {
  if (view.frame && ($('show-camera').checked || !view.result)) return `frames/${view.frame.id}`;
  return view.result ? `results/${view.result.id}` : '';
}

/** One picture at a time: a slow line shows fewer of them. */
async function fetchPicture(kind) {
  const image = images[kind], wantedKey = source();
  if (!wantedKey || image.busy || image.key === wantedKey) return;
  image.busy = true;
  try {
    image.bitmap = await createImageBitmap(await blob(`/api/${wantedKey}/${kind}`));
    image.key = wantedKey;
  } catch (_) {
    image.key = '';  // gone meanwhile: the next one
  }
  image.busy = false;
  draw(kind);
  if (source() !== wantedKey) fetchPicture(kind);
}

function trace(context, outline) {
  context.beginPath();
  for (const polygon of outline) {
    for (let i = 0; i < polygon.length; i += 2) context.lineTo(polygon[i] + 0.5, polygon[i + 1] + 0.5);
    context.closePath();
  }
}

/** A line that shows on any ground: dark below, colour above. */
function stroke(context, color, dash, width) {
  context.setLineDash([]);
  context.lineWidth = width + 2;
  context.strokeStyle = 'rgb(0 0 0 / 75%)';
  context.stroke();
  context.setLineDash(dash);
  context.lineWidth = width;
  context.strokeStyle = color;
  context.stroke();
}

/** Text that is moved down until it covers none of `taken`, to which it is added. */
function label(context, text, x, y, scale, taken) {
  context.font = `600 ${12 * scale}px system-ui, sans-serif`;
  const width = context.measureText(text).width + 6 * scale, height = 16 * scale;
  const left = Math.min(Math.max(0, x - width / 2), context.canvas.width - width);
  let top = y - height / 2;
  const covers = (other) => left < other.left + other.width && other.left < left + width
    && top < other.top + height && other.top < top + height;
  for (let tries = 0; tries < 20 && taken.some(covers); ++tries) top += height / 2;
  taken.push({left, top, width});
  context.fillStyle = 'rgb(0 0 0 / 65%)';
  context.fillRect(left, top, width, height);
  context.fillStyle = '#fff';
  context.fillText(text, left + 3 * scale, top + 12.5 * scale);
}

function drawAxes(context, pose, scale) {
  const {camera} = view.result;
  const from = project(camera, transform(pose, [0, 0, 0]));
  kAxes.forEach(([color, name], i) => {
    const to = project(camera, transform(pose, [0, 1, 2].map((k) => (k === i ? 0.06 : 0))));
    if (!from || !to) return;
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    stroke(context, color, [], 2.5 * scale);
    context.fillStyle = '#fff';
    context.fillText(name, to[0] + 3, to[1]);
  });
}

function drawPlacements(context, scale) {
  const placements = interpretation()?.placements || [], labels = [], taken = [];
  placements.forEach((placement, i) => {
    const one = view.outlines?.[i];
    if (!shown(placement) || !one) return;
    const chosen = view.chosen === i;
    const model = view.models.get(placement.model);
    const outline = chosen && view.alternative >= 0 ? one.alternatives[view.alternative] : one.outline;
    if (!outline || !outline.length) return;
    const color = model ? css(model.color) : '#fff';
    trace(context, outline);
    if (chosen) {
      context.fillStyle = 'rgb(255 255 255 / 22%)';
      context.fill();
    }
    stroke(context, color, kDashes[i % kDashes.length].map((length) => length * scale), (chosen ? 4 : 2.2) * scale);
    const xs = outline[0].filter((_, k) => k % 2 === 0), ys = outline[0].filter((_, k) => k % 2);
    const text = `${i + 1} ${placement.model}${chosen ? ` ${percent(placement.presence)}` : ''}`;
    labels.push([text, (Math.min(...xs) + Math.max(...xs)) / 2, Math.max(...ys) + 8 * scale]);
    if (chosen) {
      const pose = view.alternative >= 0 ? placement.alternatives[view.alternative].pose : placement.pose;
      drawAxes(context, pose, scale);
    }
  });
  for (const [text, x, y] of labels) label(context, text, x, y, scale, taken);
}

function drawSketch(context, scale) {
  const {box, corners} = drawing;
  context.beginPath();
  if (box) context.rect(...box);
  else if (corners) corners.forEach((corner) => context.lineTo(...corner));
  else return;
  stroke(context, '#ffe94d', [8 * scale, 5 * scale], 2.5 * scale);
}

export function draw(kind) {
  const canvas = $(kind), {bitmap} = images[kind];
  if (!bitmap) return;
  if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
    canvas.style.aspectRatio = `${bitmap.width} / ${bitmap.height}`;
  }
  const context = canvas.getContext('2d');
  const scale = bitmap.width / Math.max(200, canvas.clientWidth || bitmap.width);
  context.drawImage(bitmap, 0, 0);
  if (view.result && view.result.camera.width === bitmap.width) drawPlacements(context, scale);
  drawSketch(context, scale);
}

function redraw() {
  for (const kind of ['color', 'depth']) {
    fetchPicture(kind);
    draw(kind);
  }
}

/** The placement whose outline holds a point of the image. */
function placementAt(x, y) {
  const context = $('color').getContext('2d');
  const found = (view.outlines || []).findIndex((one) => {
    trace(context, one.outline);
    return one.outline.length && context.isPointInPath(x, y);
  });
  return found;
}

export function pixelOf(canvas, event) {
  const box = canvas.getBoundingClientRect();
  const clamp = (value, most) => Math.round(Math.min(most - 1, Math.max(0, value)));
  return [clamp((event.clientX - box.left) / box.width * canvas.width, canvas.width),
    clamp((event.clientY - box.top) / box.height * canvas.height, canvas.height)];
}

// Figures: rates over the last 5 s.
const readings = [];
function rate(field) {
  if (readings.length < 2) return 0;
  const first = readings[0], last = readings.at(-1);
  return (last.status[field] - first.status[field]) / ((last.now_ns - first.now_ns) / 1e9);
}

function figure(name, value) {
  return make('div', {}, make('dt', {}, name), make('dd', {'data-figure': name}, value));
}

function showFigures(news) {
  readings.push({now_ns: news.now_ns, status: news.status});
  while (readings.length > 2 && news.now_ns - readings[0].now_ns > 5e9) readings.shift();
  const seconds = (ns) => `${(ns / 1e9).toFixed(ns < 1e10 ? 2 : 0)} s`;
  const last = view.summaries.at(-1);
  const rows = [figure('State', news.status.state),
    figure('Frames', `${rate('frames_received').toFixed(1)} / s`),
    figure('Searched', `${rate('frames_processed').toFixed(1)} / s`)];
  if (last) {
    rows.push(figure('Search', `${Math.round(last.total_ms)} ms`),
      figure('Latency', last.origin === 'camera' ? `${Math.round((last.came_ns - last.stamp_ns) / 1e6)} ms` : '–'));
  }
  if (view.frame) rows.push(figure('Age of the frame', seconds(news.now_ns - view.frame.stamp_ns)));
  if (news.status.queue_length) rows.push(figure('Waiting', String(news.status.queue_length)));
  $('figures').replaceChildren(...rows);
}

function showTimeline() {
  const line = $('timeline'), atEnd = !view.pinned;
  const items = view.summaries.slice(-40).map((one) => make('div', {role: 'option', 'data-id': one.id,
    'aria-selected': String(view.result?.id === one.id), click: () => show(one.id, true)},
  `${one.objects.length} objects`,
  make('small', {}, `${new Date(one.came_ns / 1e6).toLocaleTimeString()} · ${one.origin}`)));
  $('newest').setAttribute('aria-pressed', String(!view.pinned));
  line.replaceChildren(...items);
  const chosen = line.querySelector('[aria-selected=true]');
  line.scrollLeft = atEnd || !chosen ? line.scrollWidth : chosen.offsetLeft - line.clientWidth / 2;
}

$('newest').addEventListener('click', () => {
  view.pinned = false;
  if (view.summaries.length) show(view.summaries.at(-1).id, false);
});
choosable($('timeline'));
for (const kind of ['color', 'depth']) {
  $(kind).addEventListener('click', (event) => {
    if ($(kind).classList.contains('drawing')) return;
    choosePlacement(placementAt(...pixelOf($(kind), event)));
  });
}
$('show-camera').addEventListener('change', redraw);
on('view', () => {
  redraw();
  showTimeline();
});
on('figures', (news) => {
  showFigures(news);
  if ($('show-camera').checked || !view.result) redraw();
  if (news.results.length) showTimeline();
});
window.addEventListener('resize', redraw);
on('redraw', redraw);
on('anew', () => { readings.length = 0; emit('redraw'); });
