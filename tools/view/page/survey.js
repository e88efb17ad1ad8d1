// A session of a recording from end to end: what happened and when, and how the joints moved, for the overview.
//
// A session of up to MOST_TICKS is read whole, a piece after the other. Of a longer one single ticks are read at even
// distances, and where the robot's state differs between two of them, the moment of the change is sought by halving: a state
// that lasts less than such a distance may be missed.

import { decode, getter } from './cdr.js';
import { Events } from './events.js';

const PIECE_TICKS = 6000;
export const MOST_TICKS = 150000;  // 10 minutes at 240 Hz; about 100 MB
export const SAMPLES = 400;        // of a longer session
const TICKS_OF_SAMPLE = 3;
const HALVINGS = 20;
export const COLUMNS = 800;

export class Survey {
  // on_news(): there is more to draw.
  constructor(recording, topics, on_news) {
    this.recording = recording;
    this.topics = topics;
    this.on_news = on_news;
    this.events = new Events();
    this.begin();
  }

  begin() {
    this.events.restart();
    if (this.recording.session === 1) this.events.note(Number(this.recording.start_ns), 'recording started', 'note');
    this.joints = [];  // of each joint: {least, greatest}, Float32Array of COLUMNS, NaN where nothing was read
    this.sampled = false;
    this.done_s = 0;
  }

  // The recording's session. Ends when another one is chosen.
  async run() {
    this.begin();
    const { recording } = this;
    const { session } = recording;
    const { ticks } = recording.sessions[session - 1];
    const length_s = Math.max(recording.length_s, 1e-9);
    const here = () => session === recording.session;
    if (this.topics.topics.has('command_source') && recording.names.includes('command_source')) {
      this.take(await recording.fetch(['command_source'], 0, recording.length_s), here);
    }
    this.sampled = ticks > MOST_TICKS;
    const step_s = this.sampled ? length_s / SAMPLES : (length_s * PIECE_TICKS) / Math.max(ticks, PIECE_TICKS);
    const sample_s = (TICKS_OF_SAMPLE * length_s) / Math.max(ticks, 1);
    let before;
    for (let from_s = 0; here() && from_s < length_s; from_s += step_s) {
      const to_s = this.sampled ? from_s + sample_s : from_s + step_s;
      const buffer = await recording.fetch(['joint_state'], from_s, Math.min(to_s, recording.length_s));
      if (!here()) return;
      if (this.sampled && before !== undefined) await this.seek(before, from_s, buffer, here);
      this.take(buffer, here);
      before = from_s;
      this.done_s = Math.min(from_s + step_s, length_s);
      this.on_news();
    }
  }

  stateIn(buffer) {
    for (const [name, , view] of this.recording.messages(buffer)) {
      if (name === 'joint_state') return getter(this.topics.topics.get(name).type, 'robot_state')(view);
    }
    return undefined;
  }

  // Between two samples whose states differ: up to the change.
  async seek(low_s, high_s, buffer, here) {
    const after = this.stateIn(buffer);
    if (after === undefined || after === this.events.state) return;
    const tick_s = this.recording.length_s / this.recording.sessions[this.recording.session - 1].ticks;
    for (let i = 0; i < HALVINGS && high_s - low_s > tick_s && here(); ++i) {
      const middle_s = (low_s + high_s) / 2;
      const found = await this.recording.fetch(['joint_state'], middle_s, middle_s + 2 * tick_s);
      const state = this.stateIn(found);
      if (state === undefined || state === this.events.state) low_s = middle_s;
      else high_s = middle_s;
    }
    this.take(await this.recording.fetch(['joint_state'], high_s, high_s + 2 * tick_s), here);
  }

  take(buffer, here) {
    if (!here()) return;
    for (const [name, stamp_ns, view] of this.recording.messages(buffer)) {
      const { type } = this.topics.topics.get(name);
      this.events.take(name, type, view);
      if (name === 'joint_state') this.draw(type, view, Number(stamp_ns - this.recording.start_ns) * 1e-9);
    }
  }

  draw(type, view, time_s) {
    if (this.joints.length === 0) {
      const { joint_count, position_rad } = decode(type, view);
      const count = Math.min(joint_count, position_rad.length);
      this.joints = Array.from({ length: count }, (_, j) => ({ read: getter(type, `position_rad[${j}]`),
        least: new Float32Array(COLUMNS).fill(NaN), greatest: new Float32Array(COLUMNS).fill(NaN) }));
    }
    const column = Math.min(Math.max(Math.floor((time_s / Math.max(this.recording.length_s, 1e-9)) * COLUMNS), 0), COLUMNS - 1);
    for (const { read, least, greatest } of this.joints) {
      const value = read(view);
      if (!(least[column] <= value)) least[column] = value;
      if (!(greatest[column] >= value)) greatest[column] = value;
    }
  }
}
