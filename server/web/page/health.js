// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Diagnostics, times of the stages, the log.

import {get, on} from './api.js';
import {$, guarded, make} from './dom.js';
import {view} from './view.js';

const kPeriod = 1000;  // ms
const kLines = 500;
const kBars = 80;
const kAxis = 20;  // pixels below the bars
const kLevels = ['debug', 'info', 'warning', 'error'];
const kStates = [['✓ OK', 'good'], ['⚠ warning', 'warn'], ['✗ error', 'bad'], ['✗ stale', 'bad']];
const kColors = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442', '#999999'];  // Okabe and Ito's

let open = false, last = 0, timer = 0, lines = [];

function showDiagnostics(all) {
  $('diagnostics').replaceChildren(...all.map((one) => {
    const [word, style] = kStates[Math.min(one.level, 3)];
    return make('section', {class: 'card', 'data-status': one.name},
      make('h3', {}, make('span', {class: style}, word), one.name.split(': ').at(-1)),
      make('p', {}, one.message),
      make('table', {}, make('tbody', {}, ...one.values.map(([key, value]) =>
        make('tr', {}, make('td', {}, key), make('td', {class: 'number'}, value))))));
  }));
}

function showLog() {
  const least = kLevels.indexOf($('log-level').value);
  const list = $('log'), atEnd = list.scrollTop + list.clientHeight >= list.scrollHeight - 5;
  list.replaceChildren(...lines.filter((line) => kLevels.indexOf(line.level) >= least).map((line) =>
    make('li', {class: {error: 'bad', warning: 'warn'}[line.level]},
      `${new Date(line.stamp_ns / 1e6).toLocaleTimeString()} ${line.level}: ${line.text}`)));
  if (atEnd) list.scrollTop = list.scrollHeight;
}

/** Patterns as well as colours tell the stages apart. */
function pattern(i) {
  const tile = document.createElement('canvas');
  tile.width = tile.height = 8;
  const pen = tile.getContext('2d');
  pen.fillStyle = kColors[i % kColors.length];
  pen.fillRect(0, 0, 8, 8);
  pen.strokeStyle = 'rgb(255 255 255 / 70%)';
  pen.beginPath();
  if (i % 3 === 1) { pen.moveTo(0, 8); pen.lineTo(8, 0); }
  if (i % 3 === 2) { pen.moveTo(4, 0); pen.lineTo(4, 8); }
  pen.stroke();
  return tile;
}

function showStages() {
  const canvas = $('stages'), results = view.summaries.slice(-kBars);
  const width = canvas.width = canvas.clientWidth, height = canvas.height = canvas.clientHeight;
  const context = canvas.getContext('2d');
  const names = [...new Set(results.flatMap((one) => one.stages.map(([name]) => name)))];
  const time = (one, wantedName) => (one.stages.find(([name]) => name === wantedName) || [])[1] || 0;
  const total = (one) => one.stages.reduce((sum, [, ms]) => sum + ms, 0);
  const most = Math.max(1, ...results.map(total));
  const fills = names.map((_, i) => context.createPattern(pattern(i), 'repeat'));
  const step = (width - 60) / kBars;
  results.forEach((one, column) => {
    let y = height - kAxis;
    names.forEach((name, i) => {
      const tall = time(one, name) / most * (height - kAxis - 20);
      context.fillStyle = fills[i];
      context.fillRect(56 + column * step, y - tall, Math.max(1, step - 1), tall);
      y -= tall;
    });
  });
  context.fillStyle = getComputedStyle(document.body).color;
  context.font = '12px system-ui, sans-serif';
  context.fillText(`${Math.round(most)} ms`, 4, 18);
  context.fillText('0', 4, height - kAxis);
  const newest = results.at(-1);
  for (const column of new Set([0, results.length - 1])) {  // the times of the first and of the last bar
    if (column < 0) continue;
    const text = new Date(results[column].came_ns / 1e6).toLocaleTimeString();
    const x = 56 + column * step, wide = context.measureText(text).width;
    if (column === 0 || x - wide > 56 + wide) context.fillText(text, column ? x + step - wide : x, height - 5);
  }
  $('stage-legend').replaceChildren(...names.map((name, i) => {
    const swatch = pattern(i);
    swatch.className = 'swatch';
    return make('span', {}, swatch, `${name} ${time(newest, name).toFixed(1)} ms`);
  }));
  canvas.dataset.bars = results.length;
}

async function refresh() {
  if (!open || document.hidden) return;
  const answer = await guarded(() => get(`/api/health?log=${last}`));
  if (!answer) return;
  showDiagnostics(answer.diagnostics);
  if (answer.log.length) {
    lines = [...lines, ...answer.log].slice(-kLines);
    last = lines.at(-1).id;
    showLog();
  }
  showStages();
}

$('log-level').addEventListener('change', showLog);
on('tab', (name) => {
  open = name === 'health';
  clearInterval(timer);
  if (!open) return;
  refresh();
  timer = setInterval(refresh, kPeriod);
});
on('anew', () => { last = 0; lines = []; });
