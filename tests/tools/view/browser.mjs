// The page in a real Chromium, without a display, by the DevTools protocol.
// Usage: node browser.mjs ADDRESS SECONDS PICTURE.png [BUTTON]: opens the page, lets it run, presses a button, prints figures as JSON.
import { writeFileSync } from 'node:fs';
import { Chromium, pause } from './chromium.mjs';

const [address, seconds, picture, button] = process.argv.slice(2);
const LIMIT_MS = 140000;
const chromium = new Chromium();

async function run() {
  await chromium.open();
  const page = (method, params) => chromium.page(method, params);
  const evaluate = (expression) => chromium.evaluate(expression);
  const { errors } = chromium;
  // CPU time of the page's thread: a busy machine makes it no longer.
  await page('Performance.enable', { timeDomain: 'threadTicks' });
  await chromium.go(address);
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
  writeFileSync(picture, await chromium.picture(clip));
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

chromium.endWithin(LIMIT_MS);
run().then((code) => chromium.end(code), (error) => {
  console.error(error.message);
  chromium.end(1);
});
