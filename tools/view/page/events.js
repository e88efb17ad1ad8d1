// What happened to the robot, with its time: armed, disarmed, damped, fault, estop, handover, recording started. Read from
// joint_state and command_source, live and of a recording; the plots draw them as marks.

import { decode, getter } from './cdr.js';

const MOST = 500;  // the oldest go
export const SOURCES = ['joint_state', 'command_source'];
const NOBODY = '';
// robot_state -> [label, kind]; the kind is a colour (plots.js).
const STATES = {
  ROBOT_DISARMED: ['disarmed', 'quiet'], ROBOT_ARMED: ['armed', 'good'], ROBOT_DAMPED: ['damped', 'warn'],
  ROBOT_FAULT: ['fault', 'bad'], ROBOT_ESTOPPED: ['estop', 'bad'],
};

const hasFault = (state) => (state?.fault?.cause ?? 'FAULT_NONE') !== 'FAULT_NONE';

// A fault in words. Numbers as the message has them, where there is a limit.
export function faultOf({ fault }, with_numbers = true) {
  const numbers = !with_numbers || fault.value === fault.limit ? '' : `: ${+fault.value.toPrecision(4)}, limit ${+fault.limit.toPrecision(4)}`;
  return `${fault.joint === 255 ? '' : `joint ${fault.joint}: `}${fault.cause.replace('FAULT_', '').replaceAll('_', ' ').toLowerCase()}${numbers}`;
}

export class Events {
  constructor() {
    this.list = [];  // {stamp_ns, label, kind}, by time
    this.types = new Map();  // topic -> how it is read
    this.restart();
  }

  restart() {
    this.list = [];
    this.state = undefined;  // of the last joint_state
    this.tick = -1;
    this.source = undefined;
    this.stamp_ns = undefined;
  }

  // A message of the shown session. True: something happened.
  take(name, type, view) {
    if (name === 'joint_state') return this.takeState(type, view);
    if (name === 'command_source') return this.takeSource(type, view);
    return false;
  }

  takeState(type, view) {
    let read = this.types.get(type);
    if (!read) {
      read = { tick: getter(type, 'header.tick'), stamp: getter(type, 'header.stamp_ns'), state: getter(type, 'robot_state') };
      this.types.set(type, read);
    }
    const tick = read.tick(view);
    if (tick <= this.tick) return false;
    this.tick = tick;
    this.stamp_ns = read.stamp(view);
    const before = this.state;
    this.state = read.state(view);
    if (before === undefined || before === this.state) return false;
    const message = decode(type, view);
    const [label, kind] = STATES[message.robot_state] ?? [String(message.robot_state), 'quiet'];
    this.note(this.stamp_ns, label === 'fault' && hasFault(message) ? `fault: ${faultOf(message, false)}` : label, kind);
    return true;
  }

  takeSource(type, view) {
    const message = decode(type, view);
    const source = message.joint_command_participant;
    const before = this.source;
    this.source = source;
    if (before === undefined || before === source || source === NOBODY) return false;
    if (before === NOBODY) return false;  // the first one: nobody handed anything over
    this.note(message.header.stamp_ns, `handover: ${source}`, 'note');
    return true;
  }

  note(stamp_ns, label, kind) {
    let at = this.list.length;
    while (at > 0 && this.list[at - 1].stamp_ns > stamp_ns) --at;
    this.list.splice(at, 0, { stamp_ns, label, kind });
    if (this.list.length > MOST) this.list.shift();
  }

  // Marks of a plot whose times count from start_ns.
  marks(start_ns) {
    return start_ns === undefined ? [] : this.list.map(({ stamp_ns, label, kind }) => ({ time_s: (stamp_ns - start_ns) * 1e-9, label, kind }));
  }
}

// Recorders as /api/status names them: which of them begins to record.
export class Recorders {
  constructor() { this.active = undefined; }

  // Names of those that record and did not at the last call; of the first call none.
  begun(status) {
    const now = new Set(status.participants.filter((row) => row.kind === 'logger' && row.state === 'active').map((row) => row.name));
    const before = this.active;
    this.active = now;
    return before === undefined ? [] : [...now].filter((name) => !before.has(name));
  }
}
