// The page in a real Chromium, without a display, by the DevTools protocol.
// Usage: node browser.mjs ADDRESS SECONDS PICTURE.png [BUTTON]: opens the page, lets it run, presses a button, prints figures as JSON.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const { WebSocket } = createRequire(import.meta.url)('./vendor/foxglove_client.cjs');
const [address, seconds, picture, button] = process.argv.slice(2);
const START_MS = 60000;
const LIMIT_MS = 140000;  // the browser ends with this program: below the test's own limit
const folder = mkdtempSync(join(tmpdir(), 'sinew_browser.'));
// Without --disable-gpu a browser that has none draws canvases in a process of its own, once a second: the page would seem to
// cost nothing.
const chromium = spawn('chromium', ['--headless=new', '--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader',
  '--remote-debugging-port=0', `--user-data-dir=${folder}`, '--window-size=1500,1250', '--hide-scrollbars', 'about:blank'],
{ stdio: ['ignore', 'ignore', 'pipe'] });

function end(code) {
  chromium.on('exit', () => {
    rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
    process.exit(code);
  });
  chromium.kill('SIGKILL');
}

const pause = (ms) => new Promise((resume) => { setTimeout(resume, ms); });

async function run() {
  const endpoint = await new Promise((done, fail) => {
    let log = '';
    setTimeout(() => fail(new Error(`chromium did not start: ${log}`)), START_MS).unref();
    chromium.on('error', fail);
    chromium.stderr.on('data', (data) => {
      log += data;
      const found = /DevTools listening on (ws:\S+)/.exec(log);
      if (found) done(found[1]);
    });
  });
  const socket = new WebSocket(endpoint, { maxPayload: 1 << 28 });
  await new Promise((resume) => { socket.on('open', resume); });
  const waiting = new Map();
  const errors = [];
  let next = 1;
  socket.on('message', (data) => {
    const message = JSON.parse(data);
    if (message.id) waiting.get(message.id)(message);
    if (message.method === 'Runtime.exceptionThrown') errors.push(message.params.exceptionDetails.exception?.description ?? 'exception');
    if (message.method === 'Log.entryAdded' && message.params.entry.level === 'error') errors.push(`${message.params.entry.text} ${message.params.entry.url ?? ''}`);
  });
  const call = async (method, params = {}, sessionId = undefined) => {
    const id = next++;
    const reply = await new Promise((resume) => {
      waiting.set(id, resume);
      socket.send(JSON.stringify({ id, method, params, sessionId }));
    });
    if (reply.error) throw new Error(`${method}: ${reply.error.message}`);
    return reply.result;
  };
  const { targetId } = await call('Target.createTarget', { url: 'about:blank' });
  const { sessionId } = await call('Target.attachToTarget', { targetId, flatten: true });
  const page = (method, params) => call(method, params, sessionId);
  const evaluate = async (expression) => (await page('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true })).result.value;
  for (const domain of ['Page', 'Runtime', 'Log']) await page(`${domain}.enable`);
  // CPU time of the page's thread: a busy machine makes it no longer.
  await page('Performance.enable', { timeDomain: 'threadTicks' });
  await page('Page.navigate', { url: address });
  const running = '(window.sinew?.figures().received ?? 0) + (window.sinew?.topics.table.end ?? 0) > 0';
  for (const limit = Date.now() + START_MS; !(await evaluate(running));) {
    if (Date.now() > limit) throw new Error(`the page does not run: ${errors.join('; ')}`);
    await pause(100);
  }
  await pause(1000);  // its first layout
  const measure = async () => {
    const { metrics } = await page('Performance.getMetrics');
    const value = (name) => metrics.find((metric) => metric.name === name).value;
    return { at_s: performance.now() / 1000, task_s: value('TaskDuration'), script_s: value('ScriptDuration'), page: await evaluate('window.sinew.figures()') };
  };
  const before = await measure();
  await pause(Number(seconds) * 1000);
  const after = await measure();
  if (button) {
    await evaluate(`document.getElementById('${button}').click()`);
    await pause(1500);
  }
  const clip = await evaluate("({ x: 0, y: 0, scale: 1, width: innerWidth, height: Math.min(innerHeight, document.querySelector('main').getBoundingClientRect().bottom) })");
  const shot = await page('Page.captureScreenshot', { format: 'png', clip });
  writeFileSync(picture, Buffer.from(shot.data, 'base64'));
  const elapsed_s = after.at_s - before.at_s;
  console.log(JSON.stringify({
    seconds: elapsed_s, task_share: (after.task_s - before.task_s) / elapsed_s, script_share: (after.script_s - before.script_s) / elapsed_s,
    samples_per_s: (after.page.samples - before.page.samples) / elapsed_s, lost: after.page.lost, signals: after.page.signals,
    draws_per_s: (after.page.plot_draws - before.page.plot_draws) / elapsed_s,
    plot_share: (after.page.plot_ms - before.page.plot_ms) / 1000 / elapsed_s,  // of its script; task_share has all that it makes
    message_share: (after.page.message_ms - before.page.message_ms) / 1000 / elapsed_s,
    robot_frames_per_s: (after.page.robot_frames - before.page.robot_frames) / elapsed_s,
    robot_share: (after.page.robot_ms - before.page.robot_ms) / 1000 / elapsed_s,
    client: after.page.received > 0 ? (await evaluate("fetch('/api/status').then((reply) => reply.json())")).clients.at(-1) : null,
    received: await evaluate('window.sinew.figures().received'),
    participants: await evaluate("document.querySelectorAll('#participants tr').length - 1"),
    robot_state: await evaluate("document.getElementById('robot_state').textContent"),
    message: await evaluate("document.getElementById('message').textContent"), errors,
  }));
  return errors.length === 0 ? 0 : 1;
}

process.on('SIGTERM', () => end(1));
setTimeout(() => {
  console.error(`not done within ${LIMIT_MS} ms`);
  end(1);
}, LIMIT_MS).unref();
run().then(end, (error) => {
  console.error(error.message);
  end(1);
});
