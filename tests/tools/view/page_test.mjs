// Modules of the page without a browser: CDR against our own encoder, signals by tick, plots that show every sample.
// Usage: SINEW_EXPECTED=EXPECTED.jsonl node --test page_test.mjs (the file is idl_write_sample's)
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { decode, getter, numberPaths, parseIdl } from '../../../tools/view/page/cdr.js';
import { Connection } from '../../../tools/view/page/connection.js';
import { Frames } from '../../../tools/view/page/frames.js';
import { Log } from '../../../tools/view/page/log.js';
import { buses, fill, participants } from '../../../tools/view/page/panels.js';
import { Recording } from '../../../tools/view/page/recording.js';
import { PlotData, Table } from '../../../tools/view/page/series.js';
import { Timeline, nameOfSession } from '../../../tools/view/page/timeline.js';
import { Topics } from '../../../tools/view/page/topics.js';

const here = import.meta.url;
const lines = readFileSync(process.env.SINEW_EXPECTED, 'utf8').trim().split('\n').map((line) => JSON.parse(line));
const viewOf = (hex) => {
  const bytes = Uint8Array.from(hex.match(/../g), (byte) => Number.parseInt(byte, 16));
  return new DataView(bytes.buffer);
};

// As the page has it: 64-bit integers as doubles, enumerators by name.
function asRead(value, type) {
  if (type.kind === 'struct') return Object.fromEntries(type.members.map((member) => [member.name, asRead(value[member.name], member.type)]));
  if (type.kind === 'array' || type.kind === 'sequence') return value.map((inner) => asRead(inner, type.element));
  if (type.kind === 'enum') return type.values[value];
  return type.kind.endsWith('int64') ? Number(BigInt(value)) : value;
}

test('every message of every topic is decoded as it was encoded', () => {
  const topics = new Set();
  for (const line of lines) {
    const type = parseIdl(line.schema).get(line.schema_name);
    assert.deepEqual(decode(type, viewOf(line.payload)), asRead(line.value, type), line.topic);
    topics.add(line.topic);
  }
  assert.ok(topics.size >= 25, `${topics.size} topics`);
});

test('every number has a path, and its getter reads what the decoder does', () => {
  let numbers = 0;
  for (const line of lines.filter((_, i) => i % 20 === 0)) {
    const type = parseIdl(line.schema).get(line.schema_name);
    const view = viewOf(line.payload);
    const message = decode(type, view);
    for (const path of numberPaths(type)) {
      let value = message;
      let of = type;
      for (const step of path.match(/[^.[\]]+/g)) {
        value = value[step];
        of = of.kind === 'struct' ? of.members.find((member) => member.name === step).type : of.element;
      }
      if (of.kind === 'enum') value = of.values.indexOf(value);
      assert.equal(getter(type, path)(view), Number(value), `${line.topic}.${path}`);
      ++numbers;
    }
  }
  assert.ok(numbers > 500, `${numbers} numbers`);
});

test('what is no number, and IDL that is none, are errors that name it', () => {
  const line = lines.find((other) => other.topic === 'joint_state');
  const type = parseIdl(line.schema).get(line.schema_name);
  for (const path of ['position_deg[0]', 'position_rad[12]', 'header', 'header.tick.x']) {
    assert.throws(() => getter(type, path), new RegExp(path.replace(/[[\].]/g, '\\$&')));
  }
  assert.throws(() => parseIdl('struct A { Unknown x; };'), /no type 'Unknown'/);
  assert.throws(() => parseIdl('@appendable struct A { long x; };'), /@appendable/);
  assert.throws(() => parseIdl('module a { struct A { long x; };'), /no end of module a/);
  assert.throws(() => decode(type, viewOf(line.payload.slice(0, 80))), RangeError);
});

test('64-bit integers are the nearest numbers, in either order of bytes', () => {
  const type = parseIdl('@final struct A { unsigned long long a; long long b; };').get('A');
  for (const value of [0n, 1n, 2n ** 32n - 1n, 2n ** 53n + 1n, 2n ** 63n - 1n, 2n ** 64n - 1n, 0xfedcba9876543210n]) {
    for (const little of [true, false]) {
      const view = new DataView(new ArrayBuffer(20));
      view.setUint8(1, little ? 1 : 0);
      view.setBigUint64(4, value, little);
      view.setBigInt64(12, -(value >> 1n), little);
      assert.equal(getter(type, 'a')(view), Number(value));
      assert.equal(getter(type, 'b')(view), Number(-(value >> 1n)));
    }
  }
});

const plotData = (...of) => new PlotData().read(...of).map((column) => [...column]);

test('rows are ticks: gaps stay empty, the oldest go, time rises', () => {
  const table = new Table(8);
  const column = table.column('a');
  const put = (tick, value) => {
    if (table.open(tick, 1e9 + tick * 1e8)) column[tick % 8] = value;
  };
  for (const tick of [100, 101, 104]) put(tick, tick);
  assert.deepEqual(plotData(table, ['a'], -1, 9, 100)[1], [100, 101, NaN, NaN, 104]);
  put(102, 102);  // late, and still kept
  assert.deepEqual(plotData(table, ['a'], -1, 9, 100)[1], [100, 101, 102, NaN, 104]);
  for (let tick = 105; tick < 120; ++tick) put(tick, tick);
  assert.equal(table.first, 112);
  put(111, 7);
  assert.deepEqual(plotData(table, ['a'], -1, 9, 100)[1], [112, 113, 114, 115, 116, 117, 118, 119]);
  const times = plotData(table, ['a'], -1, 9, 100)[0];
  assert.ok(times.every((time, i) => i === 0 || time > times[i - 1]));
});

test('a plot that is narrower than its samples shows the least and the greatest of each group', () => {
  const table = new Table(4096);
  const column = table.column('a');
  for (let tick = 0; tick < 4000; ++tick) {
    table.open(tick, tick * 1e6);
    column[tick] = tick === 1234 ? 5 : tick === 2345 ? -7 : Math.sin(tick / 100);
  }
  const [times, values, nothing] = plotData(table, ['a', 'nothing'], 0, 4, 300);
  assert.ok(times.length <= 2 * 301 && times.length > 300);
  assert.equal(times.length, values.length);
  assert.equal(Math.max(...values), 5);
  assert.equal(Math.min(...values), -7);
  assert.ok(nothing.every(Number.isNaN));
});

test('what is read for a plot keeps its arrays, and has the range of the signals that are shown', () => {
  const table = new Table(4096);
  const a = table.column('a');
  const b = table.column('b');
  for (let tick = 0; tick < 4000; ++tick) {
    table.open(tick, tick * 1e6);
    a[tick] = tick % 7 === 0 ? NaN : Math.sin(tick);
    b[tick] = 100 + tick;
  }
  const read = new PlotData();
  for (const width of [300, 5000]) {  // groups, and every sample
    read.read(table, ['a', 'b'], 0, 4, width, (i) => (i === 0 ? 0 : -1));
    const [[least, greatest]] = read.ranges;
    assert.ok(least >= -1 && greatest <= 1 && greatest - least > 1.99, `${least} ${greatest}`);
    read.read(table, ['a', 'b'], 0, 4, width);
    assert.equal(read.ranges[0][1], 4099);
    read.read(table, ['a', 'b'], 0, 4, width, (i) => i);
    assert.ok(read.ranges[0][1] <= 1, 'each axis has its own');
    assert.deepEqual(read.ranges[1], [100, 4099]);
  }
  const [times] = read.read(table, ['a', 'b'], 0, 4, 300);
  const [again] = read.read(table, ['a', 'b'], 0.5, 4, 300);
  assert.equal(times.buffer, again.buffer);
  read.read(table, ['nothing'], 0, 4, 300);
  assert.deepEqual(read.ranges, []);
});

test('the least and the greatest of a group come in their order', () => {
  const table = new Table(4096);
  const rising = table.column('rising');
  const falling = table.column('falling');
  for (let tick = 0; tick < 4000; ++tick) {
    table.open(tick, tick * 1e6);
    rising[tick] = tick;
    falling[tick] = -tick;
  }
  const [, up, down] = plotData(table, ['rising', 'falling'], 0, 4, 300);
  assert.ok(up.every((value, i) => i === 0 || value > up[i - 1]));
  assert.ok(down.every((value, i) => i === 0 || value < down[i - 1]));
});

test('groups do not change while the window moves', () => {
  const table = new Table(4096);
  const column = table.column('a');
  for (let tick = 0; tick < 4000; ++tick) {
    table.open(tick, tick * 1e6);
    column[tick] = (tick * 7919) % 997;
  }
  const groupsFrom = (from_s) => {
    const [times, values] = plotData(table, ['a'], from_s, from_s + 2, 100);
    const groups = new Map();
    for (let i = 0; i < times.length; i += 2) groups.set(times[i], [values[i], values[i + 1]]);
    return groups;
  };
  const before = groupsFrom(1);
  const both = [...groupsFrom(1.303)].filter(([time]) => before.has(time) && time < 2.9);
  assert.ok(both.length > 50, `${both.length}`);
  for (const [time, values] of both) assert.deepEqual(values, before.get(time));
});

// A clock, and frames that come when the test says so.
class Display {
  constructor() {
    this.ms = 0;
    this.frames = [];
    this.timers = [];
    this.paint_ms = 0;  // what layout and painting take
  }
  now() { return this.ms; }
  after(ms, call) { this.timers.push({ at_ms: this.ms + ms, call }); return this.timers.at(-1); }
  cancel(timer) { this.timers = this.timers.filter((other) => other !== timer); }
  frame(call) { this.frames.push(call); }
  painted(call) { this.ms += this.paint_ms; call(); }
  // Time goes on to `until_ms`; a frame comes at most every 16 ms.
  run(until_ms) {
    while (this.ms < until_ms) {
      this.ms += 1;
      for (const timer of this.timers.filter((other) => other.at_ms <= this.ms)) {
        this.cancel(timer);
        timer.call();
      }
      if (this.frames.length > 0 && this.ms % 16 < 1) for (const call of this.frames.splice(0)) call();
    }
  }
}

test('what has not changed is not drawn, and no frame is asked for', () => {
  const display = new Display();
  const frames = new Frames(display);
  let draws = 0;
  const job = frames.add({ least_ms: 50, share: 0.2, draw: () => { ++draws; return true; } });
  display.run(1000);
  assert.equal(draws, 0);
  frames.want(job);
  display.run(2000);
  assert.equal(draws, 1);
  assert.equal(display.frames.length + display.timers.length, 0);
});

test('a job that is wanted all the time is drawn at its rate, and less often when that takes long', () => {
  for (const [draw_ms, paint_ms, least, most] of [[1, 0, 19, 21], [20, 0, 8, 11], [1, 99, 1, 3]]) {
    const display = new Display();
    const frames = new Frames(display);
    display.paint_ms = paint_ms;
    let draws = 0;
    let other_draws = 0;
    const job = frames.add({ least_ms: 50, share: 0.2, draw: () => {
      ++draws;
      display.ms += draw_ms;
      frames.want(job);
      return true;
    } });
    const other = frames.add({ least_ms: 250, share: 0.05, draw: () => { ++other_draws; frames.want(other); return false; } });
    frames.want(job);
    frames.want(other);
    display.run(1000);
    assert.ok(draws >= least && draws <= most, `${draws} draws of ${draw_ms} + ${paint_ms} ms`);
    assert.ok(other_draws >= 1 && other_draws <= 4, `${other_draws}`);
  }
});

test('a job that throws does not stop the others', () => {
  const display = new Display();
  const frames = new Frames(display);
  let draws = 0;
  const bad = frames.add({ least_ms: 50, share: 0.2, draw: () => { throw new Error('bad'); } });
  const good = frames.add({ least_ms: 50, share: 0.2, draw: () => { ++draws; return true; } });
  frames.want(bad);
  frames.want(good);
  assert.throws(() => display.run(100), /bad/);
  display.run(200);
  assert.equal(draws, 1);
});

test('a hidden tab draws nothing, and what has changed when it is seen again', () => {
  const display = new Display();
  const frames = new Frames(display);
  let draws = 0;
  const job = frames.add({ least_ms: 50, share: 0.2, draw: () => { ++draws; return true; } });
  frames.hide(true);
  frames.want(job);
  display.run(60000);
  assert.equal(draws, 0);
  assert.equal(display.frames.length, 0);
  frames.hide(false);
  display.run(60100);
  assert.equal(draws, 1);
});

// As much of a table as the page uses.
class Cell {
  constructor(tag) { Object.assign(this, { tag, cells: [], writes: 0, className: '' }); }
  set textContent(text) { this.text = text; ++this.writes; }
  replaceChildren(...cells) { this.cells = cells; }
}
class FakeTable {
  constructor() { this.rows = []; }
  insertRow() { this.rows.push(new Cell('tr')); return this.rows.at(-1); }
  deleteRow() { this.rows.pop(); }
  get texts() { return this.rows.map((row) => row.cells.map((cell) => cell.text)); }
  get writes() { return this.rows.reduce((sum, row) => sum + row.cells.reduce((part, cell) => part + cell.writes, 0), 0); }
}

test('a table leaves out columns that nothing fills, and writes only what has changed', () => {
  globalThis.document = { createElement: (tag) => new Cell(tag) };
  const table = new FakeTable();
  const head = ['name', 'a', 'b'];
  fill(table, head, [], 'nothing yet');
  assert.deepEqual(table.texts, [['name'], ['nothing yet']]);
  fill(table, head, [['x', ['1', 'number'], '-'], ['y', ['-', 'number bad'], '-']], '');
  assert.deepEqual(table.texts, [['name', 'a'], ['x', '1'], ['y', '-']]);
  assert.equal(table.rows[0].cells[1].className, 'number');
  const before = table.writes;
  fill(table, head, [['x', ['1', 'number'], '-'], ['y', ['2', 'number'], '-']], '');
  assert.equal(table.writes, before + 1);
  assert.equal(table.rows[2].cells[1].className, 'number');
  fill(table, head, [['x', ['1', 'number'], 'new']], '');
  assert.deepEqual(table.texts, [head, ['x', '1', 'new']]);
});

test('the table of the buses has the counts of the body nodes, where the recording has them', () => {
  globalThis.document = { createElement: (tag) => new Cell(tag) };
  const table = new FakeTable();
  table.closest = () => ({});
  const status = { bus_count: 1, up: [true], load_percent: [12.6], answer_p50_us: [300], answer_max_us: [400], frames_dropped: [1],
    frames_lost: [2], error_frames: [4], body_samples_missed: [16], body_nodes_lost: [17] };
  buses(table, status);
  assert.deepEqual(table.texts, [
    ['bus', 'state', 'load %', 'answer us', 'worst us', 'frames lost', 'error frames', 'body samples missed', 'body nodes lost'],
    ['bus 0', 'up', '13', '300', '400', '3', '4', '16', '17']]);
  const { body_samples_missed, body_nodes_lost, ...earlier } = status;
  buses(table, earlier);
  assert.deepEqual(table.texts[1], ['bus 0', 'up', '13', '300', '400', '3', '4']);
});

test('hosts are named where there are several', () => {
  globalThis.document = { createElement: (tag) => new Cell(tag) };
  const table = new FakeTable();
  const row = { name: 'esn', host: 'a', state: 'active', cycles_Hz: 240, stale_inputs: 0, missed_ticks: 0, cpu_percent: null, resident_MB: 20, age_s: 0.5, message: '' };
  participants(table, [row, row]);
  assert.deepEqual(table.texts[0].slice(0, 2), ['participant', 'state']);
  participants(table, [row, { ...row, host: 'b' }]);
  assert.deepEqual(table.texts.slice(1).map((line) => line.slice(0, 3)), [['esn', 'a', 'active'], ['esn', 'b', 'active']]);
});

test('a session that changes begins anew, another one is not mixed in, and lost ticks are counted', () => {
  const line = lines.find((other) => other.topic === 'joint_state');
  const topics = new Topics();
  topics.add('joint_state', line.schema_name, line.schema);
  topics.add('imu', 'sinew::msg::Imu', lines.find((other) => other.topic === 'imu').schema);
  topics.plot('joint_state.position_rad[0]');
  assert.throws(() => topics.plot('joint_state.nothing'), /nothing/);
  assert.throws(() => topics.plot('no_topic.x'), /no_topic/);
  const message = (hex, session, tick) => {
    const view = viewOf(hex);
    view.setBigUint64(4, BigInt(session), true);
    view.setBigUint64(12, BigInt(tick), true);
    view.setBigInt64(20, BigInt(tick) * 4000000n, true);
    return view;
  };
  assert.equal(topics.take('joint_state', message(line.payload, 1, 10)), true);
  assert.equal(topics.take('joint_state', message(line.payload, 1, 11)), false);
  assert.equal(topics.take('joint_state', message(line.payload, 1, 14)), false);
  assert.equal(topics.lost, 2);
  assert.equal(topics.samples, 3);
  const imu = lines.find((other) => other.topic === 'imu');
  topics.take('imu', message(imu.payload, 2, 11));
  assert.equal(topics.newest('imu'), undefined);
  topics.take('imu', message(imu.payload, 1, 11));
  assert.equal(topics.newest('imu').header.tick, 11);
  assert.equal(topics.take('joint_state', message(line.payload, 2, 0)), true);
  assert.equal(topics.newest('imu'), undefined);
  assert.equal(topics.table.end - topics.table.first, 1);
});

test('messages come in batches from our server, and one by one from another', () => {
  const frame = (subscription, payload) => [1, subscription, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ...payload];
  const sized = (bytes) => [bytes.length, 0, 0, 0, ...bytes];
  const batch = [...sized(frame(1, [7, 8])), ...sized(frame(2, [])), ...sized(frame(3, [5])), ...sized(frame(1, [9]))];
  for (const [protocol, frames] of [['sinew.batch.v1', [batch]], ['foxglove.websocket.v1', [frame(1, [7, 8]), frame(2, []), frame(3, [5]), frame(1, [9])]]]) {
    globalThis.WebSocket = class {
      constructor(url, protocols) { assert.ok(protocols.includes(protocol)); this.protocol = protocol; }
      send(text) { this.sent = text; }
    };
    const came = [];
    const handlers = { advertise: () => {}, state: () => {}, report: () => {}, message: (topic, view) => came.push([topic, [...new Uint8Array(view.buffer, view.byteOffset, view.byteLength)]]) };
    const connection = new Connection('ws://here/', handlers);
    connection.take(JSON.stringify({ op: 'advertise', channels: [{ topic: 'a', id: 11 }, { topic: 'b', id: 12 }] }));
    connection.subscribe(['a', 'b']);
    for (const bytes of frames) connection.take(Uint8Array.from(bytes).buffer);
    assert.deepEqual(came, [['a', [7, 8]], ['b', []], ['a', [9]]], protocol);
  }
});

// A server with a recording of two sessions: joint_state at 10 Hz, 30 s from 5 s on, then 20 s from 2 s on.
function serveTwoSessions(replies) {
  const line = lines.find((other) => other.topic === 'joint_state');
  const sessions = [{ session: 1, session_id: '71', start_ns: '5000000000', length_s: 30 }, { session: 2, session_id: '72', start_ns: '2000000000', length_s: 20 }];
  globalThis.fetch = async (address) => {
    const query = new URL(address, 'http://here').searchParams;
    replies.push(address);
    if (address.includes('/participants')) return { ok: true, json: async () => [{ name: `of ${query.get('session')} at ${query.get('at_ns')}` }] };
    const session = sessions[query.get('session') - 1];
    if (!session) return { ok: false, text: async () => 'no such session\n' };
    const parts = [];
    for (let tick = 0; tick <= session.length_s * 10; ++tick) {
      const stamp_ns = BigInt(session.start_ns) + BigInt(tick) * 100000000n;
      if (stamp_ns < BigInt(query.get('from_ns')) || stamp_ns > BigInt(query.get('to_ns'))) continue;
      const message = viewOf(line.payload);
      message.setBigUint64(4, BigInt(session.session_id), true);
      message.setBigUint64(12, BigInt(tick), true);
      message.setBigInt64(20, stamp_ns, true);
      const head = new DataView(new ArrayBuffer(14));
      head.setBigInt64(2, stamp_ns, true);
      head.setUint32(10, message.byteLength, true);
      parts.push(new Uint8Array(head.buffer), new Uint8Array(message.buffer));
    }
    const body = Buffer.concat(parts);
    return { ok: true, arrayBuffer: async () => body.buffer.slice(body.byteOffset, body.byteOffset + body.length) };
  };
  const topics = new Topics();
  topics.add('joint_state', line.schema_name, line.schema);
  topics.plot('joint_state.header.stamp_ns');
  const recording = new Recording({ file: 'two.mcap', sessions, topics: [
    { topic: 'joint_state', messages: 502 }, { topic: 'component_status', messages: 40 }] }, topics);
  recording.want(['joint_state', 'regime', 'joint_state']);
  return { topics, recording };
}

test('a session of a recording has its own time, span and messages', async () => {
  const replies = [];
  const { topics, recording } = serveTwoSessions(replies);
  assert.equal(recording.length_s, 30);
  recording.at_s = 12;
  assert.equal(await recording.load(10), true);
  assert.match(replies.at(-1), /session=1&topics=joint_state&from_ns=5000000000&to_ns=22000000000$/);
  recording.show();
  assert.equal(topics.newest('joint_state').header.tick, 120);
  assert.equal(topics.newest('joint_state').header.session_id, 71);
  assert.equal(await recording.load(10), false, 'it is there');
  recording.select(2);
  assert.equal(recording.length_s, 20);
  assert.equal(recording.at_s, 0);
  assert.equal(topics.newest('joint_state'), undefined, 'nothing of the other session is left');
  recording.at_s = 18;
  assert.equal(await recording.load(10), true);
  assert.match(replies.at(-1), /session=2&topics=joint_state&from_ns=5000000000&to_ns=22000000000$/);
  recording.show();
  assert.equal(topics.newest('joint_state').header.session_id, 72);
  assert.equal(topics.newest('joint_state').header.tick, 180);
  assert.ok(Math.abs(topics.table.newest - 20) < 1e-9, `${topics.table.newest}`);
  assert.throws(() => recording.select(3), /expected 1 to 2/);
  recording.session = 9;
  recording.loaded = undefined;
  await assert.rejects(recording.load(10), /no such session/);
});

test('what was asked for before another session was chosen does not come into it', async () => {
  const { topics, recording } = serveTwoSessions([]);
  recording.at_s = 12;
  const late = recording.load(10);
  recording.select(2);
  recording.at_s = 1;
  assert.equal(await late, true, 'to be asked for again');
  assert.equal(topics.table.end, 0);
  assert.equal(await recording.load(10), true);
  recording.show();
  assert.equal(topics.newest('joint_state').header.session_id, 72);
});

test('a recording that plays asks for the next span before it is needed, and other signals of what is there need none', async () => {
  const replies = [];
  const { topics, recording } = serveTwoSessions(replies);
  recording.at_s = 10;
  await recording.load(10);
  recording.at_s = 14.5;
  assert.equal(await recording.load(10), false);
  recording.playing = true;
  assert.equal(await recording.load(10), true);
  const asked = replies.length;
  topics.plot('joint_state.header.tick');
  recording.want(['joint_state']);
  assert.equal(await recording.load(10), false);
  assert.equal(replies.length, asked);
  assert.equal(topics.table.columns.get('joint_state.header.tick')[50], 50);
});

test('the participants of a moment are asked for once', async () => {
  const { recording } = serveTwoSessions([]);
  recording.select(2);
  recording.at_s = 1.5;
  const [rows, second] = await Promise.all([recording.participants(), recording.participants()]);
  assert.deepEqual(rows, [{ name: 'of 2 at 3500000000' }]);
  assert.equal(second, undefined);
  assert.equal(await recording.participants(), undefined);
  recording.at_s = 2;
  assert.deepEqual(await recording.participants(), [{ name: 'of 2 at 4000000000' }]);
});

test('the log is bounded, has its lines by level and participant, and begins anew with its server', () => {
  const log = new Log();
  const line = (level, name, text) => ({ time_ms: 0, level, name, text });
  log.add({ last: 2, lines: [line('info', 'esn', 'a'), line('error', 'control', 'b')] });
  assert.deepEqual(log.names(), ['control', 'esn']);
  log.choose('warning', '');
  assert.deepEqual(log.shown().map((each) => each.text), ['b']);
  log.choose('info', 'esn');
  assert.deepEqual(log.shown().map((each) => each.text), ['a']);
  log.choose('info', '');
  log.add({ last: 602, lines: Array.from({ length: 600 }, (_, i) => line('info', 'esn', `${i}`)) });
  assert.equal(log.lines.length, 500);
  assert.equal(log.lines.at(-1).text, '599');
  log.add({ last: 1, lines: [] });
  assert.deepEqual([log.last, log.lines.length], [0, 0]);
  log.set([line('info', 'rls', 'c')]);
  assert.equal(log.shown().length, 1);
});

test('the log of a moment is asked for beside the participants', async () => {
  const { recording } = serveTwoSessions([]);
  assert.equal(recording.log(), undefined, 'the recording has none');
});

// As much of the elements of the timeline as it uses.
class Part {
  constructor() { Object.assign(this, { on: {}, hidden: true, children: [] }); }
  addEventListener(name, call) { this.on[name] = call; }
  replaceChildren(...children) { this.children = children; }
}

test('the timeline follows the session, and lists sessions where there are several', () => {
  globalThis.Option = class { constructor(text, value) { Object.assign(this, { text, value }); } };
  for (const count of [2, 1]) {
    const { recording } = serveTwoSessions([]);
    recording.sessions = recording.sessions.slice(0, count);
    const parts = new Map();
    const element = new Part();
    element.querySelector = (name) => {
      if (!parts.has(name)) parts.set(name, new Part());
      return parts.get(name);
    };
    const calls = [];
    const timeline = new Timeline(recording, element, { on_move: () => calls.push(recording.at_s), on_session: () => calls.push(`session ${recording.session}`) });
    assert.equal(element.hidden, false);
    assert.equal(parts.get('#session_label').hidden, count === 1);
    timeline.select(1, 99);
    assert.deepEqual(calls, ['session 1', 30], 'no more than there is');
    if (count === 1) continue;
    assert.deepEqual(parts.get('#session').children.map((option) => option.text), ['1: 30.0 s', '2: 20.0 s']);
    parts.get('#session').value = '2';
    parts.get('#session').on.change();
    assert.equal(recording.session, 2);
    assert.equal(parts.get('#moment').textContent, '0.00 of 20.00 s');
    parts.get('#play').on.click();
    assert.equal(parts.get('#play').textContent, 'Hold');
    assert.equal(timeline.step(1000), true);
    assert.equal(timeline.step(1500), true);
    assert.equal(recording.at_s, 0.5);
    timeline.step(600000);
    assert.equal(recording.at_s, 1.5, 'it was hidden');
    timeline.move(19.9);
    assert.equal(timeline.step(600500), false, 'the end');
    assert.equal(recording.at_s, 20);
    assert.equal(parts.get('#play').textContent, 'Play');
    parts.get('#play').on.click();
    assert.equal(recording.at_s, 0, 'again from the beginning');
  }
});

test('a session is named by its length, and by its start where that is a time of day', () => {
  assert.equal(nameOfSession({ session: 2, start_ns: '2000000000', length_s: 12.34 }), '2: 12.3 s');
  assert.match(nameOfSession({ session: 1, start_ns: '1700000000000000000', length_s: 1 }), /^1: 1\.0 s, .*2023/);
});

test('vendored files are the ones that are named', () => {
  let named = 0;
  for (const folder of ['../../../tools/view/page/vendor/', './vendor/']) {
    const readme = readFileSync(new URL(`${folder}README.md`, here), 'utf8');
    const hashes = new Map([...readme.matchAll(/^\| `([^`]+)` .*\| ([0-9a-f]{64}) \|$/gm)].map((row) => [row[1], row[2]]));
    for (const file of readdirSync(new URL(folder, here))) {
      if (file.endsWith('.txt') || file === 'README.md') continue;
      const hash = createHash('sha256').update(readFileSync(new URL(folder + file, here))).digest('hex');
      assert.equal(hash, hashes.get(file), file);
      ++named;
    }
  }
  assert.equal(named, 4);
});
