// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0

export const $ = (id) => document.getElementById(id);

/** An element: make('td', {class: 'number'}, 'text', child ...). Functions are listeners. */
export function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(key, value);
    else if (value !== undefined && value !== null && value !== false) element.setAttribute(key, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

let hide = 0;
/** Says what went wrong (bad), or that something is done, for a while. */
export function notice(text, bad = false) {
  $('notice').textContent = bad ? `✗ ${text}` : text;
  $('notice').classList.toggle('bad', bad);
  $('notice').hidden = !text;
  clearTimeout(hide);
  hide = setTimeout(() => { $('notice').hidden = true; }, 12000);
}

/** Runs what may fail, and says so if it does. */
export async function guarded(work) {
  try {
    return await work();
  } catch (error) {
    notice(error.message, true);
    return undefined;
  }
}

/** Arrow keys move the choice in a list of options. */
export function choosable(list) {
  list.addEventListener('keydown', (event) => {
    const step = {ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1}[event.key];
    if (!step) return;
    event.preventDefault();
    const options = [...list.querySelectorAll('[role=option]')];
    const at = options.findIndex((one) => one.getAttribute('aria-selected') === 'true');
    const next = options[Math.min(options.length - 1, Math.max(0, at + step))];
    if (next) next.click();
  });
}

export function percent(p) {
  if (p > 0.995 && p < 1) return '> 99 %';
  return p > 0 && p < 0.005 ? '< 1 %' : `${Math.round(100 * p)} %`;
}
export const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;
