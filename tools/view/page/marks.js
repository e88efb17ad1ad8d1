// What is drawn over the lines of a plot: events as labelled marks, ticks that are missing or stale in red.

const FONT_PX = 10;
const ROWS = 3;    // of labels: those that do not fit into them are left out, their lines are not
const MANY = 12;   // events in view: of more only those that one must not miss have their labels
const GAP_PX = 5;  // height of the red at the lower edge
const LEAST_PX = 2;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const COLOURS = { good: '--good', bad: '--bad', warn: '--warn', note: '--accent', quiet: '--quiet', cursor: '--text' };
export const colourOf = (kind) => css(COLOURS[kind] ?? '--quiet');

// Where labels of these widths go that begin at these places, from the left on: row of each, -1: none is free. right: edge.
export function rowsOf(places, right, rows = ROWS) {
  const ends = Array.from({ length: rows }, () => -Infinity);
  return places.map(([at, width]) => {
    const row = at + width > right ? -1 : ends.findIndex((end) => end <= at);
    if (row >= 0) ends[row] = at + width;
    return row;
  });
}

// The rows of the labels of events; -1: it has none.
export function labelled(events, places, right, rows = ROWS) {
  const has = events.map(({ label, kind }) => label !== '' && (events.length <= MANY || kind === 'bad' || kind === 'note'));
  const given = rowsOf(places.filter((_, i) => has[i]), right, rows);
  return has.map((one) => (one ? given.shift() : -1));
}

// events: [{time_s, label, kind}], by time.
export function drawEvents(uplot, events) {
  const { left, top, width, height } = uplot.bbox;
  const { min, max } = uplot.scales.x;
  const seen = events.filter(({ time_s }) => time_s >= min && time_s <= max);
  if (seen.length === 0) return;
  const { ctx } = uplot;
  const ratio = devicePixelRatio;
  ctx.save();
  ctx.font = `${FONT_PX * ratio}px system-ui, "DejaVu Sans", sans-serif`;
  ctx.textBaseline = 'top';
  ctx.textAlign = 'left';
  const at = seen.map(({ time_s }) => left + ((time_s - min) / (max - min)) * width);
  const widths = seen.map(({ label }) => ctx.measureText(label).width + 6 * ratio);
  // A label that would be cut at the right edge stands on the left of its line.
  const places = at.map((x, i) => [x + widths[i] > left + width ? Math.max(x - widths[i], left) : x, widths[i]]);
  const rows = labelled(seen, places, left + width + 1);
  seen.forEach(({ kind }, i) => {
    ctx.strokeStyle = colourOf(kind);
    ctx.lineWidth = ratio;
    ctx.setLineDash(kind === 'cursor' ? [] : [4 * ratio, 3 * ratio]);
    ctx.beginPath();
    ctx.moveTo(at[i], top);
    ctx.lineTo(at[i], top + height);
    ctx.stroke();
  });
  // Above the lines of all.
  seen.forEach(({ label, kind }, i) => {
    if (rows[i] < 0) return;
    const y = top + (2 + rows[i] * (FONT_PX + 3)) * ratio;
    ctx.fillStyle = css('--card');
    ctx.globalAlpha = 0.8;
    ctx.fillRect(places[i][0] + ratio, y, places[i][1] - 2 * ratio, (FONT_PX + 2) * ratio);
    ctx.globalAlpha = 1;
    ctx.fillStyle = colourOf(kind);
    ctx.fillText(label, places[i][0] + 3 * ratio, y + ratio);
  });
  ctx.restore();
}

// spans: [[from_s, to_s]].
export function drawGaps(uplot, spans) {
  const { left, top, width, height } = uplot.bbox;
  const { min, max } = uplot.scales.x;
  const { ctx } = uplot;
  const seen = spans.filter(([from_s, to_s]) => to_s >= min && from_s <= max);
  if (seen.length === 0) return;
  ctx.save();
  ctx.fillStyle = colourOf('bad');
  for (const [from_s, to_s] of seen) {
    const from = left + Math.max((from_s - min) / (max - min), 0) * width;
    const to = left + Math.min((to_s - min) / (max - min), 1) * width;
    const least = LEAST_PX * devicePixelRatio;
    ctx.fillRect(from - least / 2, top + height - GAP_PX * devicePixelRatio, Math.max(to - from, least), GAP_PX * devicePixelRatio);
  }
  ctx.restore();
}
