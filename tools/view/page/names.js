// Names of signals that are wrong: what is wrong with them, and what may have been meant.

import { getter, numberPaths } from './cdr.js';
import { partsOf } from './units.js';

const MOST_MEANT = 3;
const FAR = 0.45;  // of the longer one's letters: more changes make another word

// Letters to insert, take away, exchange or swap with their neighbour.
export function distance(a, b) {
  let before = [];
  let row = Array.from({ length: b.length + 1 }, (_, j) => j);
  for (let i = 1; i <= a.length; ++i) {
    const next = [i];
    for (let j = 1; j <= b.length; ++j) {
      const differs = a[i - 1] === b[j - 1] ? 0 : 1;
      next[j] = Math.min(next[j - 1] + 1, row[j] + 1, row[j - 1] + differs);
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1]) next[j] = Math.min(next[j], before[j - 2] + 1);
    }
    before = row;
    row = next;
  }
  return row[b.length];
}

// The candidates that are like the word, the nearest first.
export function nearest(word, candidates, most = MOST_MEANT) {
  const small = word.toLowerCase();
  return candidates.map((name) => {
    const other = name.toLowerCase();
    const far = other.startsWith(small) || small.startsWith(other) ? Math.min(distance(small, other), 1) : distance(small, other);
    return { name, far, share: far / Math.max(small.length, other.length) };
  }).filter(({ share }) => share <= FAR).sort((a, b) => a.far - b.far).slice(0, most).map(({ name }) => name);
}

function asked(names, otherwise) {
  if (names.length > 0) return `; did you mean ${names.join(' or ')}?`;
  return otherwise.length > 0 ? `; there are ${otherwise.slice(0, 12).join(', ')}${otherwise.length > 12 ? ' ...' : ''}` : '';
}

function isNumber(type, path) {
  try {
    getter(type, path);
    return true;
  } catch {
    return false;
  }
}

// Why a signal cannot be plotted; undefined: it can. topics: name -> {type}; there is one at least.
export function problemOf(name, topics) {
  for (const signal of partsOf(name)) {
    const dot = signal.indexOf('.');
    const topic = dot < 0 ? signal : signal.slice(0, dot);
    const all = [...topics.keys()];
    if (!topics.has(topic)) {
      // A field without its topic, or a topic that is none.
      const rest = dot < 0 ? '' : signal.slice(dot);
      const fields = dot >= 0 ? [] : all.flatMap((other) => numberPaths(topics.get(other).type)
        .filter((path) => path === signal || path.replace(/\[\d+\]$/, '') === signal).slice(0, 1).map((path) => `${other}.${path}`));
      // With the field where the topic has it.
      const whole = (other) => (rest !== '' && isNumber(topics.get(other).type, rest.slice(1)) ? other + rest : other);
      const meant = fields.length > 0 ? fields.slice(0, MOST_MEANT) : nearest(topic, all).map(whole);
      return `no topic '${topic}'${asked(meant, all)}`;
    }
    if (dot < 0) return `'${signal}' is a topic, expected a number of it${asked([], numberPaths(topics.get(topic).type).map((path) => `${topic}.${path}`))}`;
    const path = signal.slice(dot + 1);
    const { type } = topics.get(topic);
    if (!isNumber(type, path)) {
      const paths = numberPaths(type);
      const base = path.replace(/\[.*$/, '');
      const elements = paths.filter((other) => other.startsWith(`${base}[`));
      const meant = elements.length > 0 && path !== base ? [] : nearest(path, paths);
      const ends = elements.length > 0 && path !== base ? `; ${topic}.${base} has [0] to [${elements.length - 1}]` : '';
      return `${topic} has no number '${path}'${ends || asked(meant.map((other) => `${topic}.${other}`), paths)}`;
    }
  }
  return undefined;
}
