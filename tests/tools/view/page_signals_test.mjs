// What the page makes of names, units, events, addresses and time, without a browser.
// Usage: SINEW_EXPECTED=EXPECTED.jsonl node --test page_signals_test.mjs (the file is idl_write_sample's)
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { decode, getter, parseIdl } from '../../../tools/view/page/cdr.js';
import { Events, Recorders, faultOf } from '../../../tools/view/page/events.js';
import { Layouts, readAddress, writeAddress } from '../../../tools/view/page/layouts.js';
import { labelled, rowsOf } from '../../../tools/view/page/marks.js';
import { distance, nearest, problemOf } from '../../../tools/view/page/names.js';
import { stepOf } from '../../../tools/view/page/overview.js';
import { joints, participants } from '../../../tools/view/page/panels.js';
import { MOST_BYTES, Past } from '../../../tools/view/page/past.js';
import { Recording } from '../../../tools/view/page/recording.js';
import { PlotData, Table } from '../../../tools/view/page/series.js';
import { COLUMNS, MOST_TICKS, SAMPLES, Survey } from '../../../tools/view/page/survey.js';
import { SPEEDS, Timeline } from '../../../tools/view/page/timeline.js';
import { Topics } from '../../../tools/view/page/topics.js';
import { commonUnit, leastRange, unitOf, widened } from '../../../tools/view/page/units.js';

const lines = readFileSync(process.env.SINEW_EXPECTED, 'utf8').trim().split('\n').map((line) => JSON.parse(line));
const lineOf = (topic) => lines.find((line) => line.topic === topic);
const typeOf = (topic) => parseIdl(lineOf(topic).schema).get(lineOf(topic).schema_name);
const viewOf = (topic) => new DataView(Uint8Array.from(lineOf(topic).payload.match(/../g), (byte) => Number.parseInt(byte, 16)).buffer);
const TICK_NS = 4e6;
const STATES = ['ROBOT_DISARMED', 'ROBOT_ARMED', 'ROBOT_DAMPED', 'ROBOT_FAULT', 'ROBOT_ESTOPPED'];

// A message of a topic whose header, and robot state, are these.
function message(topic, tick, { session = 1, state } = {}) {
  const view = viewOf(topic);
  view.setBigUint64(4, BigInt(session), true);
  view.setBigUint64(12, BigInt(tick), true);
  view.setBigInt64(20, BigInt(tick * TICK_NS), true);
  if (state === undefined) return view;
  // robot_state follows the header: session, tick, stamp, origin.
  view.setUint32(4 + 28, STATES.indexOf(state), true);
  assert.equal(decode(typeOf(topic), view).robot_state, state);
  return view;
}

function topicsOf(names, past) {
  const topics = new Topics(past);
  for (const name of names) topics.add(name, lineOf(name).schema_name, lineOf(name).schema);
  return topics;
}

test('the unit of a signal is that of its name, and of the kind of its joint', () => {
  const kinds = ['JOINT_REVOLUTE', 'JOINT_PRISMATIC'];
  for (const [signal, unit] of [
    ['joint_state.position_rad[0]', 'rad'], ['joint_state.position_rad[1]', 'm'], ['joint_state.torque_Nm[1]', 'N'],
    ['joint_state.velocity_rad_s[1]', 'm/s'], ['reference.acceleration_rad_s2[0]', 'rad/s\u00b2'], ['joint_state.period_s', 's'],
    ['joint_command.motor_torque_Nm[1]', 'Nm'], ['actuator_state.motor_position_rad[1]', 'rad'],
    ['actuator_state.chamber_pressure_bar[1]', 'bar'], ['actuator_state.motor_current_A[0]', 'A'], ['joint_state.joint_count', ''],
    ['reference.position_rad[1] - joint_state.position_rad[1]', 'm'], ['joint_state.header.tick', ''], ['x.s', '']]) {
    assert.equal(unitOf(signal, kinds), unit, signal);
  }
  assert.equal(commonUnit('rad', ['JOINT_PRISMATIC', 'JOINT_PRISMATIC']), 'm');
  assert.equal(commonUnit('rad', kinds), undefined, 'joints of both kinds have none in common');
  assert.equal(commonUnit('Nm', []), 'Nm');
});

test('an axis is no narrower than the least range of its unit, and keeps what is wider', () => {
  assert.deepEqual(widened(0.4999, 0.5001, 'rad').map((value) => Number(value.toFixed(6))), [0.495, 0.505]);
  assert.deepEqual(widened(-1, 2, 'rad'), [-1, 2]);
  assert.deepEqual(widened(3, 3, ''), [3, 3]);
});

test('the difference of two signals is there where both are', () => {
  const table = new Table(4096);
  const a = table.column('t.a');
  const b = table.column('t.b');
  for (let tick = 0; tick < 4000; ++tick) {
    table.open(tick, tick * 1e6);
    a[tick] = tick % 10 === 3 ? NaN : 2 * tick;
    b[tick] = tick;
  }
  const read = new PlotData();
  const [, every] = read.read(table, ['t.a - t.b'], 0, 0.02, 500);
  assert.deepEqual([...every].slice(0, 5), [0, 1, 2, NaN, 4]);
  const [, grouped] = read.read(table, ['t.a - t.b'], 0, 4, 100);
  assert.equal(Math.max(...grouped), 3999 - 0);
  assert.ok([...read.read(table, ['t.a - t.none'], 0, 4, 100)[1]].every(Number.isNaN));
});

test('a name that is wrong is refused, with what may have been meant', () => {
  assert.equal(distance('joint_state', 'joint_sttae'), 1);
  assert.equal(distance('', 'abc'), 3);
  assert.deepEqual(nearest('regim', ['residual', 'regime', 'imu']), ['regime']);
  const { topics } = topicsOf(['joint_state', 'joint_command', 'reference', 'regime']);
  for (const good of ['joint_state.position_rad[0]', 'joint_state.header.tick', 'reference.position_rad[3] - joint_state.position_rad[3]']) {
    assert.equal(problemOf(good, topics), undefined, good);
  }
  for (const [bad, ...words] of [
    ['joint_stat.position_rad[0]', "no topic 'joint_stat'", 'did you mean joint_state.position_rad[0]'],
    ['joint_state.positon_rad[0]', "no number 'positon_rad[0]'", 'did you mean joint_state.position_rad[0]'],
    ['joint_state.position_rad', 'did you mean joint_state.position_rad[0]'], ['joint_state.position_rad[12]', 'has [0] to [11]'],
    ['position_rad[0]', 'joint_state.position_rad[0]'], ['zzzzzzzz.x', 'there are joint_state'], ['joint_state', 'is a topic'],
    ['reference.position_rad[0] - joint_stat.position_rad[0]', "no topic 'joint_stat'"]]) {
    for (const word of words) assert.ok(problemOf(bad, topics)?.includes(word), `${bad}: ${problemOf(bad, topics)}`);
  }
});

test('what happens to the robot is an event, once, with its time', () => {
  const events = new Events();
  const type = typeOf('joint_state');
  const take = (tick, state) => events.take('joint_state', type, message('joint_state', tick, { state }));
  assert.equal(take(0, 'ROBOT_DISARMED'), false, 'as it was found');
  assert.equal(take(1, 'ROBOT_DISARMED'), false);
  for (const [i, state] of ['ROBOT_ARMED', 'ROBOT_DAMPED', 'ROBOT_FAULT', 'ROBOT_ESTOPPED', 'ROBOT_DISARMED'].entries()) assert.equal(take(10 + i, state), true);
  assert.equal(take(3, 'ROBOT_ARMED'), false, 'late: an older tick says nothing new');
  const marks = events.marks(0);
  assert.deepEqual(marks.map(({ label }) => label.replace(/^fault: .*/, 'fault')), ['armed', 'damped', 'fault', 'estop', 'disarmed']);
  assert.ok(Math.abs(marks[0].time_s - 0.04) < 1e-12);
  events.note(11.5 * TICK_NS, 'recording started', 'note');
  assert.equal(events.list[2].label, 'recording started', 'by time');
  for (let i = 0; i < 2000; ++i) events.note(i * 1e9, 'x', 'note');
  assert.equal(events.list.length, 500);
  events.restart();
  assert.deepEqual(events.list, []);
  assert.deepEqual(events.marks(undefined), []);
});

test('a handover is a change from one participant to another', () => {
  const events = new Events();
  const type = parseIdl('struct Header { long long stamp_ns; }; struct C { Header header; string joint_command_participant; };').get('C');
  const source = (name, stamp) => {
    const bytes = new TextEncoder().encode(`${name}\0`);
    const view = new DataView(new ArrayBuffer(4 + 8 + 4 + bytes.length));
    view.setUint8(1, 1);
    view.setBigInt64(4, BigInt(stamp), true);
    view.setUint32(12, bytes.length, true);
    bytes.forEach((byte, i) => view.setUint8(16 + i, byte));
    return events.take('command_source', type, view);
  };
  assert.deepEqual([['', 0], ['control', 1], ['control', 2], ['control_2', 3e9], ['', 4e9]].map(([name, at]) => source(name, at)), [false, false, false, true, false]);
  assert.deepEqual(events.marks(1e9), [{ time_s: 2, label: 'handover: control_2', kind: 'note' }]);
});

test('a recorder that begins is named once, those that were there are not', () => {
  const recorders = new Recorders();
  const row = (name, kind, state = 'active') => ({ name, kind, state });
  assert.deepEqual(recorders.begun({ participants: [row('logger', 'logger')] }), []);
  assert.deepEqual(recorders.begun({ participants: [row('logger', 'logger'), row('second', 'logger', 'configured'), row('esn', 'esn')] }), []);
  assert.deepEqual(recorders.begun({ participants: [row('logger', 'logger'), row('second', 'logger')] }), ['second']);
  assert.deepEqual(recorders.begun({ participants: [row('second', 'logger')] }), []);
});

test('a fault is said with its numbers where there is a limit', () => {
  const fault = { cause: 'FAULT_OVERSPEED', joint: 2, value: 7.12345, limit: 6.3 };
  assert.equal(faultOf({ fault }), 'joint 2: overspeed: 7.123, limit 6.3');
  assert.equal(faultOf({ fault: { ...fault, joint: 255, value: 1, limit: 1 } }), 'overspeed');
});

test('labels of events do not lie over one another', () => {
  assert.deepEqual(rowsOf([[0, 50], [10, 50], [20, 50], [30, 50], [60, 50]], 200), [0, 1, 2, -1, 0]);
  assert.deepEqual(rowsOf([[190, 50]], 200), [-1], 'beyond the edge');
  const events = Array.from({ length: 20 }, (_, i) => ({ label: 'x', kind: i === 7 ? 'bad' : 'good' }));
  const rows = labelled(events, events.map((_, i) => [10 * i, 9]), 200);
  assert.deepEqual(rows.map((row, i) => (row >= 0 ? i : -1)).filter((i) => i >= 0), [7], 'of many only what one must not miss');
});

test('a signal that is added begins with its past, of its session only and of no more than is kept', () => {
  const past = new Past();
  const topics = topicsOf(['joint_state', 'reference'], past);
  topics.plot('joint_state.header.tick');
  for (let tick = 100; tick < 150; ++tick) {
    topics.take('joint_state', message('joint_state', tick));
    if (tick % 2 === 0) topics.take('reference', message('reference', tick));
  }
  topics.plot('reference.header.tick');
  const column = topics.table.columns.get('reference.header.tick');
  assert.equal(column[120], 120);
  assert.ok(Number.isNaN(column[121]));
  topics.take('joint_state', message('joint_state', 0, { session: 2 }));
  assert.deepEqual([...past.of('joint_state')].length, 1, 'the other session is gone');

  const bounded = new Past(10000);
  const view = new DataView(new ArrayBuffer(1000));
  for (let i = 0; i < 20000; ++i) bounded.keep(i % 2 ? 'a' : 'b', view);
  assert.ok(bounded.bytes <= 10000 && bounded.messages.length < 10000);
  assert.equal([...bounded.of('a')].length, 4);
});

test('a topic that is advertised again goes on', () => {
  const topics = topicsOf(['joint_state']);
  topics.plot('joint_state.header.tick');
  topics.take('joint_state', message('joint_state', 1));
  topics.add('joint_state', lineOf('joint_state').schema_name, lineOf('joint_state').schema);
  topics.plot('joint_state.header.tick');
  topics.take('joint_state', message('joint_state', 2));
  assert.equal(topics.table.columns.get('joint_state.header.tick')[2], 2);
});

test('ticks that are missing or stale are shown, those that came late are not', () => {
  const topics = topicsOf(['joint_state', 'reference']);
  topics.plot('joint_state.header.tick');
  topics.plot('reference.header.tick');
  for (const tick of [0, 1, 2, 5, 6, 9]) topics.take('joint_state', message('joint_state', tick));
  const spans = () => topics.gapsOf(['joint_state.header.tick']).length;
  assert.equal(spans(), 2);
  topics.take('joint_state', message('joint_state', 7));
  topics.take('joint_state', message('joint_state', 8));
  assert.equal(spans(), 1);
  assert.deepEqual(topics.gapsOf(['nothing.x']), []);
  const stale = message('reference', 3);
  const offset = [...Array(stale.byteLength - 4).keys()].find((at) => {
    const copy = new DataView(stale.buffer.slice(0));
    copy.setUint8(4 + at, 1 - copy.getUint8(4 + at));
    return getter(typeOf('reference'), 'stale')(copy) !== getter(typeOf('reference'), 'stale')(stale);
  });
  stale.setUint8(4 + offset, 1);
  topics.take('reference', stale);
  assert.equal(topics.gapsOf(['reference.header.tick']).length, 1);
});

test('the address holds place, signals and layout, and is read as it was written', () => {
  const shown = { signals: ['joint_state.position_rad[0]', 'a.b - c.d'], joint: 3, window_s: 30, hide: ['error', 'residual'], session: 2, at_s: 12.3456, speed: 0.5 };
  const search = writeAddress(shown);
  assert.deepEqual(readAddress(search), { shown: { ...shown, at_s: 12.346 }, problems: [] });
  assert.match(search, /joint_state\.position_rad\[0\],a\.b/, 'a link that one can read');
  assert.equal(writeAddress({ signals: [], joint: 0, window_s: 10, hide: [] }), '');
  assert.deepEqual(readAddress(writeAddress({ signals: [], joint: 0, window_s: 10, hide: [], configured: true })).shown, { signals: [] });
  const { shown: kept, problems } = readAddress('?at=x&joint=-1&session=1.5&speed=99&window=7');
  assert.deepEqual(kept, {});
  assert.equal(problems.length, 5);
  for (const name of ['at=x', 'joint=-1', 'session=1.5', 'speed=99', 'window=7']) assert.ok(problems.some((problem) => problem.startsWith(`${name}: expected`)), name);
});

test('layouts are kept under their names, and what another program left there harms nothing', () => {
  const kept = new Map();
  const layouts = new Layouts({ getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value) });
  assert.deepEqual(layouts.names(), []);
  const knee = { signals: ['a.b'], joint: 3, window_s: 5, hide: ['error'] };
  layouts.put('knee', { ...knee, at_s: 9 });
  layouts.put('all', { signals: [], joint: 0, window_s: 10, hide: [] });
  assert.deepEqual(layouts.names(), ['all', 'knee']);
  assert.deepEqual(layouts.get('knee'), knee);
  layouts.remove('all');
  assert.deepEqual(layouts.names(), ['knee']);
  assert.equal(layouts.get('constructor'), undefined);
  for (const text of ['no JSON', '[1]', 'null', '3']) {
    kept.set('sinew-layouts', text);
    assert.deepEqual(layouts.names(), [], text);
  }
  kept.set('sinew-layouts', '{"x": {"signals": "a", "joint": -1, "window_s": 7}}');
  assert.deepEqual(layouts.get('x'), { signals: [], joint: 0, window_s: 10, hide: [] });
  assert.throws(() => new Layouts(undefined).put('x', knee), /keeps no layouts/);
});

class Cell {
  constructor(tag) { Object.assign(this, { tag, cells: [], className: '' }); }
  replaceChildren(...cells) { this.cells = cells; }
}
class FakeTable {
  constructor() { this.rows = []; }
  insertRow() { this.rows.push(new Cell('tr')); return this.rows.at(-1); }
  deleteRow() { this.rows.pop(); }
  cell(row, head) { return this.rows[row].cells[this.rows[0].cells.findIndex((cell) => cell.textContent === head)]; }
}

test('stale and missed counts are red, and values that are old are dimmed', () => {
  globalThis.document = { createElement: (tag) => new Cell(tag) };
  const table = new FakeTable();
  const row = { name: 'esn', host: 'a', state: 'active', cycles_Hz: 240, stale_inputs: 0, missed_ticks: 3, cpu_percent: 1, resident_MB: 20, age_s: 0.5, message: 'm' };
  participants(table, [row, { ...row, age_s: 9 }]);
  assert.equal(table.cell(1, 'missed').className, 'number bad');
  assert.equal(table.cell(1, 'stale').className, 'number');
  assert.equal(table.cell(1, 'participant').className, '');
  assert.equal(table.cell(2, 'participant').className, 'old');
  assert.equal(table.cell(2, 'age s').className, 'number bad');

  const state = { header: { stamp_ns: 5e9 }, joint_count: 2, joint_kind: ['JOINT_REVOLUTE', 'JOINT_PRISMATIC'], valid: [true, true],
    position_rad: [1, 2], torque_Nm: [3, 4], age_us: [100, 900000] };
  const prediction = { header: { stamp_ns: 4e9 }, valid: [true, true], torque_Nm: [3, 4] };
  const messages = { joint_state: state, torque_prediction: prediction };
  const of = new FakeTable();
  joints(of, { newest: (name) => messages[name] }, ['knee', 'slide']);
  assert.equal(of.cell(1, 'position').textContent, '1.000 rad', 'joints of both kinds');
  assert.equal(of.cell(2, 'position').textContent, '2.000 m');
  assert.equal(of.cell(1, 'position').className, 'number');
  assert.equal(of.cell(2, 'position').className, 'number old', 'lost');
  assert.equal(of.cell(1, 'predicted').className, 'number minor old', 'a second behind');
  state.joint_kind = ['JOINT_PRISMATIC', 'JOINT_PRISMATIC'];
  joints(of, { newest: (name) => messages[name] }, undefined, 3);
  assert.equal(of.cell(1, 'm').className, 'number old', 'nothing came for three seconds');
  assert.equal(of.cell(1, 'N').textContent, '3.00');
});

// A recording of one session whose joint_state change their state at these ticks.
function recordingOf(ticks, changes, asked = []) {
  globalThis.fetch = async (address) => {
    const query = new URL(address, 'http://here').searchParams;
    asked.push(address);
    const parts = [];
    const from = Math.max(Math.ceil(Number(query.get('from_ns')) / TICK_NS), 0);
    const to = Math.min(Math.floor(Number(query.get('to_ns')) / TICK_NS), ticks - 1);
    for (let tick = from; query.get('topics') === 'joint_state' && tick <= to; ++tick) {
      const state = changes.filter(([at]) => at <= tick).at(-1)?.[1] ?? 'ROBOT_DISARMED';
      const view = message('joint_state', tick);
      view.setUint32(4 + 28, STATES.indexOf(state), true);
      const head = new DataView(new ArrayBuffer(14));
      head.setBigInt64(2, BigInt(tick * TICK_NS), true);
      head.setUint32(10, view.byteLength, true);
      parts.push(new Uint8Array(head.buffer), new Uint8Array(view.buffer));
    }
    const body = Buffer.concat(parts);
    return { ok: true, arrayBuffer: async () => body.buffer.slice(body.byteOffset, body.byteOffset + body.length) };
  };
  const topics = topicsOf(['joint_state']);
  const sessions = [{ session: 1, session_id: '1', start_ns: '0', length_s: ((ticks - 1) * TICK_NS) / 1e9, ticks }];
  return { topics, recording: new Recording({ file: 'x.mcap', sessions, topics: [{ topic: 'joint_state', messages: ticks }] }, topics) };
}

test('a recording is surveyed from end to end: events with their times, and how the joints moved', async () => {
  const asked = [];
  const { topics, recording } = recordingOf(13000, [[4000, 'ROBOT_ARMED'], [4001, 'ROBOT_DAMPED'], [9000, 'ROBOT_ESTOPPED']], asked);
  let news = 0;
  const survey = new Survey(recording, topics, () => { ++news; });
  await survey.run();
  assert.deepEqual(survey.events.list.map(({ label, stamp_ns }) => [label, stamp_ns / TICK_NS]),
    [['recording started', 0], ['armed', 4000], ['damped', 4001], ['estop', 9000]]);
  assert.ok(asked.length >= 3 && news === asked.length, `${asked.length} ${news}`);
  assert.equal(survey.joints[0].least.filter(Number.isNaN).length, 0);
  assert.equal(survey.joints[0].least.length, COLUMNS);
});

test('a long recording is sampled, and a change between two samples found to the tick', async () => {
  const asked = [];
  const { topics, recording } = recordingOf(400000, [[123457, 'ROBOT_ARMED'], [300000, 'ROBOT_FAULT']], asked);
  const survey = new Survey(recording, topics, () => {});
  await survey.run();
  assert.equal(survey.sampled, true);
  const [, armed, fault] = survey.events.list;
  assert.equal(armed.label, 'armed');
  assert.ok(Math.abs(armed.stamp_ns / TICK_NS - 123457) <= 2, `${armed.stamp_ns / TICK_NS}`);
  assert.ok(Math.abs(fault.stamp_ns / TICK_NS - 300000) <= 2, `${fault.stamp_ns / TICK_NS}`);
  assert.ok(asked.length < 500, `${asked.length} requests`);
});

test('times under the overview are round, and have room', () => {
  assert.equal(stepOf(20, 1280), 1);
  assert.equal(stepOf(20, 380), 5);
  assert.equal(stepOf(3600, 1280), 300);
  assert.ok(stepOf(1e6, 300) >= (1e6 * 64) / 300);
});

// As much of the elements of the timeline as it uses.
class Part {
  constructor() { Object.assign(this, { on: {}, hidden: true, children: [] }); }
  addEventListener(name, call) { this.on[name] = call; }
  replaceChildren(...children) { this.children = children; }
}

test('keys and speed move through a recording', () => {
  globalThis.Option = class { constructor(text, value) { Object.assign(this, { text, value }); } };
  const { recording } = recordingOf(2501, []);  // 10 s
  const parts = new Map();
  const element = new Part();
  element.querySelector = (name) => {
    if (!parts.has(name)) parts.set(name, new Part());
    return parts.get(name);
  };
  const timeline = new Timeline(recording, element, { on_move: () => {}, on_session: () => {} });
  timeline.select(1, 5);
  for (const [key, shift, at_s] of [['ArrowRight', false, 6], ['ArrowLeft', true, 5.9], ['End', false, 10], ['ArrowRight', false, 10], ['Home', false, 0], ['ArrowLeft', false, 0]]) {
    assert.equal(timeline.key(key, shift), true);
    assert.ok(Math.abs(recording.at_s - at_s) < 1e-9, `${key}: ${recording.at_s}`);
  }
  assert.equal(timeline.key('x'), false);
  assert.equal(timeline.key(' '), true);
  assert.equal(recording.playing, true);
  parts.get('#speed').value = '10';
  parts.get('#speed').on.change();
  timeline.step(1000);
  timeline.step(1100);
  assert.ok(Math.abs(recording.at_s - 1) < 1e-9, `${recording.at_s}`);
  timeline.setSpeed(0.1);
  timeline.step(2100);
  assert.ok(Math.abs(recording.at_s - 1.1) < 1e-9, `${recording.at_s}`);
  timeline.key(' ');
  assert.equal(recording.playing, false);
  timeline.setSpeed(3);
  assert.ok(parts.get('#speed').children.some(({ text }) => text === '3 x'), 'of a link');
});

test('limits that the page of the docs states are those of the code', () => {
  const text = readFileSync(new URL('../../../docs/participants/view.md', import.meta.url), 'utf8').replace(/\s+/g, ' ');
  for (const limit of [`up to ${MOST_BYTES >> 20} MiB`, `more than ${String(MOST_TICKS).replace(/(\d{3})$/, ' $1')} ticks`, `at ${SAMPLES} moments`,
    `${SPEEDS[0]} to ${SPEEDS.at(-1)} times as fast`, `${leastRange('rad')} rad)`]) assert.ok(text.includes(limit), limit);
});
