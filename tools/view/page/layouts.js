// What is shown, as text: in the address of the page, so that a link opens the same view, and under a name in this browser.

import { isSpeed } from './timeline.js';

const STORED = 'sinew-layouts';
const WINDOWS_S = [5, 10, 30, 60, 120];
export const DEFAULT = { signals: [], joint: 0, window_s: 10, hide: [] };
const PLACE = { session: 1, at_s: undefined, speed: 1 };

const listOf = (text) => text.split(',').map((word) => word.trim()).filter(Boolean);

// Of location.search: what it asks for, and what it asks for in vain.
export function readAddress(search) {
  const query = new URLSearchParams(search);
  const shown = {};
  const problems = [];
  const number = (name, key, allowed, expected) => {
    if (!query.has(name)) return;
    const value = query.get(name).trim() === '' ? NaN : Number(query.get(name));
    if (allowed(value)) shown[key] = value;
    else problems.push(`${name}=${query.get(name)}: expected ${expected}`);
  };
  if (query.has('signals')) shown.signals = listOf(query.get('signals'));
  if (query.has('hide')) shown.hide = listOf(query.get('hide'));
  number('joint', 'joint', (value) => Number.isInteger(value) && value >= 0, 'the number of a joint, from 0 on');
  number('window', 'window_s', (value) => WINDOWS_S.includes(value), `one of ${WINDOWS_S.join(', ')} s`);
  number('session', 'session', (value) => Number.isInteger(value) && value >= 1, 'the number of a session, from 1 on');
  number('at', 'at_s', (value) => Number.isFinite(value), 'seconds from the beginning of the session');
  number('speed', 'speed', isSpeed, '0.1 to 10');
  return { shown, problems };
}

// The search part of an address for what is shown; what is as by default is left out.
export function writeAddress(shown) {
  const query = new URLSearchParams();
  const put = (name, value, plain) => { if (value !== undefined && String(value) !== String(plain)) query.set(name, value); };
  put('session', shown.session, PLACE.session);
  put('at', shown.at_s === undefined ? undefined : Number(shown.at_s.toFixed(3)), PLACE.at_s);
  put('speed', shown.speed, PLACE.speed);
  put('joint', shown.joint, DEFAULT.joint);
  put('window', shown.window_s, DEFAULT.window_s);
  put('hide', shown.hide.join(','), '');
  // An empty list is one too: those of the configuration are gone then.
  if (shown.signals.length > 0 || shown.configured) query.set('signals', shown.signals.join(','));
  const text = query.toString().replaceAll('%2C', ',').replaceAll('%5B', '[').replaceAll('%5D', ']');
  return text === '' ? '' : `?${text}`;
}

// What it has that is no layout's, by hand or by another program, is as by default.
const texts = (list) => (Array.isArray(list) ? list.filter((one) => typeof one === 'string') : []);
const layoutOf = ({ signals, joint, window_s, hide }) => ({
  signals: texts(signals), hide: texts(hide),
  joint: Number.isInteger(joint) && joint >= 0 ? joint : DEFAULT.joint,
  window_s: WINDOWS_S.includes(window_s) ? window_s : DEFAULT.window_s,
});

// Layouts by name. storage: localStorage, or what is like it; undefined where the browser has none to give.
export class Layouts {
  constructor(storage) {
    this.storage = storage;
  }

  all() {
    try {
      const kept = JSON.parse(this.storage?.getItem(STORED) ?? '{}');
      return kept && typeof kept === 'object' && !Array.isArray(kept) ? kept : {};
    } catch {
      return {};  // another program's
    }
  }

  names() { return Object.keys(this.all()).sort((a, b) => a.localeCompare(b)); }

  // A layout with all that one has; undefined: none of that name.
  get(name) {
    const kept = Object.hasOwn(this.all(), name) ? this.all()[name] : undefined;
    return kept && layoutOf(kept);
  }

  // Throws Error: the browser keeps nothing.
  put(name, layout) { this.write({ ...this.all(), [name]: layoutOf(layout) }); }

  remove(name) {
    const { [name]: gone, ...rest } = this.all();
    this.write(rest);
  }

  write(all) {
    if (!this.storage) throw new Error('this browser keeps no layouts');
    this.storage.setItem(STORED, JSON.stringify(all));
  }
}
