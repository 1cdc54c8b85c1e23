// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The parameters, with the descriptions and ranges that ROS 2 tools show too.

import {get, on, post} from './api.js';
import {$, guarded, make, notice} from './dom.js';

let parameters = [];

const text = (value) => (Array.isArray(value) ? value.join(', ') : String(value));

function read(parameter, input) {
  if (parameter.type === 'bool') return input.checked;
  if (parameter.type === 'integer' || parameter.type === 'double') return Number(input.value);
  if (parameter.type === 'string array') return input.value.split(',').map((one) => one.trim()).filter(Boolean);
  return input.value;
}

async function set(parameter, input) {
  const value = read(parameter, input);
  const done = await guarded(() => post('/api/parameters', {name: parameter.name, value}));
  if (done) notice(`${parameter.name} is ${text(value)}`);
  await fetchParameters();
}

function control(parameter) {
  const isNumber = parameter.type === 'integer' || parameter.type === 'double';
  const input = make('input', {id: `set-${parameter.name}`, type: parameter.type === 'bool' ? 'checkbox' : isNumber ? 'number' : 'text',
    disabled: parameter.read_only ? '' : undefined, step: parameter.type === 'double' ? 'any' : undefined,
    min: isNumber ? parameter.range?.[0] : undefined, max: isNumber ? parameter.range?.[1] : undefined,
    'aria-label': parameter.name, change: () => set(parameter, input)});
  if (parameter.type === 'bool') input.checked = parameter.value;
  else input.value = text(parameter.value);
  return input;
}

function row(parameter) {
  const range = parameter.range ? `${parameter.range[0]} to ${parameter.range[1]}; ` : '';
  const changed = text(parameter.value) !== text(parameter.default);
  return make('tr', {'data-parameter': parameter.name},
    make('td', {}, changed ? make('b', {title: 'not the default'}, `• ${parameter.name}`) : parameter.name),
    make('td', {}, control(parameter)),
    make('td', {}, parameter.description, make('br'),
      make('small', {class: 'soft'}, `${range}default ${text(parameter.default) || 'empty'}${parameter.read_only ? '; set at the start' : ''}`)));
}

function showParameters() {
  const words = $('find-setting').value.toLowerCase();
  const found = parameters.filter((one) => !($('only-changeable').checked && one.read_only)
    && `${one.name} ${one.description}`.toLowerCase().includes(words));
  $('parameters').replaceChildren(make('table', {}, make('tbody', {}, ...found.map(row))));
}

async function fetchParameters() {
  parameters = await guarded(() => get('/api/parameters')) || parameters;
  showParameters();
}

$('find-setting').addEventListener('input', showParameters);
$('only-changeable').addEventListener('change', showParameters);
on('tab', (name) => { if (name === 'settings') fetchParameters(); });
