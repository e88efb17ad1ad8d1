// Plots of signals over time (uPlot), with one cursor for all, zoom and pause.
//
// Drag in a plot: zoom, which pauses; double click: all of the window again. While paused the data go on coming. A plot
// that is scrolled out of the window is not drawn.

import uPlot from './vendor/uPlot.esm.js';
import { watchVisibility } from './frames.js';
import { PlotData } from './series.js';

const COLOURS = ['#3987e5', '#e8833a', '#3aa757', '#c94f7c', '#8e6bd8', '#23a6a6', '#b58a00', '#d9534f', '#6b7f95', '#7cb342'];
const LEAST_HEIGHT = 150;
const MOST_HEIGHT = 320;
const DIGITS = 5;
const LINE = 1;  // pixels: wider lines cost several times as much without a GPU
const DOT = 1.5;
const RANGE_PART = 0.1;  // of the values' range, left above and below them
const LEAST_SPAN_S = 0.01;  // at the beginning of a recording

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Of the axis, for values from least to greatest (NaN: there are none): a line that is flat lies in the middle.
function rangeOf(least, greatest) {
  if (Number.isNaN(least)) return [0, 1];
  if (least < greatest) return uPlot.rangeNum(least, greatest, RANGE_PART, true);
  const around = RANGE_PART * Math.abs(least) || 1;
  return [least - around, least + around];
}

// The line of a signal in pixels of the canvas: NaN ends it, a value between two NaN is a dot.
function linePath(plot, index, first, last) {
  const [times] = plot.data;
  const values = plot.data[index];
  const { x, y } = plot.scales;
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
  constructor(parent, title, unit, { on_zoom, on_remove, want }) {
    this.title = title;
    this.unit = unit;
    this.signals = [];
    this.on_zoom = on_zoom;
    this.on_remove = on_remove;
    this.want = want;
    this.read = new PlotData();
    this.range = [0, 1];
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

  show(signals) {
    if (signals.join() === this.signals.join()) return;
    this.signals = [...signals];
    this.make();
    this.want();
  }

  make() {
    this.uplot?.destroy();
    this.uplot = undefined;
    this.element.replaceChildren();
    this.element.hidden = this.signals.length === 0;
    if (this.signals.length === 0) return;
    const heading = document.createElement('h3');
    heading.textContent = this.unit ? `${this.title}, ${this.unit}` : this.title;
    this.element.append(heading);
    const axis = { stroke: css('--quiet'), grid: { stroke: css('--line'), width: 1 }, ticks: { stroke: css('--line'), width: 1 }, font: '11px system-ui' };
    const value = (plot, number) => (Number.isFinite(number) ? Number(number.toPrecision(DIGITS)).toString() : '');
    const there = (plot, series, i) => (Number.isFinite(plot.data[series][i]) ? i : null);
    this.uplot = new uPlot({
      width: this.width(), height: this.height,
      cursor: { sync: { key: 'sinew', setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { show: this.signals.length <= 6 }, dataIdx: there },
      select: { show: true },
      legend: { live: true, isolate: false },
      // What is read for a plot has its range already; uPlot would look for it again, and take NaN for one.
      scales: { x: { time: false }, y: { auto: false, range: () => this.range } },
      axes: [{ ...axis, size: 26 }, { ...axis, size: 62, values: (plot, ticks) => ticks.map((tick) => Number(tick.toPrecision(DIGITS)).toString()) }],
      series: [{ label: 'time', value: (plot, t) => (Number.isFinite(t) ? `${t.toFixed(3)} s` : '') },
        ...this.signals.map((signal, i) => ({ label: signal, stroke: COLOURS[i % COLOURS.length], width: LINE, pxAlign: 0,
          points: { show: false }, value, paths: linePath, dash: i >= COLOURS.length ? [4, 3] : undefined }))],
      hooks: {
        setSelect: [(plot) => {
          if (plot.select.width < 3) return;
          this.on_zoom(plot.posToVal(plot.select.left, 'x'), plot.posToVal(plot.select.left + plot.select.width, 'x'));
          plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        }],
        setSeries: [() => this.want()],
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
    const data = this.read.read(table, this.signals, from_s, to_s, points, (i) => this.uplot.series[i + 1].show);
    this.range = rangeOf(this.read.least, this.read.greatest);
    this.uplot.batch(() => {
      this.uplot.setData(data, false);
      this.uplot.setScale('x', { min: from_s, max: to_s });
      this.uplot.setScale('y', { min: this.range[0], max: this.range[1] });
    });
    return true;
  }

  // What is above and below the picture: heading, legend, margins.
  get frame_height() { return this.element.offsetHeight - this.height; }

  resize(height) {
    this.height = height;
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
    this.at_s = undefined;    // a recording's moment: the window ends there
    this.list = [];
    this.task_ms = 0;
    this.draws = 0;
    this.on_change = () => {};
    new ResizeObserver(() => this.resize()).observe(parent);
    window.addEventListener('resize', () => this.resize());
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

  // Whether new data change what is shown.
  get follows() { return this.paused === undefined; }

  add(title, unit, on_remove) {
    const plot = new Plot(this.parent, title, unit, { on_zoom: (from_s, to_s) => this.zoom(from_s, to_s), on_remove, want: this.want });
    this.list.push(plot);
    return plot;
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

  zoom(from_s, to_s) {
    if (from_s === undefined) {
      this.zoomed = undefined;
    } else {
      this.zoomed = [from_s, to_s];
      if (!this.paused && this.at_s === undefined) this.paused = this.topics.table.snapshot();
    }
    this.want();
    this.on_change();
  }

  // The session has changed: what was paused is of another one.
  restart() {
    this.pause(false);
  }

  // True: something was drawn.
  draw() {
    const begin = performance.now();
    const table = this.paused ?? this.topics.table;
    const begin_s = this.at_s === undefined ? -Infinity : 0;  // a recording has nothing before
    const end_s = this.zoomed?.[1] ?? this.at_s ?? table.newest;
    const from_s = this.zoomed?.[0] ?? Math.max(end_s - this.window_s, begin_s);
    const to_s = Math.max(end_s, from_s + LEAST_SPAN_S);
    let drawn = false;
    for (const plot of this.list) drawn = plot.draw(table, from_s, to_s) || drawn;
    this.task_ms += performance.now() - begin;
    if (drawn) ++this.draws;
    return drawn;
  }
}
