// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What the page asks the server to do.

import {blob, emit, on, post, wanted} from './api.js';
import {$, guarded, make, notice} from './dom.js';
import {draw, drawing, pixelOf} from './live.js';
import {show, view} from './view.js';

/** Disables a button while the server works, and shows the result that comes of it. */
async function search(button, path, body) {
  button.disabled = true;
  const answer = await guarded(() => post(path, body));
  button.disabled = false;
  if (answer) await show(answer.result, true);
}

$('pause').addEventListener('click', () => guarded(async () => {
  await post('/api/parameters', {name: 'detection.continuous', value: view.status?.state === 'paused'});
}));
on('news', (news) => {
  const paused = news.status.state === 'paused';
  $('pause').textContent = paused ? 'Go on' : 'Pause';
  $('pause').setAttribute('aria-pressed', String(paused));
});

$('one-frame').addEventListener('click', () => search($('one-frame'), '/api/search', {}));

$('save').addEventListener('click', () => guarded(async () => {
  if (!view.result) throw new Error('There is no result to save yet.');
  const archive = await blob(`/api/results/${view.result.id}/archive`);
  const link = make('a', {href: URL.createObjectURL(archive), download: `frame_${view.result.id}.tar`});
  link.click();
  URL.revokeObjectURL(link.href);
  notice('Saved. Unpack it, then: bpa detect --depth depth.png --color color.png --camera camera.json');
}));

$('open-more').addEventListener('click', () => {
  $('more').hidden = !$('more').hidden;
  $('open-more').setAttribute('aria-expanded', String(!$('more').hidden));
});

$('show-tracks').addEventListener('change', () => { wanted.tracks = $('show-tracks').checked; });

// Draw a box or a line around something; what is inside is searched.
let mode = '';
function setMode(next) {
  mode = mode === next ? '' : next;
  $('draw-region').setAttribute('aria-pressed', String(mode === 'region'));
  $('draw-mask').setAttribute('aria-pressed', String(mode === 'mask'));
  for (const kind of ['color', 'depth']) $(kind).classList.toggle('drawing', mode !== '');
  if (mode) {
    $('show-camera').checked = false;  // the frame that is searched is the one of the result
    view.pinned = true;
    emit('view');
  }
}
$('draw-region').addEventListener('click', () => setMode('region'));
$('draw-mask').addEventListener('click', () => setMode('mask'));
document.addEventListener('keydown', (event) => { if (event.key === 'Escape' && mode) setMode(mode); });

function searchThere(body) {
  if (!view.result) return notice('There is no frame to search yet.');
  return search($('draw-region'), `/api/search?result=${view.result.id}`, body);
}

function boxOf([[x0, y0], [x1, y1]]) {
  return [Math.min(x0, x1), Math.min(y0, y1), Math.abs(x1 - x0) + 1, Math.abs(y1 - y0) + 1];
}

function listen(kind) {
  const canvas = $(kind);
  let from = null;
  const sketch = () => ['color', 'depth'].forEach(draw);
  canvas.addEventListener('pointerdown', (event) => {
    if (!mode) return;
    event.preventDefault();
    canvas.setPointerCapture(event.pointerId);
    from = pixelOf(canvas, event);
    drawing.corners = mode === 'mask' ? [from] : null;
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!from) return;
    const at = pixelOf(canvas, event);
    if (mode === 'mask') drawing.corners.push(at);
    else drawing.box = boxOf([from, at]);
    sketch();
  });
  canvas.addEventListener('pointerup', async () => {
    if (!from) return;
    from = null;
    const body = mode === 'mask' ? {polygon: drawing.corners} : drawing.box ? {region: drawing.box} : null;
    if (mode) setMode(mode);
    if (body) await searchThere(body);
    drawing.box = drawing.corners = null;
    sketch();
  });
}
listen('color');
listen('depth');

$('region-search').addEventListener('click', () => searchThere(
  {region: ['x', 'y', 'w', 'h'].map((name) => Number($(`region-${name}`).value))}));

async function cameraOf(file) {
  if (!file) throw new Error('A PNG pair needs its camera: choose a camera.json with fx, fy, cx, cy.');
  const json = JSON.parse(await file.text());
  const [fx, , cx, , fy, cy] = json.cam_K || [json.fx, 0, json.cx, 0, json.fy, json.cy];
  return {fx, fy, cx, cy, depth_scale_mm: json.depth_scale ?? 1};
}

$('upload').addEventListener('click', () => guarded(async () => {
  const file = (name) => $(`upload-${name}`).files[0];
  if (file('pcd')) return search($('upload'), '/api/upload?kind=pcd', file('pcd'));
  if (!file('depth')) throw new Error('Choose a depth image or a cloud first.');
  const camera = await cameraOf(file('camera'));
  const query = new URLSearchParams({kind: 'png', depth_bytes: file('depth').size, ...camera});
  return search($('upload'), `/api/upload?${query}`, new Blob([file('depth'), ...(file('color') ? [file('color')] : [])]));
}));

$('record-start').addEventListener('click', () => guarded(async () => {
  const body = {path: $('record-path').value, seconds: Number($('record-seconds').value)};
  const done = await post('/api/record', body);
  notice(`Recording to ${done.path}`);
}));
$('record-stop').addEventListener('click', () => guarded(async () => {
  const done = await post('/api/record', {stop: true});
  notice(`${done.frames} frames, ${(done.bytes / 1e6).toFixed(1)} MB in ${done.path}`);
}));
