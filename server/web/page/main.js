// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Tabs, the state of the connection, and the token where one is needed.

import {emit, follow, on, setToken} from './api.js';
import {$} from './dom.js';
import './view.js';
import './live.js';
import './interpretations.js';
import './view3d.js';
import './models.js';
import './health.js';
import './settings.js';
import './actions.js';

const tabs = [...document.querySelectorAll('[role=tab]')];

function open(tab) {
  for (const one of tabs) {
    const chosen = one === tab;
    one.setAttribute('aria-selected', String(chosen));
    one.tabIndex = chosen ? 0 : -1;
    $(one.getAttribute('aria-controls')).hidden = !chosen;
  }
  emit('tab', tab.getAttribute('aria-controls'));
  emit('redraw');
}

tabs.forEach((tab, i) => {
  tab.addEventListener('click', () => open(tab));
  tab.addEventListener('keydown', (event) => {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!step) return;
    const next = tabs[(i + step + tabs.length) % tabs.length];
    next.focus();
    open(next);
  });
});
open(tabs[0]);

const kWords = {connected: '● connected', lost: '✗ server lost, trying again …', token: '✗ token needed'};
on('connection', (state) => {
  $('connection').dataset.state = state;
  $('connection').textContent = kWords[state];
  $('token-form').hidden = state !== 'token';
});

$('token-form').addEventListener('submit', (event) => {
  event.preventDefault();
  setToken($('token').value);
});

follow();
