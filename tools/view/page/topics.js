// What comes of the topics: signals into the table, the newest message of the others, counts of what is missing.

import { decode, getter, numberPaths, parseIdl } from './cdr.js';
import { Table } from './series.js';

const PROVIDER = 'joint_state';  // its session is the one that is shown

export class Topics {
  constructor() {
    this.table = new Table();
    this.topics = new Map();  // name -> {type, head, signals, newest, decoded, decoded_of, received, lost, tick}
    this.session = undefined;
    this.sessions = 0;
    this.samples = 0;  // values that went into the table
    this.problems = [];
  }

  // A topic that can come, with its schema.
  add(name, schema_name, schema) {
    try {
      const type = parseIdl(schema).get(schema_name);
      if (!type) throw new Error(`no struct ${schema_name}`);
      const head = ['session_id', 'tick', 'stamp_ns'].map((field) => getter(type, `header.${field}`));
      this.topics.set(name, { type, head, signals: [], newest: undefined, received: 0, lost: 0, tick: undefined });
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
    topic.signals.push({ signal, read: getter(topic.type, signal.slice(dot + 1)), column: this.table.column(signal) });
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
    for (const topic of this.topics.values()) Object.assign(topic, { newest: undefined, decoded_of: undefined, tick: undefined });
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
    if (topic.tick !== undefined && tick > topic.tick + 1 && topic.signals.length > 0) topic.lost += tick - topic.tick - 1;
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

  // Of the topics that are plotted: ticks that did not come.
  get lost() {
    let sum = 0;
    for (const topic of this.topics.values()) sum += topic.lost;
    return sum;
  }
}
