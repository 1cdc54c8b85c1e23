// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The ranked interpretations of a result, and the placements of the one that is chosen.

import {get, on} from './api.js';
import {$, choosable, css, guarded, make, percent} from './dom.js';
import {uncertainty} from './geometry.js';
import {kSameDegrees, kSamePlace, readings, samePlacement} from './readings.js';
import {choosePlacement, chooseRank, interpretation, shown, view} from './view.js';

const kLeast = 0.005;     // log odds that are shown
/** The objects of the first interpretation; of another, how it differs from that. */
function describe(one, first) {
  const names = (placements) => placements.map((placement) => placement.model).join(', ');
  const visible = one.placements.filter(shown);
  if (one === first) return visible.length ? names(visible) : 'nothing known';
  const in_ = (placement, list) => list.some((other) => samePlacement(placement, other, view.models));
  const more = visible.filter((placement) => !in_(placement, first.placements));
  const fewer = first.placements.filter((placement) => shown(placement) && !in_(placement, one.placements));
  const moved = more.filter((placement) => fewer.some((other) => other.model === placement.model));
  const only = (list) => list.filter((placement) => !moved.some((other) => other.model === placement.model));
  const words = [[only(fewer), 'without'], [only(more), 'with'], [moved, 'another pose of']]
    .filter(([list]) => list.length).map(([list, word]) => `${word} ${names(list)}`);
  return words.length ? `as rank 1, ${words.join(', ')}` : 'as rank 1, poses nearly the same';
}

const kMeaning = `A line is a set of objects in their poses. Interpretations whose poses differ by less than
  ${100 * kSamePlace} cm and ${kSameDegrees}° share a line. Its percentage is their sum, among all that are listed. Rank 1
  comes first, the other lines by falling percentage. Ranks are those of results and topics. Rank 1 has the best score. Each next rank holds a pose that no rank before it holds, however
  improbable. The remaining ranks follow by falling score. The presence of one object stands beside its name
  below: the probability that it is there, at whatever pose.`;

function option(one, kind, probability, text, ranks) {
  return make('div', {role: 'option', class: kind, 'data-rank': one.rank,
    'aria-selected': String(one.rank === view.rank), click: () => chooseRank(one.rank)},
  make('span', {class: 'number'}, percent(probability)), ` ${text} `, make('small', {}, ranks));
}

/** The lines of one reading: its first interpretation and, while one of them is shown, the others. */
function lines({probability, members}, first) {
  const [one, ...others] = members;
  const open = members.some((member) => member.rank === view.rank);
  const ranks = members.map((member) => member.rank);
  const few = ranks.length > 6 ? `${ranks.slice(0, 5).join(', ')} … ${ranks.at(-1)}` : ranks.join(', ');
  return [option(one, 'line', probability, describe(one, first), `${others.length ? 'ranks' : 'rank'} ${few}`),
    ...(open ? others.map((other) => option(other, 'like', other.probability, 'of it, nearly the same poses', `rank ${other.rank}`)) : [])];
}

function showRanks() {
  const all = view.result ? view.result.result.interpretations : [];
  $('of-result').textContent = view.result
    ? `of result ${view.result.id}, ${view.result.origin}${view.pinned ? ', held' : ''}` : '';
  $('of-result').dataset.id = view.result ? view.result.id : '';
  $('interpretations').replaceChildren(...readings(all, view.models, shown).flatMap((reading) => lines(reading, all[0])));
  $('meaning').textContent = kMeaning;
}

/** What may be missing, and why: the doctor on the frame, and what the search may have missed. */
function showMissed() {
  const kMentioned = 0.05;  // objects
  const missed = (view.result?.result.missed || []).filter(({expected}) => expected >= kMentioned)
    .sort((one, other) => other.expected - one.expected);
  $('advice').textContent = view.result?.advice || '';
  $('missed').textContent = missed.length
    ? `Objects in sight that the search expects to have missed: ${missed.map(({model, expected}) => `${model} ${expected.toFixed(2)}`).join(', ')}.`
    : '';
}

/** The numbers of the search that are not their defaults, and why. */
function showPlan() {
  const entries = Object.entries(view.result?.result.plan || {}).filter(([, entry]) => entry.reason !== 'default');
  $('plan').replaceChildren(...entries.map(([name, {value, reason}]) => make('tr', {}, make('td', {}, name),
    make('td', {class: 'number'}, String(value)), make('td', {}, reason))));
}

function bar(value, most) {
  const share = Math.min(1, Math.abs(value) / most) * 50;
  const filled = make('i', {class: value < 0 ? 'minus' : ''});
  filled.style.left = `${value < 0 ? 50 - share : 50}%`;
  filled.style.width = `${share}%`;
  return make('span', {class: 'bar', role: 'img', 'aria-label': value.toFixed(2)}, filled, make('b'));
}

async function showScore(number, into) {
  const parts = await guarded(() =>
    get(`/api/results/${view.result.id}/score?rank=${view.rank}&placement=${number}`));
  if (!parts) return;
  if (!parts.length) {
    into.replaceChildren('The server does not say what the score is made of.');
    return;
  }
  const sorted = parts.filter((part) => Math.abs(part.adds) >= kLeast)
    .sort((a, b) => Math.abs(b.adds) - Math.abs(a.adds));
  const rest = parts.filter((part) => !sorted.includes(part)).map((part) => part.name);
  const most = Math.max(1, ...sorted.map((part) => Math.abs(part.adds)));
  into.replaceChildren(make('p', {class: 'soft'}, `The score is ${parts.reduce((sum, part) => sum + part.adds, 0).toFixed(2)}, the sum of:`),
  make('table', {class: 'score'}, make('thead', {}, make('tr', {},
    make('th', {}, 'component'), make('th', {}, 'value'), make('th', {colspan: 2}, 'adds to the log odds'))),
  make('tbody', {}, ...sorted.map((part) => make('tr', {title: `${part.meaning} (${part.unit})`},
    make('td', {}, part.name), make('td', {class: 'number'}, part.value.toPrecision(3)),
    make('td', {}, bar(part.adds, most)), make('td', {class: 'number'}, part.adds.toFixed(2)))))),
  make('p', {class: 'soft'}, rest.length ? `Nothing is added by ${rest.join(', ')}.` : ''));
}

function alternatives(placement, number) {
  if (!placement.alternatives || !placement.alternatives.length) return make('p', {class: 'soft'}, 'No other pose fits the view.');
  const option = (text, k) => make('button', {'aria-pressed': String(view.alternative === k),
    click: () => choosePlacement(number, k)}, text);
  return make('p', {}, 'Poses that fit as well: ', option(`this, ${percent(ownWeight(placement))}`, -1), ' ',
    ...placement.alternatives.slice(0, 6).flatMap((one, k) => [option(`${k + 1}: ${percent(one.weight)}`, k), ' ']));
}

const ownWeight = ({alternatives}) => 1 - (alternatives || []).reduce((sum, one) => sum + one.weight, 0);

function card(placement, number) {
  const model = view.models.get(placement.model);
  const badge = make('span', {class: 'badge'}, String(number + 1));
  if (model) badge.style.background = css(model.color);
  const chosen = view.chosen === number;
  const [x, y, z] = placement.pose.translation_m;
  const open = ownWeight(placement) < 0.5;  // as pose_is_open()
  const head = make('h3', {}, badge, make('button', {'aria-expanded': String(chosen), 'data-placement': number,
    click: () => choosePlacement(chosen ? -1 : number)}, placement.model),
    percent(placement.presence), open ? make('small', {}, ', pose open') : '');
  const box = make('div', {class: chosen ? 'placement chosen' : 'placement'}, head,
    make('p', {}, uncertainty(placement, model)));
  if (!chosen) return box;
  const score = make('div', {}, 'score …');
  box.append(make('p', {class: 'soft'}, `At ${x.toFixed(3)}, ${y.toFixed(3)}, ${z.toFixed(3)} m (right, down, forward); `
    + `${percent(placement.visible_fraction)} of its near side is visible; log odds ${placement.score.toFixed(2)}.`),
  alternatives(placement, number), score);
  showScore(number, score);
  return box;
}

let drawn = '';
function showPlacements() {
  const placements = interpretation()?.placements || [];
  // The score table is fetched: made again only for another choice.
  const key = [view.result?.id, view.rank, view.chosen, view.alternative, view.models.size,
    JSON.stringify(view.thresholds)].join('|');
  if (key === drawn) return;
  drawn = key;
  const cards = placements.flatMap((placement, i) => (shown(placement) ? [card(placement, i)] : []));
  const hidden = placements.length - cards.length;
  $('placements').replaceChildren(...cards,
    make('p', {class: 'soft'}, hidden ? `${hidden} below their threshold (Models).` : placements.length ? '' : 'Nothing known is there.'));
}

function showTracks() {
  const tracks = $('show-tracks').checked && view.tracks ? view.tracks.tracks : [];
  const speed = (track) => Math.round(1000 * Math.hypot(...track.velocity));
  $('tracks').replaceChildren(...(tracks.length ? [make('h2', {}, 'Tracks'), make('table', {}, make('tbody', {},
    ...tracks.map((track) => make('tr', {'data-track': track.name}, make('td', {}, track.name), make('td', {}, track.state),
      make('td', {class: 'number'}, percent(track.probability)), make('td', {class: 'number'}, `${speed(track)} mm/s`)))))] : []));
}

choosable($('interpretations'));
on('figures', showTracks);
on('view', () => {
  showRanks();
  showMissed();
  showPlan();
  showPlacements();
});
