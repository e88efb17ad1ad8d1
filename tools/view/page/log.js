// The log of all participants: its newest lines, by level and participant, the newest at the bottom.

import { fill } from './panels.js';

const MOST = 500;
const LEVELS = ['info', 'warning', 'error', 'critical'];
const COLOURS = { info: 'quiet', warning: 'warn', error: 'bad', critical: 'bad' };
const BOTTOM_PX = 4;  // as far from the end counts as at it

const two = (number) => String(number).padStart(2, '0');

function clock(time_ms) {
  const time = new Date(time_ms);
  return `${two(time.getHours())}:${two(time.getMinutes())}:${two(time.getSeconds())}.${String(time.getMilliseconds()).padStart(3, '0')}`;
}

const timeOf = (line) => (line.time_s === undefined ? clock(line.time_ms) : line.time_s.toFixed(3));

export class Log {
  constructor() {
    this.lines = [];  // {time_ms or time_s, level, name, text}
    this.last = 0;  // number of the newest line of a server
    this.level = LEVELS[0];
    this.name = '';  // all
    this.changed = true;
  }

  choose(level, name) { Object.assign(this, { level, name, changed: true }); }

  // Reply of /api/log: what came since; true: something did. A server that was started again begins anew.
  add({ last, lines }) {
    if (last < this.last) this.lines = [];
    else this.lines.push(...lines);
    this.last = last < this.last ? 0 : last;
    this.lines.splice(0, Math.max(this.lines.length - MOST, 0));
    this.changed ||= lines.length > 0 || this.last === 0;
    return this.changed;
  }

  // All lines of a moment.
  set(lines) { Object.assign(this, { lines, changed: true }); }

  names() { return [...new Set(this.lines.map((line) => line.name))].sort(); }

  shown() {
    const least = LEVELS.indexOf(this.level);
    return this.lines.filter((line) => LEVELS.indexOf(line.level) >= least && (!this.name || line.name === this.name));
  }

  // What has changed into the table and the choice of participants. A reader of older lines is not moved away.
  show(table, select) {
    if (!this.changed) return;
    this.changed = false;
    this.offer(select);
    const scroll = table.parentElement;
    const at_end = scroll.scrollTop + scroll.clientHeight >= scroll.scrollHeight - BOTTOM_PX;
    fill(table, ['time', 'level', 'participant', 'text'], this.shown().map((line) => [
      [timeOf(line), 'number'], [line.level, COLOURS[line.level] ?? 'bad'], line.name, [line.text, 'line'],
    ]), 'no line');
    if (at_end) scroll.scrollTop = scroll.scrollHeight;
  }

  // The participants to choose from; one that is chosen stays.
  offer(select) {
    const names = [...new Set([...this.names(), ...(this.name ? [this.name] : [])])];
    if (select.length === names.length + 1 && names.every((name, i) => select.options[i + 1].value === name)) return;
    select.replaceChildren(...['', ...names].map((name) => Object.assign(document.createElement('option'), { value: name, textContent: name || 'all' })));
    select.value = this.name;
  }
}
