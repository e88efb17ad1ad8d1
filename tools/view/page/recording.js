// A recording: fills the table for the window that the slider shows, and plays.
//
// The table holds the span [from, to] around the moment; the rest is fetched when the moment leaves it.

const AHEAD_S = 5;
const RECORD_BYTES = 14;  // index of the topic, stamp, size

export class Recording {
  constructor(info, topics) {
    this.topics = topics;
    this.names = info.topics.map((topic) => topic.topic);
    this.start_ns = BigInt(info.start_ns);
    this.length_s = Number(BigInt(info.end_ns) - this.start_ns) * 1e-9;
    this.at_s = 0;
    this.playing = false;
    this.loaded = undefined;  // [from_s, to_s]
    this.moments = new Map();  // topic -> [{time_s, view}]
    this.busy = false;
    this.bytes = 0;
  }

  // Fetches what the window needs; true: the table has changed.
  async load(window_s) {
    const from_s = Math.max(this.at_s - window_s, 0);
    const to_s = this.at_s;
    if (this.busy || (this.loaded && from_s >= this.loaded[0] && to_s <= this.loaded[1])) return false;
    this.busy = true;
    try {
      const span = [Math.max(from_s - AHEAD_S, 0), Math.min(to_s + AHEAD_S, this.length_s)];
      const ns = (time_s) => (this.start_ns + BigInt(Math.round(time_s * 1e9))).toString();
      const wanted = this.names.filter((name) => this.topics.topics.has(name) && name !== 'component_status'
        && name !== 'reservoir_state' && name !== 'readout');
      const reply = await fetch(`/api/recording/messages?topics=${wanted.join(',')}&from_ns=${ns(span[0])}&to_ns=${ns(span[1])}`);
      if (!reply.ok) throw new Error(await reply.text());
      this.fill(await reply.arrayBuffer());
      this.loaded = span;
      return true;
    } finally {
      this.busy = false;
    }
  }

  fill(buffer) {
    const { topics } = this;
    topics.table.reset();
    for (const topic of topics.topics.values()) Object.assign(topic, { tick: undefined, lost: 0 });
    this.moments.clear();
    const head = new DataView(buffer);
    let first = true;
    for (let at = 0; at < buffer.byteLength;) {
      const name = this.names[head.getUint16(at, true)];
      const stamp_ns = head.getBigInt64(at + 2, true);
      const size = head.getUint32(at + 10, true);
      const view = new DataView(buffer, at + RECORD_BYTES, size);
      at += RECORD_BYTES + size;
      if (first) {  // one session; times count from its beginning
        topics.session = topics.topics.get(name).head[0](view);
        topics.table.start_ns = Number(this.start_ns);
        topics.table.first = topics.topics.get(name).head[1](view);
        topics.table.end = topics.table.first;
        first = false;
      }
      topics.take(name, view);
      if (!this.moments.has(name)) this.moments.set(name, []);
      this.moments.get(name).push({ time_s: Number(stamp_ns - this.start_ns) * 1e-9, view });
    }
    this.bytes += buffer.byteLength;
  }

  // The newest messages of the moment become those of the topics.
  show() {
    for (const [name, list] of this.moments) {
      let low = 0;
      let high = list.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (list[middle].time_s <= this.at_s + 1e-6) low = middle + 1;
        else high = middle;
      }
      this.topics.topics.get(name).newest = list[Math.max(low - 1, 0)]?.view;
    }
  }
}
