// Plots of signals over time (uPlot), with one cursor for all, zoom and pause.
//
// Drag in a plot: zoom, which pauses; double click: all of the window again. While paused the data go on coming.

import uPlot from './vendor/uPlot.esm.js';
import { plotData } from './series.js';

const COLOURS = ['#3987e5', '#e8833a', '#3aa757', '#c94f7c', '#8e6bd8', '#23a6a6', '#b58a00', '#d9534f', '#6b7f95', '#7cb342'];
const HEIGHT = 170;
const DIGITS = 5;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

class Plot {
  constructor(parent, title, unit, on_zoom, on_remove) {
    this.title = title;
    this.unit = unit;
    this.signals = [];
    this.on_zoom = on_zoom;
    this.on_remove = on_remove;
    this.element = document.createElement('section');
    this.element.className = 'plot';
    parent.append(this.element);
  }

  show(signals) {
    if (this.uplot && signals.join() === this.signals.join()) return;
    this.signals = [...signals];
    this.make();
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
    const value = (plot, number) => (number === null || number === undefined ? '-' : Number(number.toPrecision(DIGITS)).toString());
    this.uplot = new uPlot({
      width: this.width(), height: HEIGHT, pxAlign: false,
      cursor: { sync: { key: 'sinew', setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { show: this.signals.length <= 6 } },
      select: { show: true },
      legend: { live: true, isolate: false },
      scales: { x: { time: false } },
      axes: [{ ...axis, size: 26 }, { ...axis, size: 62, values: (plot, ticks) => ticks.map((tick) => Number(tick.toPrecision(DIGITS)).toString()) }],
      series: [{ label: 't', value: (plot, t) => (t === null || t === undefined ? '-' : `${t.toFixed(3)} s`) },
        ...this.signals.map((signal, i) => ({ label: signal, stroke: COLOURS[i % COLOURS.length], width: 1.25, points: { show: false }, value,
          dash: i >= COLOURS.length ? [4, 3] : undefined }))],
      hooks: { setSelect: [(plot) => {
        if (plot.select.width < 3) return;
        this.on_zoom(plot.posToVal(plot.select.left, 'x'), plot.posToVal(plot.select.left + plot.select.width, 'x'));
        plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
      }] },
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

  width() { return Math.max(this.element.clientWidth - 2, 200); }

  draw(table, from_s, to_s) {
    if (!this.uplot) return;
    const points = Math.max(100, this.uplot.bbox.width / devicePixelRatio);
    this.uplot.batch(() => {
      this.uplot.setData(plotData(table, this.signals, from_s, to_s, points), true);
      this.uplot.setScale('x', { min: from_s, max: to_s });
    });
  }

  resize() { this.uplot?.setSize({ width: this.width(), height: HEIGHT }); }
}

export class Plots {
  constructor(parent, topics) {
    this.parent = parent;
    this.topics = topics;
    this.window_s = 10;
    this.paused = undefined;  // a snapshot of the table
    this.zoomed = undefined;  // [from_s, to_s]
    this.at_s = undefined;    // a recording's moment: the window ends there
    this.list = [];
    this.task_ms = 0;
    this.draws = 0;
    this.on_change = () => {};
    new ResizeObserver(() => this.list.forEach((plot) => plot.resize())).observe(parent);
  }

  add(title, unit, on_remove) {
    const plot = new Plot(this.parent, title, unit, (from_s, to_s) => this.zoom(from_s, to_s), on_remove);
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
    this.dirty = true;
    this.on_change();
  }

  zoom(from_s, to_s) {
    if (from_s === undefined) {
      this.zoomed = undefined;
    } else {
      this.zoomed = [from_s, to_s];
      if (!this.paused && this.at_s === undefined) this.paused = this.topics.table.snapshot();
    }
    this.dirty = true;
    this.on_change();
  }

  // The session has changed: what was paused is of another one.
  restart() {
    this.pause(false);
  }

  draw() {
    if ((this.paused || this.at_s !== undefined) && !this.dirty) return;
    this.dirty = false;
    const begin = performance.now();
    const table = this.paused ?? this.topics.table;
    const to_s = this.zoomed?.[1] ?? this.at_s ?? table.newest;
    const begin_s = this.at_s === undefined ? -Infinity : 0;  // a recording has nothing before
    const from_s = this.zoomed?.[0] ?? Math.max(to_s - this.window_s, begin_s);
    for (const plot of this.list) plot.draw(table, from_s, to_s);
    this.task_ms += performance.now() - begin;
    ++this.draws;
  }
}
