// Signals by tick: a row a tick of the state provider, a column a signal. Values that did not come stay NaN.
//
// Rows are kept in a ring; the memory is taken once. Times are seconds since the first row.

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

// Rows from from_s to to_s for a plot that is `width` points wide: [times, values of each column], null where there is
// none. With more than two rows a point, each group of rows becomes its least and its greatest value, in their order, so
// that every sample shows.
export function plotData(table, names, from_s, to_s, width) {
  const begin = table.tickAt(from_s);
  let end = table.tickAt(to_s);
  if (end < table.end) ++end;
  const rows = table.rows;
  const columns = names.map((name) => table.columns.get(name));
  const group = Math.ceil((end - begin) / Math.max(width, 1));
  const times = [];
  const values = names.map(() => []);
  if (group <= 2) {
    for (let tick = begin; tick < end; ++tick) {
      times.push(table.time[tick % rows]);
      columns.forEach((column, i) => {
        const value = column ? column[tick % rows] : NaN;
        values[i].push(value === value ? value : null);
      });
    }
    return [times, ...values];
  }
  // Groups begin at multiples of their size, so that they do not change while the window moves.
  for (let tick = begin - (begin % group); tick < end; tick += group) {
    const from = Math.max(tick, table.first);
    const to = Math.min(tick + group, table.end);
    if (from >= to) continue;
    times.push(table.time[from % rows], table.time[(to - 1) % rows]);
    for (let i = 0; i < columns.length; ++i) {
      const column = columns[i];
      let least = Infinity, greatest = -Infinity, least_at = 0, greatest_at = 0;
      for (let k = from; column && k < to; ++k) {
        const value = column[k % rows];
        if (value < least) { least = value; least_at = k; }
        if (value > greatest) { greatest = value; greatest_at = k; }
      }
      if (least === Infinity) values[i].push(null, null);
      else if (least_at <= greatest_at) values[i].push(least, greatest);
      else values[i].push(greatest, least);
    }
  }
  return [times, ...values];
}
