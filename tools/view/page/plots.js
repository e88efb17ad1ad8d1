// Plots of signals over time (uPlot), with one cursor for all, zoom and pause.
//
// Drag in a plot: zoom; double click: all of the window again. A zoom that ends at the newest data moves on with them; another
// one stays, until its data are gone. Only `Pause` pauses, and the data go on coming meanwhile. A plot that is scrolled out
// of the window is not drawn.

import uPlot from './vendor/uPlot.esm.js';
import { watchVisibility } from './frames.js';
import { drawEvents, drawGaps } from './marks.js';
import { PlotData } from './series.js';
import { widened } from './units.js';

const COLOURS = ['#3987e5', '#e8833a', '#3aa757', '#c94f7c', '#8e6bd8', '#23a6a6', '#b58a00', '#d9534f', '#6b7f95', '#7cb342'];
const LEAST_HEIGHT = 150;
const MOST_HEIGHT = 320;
const DIGITS = 5;
const LINE = 1;  // pixels: wider lines cost several times as much without a GPU
const DOT = 1.5;
const RANGE_PART = 0.1;  // of the values' range, left above and below them
const LEAST_SPAN_S = 0.01;  // at the beginning of a recording
const AT_END = 0.02;  // of the span: a zoom that ends so near to the newest data moves on with them
const SCALES = ['y', 'y2'];  // the axes on the left and on the right, a unit each
const LETTER = 6.6;    // pixels of a digit
const AXIS_FREE = 17;  // beside the numbers
const NARROW = 520;  // pixels: axes of a plot that is narrower take less of it

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Of the axis, for values of a unit from least to greatest (undefined: there are none): a line that is flat lies in the middle.
function rangeOf(values, unit) {
  if (!values) return [0, 1];
  const [least, greatest] = widened(...values, unit);
  if (least < greatest) return uPlot.rangeNum(least, greatest, RANGE_PART, true);
  const around = RANGE_PART * Math.abs(least) || 1;
  return [least - around, least + around];
}

// The line of a signal in pixels of the canvas: NaN ends it, a value between two NaN is a dot.
function linePath(plot, index, first, last) {
  const [times] = plot.data;
  const values = plot.data[index];
  const { x } = plot.scales;
  const y = plot.scales[plot.series[index].scale];
  const { left, top, width, height } = plot.bbox;
  const per_x = width / (x.max - x.min);
  const per_y = height / (y.max - y.min);
  const stroke = new Path2D();
  let drawing = false;
  for (let i = first; i <= last; ++i) {
    const value = values[i];
    if (value !== value) {
      drawing = false;
      continue;
    }
    const at_x = left + (times[i] - x.min) * per_x;
    const at_y = top + (y.max - value) * per_y;
    if (drawing) {
      stroke.lineTo(at_x, at_y);
    } else {
      stroke.moveTo(at_x, at_y);
      drawing = true;
      if (i === last || values[i + 1] !== values[i + 1]) stroke.lineTo(at_x + DOT, at_y);
    }
  }
  return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 0 };
}

class Plot {
  // want(): it is to be drawn again.
  // on_remove(signal): a click on its label; on_hide(): its button.
  constructor(parent, title, { on_zoom, on_remove, on_hide, want, decorate }) {
    this.title = title;
    this.signals = [];
    this.units = [];  // of the signals
    this.axes = [];   // units of the axes, left and right
    this.on_zoom = on_zoom;
    this.on_remove = on_remove;
    this.on_hide = on_hide;
    this.decorate = decorate;
    this.want = want;
    this.read = new PlotData();
    this.ranges = [[0, 1], [0, 1]];
    this.height = LEAST_HEIGHT;
    this.visible = true;
    this.element = document.createElement('section');
    this.element.className = 'plot';
    this.element.hidden = true;
    parent.append(this.element);
    watchVisibility(this.element, (visible) => {
      this.visible = visible;
      if (visible) want();
    });
  }

  // units: of each signal; two different ones at most.
  show(signals, units) {
    if (signals.join() === this.signals.join() && units.join() === this.units.join()) return;
    this.signals = [...signals];
    this.units = [...units];
    this.axes = [...new Set(units)].slice(0, SCALES.length);
    this.make();
    this.want();
  }

  axisOf(i) { return Math.max(this.axes.indexOf(this.units[i]), 0); }

  heading() {
    const bar = document.createElement('div');
    bar.className = 'plot_head';
    const heading = document.createElement('h3');
    const [left, right] = this.axes;
    const units = this.axes.length < 2 ? left : `${left || 'number'} (left), ${right || 'number'} (right)`;
    heading.textContent = units ? `${this.title}, ${units}` : this.title;
    bar.append(heading);
    if (this.on_hide) {
      const button = Object.assign(document.createElement('button'), { className: 'hide', textContent: '\u00d7', title: 'hide this plot' });
      button.setAttribute('aria-label', `hide ${this.title}`);
      button.addEventListener('click', () => this.on_hide());
      bar.append(button);
    }
    return bar;
  }

  make() {
    this.uplot?.destroy();
    this.uplot = undefined;
    this.element.replaceChildren();
    this.element.hidden = this.signals.length === 0;
    if (this.signals.length === 0) return;
    this.element.append(this.heading());
    this.narrow = this.width() < NARROW;
    const line = { stroke: css('--line'), width: 1 };
    const axis = { stroke: css('--quiet'), grid: line, ticks: line, font: '11px system-ui' };
    const numbers = (plot, ticks) => ticks.map((tick) => Number(tick.toPrecision(DIGITS)).toString());
    // As wide as its numbers; the least is that of most plots, so that they stand under one another.
    const width = (plot, values) => Math.max(this.narrow ? 38 : 62, AXIS_FREE + LETTER * Math.max(0, ...(values ?? []).map((text) => text.length)));
    const sides = this.axes.map((_, i) => ({ ...axis, scale: SCALES[i], side: i === 0 ? 3 : 1, size: width, values: numbers,
      grid: i === 0 ? line : { show: false } }));
    const value = (plot, number) => (Number.isFinite(number) ? Number(number.toPrecision(DIGITS)).toString() : '');
    const there = (plot, series, i) => (Number.isFinite(plot.data[series][i]) ? i : null);
    this.uplot = new uPlot({
      width: this.width(), height: this.height,
      cursor: { sync: { key: 'sinew', setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { show: this.signals.length <= 6 }, dataIdx: there },
      select: { show: true },
      legend: { live: true, isolate: false },
      // What is read for a plot has its range already; uPlot would look for it again, and take NaN for one.
      scales: { x: { time: false }, ...Object.fromEntries(this.axes.map((_, i) => [SCALES[i], { auto: false, range: () => this.ranges[i] }])) },
      axes: [{ ...axis, size: 26 }, ...sides],
      series: [{ label: 'time', value: (plot, t) => (Number.isFinite(t) ? `${t.toFixed(3)} s` : '') },
        ...this.signals.map((signal, i) => ({ label: this.axisOf(i) === 0 ? signal : `${signal} (right)`,
          stroke: COLOURS[i % COLOURS.length], width: LINE, scale: SCALES[this.axisOf(i)], pxAlign: 0,
          points: { show: false }, value, paths: linePath, dash: i >= COLOURS.length ? [4, 3] : undefined }))],
      hooks: {
        setSelect: [(plot) => {
          if (plot.select.width < 3) return;
          this.on_zoom(plot.posToVal(plot.select.left, 'x'), plot.posToVal(plot.select.left + plot.select.width, 'x'));
          plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        }],
        setSeries: [() => this.want()],
        draw: [(plot) => this.decorate(plot, this.signals)],
      },
    }, [[], ...this.signals.map(() => [])], this.element);
    this.uplot.over.addEventListener('dblclick', () => this.on_zoom());
    if (this.on_remove) this.removers();
  }

  // A click on a label takes the signal away.
  removers() {
    this.element.querySelectorAll('.u-series').forEach((row, i) => {
      if (i === 0) return;
      row.title = 'click: take it away';
      row.addEventListener('click', (event) => {
        event.stopPropagation();
        this.on_remove(this.signals[i - 1]);
      }, true);
    });
  }

  width() {
    const style = getComputedStyle(this.element);
    return Math.max(this.element.clientWidth - Number.parseFloat(style.paddingLeft) - Number.parseFloat(style.paddingRight), 200);
  }

  // True: it was drawn.
  draw(table, from_s, to_s) {
    if (!this.uplot || !this.visible) return false;
    const points = Math.max(100, this.uplot.bbox.width / devicePixelRatio);
    const data = this.read.read(table, this.signals, from_s, to_s, points, (i) => (this.uplot.series[i + 1].show ? this.axisOf(i) : -1));
    this.ranges = this.axes.map((unit, i) => rangeOf(this.read.ranges[i], unit));
    this.uplot.batch(() => {
      this.uplot.setData(data, false);
      this.uplot.setScale('x', { min: from_s, max: to_s });
      this.ranges.forEach(([min, max], i) => this.uplot.setScale(SCALES[i], { min, max }));
    });
    return true;
  }

  // What is above and below the picture: heading, legend, margins.
  get frame_height() { return this.element.offsetHeight - this.height; }

  resize(height) {
    this.height = height;
    if (this.uplot && this.narrow !== this.width() < NARROW) this.make();
    if (!this.uplot || (this.uplot.width === this.width() && this.uplot.height === height)) return;
    this.uplot.setSize({ width: this.width(), height });
    this.want();
  }
}

export class Plots {
  // want(): something has changed, draw() is to be called.
  constructor(parent, topics, want) {
    this.parent = parent;
    this.topics = topics;
    this.want = want;
    this.window_s = 10;
    this.paused = undefined;  // a snapshot of the table
    this.zoomed = undefined;  // [from_s, to_s]
    this.zoom_moves = false;  // it ends at the newest data
    this.marks = () => [];    // (start_ns) => what happened: marks.js
    this.at_s = undefined;    // a recording's moment: the window ends there
    this.list = [];
    this.task_ms = 0;
    this.draws = 0;
    this.on_change = () => {};
    new ResizeObserver(() => this.resize()).observe(parent);
    window.addEventListener('resize', () => this.resize());
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.list.forEach((plot) => { plot.make(); want(); }));
  }

  // The plots fill the window; what does not fit is below.
  resize() {
    const shown = this.list.filter((plot) => plot.uplot);
    if (shown.length === 0) return;
    const gap = Number.parseFloat(getComputedStyle(this.parent).rowGap) || 0;
    const frames = shown.reduce((sum, plot) => sum + plot.frame_height + gap, 0);
    const free = window.innerHeight - (this.parent.getBoundingClientRect().top + window.scrollY) - frames - gap;
    const height = Math.min(Math.max(Math.floor(free / shown.length), LEAST_HEIGHT), MOST_HEIGHT);
    shown.forEach((plot) => plot.resize(height));
  }

  get table() { return this.paused ?? this.topics.table; }

  // Whether new data change what is shown.
  get follows() { return this.paused === undefined && (!this.zoomed || this.zoom_moves || this.zoomed[1] >= this.drawn_s); }

  add(title, { on_remove, on_hide } = {}) {
    const plot = new Plot(this.parent, title, { on_zoom: (from_s, to_s) => this.zoom(from_s, to_s), on_remove, on_hide, want: this.want,
      decorate: (uplot, signals) => this.decorate(uplot, signals) });
    this.list.push(plot);
    return plot;
  }

  decorate(uplot, signals) {
    drawGaps(uplot, this.topics.gapsOf(signals, this.table));
    drawEvents(uplot, this.marks(this.table.start_ns));
    if (this.zoomed && this.at_s !== undefined) drawEvents(uplot, [{ time_s: this.at_s, label: '', kind: 'cursor' }]);
  }

  pause(yes) {
    if (!yes) {
      this.paused = undefined;
      this.zoomed = undefined;
    } else if (!this.paused) {
      this.paused = this.topics.table.snapshot();
    }
    this.want();
    this.on_change();
  }

  // Without arguments: all of the window again. What is paused stays so, and nothing else becomes it.
  zoom(from_s, to_s) {
    this.zoomed = from_s === undefined ? undefined : [from_s, to_s];
    const live = this.paused === undefined && this.at_s === undefined;
    this.zoom_moves = live && from_s !== undefined && to_s >= this.table.newest - AT_END * this.window_s;
    this.want();
    this.on_change();
  }

  // A zoom into data that the table does not have any more ends.
  forgetZoom() {
    if (this.zoomed && this.at_s === undefined && this.zoomed[1] < this.table.oldest) this.zoom();
  }

  // The session has changed: what was paused is of another one.
  restart() {
    this.pause(false);
  }

  // What is shown of the table: [from_s, to_s].
  span(table) {
    const begin_s = this.at_s === undefined ? -Infinity : 0;  // a recording has nothing before
    if (this.zoomed && this.zoom_moves) {
      const on_s = table.newest - this.zoomed[1];
      return [this.zoomed[0] + on_s, table.newest];
    }
    const end_s = this.zoomed?.[1] ?? this.at_s ?? table.newest;
    const from_s = this.zoomed?.[0] ?? Math.max(end_s - this.window_s, begin_s);
    return [from_s, Math.max(end_s, from_s + LEAST_SPAN_S)];
  }

  // True: something was drawn.
  draw() {
    const begin = performance.now();
    const { table } = this;
    const [from_s, to_s] = this.span(table);
    this.drawn_s = table.newest;
    let drawn = false;
    for (const plot of this.list) drawn = plot.draw(table, from_s, to_s) || drawn;
    this.task_ms += performance.now() - begin;
    if (drawn) ++this.draws;
    return drawn;
  }
}
