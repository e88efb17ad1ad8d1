// A real Chromium without a display, by the DevTools protocol.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const { WebSocket } = createRequire(import.meta.url)('./vendor/foxglove_client.cjs');
export const START_MS = 60000;
export const pause = (ms) => new Promise((resume) => { setTimeout(resume, ms); });

export class Chromium {
  constructor() {
    this.folder = mkdtempSync(join(tmpdir(), 'sinew_browser.'));
    // Without --disable-gpu a browser that has none draws canvases in a process of its own, once a second: the page would seem
    // to cost nothing.
    this.process = spawn('chromium', ['--headless=new', '--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader',
      '--remote-debugging-port=0', `--user-data-dir=${this.folder}`, '--window-size=1500,1250', '--hide-scrollbars', 'about:blank'],
    { stdio: ['ignore', 'ignore', 'pipe'] });
    this.errors = [];  // of the page
    process.on('SIGTERM', () => this.end(1));
  }

  // Ends this program too, with that exit code.
  end(code) {
    this.process.on('exit', () => {
      rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
      process.exit(code);
    });
    this.process.kill('SIGKILL');
  }

  // Ends it when that takes longer than allowed, below the limit of the test itself.
  endWithin(limit_ms) {
    setTimeout(() => {
      console.error(`not done within ${limit_ms} ms`);
      this.end(1);
    }, limit_ms).unref();
  }

  // A page that is empty.
  async open() {
    const endpoint = await new Promise((done, fail) => {
      let log = '';
      setTimeout(() => fail(new Error(`chromium did not start: ${log}`)), START_MS).unref();
      this.process.on('error', fail);
      this.process.stderr.on('data', (data) => {
        log += data;
        const found = /DevTools listening on (ws:\S+)/.exec(log);
        if (found) done(found[1]);
      });
    });
    this.socket = new WebSocket(endpoint, { maxPayload: 1 << 28 });
    await new Promise((resume) => { this.socket.on('open', resume); });
    this.waiting = new Map();
    this.next = 1;
    this.socket.on('message', (data) => this.take(JSON.parse(data)));
    const { targetId } = await this.call('Target.createTarget', { url: 'about:blank' });
    this.session = (await this.call('Target.attachToTarget', { targetId, flatten: true })).sessionId;
    for (const domain of ['Page', 'Runtime', 'Log']) await this.page(`${domain}.enable`);
  }

  take(message) {
    if (message.id) this.waiting.get(message.id)(message);
    if (message.method === 'Runtime.exceptionThrown') this.errors.push(message.params.exceptionDetails.exception?.description ?? 'exception');
    if (message.method === 'Log.entryAdded' && message.params.entry.level === 'error') {
      this.errors.push(`${message.params.entry.text} ${message.params.entry.url ?? ''}`);
    }
  }

  async call(method, params = {}, sessionId = undefined) {
    const id = this.next++;
    const reply = await new Promise((resume) => {
      this.waiting.set(id, resume);
      this.socket.send(JSON.stringify({ id, method, params, sessionId }));
    });
    if (reply.error) throw new Error(`${method}: ${reply.error.message}`);
    return reply.result;
  }

  page(method, params) { return this.call(method, params, this.session); }

  async evaluate(expression) {
    const reply = await this.page('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    if (reply.exceptionDetails) throw new Error(reply.exceptionDetails.exception?.description ?? expression);
    return reply.result.value;
  }

  // Goes to an address and waits until data have come, or until something else is so.
  async go(address, running = '(window.sinew?.figures().received ?? 0) + (window.sinew?.topics.table.end ?? 0) > 0') {
    await this.page('Page.navigate', { url: address });
    for (const limit = Date.now() + START_MS; !(await this.evaluate(running));) {
      if (Date.now() > limit) throw new Error(`the page does not run: ${this.errors.join('; ')}`);
      await pause(100);
    }
  }

  async picture(clip) {
    return Buffer.from((await this.page('Page.captureScreenshot', { format: 'png', clip })).data, 'base64');
  }
}
