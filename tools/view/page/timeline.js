// The line above a recording: which of its sessions, which moment, Play and how fast, and the keys that do the same.

const CLOCK_NS = 1e18;  // stamps from September 2001 on are times of day; those of a simulation begin at 0

const LONGEST_STEP_S = 1;  // what passes while the tab is hidden is not played
const JUMP_S = 1;          // of the keys left and right; with Shift a tenth
export const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10];
export const isSpeed = (speed) => Number.isFinite(speed) && speed >= SPEEDS[0] && speed <= SPEEDS.at(-1);

// What the list of sessions says of one of them.
export function nameOfSession(session) {
  const name = `${session.session}: ${session.length_s.toFixed(1)} s`;
  const start_ns = Number(session.start_ns);
  return start_ns < CLOCK_NS ? name : `${name}, ${new Date(start_ns * 1e-6).toLocaleString()}`;
}

export class Timeline {
  // on_move(): the moment has changed; on_session(): another session is shown.
  constructor(recording, element, { on_move, on_session }) {
    this.recording = recording;
    this.on_move = on_move;
    this.on_session = on_session;
    this.stepped_ms = undefined;
    const part = (name) => element.querySelector(name);
    this.moment = part('#moment');
    this.button = part('#play');
    this.choice = part('#session');
    this.speeds = part('#speed');
    part('#session_label').hidden = recording.sessions.length < 2;
    this.choice.replaceChildren(...recording.sessions.map((session) => new Option(nameOfSession(session), session.session)));
    this.choice.addEventListener('change', () => this.select(Number(this.choice.value)));
    this.button.addEventListener('click', () => this.play(!this.recording.playing));
    this.speeds.addEventListener('change', () => this.setSpeed(Number(this.speeds.value)));
    this.setSpeed(1);
    element.hidden = false;
  }

  // Throws Error: there is no such session.
  select(number, at_s = 0) {
    this.recording.select(number);
    this.choice.value = number;
    this.play(false);
    this.on_session();
    this.move(at_s);
  }

  move(time_s) {
    const { recording } = this;
    recording.at_s = Math.min(Math.max(time_s, 0), recording.length_s);
    this.moment.textContent = `${recording.at_s.toFixed(2)} of ${recording.length_s.toFixed(2)} s`;
    this.on_move();
  }

  play(yes) {
    this.recording.playing = yes;
    this.button.textContent = yes ? 'Hold' : 'Play';
    this.stepped_ms = undefined;
    if (yes) this.move(this.recording.at_s < this.recording.length_s ? this.recording.at_s : 0);
  }

  // One that is not in the list is put into it.
  setSpeed(speed) {
    this.recording.speed = speed;
    const speeds = [...new Set([...SPEEDS, speed])].sort((a, b) => a - b);
    this.speeds.replaceChildren(...speeds.map((other) => new Option(`${other} x`, other)));
    this.speeds.value = speed;
    if (this.recording.playing) this.on_move();  // more of it is needed ahead
  }

  // A key of the page. True: it was one of the recording's.
  key(name, shift = false) {
    const { recording } = this;
    const jump_s = JUMP_S * (shift ? 0.1 : 1);
    const move = { ArrowLeft: recording.at_s - jump_s, ArrowRight: recording.at_s + jump_s, Home: 0, End: recording.length_s }[name];
    if (move !== undefined) this.move(move);
    else if (name === ' ') this.play(!recording.playing);
    else return false;
    return true;
  }

  // While it plays: on by the time since the last step. True: it plays on.
  step(now_ms) {
    const { recording } = this;
    if (!recording.playing) return false;
    if (this.stepped_ms !== undefined) this.move(recording.at_s + recording.speed * Math.min((now_ms - this.stepped_ms) / 1000, LONGEST_STEP_S));
    this.stepped_ms = now_ms;
    if (recording.at_s >= recording.length_s) this.play(false);
    return recording.playing;
  }
}
