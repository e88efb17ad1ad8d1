// The page at three widths, light and dark, in a real Chromium: no text is cut, none lies over another.
// Usage: node layout_check.mjs ADDRESS PREFIX: pictures are PREFIX_WIDTH_SCHEME.png; prints JSON {findings: [...], errors: [...]}.
import { writeFileSync } from 'node:fs';
import { Chromium, pause } from './chromium.mjs';

const [address, prefix] = process.argv.slice(2);
const WIDTHS = [1400, 900, 400];
const SCHEMES = ['light', 'dark'];
const HEIGHT = 1000;
const MOST_HEIGHT = 4000;  // of a picture
const SETTLE_MS = 2500;    // tables are drawn 4 times a second, the participants of a recording are asked for
const LIMIT_MS = 140000;
const chromium = new Chromium();

// In the page. Texts that are seen, with the rectangles of their lines; then what is wrong with them.
function findings() {
  const most_px = 1;  // of rounding
  const texts = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const element = node.parentElement;
    if (!node.textContent.trim() || !element.checkVisibility({ checkOpacity: false, checkVisibilityCSS: true })) continue;
    if (element.closest('script, style, datalist, option')) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const box of range.getClientRects()) if (box.width > 0 && box.height > 0) texts.push({ text: node.textContent.trim(), element, box });
  }
  const found = [];
  const name = ({ text, element }) => `'${text.slice(0, 60)}' in ${element.closest('[id]')?.id ?? element.tagName}`;
  if (document.documentElement.scrollWidth > innerWidth + most_px) found.push(`the page is ${document.documentElement.scrollWidth} px wide`);
  for (const text of texts) {
    const { element, box } = text;
    if (box.right > innerWidth + most_px || box.left < -most_px) found.push(`beyond the page: ${name(text)}`);
    for (let outer = element; outer && outer !== document.body; outer = outer.parentElement) {
      const { overflowX, overflowY } = getComputedStyle(outer);
      const edge = outer.getBoundingClientRect();
      // What is longer than its list is scrolled down to; sideways nothing is. A message of one line has its whole text as its title.
      if (overflowX !== 'visible' && !(outer.matches('.wide') && outer.title) && (box.right > edge.right + most_px || box.left < edge.left - most_px)) {
        found.push(`cut sideways: ${name(text)}`);
        break;
      }
      if (overflowY === 'hidden' && (box.bottom > edge.bottom + most_px || box.top < edge.top - most_px)) {
        found.push(`cut below: ${name(text)}`);
        break;
      }
    }
  }
  // The head stays above what is scrolled, and a list that is open lies over the page.
  const flat = texts.filter(({ element }) => !element.closest('header, .sheet'));
  const shown = flat.filter(({ element, box }) => {
    const scroll = element.closest('.scroll')?.getBoundingClientRect();
    return !scroll || (box.bottom <= scroll.bottom + most_px && box.top >= scroll.top - most_px);
  });
  for (let i = 0; i < shown.length; ++i) {
    for (let j = i + 1; j < shown.length; ++j) {
      const [a, b] = [shown[i].box, shown[j].box];
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 2 && down > 4) found.push(`over one another: ${name(shown[i])}, ${name(shown[j])}`);
    }
  }
  // Numbers of the axes are drawn: they are to fit beside the plot.
  for (const plot of window.sinew.plots.list.filter((one) => one.uplot)) {
    for (const axis of plot.uplot.axes.slice(1)) {
      const context = plot.uplot.ctx;
      context.save();
      context.font = `${11 * devicePixelRatio}px system-ui`;
      for (const text of axis._values ?? []) {
        if (context.measureText(text).width / devicePixelRatio + 10 > axis._size) found.push(`cut: '${text}' of an axis of ${plot.title}`);
      }
      context.restore();
    }
  }
  return found;
}

async function run() {
  await chromium.open();
  const all = [];
  for (const scheme of SCHEMES) {
    for (const width of WIDTHS) {
      const size = (height) => chromium.page('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: width < 600 });
      await size(HEIGHT);
      await chromium.page('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: scheme }] });
      await chromium.go(address, '(window.sinew?.topics.topics.size ?? 0) > 0');  // a robot may be absent
      await pause(SETTLE_MS);
      for (const one of await chromium.evaluate(`(${findings})()`)) all.push(`${width} px, ${scheme}: ${one}`);
      const height = Math.min(await chromium.evaluate('document.documentElement.scrollHeight'), MOST_HEIGHT);
      await size(Math.max(height, HEIGHT));
      await pause(500);
      writeFileSync(`${prefix}_${width}_${scheme}.png`, await chromium.picture({ x: 0, y: 0, scale: 1, width, height }));
    }
  }
  console.log(JSON.stringify({ findings: all, errors: chromium.errors }));
  return all.length + chromium.errors.length === 0 ? 0 : 1;
}

chromium.endWithin(LIMIT_MS);
run().then((code) => chromium.end(code), (error) => {
  console.error(error.message);
  chromium.end(1);
});
