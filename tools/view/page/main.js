// The page: one state (topics, plots, robot), drawn at three rates: plots 20, robot 15, tables 4 times a second.

import { Connection } from './connection.js';
import { Topics } from './topics.js';
import { Plots } from './plots.js';
import { Recording } from './recording.js';
import * as panels from './panels.js';

const PLOT_MS = 50;
const TABLE_MS = 250;
const STATUS_MS = 1000;
const CONFIRM_MS = 3000;
// Read for the tables, beside what is plotted.
const SHOWN = ['joint_state', 'actuator_state', 'regime', 'residual', 'torque_prediction', 'bus_status', 'sim_body_truth'];
const DEFAULT_PLOTS = [
  ['Position', 'rad (m)', ['reference.position_rad', 'joint_state.position_rad']],
  ['Torque: computed from the current, and predicted', 'Nm (N)', ['joint_state.torque_Nm', 'torque_prediction.torque_Nm']],
  ['Chamber pressure', 'bar', ['pneumatic_state.target_pressure_bar', 'actuator_state.chamber_pressure_bar']],
  ['Residual of the model', 'Nm (N)', ['residual.residual_Nm']],
];

const $ = (id) => document.getElementById(id);
const given = document.querySelector('meta[name=sinew-token]').content;
const token = given || new URLSearchParams(location.hash.slice(1)).get('token') || '';

const topics = new Topics();
const plots = new Plots($('plots'), topics);
const figures = { received: 0, message_ms: 0, began_ms: performance.now() };
let info;
let status;
let connection;
let connected = 'connecting';
let recording;
let robot;
let joint = 0;
let names;
let extra;
let reported = '';
const chosen = [];

function say(text) {
  reported = text;
  $('message').textContent = text;
}

async function command(path) {
  try {
    const reply = await fetch(`/api/${path}`, { method: 'POST', headers: { 'X-Sinew-Token': token } });
    say(reply.ok ? '' : (await reply.text()).trim());
  } catch {
    say(`${path}: the server does not answer; use the estop of the robot`);
  }
}

// What can move the robot takes two clicks.
function confirmed(button, path) {
  const label = button.textContent;
  let timer;
  button.addEventListener('click', () => {
    if (timer) {
      clearTimeout(timer);
      command(path);
    }
    const asks = !timer;
    timer = asks ? setTimeout(() => { timer = undefined; button.textContent = label; }, CONFIRM_MS) : undefined;
    button.textContent = asks ? `${label}: sure?` : label;
  });
}

function signalOf(topic_path) { return `${topic_path}[${joint}]`; }

function has(signal) { return topics.topics.has(signal.slice(0, signal.indexOf('.'))); }

function wanted() {
  const all = [...DEFAULT_PLOTS.flatMap(([, , list]) => list.map(signalOf)), ...chosen];
  return all.filter(has);
}

// Columns for what is plotted now, subscriptions, and the plots themselves.
function choose() {
  const signals = new Set(wanted());
  for (const old of [...topics.table.columns.keys()]) if (!signals.has(old)) topics.unplot(old);
  for (const signal of signals) {
    try {
      topics.plot(signal);
    } catch (error) {
      say(error.message);
      const at = chosen.indexOf(signal);
      if (at >= 0) chosen.splice(at, 1);
    }
  }
  if (recording) recording.loaded = undefined;
  connection?.subscribe([...SHOWN, ...[...signals].map((signal) => signal.slice(0, signal.indexOf('.')))]);
  arrange();
}

// A plot is shown when one of its signals comes.
function arrange() {
  DEFAULT_PLOTS.forEach(([, , list], i) => {
    const here = list.map(signalOf).filter((signal) => topics.topics.get(signal.slice(0, signal.indexOf('.')))?.received > 0);
    plots.list[i].show(here);
  });
  extra.show(chosen.filter((signal) => topics.table.columns.has(signal)));
  plots.dirty = true;
}

function offerSignals() {
  $('signals').replaceChildren(...topics.signals().map((signal) => {
    const option = document.createElement('option');
    option.value = signal;
    return option;
  }));
}

function addChannels(channels) {
  for (const channel of channels) topics.add(channel.topic, channel.schemaName, channel.schema);
  offerSignals();
  choose();
}

function onMessage(topic, view) {
  const begin = performance.now();
  if (topics.take(topic, view)) plots.restart();
  ++figures.received;
  figures.message_ms += performance.now() - begin;
}

function showState() {
  const state = topics.newest('joint_state');
  const live = !recording;
  const fresh = recording || (connected === 'connected' && status?.robot_state);
  const word = state && fresh ? state.robot_state.replace('ROBOT_', '').toLowerCase() : connected === 'connected' || recording ? 'not heard' : connected;
  $('robot_state').textContent = word;
  $('robot_state').className = `badge ${word}`;
  const parts = [];
  if (state) parts.push(`tick ${state.header.tick}`, state.header.origin.replace('ORIGIN_', '').toLowerCase());
  if (live && topics.lost > 0) parts.push(`${topics.lost} ticks missing`);
  if (live && topics.sessions > 1) parts.push(`${topics.sessions} sessions`);
  if (recording) parts.push(info.recording.file + (info.recording.more_sessions ? ' (first session)' : ''));
  $('facts').textContent = parts.join(', ');
  const count = state?.joint_count ?? 0;
  if (info.robot) names = info.robot.driven.length === count ? info.robot.driven : info.robot.moving.length === count ? info.robot.moving : undefined;
  if ($('joint').length !== count && count > 0) {
    $('joint').replaceChildren(...Array.from({ length: count }, (_, i) => new Option(names?.[i] ?? `joint ${i}`, i)));
    $('joint').value = joint;
  }
}

function showTables() {
  showState();
  arrange();
  panels.joints($('joints'), topics, names);
  panels.buses($('buses'), topics.newest('bus_status'));
  if (status) {
    panels.participants($('participants'), status.participants);
    panels.topics($('topics'), status.topics, topics);
    panels.clients($('clients'), status.clients);
  }
  const problems = [...topics.problems, ...(status?.problems ?? [])];
  $('problems_card').hidden = problems.length === 0;
  $('problems').replaceChildren(...problems.map((problem) => Object.assign(document.createElement('li'), { textContent: problem })));
}

function showStatus() {
  const { recording: running, action } = status;
  $('record').textContent = running.stopping ? 'Stopping' : running.running ? 'Stop recording' : 'Record';
  $('record').classList.toggle('on', running.running);
  $('record').title = running.file ? `last: ${running.file}` : 'starts a logger on the host of sinew-view';
  if (action?.pending) say(`${action.action}: not confirmed yet`);
  else if (action && !action.done && action.why) say(`${action.action}: ${action.why}`);
  else if (running.problem) say(`recording: ${running.problem}`);
  else if (reported.endsWith('not confirmed yet')) say('');
}

async function readStatus() {
  try {
    const reply = await fetch('/api/status');
    const next = await reply.json();
    if (next.participants) {
      status = next;
      showStatus();
    }
  } catch {
    status = undefined;
  }
}

async function showRecording() {
  const slider = $('slider');
  $('timeline').hidden = false;
  document.querySelectorAll('.live').forEach((element) => { element.hidden = true; });
  document.querySelector('.buttons').hidden = true;
  slider.max = recording.length_s;
  const move = (time_s) => {
    recording.at_s = Math.min(Math.max(time_s, 0), recording.length_s);
    slider.value = recording.at_s;
    $('moment').textContent = `${recording.at_s.toFixed(2)} of ${recording.length_s.toFixed(2)} s`;
    plots.at_s = recording.at_s;
    plots.dirty = true;
  };
  slider.addEventListener('input', () => move(Number(slider.value)));
  $('play').addEventListener('click', () => {
    recording.playing = !recording.playing;
    if (recording.playing && recording.at_s >= recording.length_s) move(0);
    $('play').textContent = recording.playing ? 'Hold' : 'Play';
  });
  recording.step = (elapsed_s) => {
    if (!recording.playing) return;
    move(recording.at_s + elapsed_s);
    if (recording.at_s >= recording.length_s) $('play').click();
  };
  const asked_s = Number(new URLSearchParams(location.search).get('at'));
  move(asked_s > 0 ? asked_s : Math.min(plots.window_s, recording.length_s));
}

async function refreshRecording() {
  try {
    if (await recording.load(plots.window_s)) plots.dirty = true;
  } catch (error) {
    say(error.message.trim());
  }
  recording.show();
}

async function startRobot() {
  const reply = await fetch('/robot.urdf');
  if (!reply.ok) return;
  const { RobotView } = await import('./robot.js');
  $('scene').replaceChildren();
  try {
    robot = new RobotView($('scene'), await reply.text(), info.robot);
  } catch (error) {
    $('scene').innerHTML = '<p class="empty"></p>';
    $('scene').firstChild.textContent = `The robot cannot be drawn: ${error.message}`;
  }
}

let plotted_ms = 0;
let tabled_ms = 0;
let last_ms = performance.now();
function frame(now_ms) {
  if (recording) {
    recording.step((now_ms - last_ms) / 1000);
    refreshRecording();
  }
  last_ms = now_ms;
  if (now_ms - plotted_ms >= PLOT_MS) {
    plotted_ms = now_ms;
    plots.draw();
  }
  if (robot?.due(now_ms)) {
    robot.pose(topics.newest('joint_state'), topics.newest('sim_body_truth'));
    robot.draw(now_ms);
  }
  if (now_ms - tabled_ms >= TABLE_MS) {
    tabled_ms = now_ms;
    showTables();
  }
  requestAnimationFrame(frame);
}

async function start() {
  info = await (await fetch('/api/info')).json();
  document.title = info.domain === null ? 'Sinew, a recording' : `Sinew, domain ${info.domain}`;
  $('title').textContent = document.title;
  $('arm').hidden = $('reset').hidden = !info.allow_arming;
  const query = new URLSearchParams(location.search);
  const asked = query.get('signals');
  joint = Math.max(0, Math.trunc(Number(query.get('joint') ?? 0)) || 0);
  chosen.push(...(asked ? asked.split(',') : info.signals));
  for (const [title, unit] of DEFAULT_PLOTS) plots.add(title, unit);
  extra = plots.add('More signals', '', (signal) => {
    chosen.splice(chosen.indexOf(signal), 1);
    choose();
  });
  plots.on_change = () => {
    const paused = plots.paused !== undefined;
    $('pause').classList.toggle('on', paused);
    $('pause').textContent = paused ? 'Go on' : 'Pause';
  };
  $('pause').addEventListener('click', () => plots.pause(plots.paused === undefined));
  $('joint').addEventListener('change', () => {
    joint = Number($('joint').value);
    choose();
  });
  $('window').addEventListener('change', () => {
    plots.window_s = Number($('window').value);
    plots.zoomed = undefined;
    plots.dirty = true;
  });
  $('signal').addEventListener('change', () => {
    const signal = $('signal').value.trim();
    $('signal').value = '';
    if (!signal || chosen.includes(signal)) return;
    say('');
    chosen.push(signal);
    choose();
  });
  $('estop').addEventListener('click', () => command('estop'));
  $('disarm').addEventListener('click', () => command('disarm'));
  confirmed($('arm'), 'arm');
  confirmed($('reset'), 'reset');
  $('record').addEventListener('click', () => command(status?.recording.running ? 'record/stop' : 'record/start'));
  if (info.recording) {
    recording = new Recording(info.recording, topics);
    addChannels(info.recording.topics);
    await showRecording();
  } else {
    connection = new Connection(`ws://${location.host}/`, {
      advertise: addChannels,
      message: onMessage,
      state: (text) => { connected = text; },
      report: say,
    });
    readStatus();
    setInterval(readStatus, STATUS_MS);
  }
  if (info.robot) startRobot();
  requestAnimationFrame(frame);
}

// For tests and for whoever wants to know: what the page costs and what it missed.
window.sinew = {
  topics, plots,
  figures: () => ({
    seconds: (performance.now() - figures.began_ms) / 1000, received: figures.received, samples: topics.samples, lost: topics.lost,
    message_ms: figures.message_ms, plot_ms: plots.task_ms, plot_draws: plots.draws, robot_ms: robot?.task_ms ?? 0,
    robot_frames: robot?.frames ?? 0, signals: topics.table.columns.size, state: connected,
  }),
};

start().catch((error) => say(`The page cannot start: ${error.message}`));
