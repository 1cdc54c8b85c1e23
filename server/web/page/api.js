// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Talks to the server: requests with the token, and the news, for which the page asks again and
// again. A server that is lost is asked every second until it is back.

const kPatience = 8000;  // ms, longer than the server lets a request for news wait
const kRetry = 1000;     // ms

/** Of this tab; ends with it. The address holds it only until it was read. */
function takeToken() {
  const given = /[#&]token=([^&]*)/.exec(location.hash);
  if (given) {
    sessionStorage.setItem('token', decodeURIComponent(given[1]));
    history.replaceState(null, '', location.pathname);
  }
  return sessionStorage.getItem('token') || '';
}

let token = takeToken();
export function setToken(text) {
  token = text.trim();
  sessionStorage.setItem('token', token);
}

async function ask(path, options = {}, patience = 0) {
  const headers = token ? {Authorization: `Bearer ${token}`} : {};
  const signal = patience ? AbortSignal.timeout(patience) : undefined;
  const answer = await fetch(path, {...options, headers, signal, cache: 'no-store'});
  if (answer.ok) return answer;
  let message = `the server answers ${answer.status}`;
  try {
    message = (await answer.json()).message || message;
  } catch (_) {
    // no JSON: the number has to do
  }
  throw Object.assign(new Error(message), {status: answer.status});
}

export const get = async (path) => (await ask(path)).json();
export const blob = async (path) => (await ask(path)).blob();
export const bytes = async (path) => (await ask(path)).arrayBuffer();
export const post = async (path, body) =>
  (await ask(path, {method: 'POST', body: body instanceof Blob ? body : JSON.stringify(body)})).json();

/** Emits "news", "connection" (its detail "connected", "lost" or "token") and "anew". */
export const events = new EventTarget();
export const emit = (name, detail) => events.dispatchEvent(new CustomEvent(name, {detail}));
export const on = (name, react) => events.addEventListener(name, (event) => react(event.detail));

/** What the page asks the server for: tracks, and to keep the result that it shows (0: none). */
export const wanted = {tracks: false, held: () => 0};

const viewer = crypto.getRandomValues(new Uint32Array(2)).join('-');
const known = {sequence: 0, result: 0, uptime: 0};
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

async function once() {
  const query = new URLSearchParams({viewer, sequence: known.sequence, result: known.result,
    tracks: wanted.tracks ? 1 : 0, held: wanted.held()});
  const news = await (await ask(`/api/live?${query}`, {}, kPatience)).json();
  if (!news.status) return;
  if (news.status.uptime_s < known.uptime) {  // another server than before
    known.result = 0;
    known.sequence = 0;
    known.uptime = 0;
    emit('anew');
    return;
  }
  known.uptime = news.status.uptime_s;
  known.sequence = news.sequence;
  for (const result of news.results) known.result = Math.max(known.result, result.id);
  emit('connection', 'connected');
  emit('news', news);
}

/** Never returns. A page that nobody sees does not ask. */
export async function follow() {
  for (;;) {
    if (document.hidden) {
      await pause(kRetry);
      continue;
    }
    try {
      await once();
    } catch (error) {
      emit('connection', error.status === 401 ? 'token' : 'lost');
      await pause(kRetry);
    }
  }
}
