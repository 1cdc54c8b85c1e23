// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What the page looks at: which result, which interpretation, which placement. Emits "view" when that
// changes, with {result, outlines, rank, chosen, alternative}.

import {emit, get, on, wanted} from './api.js';
import {guarded} from './dom.js';

export const view = {
  result: null,      // everything of one result
  outlines: null,    // of the interpretation
  rank: 1,
  chosen: -1,        // number of a placement
  alternative: -1,   // of the chosen placement; -1: its pose
  pinned: false,     // stay at this result when newer ones come
  summaries: [],     // of the last results, the newest last
  models: new Map(),
  status: null,
  frame: null,       // the camera's newest
  now_ns: 0,
  thresholds: JSON.parse(sessionStorage.getItem('thresholds') || '{}'),
};

const kSummaries = 200;
let loading = 0;

wanted.held = () => (view.result ? view.result.id : 0);

export const interpretation = () =>
  (view.result ? view.result.result.interpretations[view.rank - 1] : undefined);

/** Whether a placement passes its model's threshold. */
export const shown = (placement) => placement.presence >= (view.thresholds[placement.model] || 0);

export function setThreshold(model, value) {
  view.thresholds[model] = value;
  sessionStorage.setItem('thresholds', JSON.stringify(view.thresholds));
  emit('view');
}

/** Shows a result: what the news had, or the one of this number. */
export async function show(result, pinned) {
  const ticket = ++loading;
  view.pinned = pinned;  // at once, or news would overtake what was chosen
  if (typeof result === 'number') {
    result = await guarded(() => get(`/api/results/${result}`));
    if (!result) return;
  }
  if (ticket !== loading) return;
  Object.assign(view, {result, rank: 1, chosen: -1, alternative: -1, outlines: null});
  await fetchOutlines();
}

export async function chooseRank(rank) {
  Object.assign(view, {rank, chosen: -1, alternative: -1, outlines: null, pinned: true});
  await fetchOutlines();
}

export function choosePlacement(number, alternative = -1) {
  view.chosen = number;
  view.alternative = alternative;
  view.pinned = true;
  emit('view');
}

async function fetchOutlines() {
  const {result, rank} = view;
  emit('view');
  const outlines = await get(`/api/results/${result.id}/outlines?rank=${rank}`).catch(() => null);
  if (view.result !== result || view.rank !== rank) return;
  view.outlines = outlines;
  emit('view');
}

export async function fetchModels() {
  const answer = await guarded(() => get('/api/models'));
  if (!answer) return;
  view.library = answer;
  view.models = new Map(answer.models.map((model) => [model.name, model]));
  emit('models');
  emit('view');
}

on('news', (news) => {
  const version = view.status ? view.status.database_version : -1;
  Object.assign(view, {status: news.status, now_ns: news.now_ns, frame: news.frame || null,
    tracks: news.tracks || null});
  view.summaries = [...view.summaries, ...news.results].slice(-kSummaries);
  if (news.status.database_version !== version) fetchModels();
  if (news.newest && !view.pinned) show(news.newest, false);
  emit('figures', news);
});
on('anew', () => {
  Object.assign(view, {summaries: [], result: null, outlines: null, pinned: false, status: null, frame: null});
  emit('view');
});
