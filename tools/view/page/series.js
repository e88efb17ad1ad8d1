// Signals by tick: a row a tick of the state provider, a column a signal. Values that did not come stay NaN.
//
// Rows are kept in a ring; the memory is taken once. Times are seconds since the first row.

import { partsOf } from './units.js';

export const ROWS = 32768;  // 136 s at 240 Hz

export class Table {
  constructor(rows = ROWS) {
    this.rows = rows;
    this.columns = new Map();  // name -> Float64Array
    this.time = new Float64Array(rows);
    this.reset();
  }

  reset() {
    this.first = 0;    // ticks of the rows that are there: first <= tick < end
    this.end = 0;
    this.start_ns = undefined;
    for (const column of this.columns.values()) column.fill(NaN);
  }

  column(name) {
    let column = this.columns.get(name);
    if (!column) {
      column = new Float64Array(this.rows).fill(NaN);
      this.columns.set(name, column);
    }
    return column;
  }

  drop(name) { this.columns.delete(name); }

  // Columns of a plotted name: [minuend, subtrahend or undefined]; undefined: not all are there.
  sources(name) {
    const parts = partsOf(name).map((part) => this.columns.get(part));
    return parts.every(Boolean) ? parts : undefined;
  }

  // Makes the row of a tick; false: it is older than what is kept.
  open(tick, stamp_ns) {
    if (this.start_ns === undefined) {
      this.start_ns = stamp_ns;
      this.first = tick;
      this.end = tick;
    }
    if (tick < this.first) return false;
    if (tick >= this.end) {
      const from = Math.max(this.end, tick - this.rows + 1);
      for (let missing = from; missing <= tick; ++missing) {
        const index = missing % this.rows;
        // A tick that did not come lies between its neighbours.
        this.time[index] = (stamp_ns - this.start_ns) * 1e-9;
        for (const column of this.columns.values()) column[index] = NaN;
      }
      this.end = tick + 1;
      this.first = Math.max(this.first, this.end - this.rows);
    }
    this.time[tick % this.rows] = (stamp_ns - this.start_ns) * 1e-9;
    return true;
  }

  get newest() { return this.end > this.first ? this.time[(this.end - 1) % this.rows] : 0; }
  get oldest() { return this.end > this.first ? this.time[this.first % this.rows] : 0; }

  // The first tick whose time is not before time_s.
  tickAt(time_s) {
    let low = this.first;
    let high = this.end;
    while (low < high) {
      const middle = Math.floor((low + high) / 2);
      if (this.time[middle % this.rows] < time_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  // A copy that does not move on, for a display that is paused.
  snapshot() {
    const copy = new Table(this.rows);
    copy.time.set(this.time);
    for (const [name, column] of this.columns) copy.columns.set(name, column.slice());
    Object.assign(copy, { first: this.first, end: this.end, start_ns: this.start_ns });
    return copy;
  }
}

// Rows of a table for a plot. With more than two rows a point, each group of rows becomes its least and its greatest
// value, in their order, so that every sample shows. The arrays are kept and filled again.
export class PlotData {
  constructor() {
    this.columns = [];  // Float64Array: times, then a column a signal
    this.ranges = [];   // [least, greatest] of the values that were read, an axis each; undefined: there were none
  }

  // From from_s to to_s, for `width` points: [times, values of each name], NaN where there is none. They are views that the
  // next call fills again. axis(i): the range to which name i belongs, -1: none; 0 by default.
  read(table, names, from_s, to_s, width, axis = () => 0) {
    const begin = table.tickAt(from_s);
    let end = table.tickAt(to_s);
    if (end < table.end) ++end;
    const group = Math.ceil((end - begin) / Math.max(width, 1));
    // Groups begin at multiples of their size, so that they do not change while the window moves.
    const first = group <= 2 ? begin : begin - (begin % group);
    const most = group <= 2 ? end - begin : 2 * Math.ceil((end - first) / group);
    while (this.columns.length <= names.length) this.columns.push(new Float64Array(0));
    for (let i = 0; i <= names.length; ++i) {
      if (this.columns[i].length < most) this.columns[i] = new Float64Array(Math.ceil(1.25 * most));
    }
    this.ranges = [];
    const count = group <= 2 ? this.every(table, names, begin, end, axis) : this.grouped(table, names, first, end, group, axis);
    return this.columns.slice(0, names.length + 1).map((column) => column.subarray(0, count));
  }

  every(table, names, begin, end, axis) {
    const { rows } = table;
    for (let i = -1; i < names.length; ++i) {
      const [from, minus] = i < 0 ? [table.time] : table.sources(names[i]) ?? [];
      const to = this.columns[i + 1];
      let at = begin % rows;
      let least = Infinity, greatest = -Infinity;
      for (let k = 0; k < end - begin; ++k) {
        const value = !from ? NaN : minus ? from[at] - minus[at] : from[at];
        to[k] = value;
        if (value < least) least = value;
        if (value > greatest) greatest = value;
        if (++at === rows) at = 0;
      }
      if (i >= 0) this.widen(axis(i), least, greatest);
    }
    return end - begin;
  }

  grouped(table, names, first, end, group, axis) {
    const { rows } = table;
    let count = 0;
    for (let i = -1; i < names.length; ++i) {
      const [from, minus] = i < 0 ? [table.time] : table.sources(names[i]) ?? [];
      const to = this.columns[i + 1];
      let low = Infinity, high = -Infinity;
      count = 0;
      for (let tick = first; tick < end; tick += group) {
        const start = Math.max(tick, table.first);
        const stop = Math.min(tick + group, table.end);
        if (start >= stop) continue;
        if (i < 0) {
          to[count++] = from[start % rows];
          to[count++] = from[(stop - 1) % rows];
          continue;
        }
        let least = Infinity, greatest = -Infinity, least_k = 0, greatest_k = 0;
        let at = start % rows;
        for (let k = start; from && k < stop; ++k) {
          const value = minus ? from[at] - minus[at] : from[at];
          if (value < least) { least = value; least_k = k; }
          if (value > greatest) { greatest = value; greatest_k = k; }
          if (++at === rows) at = 0;
        }
        if (least === Infinity) least = greatest = NaN;
        else if (least < low) low = least;
        if (greatest > high) high = greatest;
        to[count++] = least_k <= greatest_k ? least : greatest;
        to[count++] = least_k <= greatest_k ? greatest : least;
      }
      if (i >= 0) this.widen(axis(i), low, high);
    }
    return count;
  }

  widen(axis, least, greatest) {
    if (axis < 0 || least > greatest) return;
    const [low, high] = this.ranges[axis] ?? [Infinity, -Infinity];
    this.ranges[axis] = [Math.min(low, least), Math.max(high, greatest)];
  }
}
