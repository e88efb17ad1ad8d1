// A recording: fills the table for the window that the slider shows, a session of it at a time.
//
// The table holds the span around the moment; the rest is fetched when the moment leaves it.

const AHEAD_S = 5;
const EARLY_S = 1;  // while it plays, the next span is asked for so long before it is needed
const RECORD_BYTES = 14;  // index of the topic, stamp, size

export class Recording {
  // info: of /api/recording. Shows the first session.
  constructor(info, topics) {
    this.topics = topics;
    this.file = info.file;
    this.sessions = info.sessions;
    this.names = info.topics.map((topic) => topic.topic);
    this.has_log = info.topics.some((topic) => topic.topic === 'log' && topic.messages > 0);
    this.has_participants = info.topics.some((topic) => topic.topic === 'component_status' && topic.messages > 0);
    this.wanted = [];  // topics that are fetched
    this.busy = false;
    this.asking = {};  // by what is asked for at a moment
    this.bytes = 0;
    this.select(1);
  }

  // Shows a session, numbered from 1 on, from its beginning. Throws Error: there is no such session.
  select(number) {
    const session = this.sessions[number - 1];
    if (!session) throw new Error(`session ${number}: expected 1 to ${this.sessions.length}`);
    this.session = number;
    this.start_ns = BigInt(session.start_ns);
    this.length_s = session.length_s;
    this.at_s = 0;
    this.playing = false;
    this.speed ??= 1;  // of playing
    this.loaded = undefined;  // {span: [from_s, to_s], names, buffer}
    this.asked = {};
    this.moments = new Map();  // topic -> [{time_s, view}]
    this.topics.restart(undefined);
    for (const topic of this.topics.topics.values()) topic.received = 0;
  }

  // Topics to fetch from now on. Those that are there already go into the table again, since its signals have changed.
  want(names) {
    this.wanted = [...new Set(names)].filter((name) => this.names.includes(name) && this.topics.topics.has(name));
    if (!this.loaded) return;
    if (this.wanted.every((name) => this.loaded.names.includes(name))) this.fill(this.loaded.buffer);
    else this.loaded = undefined;
  }

  stamp(time_s) { return (this.start_ns + BigInt(Math.round(time_s * 1e9))).toString(); }

  // Fetches what the window needs, and what is shown until shown_s; true: the table has changed.
  async load(window_s, shown_s = 0) {
    const from_s = Math.max(this.at_s - window_s, 0);
    const ahead = Math.max(this.speed, 1);
    const to_s = Math.min(Math.max(this.at_s + (this.playing ? EARLY_S * ahead : 0), shown_s), this.length_s);
    if (this.busy || this.wanted.length === 0) return false;
    if (this.loaded && from_s >= this.loaded.span[0] && to_s <= this.loaded.span[1]) return false;
    this.busy = true;
    try {
      const span = [Math.max(from_s - AHEAD_S, 0), Math.min(to_s + AHEAD_S * ahead, this.length_s)];
      const { session, wanted } = this;
      const buffer = await this.fetch(wanted, ...span);
      if (session !== this.session || wanted !== this.wanted) return true;  // asked for something else meanwhile: once more
      this.loaded = { span, names: wanted, buffer };
      this.fill(buffer);
      return true;
    } finally {
      this.busy = false;
    }
  }

  // The messages of topics of the shown session between two times, as /api/recording/messages has them.
  async fetch(names, from_s, to_s) {
    const reply = await fetch(`/api/recording/messages?session=${this.session}&topics=${names.join(',')}`
      + `&from_ns=${this.stamp(from_s)}&to_ns=${this.stamp(to_s)}`);
    if (!reply.ok) throw new Error((await reply.text()).trim());
    const buffer = await reply.arrayBuffer();
    this.bytes += buffer.byteLength;
    return buffer;
  }

  // [topic, stamp_ns, DataView] of each message of an answer.
  *messages(buffer) {
    const head = new DataView(buffer);
    for (let at = 0; at < buffer.byteLength;) {
      const name = this.names[head.getUint16(at, true)];
      const stamp_ns = head.getBigInt64(at + 2, true);
      const size = head.getUint32(at + 10, true);
      yield [name, stamp_ns, new DataView(buffer, at + RECORD_BYTES, size)];
      at += RECORD_BYTES + size;
    }
  }

  fill(buffer) {
    const { topics } = this;
    topics.table.reset();
    for (const topic of topics.topics.values()) Object.assign(topic, { tick: undefined, lost: 0, gaps: [] });
    this.moments.clear();
    let first = true;
    for (const [name, stamp_ns, view] of this.messages(buffer)) {
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
    this.show();
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
      this.topics.topics.get(name).newest = low > 0 ? list[low - 1].view : undefined;
    }
  }

  // Rows of the participants at the moment; undefined: they are those of the last call, or on their way.
  participants() { return this.has_participants ? this.rowsAt('participants') : undefined; }

  // Lines of the log until the moment, likewise.
  log() { return this.has_log ? this.rowsAt('log') : undefined; }

  async rowsAt(what) {
    const moment = `session=${this.session}&at_ns=${this.stamp(this.at_s)}`;
    if (this.asking[what] || moment === this.asked[what]) return undefined;
    this.asking[what] = true;
    this.asked[what] = moment;
    try {
      const reply = await fetch(`/api/recording/${what}?${moment}`);
      if (!reply.ok) throw new Error((await reply.text()).trim());
      return await reply.json();
    } finally {
      this.asking[what] = false;
    }
  }
}
