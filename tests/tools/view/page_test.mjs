// Modules of the page without a browser: CDR against our own encoder, signals by tick, plots that show every sample.
// Usage: SINEW_EXPECTED=EXPECTED.jsonl node --test page_test.mjs (the file is idl_write_sample's)
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { decode, getter, numberPaths, parseIdl } from '../../../tools/view/page/cdr.js';
import { Table, plotData } from '../../../tools/view/page/series.js';
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

test('rows are ticks: gaps stay empty, the oldest go, time rises', () => {
  const table = new Table(8);
  const column = table.column('a');
  const put = (tick, value) => {
    if (table.open(tick, 1e9 + tick * 1e8)) column[tick % 8] = value;
  };
  for (const tick of [100, 101, 104]) put(tick, tick);
  assert.deepEqual(plotData(table, ['a'], -1, 9, 100)[1], [100, 101, null, null, 104]);
  put(102, 102);  // late, and still kept
  assert.deepEqual(plotData(table, ['a'], -1, 9, 100)[1], [100, 101, 102, null, 104]);
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
  const [times, values] = plotData(table, ['a', 'nothing'], 0, 4, 300);
  assert.ok(times.length <= 2 * 301 && times.length > 300);
  assert.equal(times.length, values.length);
  assert.equal(Math.max(...values), 5);
  assert.equal(Math.min(...values), -7);
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
