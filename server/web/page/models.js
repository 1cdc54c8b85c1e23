// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The library: what is loaded, what is not, and from which probability each model is shown.

import {blob, get, on, post} from './api.js';
import {$, css, guarded, make, notice} from './dom.js';
import {fetchModels, setThreshold, view} from './view.js';

let alike = [];

function symmetries(model) {
  const turns = model.symmetry_turns_wxyz.length;
  const words = [];
  if (model.symmetry_axes.length) words.push(`turns freely about ${model.symmetry_axes.length} axis`);
  if (turns) words.push(`${turns + 1} orientations that look alike`);
  return `Symmetry: ${words.join(', ') || 'none'} (${model.symmetry_origin}).`;
}

/** How many placements of the last results the threshold keeps. */
function kept(name) {
  const threshold = view.thresholds[name] || 0;
  const all = view.summaries.flatMap((one) => one.objects.filter(([model]) => model === name));
  const keeps = all.filter(([, probability]) => probability >= threshold).length;
  return `keeps ${keeps} of ${all.length} placements in the last ${view.summaries.length} results`;
}

async function change(name, action, button) {
  button.disabled = true;
  const done = await guarded(() => post(`/api/models/${encodeURIComponent(name)}/${action}`, {}));
  button.disabled = false;
  if (done) notice(`${name}: ${action === 'load' ? 'loaded' : 'unloaded'}`);
  await fetchModels();
}

function thresholdOf(model) {
  const said = make('output', {'data-kept': model.name}, kept(model.name));
  const value = make('b', {}, (view.thresholds[model.name] || 0).toFixed(2));
  const range = make('input', {type: 'range', min: 0, max: 1, step: 0.01, value: view.thresholds[model.name] || 0,
    'aria-label': `Threshold of ${model.name}`, input: () => {
      setThreshold(model.name, Number(range.value));
      value.textContent = Number(range.value).toFixed(2);
      said.textContent = kept(model.name);
    }});
  return make('div', {}, make('label', {}, 'Threshold ', value, range), make('small', {class: 'soft'}, said));
}

function card(model) {
  const picture = make('img', {alt: `${model.name}, rendered`, width: 96, height: 96});
  blob(`/api/models/${model.name}/thumbnail`).then((image) => { picture.src = URL.createObjectURL(image); })
    .catch(() => { picture.alt = 'no picture'; });
  picture.addEventListener('load', () => URL.revokeObjectURL(picture.src));
  const badge = make('span', {class: 'badge'}, String(model.number));
  badge.style.background = css(model.color);
  const size = model.box_max.map((high, i) => Math.round(1000 * (high - model.box_min[i]))).join(' × ');
  const warnings = [...model.warnings, ...(model.complete ? [] : ['seen from one side only']),
    ...(model.has_colors ? [] : ['has no colours']),
    ...alike.filter((finding) => finding.what.split(' ').includes(model.name))
      .map((finding) => `${finding.what}: ${finding.why}. ${finding.remedy}`)];
  const unload = make('button', {'data-unload': model.name, click: () => change(model.name, 'unload', unload)}, 'Unload');
  return make('section', {class: 'card', 'data-model': model.name},
    make('div', {class: 'head'}, picture, make('div', {}, make('h3', {}, badge, model.name),
      `${size} mm, ${model.points} points`, make('br'), symmetries(model))),
    warnings.length ? make('ul', {class: 'warn'}, ...warnings.map((text) => make('li', {}, `⚠ ${text}`))) : null,
    thresholdOf(model), unload);
}

function showModels() {
  const {library} = view;
  if (!library) return;
  $('cards').replaceChildren(...library.models.map(card));
  const others = library.not_loaded.map((name) => {
    const load = make('button', {'data-load': name, click: () => change(name, 'load', load)}, 'Load');
    return make('tr', {}, make('td', {}, name), make('td', {}, load));
  });
  const broken = library.broken.map((one) => make('li', {class: 'bad'}, `✗ ${one.name}: ${one.why}`));
  $('others').replaceChildren(
    ...(others.length ? [make('h2', {}, 'In the folder, not loaded'), make('table', {}, make('tbody', {}, ...others))] : []),
    ...(broken.length ? [make('h2', {}, 'Cannot be read'), make('ul', {}, ...broken)] : []),
    make('p', {class: 'soft'}, `Library ${library.library}, version ${library.version}`));
}

async function compare() {
  for (;;) {
    const answer = await guarded(() => get('/api/look_alikes'));
    if (!answer) return;
    $('compare-state').textContent = answer.running ? 'comparing all pairs …'
      : {0: 'No two look alike', 1: '1 pair looks alike'}[answer.findings.length]
        || `${answer.findings.length} pairs look alike`;
    alike = answer.findings;
    if (!answer.running) break;
    await new Promise((done) => setTimeout(done, 1000));
  }
  showModels();
}

async function fetchLeast() {
  const all = await guarded(() => get('/api/parameters'));
  const least = all?.find((one) => one.name === 'detector.scene.min_probability');
  if (least) $('min-probability').value = least.value;
}

$('compare').addEventListener('click', compare);
$('min-probability').addEventListener('change', () => guarded(() => post('/api/parameters',
  {name: 'detector.scene.min_probability', value: Number($('min-probability').value)})));
on('models', showModels);
on('tab', (name) => {
  if (name !== 'models') return;
  showModels();
  fetchLeast();
});
