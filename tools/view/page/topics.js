// What comes of the topics: signals into the table, the newest message of the others, counts of what is missing.

import { decode, getter, numberPaths, parseIdl } from './cdr.js';
import { Past } from './past.js';
import { Table } from './series.js';
import { partsOf } from './units.js';

const PROVIDER = 'joint_state';  // its session is the one that is shown
const MOST_GAPS = 1000;  // the oldest go
const STALE = 'stale';   // a field: the message was made without an input

// Ticks, both inclusive, that did not come, or whose message was stale.
function addGap({ gaps }, from, to, stale) {
  const last = gaps.at(-1);
  if (last && last.stale === stale && last.to + 1 === from) last.to = to;
  else gaps.push({ from, to, stale });
  if (gaps.length > MOST_GAPS) gaps.shift();
}

export class Topics {
  // past: where what came is kept, for signals that are added later; a recording has its own.
  constructor(past = undefined) {
    this.past = past;
    this.table = new Table();
    this.topics = new Map();  // name -> {type, schema, head, stale, gaps, signals, newest, decoded, decoded_of, received, lost, tick}
    this.session = undefined;
    this.sessions = 0;
    this.samples = 0;  // values that went into the table
    this.problems = [];
  }

  // A topic that can come, with its schema. One that is there already, as after a broken connection, goes on.
  add(name, schema_name, schema) {
    const there = this.topics.get(name);
    if (there?.schema === schema) return;
    for (const { signal } of there?.signals ?? []) this.table.drop(signal);
    try {
      const type = parseIdl(schema).get(schema_name);
      if (!type) throw new Error(`no struct ${schema_name}`);
      const head = ['session_id', 'tick', 'stamp_ns'].map((field) => getter(type, `header.${field}`));
      const stale = type.members.some((member) => member.name === STALE) ? getter(type, STALE) : undefined;
      this.topics.set(name, { type, schema, head, stale, gaps: [], signals: [], newest: undefined, received: 0, lost: 0, tick: undefined });
    } catch (error) {
      this.problems.push(`${name}: ${error.message}`);
    }
  }

  // "joint_state.position_rad[0]" becomes a column of the table. Throws Error: there is no such signal.
  plot(signal) {
    if (this.table.columns.has(signal)) return;
    const dot = signal.indexOf('.');
    const topic = this.topics.get(signal.slice(0, dot));
    if (!topic) throw new Error(`no topic '${signal.slice(0, dot)}'`);
    const read = getter(topic.type, signal.slice(dot + 1));
    const column = this.table.column(signal);
    topic.signals.push({ signal, read, column });
    if (this.past) this.fillFromPast(signal.slice(0, dot), topic, read, column);
  }

  // A column that is new gets what its topic brought before.
  fillFromPast(name, topic, read, column) {
    const [session_of, tick_of, stamp_of] = topic.head;
    for (const view of this.past.of(name)) {
      const tick = tick_of(view);
      if (session_of(view) !== this.session || !this.table.open(tick, stamp_of(view))) continue;
      column[tick % this.table.rows] = read(view);
    }
  }

  unplot(signal) {
    for (const topic of this.topics.values()) topic.signals = topic.signals.filter((other) => other.signal !== signal);
    this.table.drop(signal);
  }

  signals() {
    const names = [];
    for (const [name, topic] of this.topics) {
      if (name === 'component_status' || name === 'log') continue;  // no row of its own for each tick
      for (const path of numberPaths(topic.type)) if (!path.startsWith('header.')) names.push(`${name}.${path}`);
    }
    return names;
  }

  restart(session) {
    this.session = session;
    ++this.sessions;
    this.table.reset();
    this.past?.restart();
    for (const topic of this.topics.values()) Object.assign(topic, { newest: undefined, decoded_of: undefined, tick: undefined, gaps: [] });
  }

  // A message as it came: DataView with the 4-byte header. True: a new session began with it.
  take(name, view) {
    const topic = this.topics.get(name);
    if (!topic) return false;
    const [session_of, tick_of, stamp_of] = topic.head;
    const session = session_of(view);
    const begins = name === PROVIDER && session !== this.session;
    if (begins) this.restart(session);
    if (session !== this.session) return false;
    const tick = tick_of(view);
    ++topic.received;
    this.past?.keep(name, view);
    if (topic.tick !== undefined && tick > topic.tick + 1) {
      if (topic.signals.length > 0) topic.lost += tick - topic.tick - 1;
      addGap(topic, topic.tick + 1, tick - 1, false);
    }
    if (topic.stale?.(view)) addGap(topic, tick, tick, true);
    if (topic.tick === undefined || tick > topic.tick) topic.tick = tick;
    topic.newest = view;
    if (topic.signals.length > 0 && this.table.open(tick, stamp_of(view))) {
      const index = tick % this.table.rows;
      for (const { read, column } of topic.signals) column[index] = read(view);
      this.samples += topic.signals.length;
    }
    return begins;
  }

  // The newest message as an object, the same one until another message comes; undefined: none came.
  newest(name) {
    const topic = this.topics.get(name);
    if (!topic?.newest) return undefined;
    if (topic.decoded_of !== topic.newest) {
      topic.decoded = decode(topic.type, topic.newest);
      topic.decoded_of = topic.newest;
    }
    return topic.decoded;
  }

  // Of plotted names: spans of ticks that did not come or are stale, at most the table's. A tick that came late is there.
  gapsOf(names, table = this.table) {
    const spans = [];
    for (const part of new Set(names.flatMap(partsOf))) {
      const column = table.columns.get(part);
      for (const { from, to, stale } of this.topics.get(part.slice(0, part.indexOf('.')))?.gaps ?? []) {
        const first = Math.max(from, table.first);
        const last = Math.min(to, table.end - 1);
        if (first > last || !(stale || (column && Number.isNaN(column[first % table.rows])))) continue;
        spans.push([table.time[first % table.rows], table.time[last % table.rows]]);
      }
    }
    return spans;
  }

  // Of the topics that are plotted: ticks that did not come.
  get lost() {
    let sum = 0;
    for (const topic of this.topics.values()) sum += topic.lost;
    return sum;
  }
}
