// The whole length of a recording in one strip: position of the joint that is chosen, events, the window of the plots, the
// moment. A click, or a drag, goes there.

import { colourOf, labelled } from './marks.js';
import { COLUMNS } from './survey.js';

const FONT_PX = 10;
const LABEL_ROWS = 2;
const BASE_PX = 14;   // of the times, at the lower edge
const STEPS_S = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400];
const LEAST_STEP_PX = 64;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Distance of the times that are written under a strip of that width.
export function stepOf(length_s, width_px) {
  const least_s = (length_s * LEAST_STEP_PX) / Math.max(width_px, 1);
  return STEPS_S.find((step) => step >= least_s) ?? STEPS_S.at(-1) * Math.ceil(least_s / STEPS_S.at(-1));
}

export class Overview {
  // on_pick(time_s).
  constructor(canvas, recording, survey, { on_pick, want }) {
    this.canvas = canvas;
    this.recording = recording;
    this.survey = survey;
    this.joint = 0;
    this.span = [0, 0];  // of the plots
    const pick = (event) => {
      const box = canvas.getBoundingClientRect();
      on_pick(((event.clientX - box.left) / box.width) * recording.length_s);
    };
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      pick(event);
    });
    canvas.addEventListener('pointermove', (event) => { if (canvas.hasPointerCapture(event.pointerId)) pick(event); });
    new ResizeObserver(want).observe(canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', want);
  }

  draw() {
    const { canvas, recording, survey } = this;
    const ratio = devicePixelRatio;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (width === 0) return false;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    canvas.setAttribute('aria-valuemax', recording.length_s.toFixed(2));
    canvas.setAttribute('aria-valuenow', recording.at_s.toFixed(2));
    const c = canvas.getContext('2d');
    const length_s = Math.max(recording.length_s, 1e-9);
    const at = (time_s) => (time_s / length_s) * width;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    c.font = `${FONT_PX}px system-ui, "DejaVu Sans", sans-serif`;
    c.fillStyle = css('--accent');
    c.globalAlpha = 0.16;
    c.fillRect(at(this.span[0]), 0, Math.max(at(this.span[1]) - at(this.span[0]), 1), height - BASE_PX);
    c.globalAlpha = 1;
    this.drawTimes(c, at, width, height, length_s);
    this.drawJoint(c, width, height);
    this.drawEvents(c, at, width, height, survey.events.marks(Number(recording.start_ns)));
    c.fillStyle = css('--text');
    c.fillRect(at(recording.at_s) - 1, 0, 2, height - BASE_PX);
    return true;
  }

  drawTimes(c, at, width, height, length_s) {
    const step_s = stepOf(length_s, width);
    c.fillStyle = css('--quiet');
    c.strokeStyle = css('--line');
    c.textBaseline = 'bottom';
    for (let time_s = 0; time_s <= length_s; time_s += step_s) {
      const x = at(time_s);
      const text = `${Number(time_s.toFixed(1))} s`;
      c.beginPath();
      c.moveTo(x, 0);
      c.lineTo(x, height - BASE_PX);
      c.stroke();
      if (x + c.measureText(text).width + 2 < width) c.fillText(text, x + 2, height);
    }
  }

  drawJoint(c, width, height) {
    const joint = this.survey.joints[this.joint];
    if (!joint) return;
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < COLUMNS; ++i) {
      if (joint.least[i] < low) low = joint.least[i];
      if (joint.greatest[i] > high) high = joint.greatest[i];
    }
    if (low > high) return;
    const room = height - BASE_PX - 6;
    const scale = high > low ? room / (high - low) : 0;
    const y = (value) => 3 + (scale > 0 ? (high - value) * scale : room / 2);
    c.strokeStyle = css('--accent');
    c.beginPath();
    let drawing = false;
    for (let i = 0; i < COLUMNS; ++i) {
      if (Number.isNaN(joint.least[i])) {
        if (!this.survey.sampled && i * width > COLUMNS) drawing = drawing && width < COLUMNS;
        continue;
      }
      const x = ((i + 0.5) / COLUMNS) * width;
      if (drawing) c.lineTo(x, y(joint.greatest[i]));
      else c.moveTo(x, y(joint.greatest[i]));
      c.lineTo(x, y(joint.least[i]));
      drawing = true;
    }
    c.stroke();
  }

  drawEvents(c, at, width, height, events) {
    c.textBaseline = 'top';
    const widths = events.map(({ label }) => c.measureText(label).width + 6);
    const places = events.map(({ time_s }, i) => [at(time_s) + widths[i] > width ? Math.max(at(time_s) - widths[i], 0) : at(time_s), widths[i]]);
    const rows = labelled(events, places, width + 1, LABEL_ROWS);
    for (const { time_s, kind } of events) {
      c.fillStyle = colourOf(kind);
      c.fillRect(at(time_s) - 0.5, 0, 1, height - BASE_PX);
    }
    events.forEach(({ label, kind }, i) => {
      if (rows[i] < 0) return;
      const y = 1 + rows[i] * (FONT_PX + 2);
      c.globalAlpha = 0.8;
      c.fillStyle = css('--card');
      c.fillRect(places[i][0] + 1, y, places[i][1] - 2, FONT_PX + 2);
      c.globalAlpha = 1;
      c.fillStyle = colourOf(kind);
      c.fillText(label, places[i][0] + 3, y + 1);
    });
  }
}
