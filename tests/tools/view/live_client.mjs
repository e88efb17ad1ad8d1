// What the system test asks of a running sinew-view, with Foxglove's own client (vendor/README.md).
// Usage: node live_client.mjs PORT receive COUNT | operate | observe | record FILE.json | recorded FILE.json
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { decode, parseIdl } from '../../../tools/view/page/cdr.js';

const { FoxgloveClient, WebSocket } = createRequire(import.meta.url)('./vendor/foxglove_client.cjs');
const [port, what, argument] = process.argv.slice(2);
const site = `http://127.0.0.1:${port}`;
const LIMIT_MS = 20000;

async function until(question, about) {
  for (const end = Date.now() + LIMIT_MS; Date.now() < end;) {
    const answer = await question();
    if (answer) return answer;
    await new Promise((resume) => { setTimeout(resume, 50); });
  }
  throw new Error(`not within ${LIMIT_MS} ms: ${about}`);
}

const status = async () => (await fetch(`${site}/api/status`)).json();
const stateIs = (state) => until(async () => (await status()).robot_state === state, `the robot is ${state}`);

async function tokenOfPage() {
  const page = await (await fetch(site)).text();
  return /name="sinew-token" content="([0-9a-f]{32})"/.exec(page)[1];
}

async function post(path, headers) {
  const reply = await fetch(`${site}/api/${path}`, { method: 'POST', headers });
  await reply.text();
  return reply.status;
}

// COUNT messages of joint_state, every one after the other.
async function receive(count) {
  const client = new FoxgloveClient({ ws: new WebSocket(`ws://127.0.0.1:${port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  const ticks = [];
  let type;
  await new Promise((done, fail) => {
    setTimeout(() => fail(new Error(`${ticks.length} of ${count} messages`)), LIMIT_MS).unref();
    client.on('error', fail);
    client.on('status', (report) => fail(new Error(report.message)));
    client.on('serverInfo', (info) => assert.deepEqual(info.capabilities, []));
    client.on('advertise', (channels) => {
      const channel = channels.find((other) => other.topic === 'joint_state');
      assert.equal(channel.encoding, 'cdr');
      assert.equal(channel.schemaEncoding, 'omgidl');
      type = parseIdl(channel.schema).get(channel.schemaName);
      client.subscribe(channel.id);
    });
    client.on('message', ({ data, timestamp }) => {
      const state = decode(type, new DataView(data.buffer, data.byteOffset, data.byteLength));
      assert.ok(Math.abs(Number(timestamp) * 1e-6 - Date.now()) < LIMIT_MS, 'the stamp is the time of reception');
      assert.equal(state.joint_count, 1);
      ticks.push(state.header.tick);
      if (ticks.length >= count) done();
    });
  });
  const missing = ticks.at(-1) - ticks[0] + 1 - ticks.length;
  console.log(JSON.stringify({ received: ticks.length, missing }));
  assert.ok(ticks.every((tick, i) => i === 0 || tick === ticks[i - 1] + 1), `${missing} ticks missing`);
  client.close();
}

async function operate() {
  const token = await tokenOfPage();
  const good = { 'X-Sinew-Token': token, Origin: site };
  await stateIs('disarmed');
  assert.equal(await post('arm', {}), 403);
  assert.equal(await post('arm', { ...good, Origin: 'http://evil.example' }), 403);
  assert.equal(await post('estop', { ...good, 'X-Sinew-Token': '0'.repeat(32) }), 403);
  assert.equal((await status()).robot_state, 'disarmed');
  assert.equal(await post('arm', good), 202);
  await stateIs('armed');
  // Somebody looks and leaves: nothing changes.
  const socket = new WebSocket(`ws://127.0.0.1:${port}`, ['foxglove.websocket.v1']);
  await new Promise((resume) => { socket.on('open', resume); });
  socket.terminate();
  await until(async () => (await status()).clients.length === 0, 'the client is gone');
  assert.equal((await status()).robot_state, 'armed');
  assert.equal(await post('estop', good), 202);
  await stateIs('estopped');
  await until(async () => (await status()).action.done, 'the estop is confirmed');
  assert.equal(await post('reset', good), 202);
  await stateIs('disarmed');
  assert.equal(await post('nothing', good), 404);
}

// A server without --allow-arming: estop and disarm only.
async function observe() {
  const good = { 'X-Sinew-Token': await tokenOfPage(), Origin: site };
  assert.equal(await post('arm', good), 403);
  assert.equal(await post('reset', good), 403);
  assert.equal(await post('disarm', good), 202);
  const info = await (await fetch(`${site}/api/info`)).json();
  assert.deepEqual(info.robot, { driven: ['joint'], moving: ['joint'] });
  assert.match(await (await fetch(`${site}/robot.urdf`)).text(), /<robot name="rig">/);
  assert.equal((await fetch(`${site}/robot/../robot.urdf.secret`)).status, 404);
  assert.equal((await fetch(`${site}/../../etc/passwd`)).status, 404);
  assert.equal((await fetch(`${site}/main.js`)).headers.get('content-type'), 'text/javascript; charset=utf-8');
  const row = await until(async () => (await status()).participants.find((other) => other.name === 'surrogate' && other.cpu_percent !== null),
    'the surrogate with its load');
  assert.equal(row.state, 'active');
  assert.ok(row.cycles_Hz > 100 && row.resident_MB > 1 && row.cpu_percent >= 0, JSON.stringify(row));
  const topic = (await status()).topics.find((other) => other.name === 'joint_state');
  assert.ok(topic.rate_Hz > 100, JSON.stringify(topic));
}

async function record(file) {
  const good = { 'X-Sinew-Token': await tokenOfPage(), Origin: site };
  assert.equal(await post('record/start', good), 202);
  const running = await until(async () => {
    const now = await status();
    return now.recording.running && now.participants.some((row) => row.name === 'view-logger' && row.cycles > 300) && now;
  }, 'the logger writes');
  assert.equal(await post('record/stop', good), 202);
  await until(async () => !(await status()).recording.running, 'the logger has ended');
  assert.equal((await status()).recording.problem, '');
  writeFileSync(file, JSON.stringify({ file: running.recording.file }));
}

// The server shows that recording.
async function recorded() {
  const info = await (await fetch(`${site}/api/info`)).json();
  assert.equal(info.mode, 'recording');
  const described = await (await fetch(`${site}/api/recording`)).json();
  assert.equal(described.sessions.length, 1);
  const [session] = described.sessions;
  assert.equal(session.length_s, Number(BigInt(session.end_ns) - BigInt(session.start_ns)) / 1e9);
  const topic = described.topics.findIndex((other) => other.topic === 'joint_state');
  const { messages } = described.topics[topic];
  assert.equal(session.ticks, messages);
  const ask = (query) => fetch(`${site}/api/recording/messages?${query}`);
  const reply = await ask(`topics=joint_state&from_ns=${session.start_ns}&to_ns=${session.end_ns}`);
  const bytes = new DataView(await reply.arrayBuffer());
  const stampsOf = (view) => {
    const stamps = [];
    for (let at = 0; at < view.byteLength; at += 14 + view.getUint32(at + 10, true)) {
      assert.equal(view.getUint16(at, true), topic);
      stamps.push(view.getBigInt64(at + 2, true));
    }
    return stamps;
  };
  const stamps = stampsOf(bytes);
  assert.ok(stamps.every((stamp, i) => i === 0 || stamp > stamps[i - 1]));
  assert.equal(stamps.length, messages);
  assert.equal(stamps.at(-1).toString(), session.end_ns);
  const middle = (BigInt(session.start_ns) + BigInt(session.end_ns)) / 2n;
  const half = await (await ask(`topics=joint_state&from_ns=${middle}&to_ns=${session.end_ns}`)).arrayBuffer();
  assert.deepEqual(stampsOf(new DataView(half)), stamps.filter((stamp) => stamp >= middle));
  assert.equal((await ask('topics=joint_state&from_ns=1')).status, 400);
  assert.equal((await ask('topics=joint_state&from_ns=x&to_ns=1')).status, 400);
  assert.equal((await ask(`session=2&topics=joint_state&from_ns=0&to_ns=${session.end_ns}`)).status, 400);
  const rows = await (await fetch(`${site}/api/recording/participants?at_ns=${session.end_ns}`)).json();
  const row = rows.find((other) => other.name === 'surrogate');
  assert.ok(row, JSON.stringify(rows));
  assert.equal(row.state, 'active');
  assert.ok(row.age_s >= 0 && row.age_s < 2.5 && row.resident_MB > 1 && row.cpu_percent === null, JSON.stringify(row));
  assert.equal(await post('estop', { 'X-Sinew-Token': await tokenOfPage(), Origin: site }), 409);
  console.log(JSON.stringify({ messages }));
}

if (what === 'receive') await receive(Number(argument));
else if (what === 'operate') await operate();
else if (what === 'observe') await observe();
else if (what === 'record') await record(argument);
else if (what === 'recorded') await recorded();
else throw new Error(`'${what}', expected receive, operate, observe, record or recorded`);
process.exit(0);
