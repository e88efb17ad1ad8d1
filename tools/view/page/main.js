// The page: one state (topics, plots, robot). What has changed is drawn: plots at most 20, the robot 15, tables 4 times a
// second (frames.js).

import { Connection } from './connection.js';
import { Frames } from './frames.js';
import { Log } from './log.js';
import { Topics } from './topics.js';
import { Plots } from './plots.js';
import { Recording } from './recording.js';
import { Timeline } from './timeline.js';
import * as panels from './panels.js';

// Shares of the time: of one core all drawing together takes no more than half.
const PLOTS = { least_ms: 50, share: 0.25 };
const ROBOT = { least_ms: 1000 / 15, most_ms: 3000, share: 0.2, heavy: true };
const TABLES = { least_ms: 250, share: 0.05 };
const PLAY_MS = 50;
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

const frames = new Frames();
const topics = new Topics();
const drawing = {
  play: frames.add({ least_ms: PLAY_MS, share: 1, draw: playOn }),  // first: the others show the moment that it makes
  plots: frames.add({ ...PLOTS, draw: () => plots.draw() }),
  robot: frames.add({ ...ROBOT, draw: drawRobot }),
  tables: frames.add({ ...TABLES, draw: showTables }),
};
const want = (job) => frames.want(job);
const plots = new Plots($('plots'), topics, () => want(drawing.plots));
const log = new Log();
const figures = { received: 0, message_ms: 0, began_ms: performance.now() };
let info;
let status;
let connection;
let connected = 'connecting';
let recording;
let timeline;
let robot;
let joint = 0;
let names;
let extra;
let reported = '';
const chosen = [];

function put(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}

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
  const read = [...SHOWN, ...[...signals].map((signal) => signal.slice(0, signal.indexOf('.')))];
  connection?.subscribe(read);
  recording?.want(read);
  if (recording) refreshRecording();
  arrange();
  want(drawing.plots);
}

// A plot is shown when one of its signals comes.
function arrange() {
  DEFAULT_PLOTS.forEach(([, , list], i) => {
    const here = list.map(signalOf).filter((signal) => topics.topics.get(signal.slice(0, signal.indexOf('.')))?.received > 0);
    plots.list[i].show(here);
  });
  extra.show(chosen.filter((signal) => topics.table.columns.has(signal)));
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
  if (plots.follows) want(drawing.plots);
  if (robot) want(drawing.robot);
  want(drawing.tables);
  ++figures.received;
  figures.message_ms += performance.now() - begin;
}

function waiting() {
  const others = (status?.participants ?? []).map(participant => participant.name).join(', ');
  return `waiting for a state provider in domain ${info.domain}; heard: ${others || 'nobody'}`;
}

const hasFault = state => (state?.fault?.cause ?? 'FAULT_NONE') !== 'FAULT_NONE';

// Of a recording, where nobody says what to do.
function faultOf({ fault }) {
  const numbers = fault.value === fault.limit ? '' : `: ${+fault.value.toPrecision(4)}, limit ${+fault.limit.toPrecision(4)}`;
  return `${fault.joint === 255 ? '' : `joint ${fault.joint}: `}${fault.cause.replace('FAULT_', '').replaceAll('_', ' ').toLowerCase()}${numbers}`;
}

function showState() {
  const state = topics.newest('joint_state');
  const live = !recording;
  const fresh = recording || (connected === 'connected' && status?.robot_state);
  const word = state && fresh ? state.robot_state.replace('ROBOT_', '').toLowerCase() : connected === 'connected' || recording ? 'not heard' : connected;
  put('robot_state', word);
  if ($('robot_state').className !== `badge ${word}`) $('robot_state').className = `badge ${word}`;
  const parts = [];
  if (fresh && hasFault(state)) parts.push(live && status.fault ? status.fault : faultOf(state));
  if (live && !fresh && connected === 'connected') parts.push(waiting());
  if (state) parts.push(`tick ${state.header.tick}`, state.header.origin.replace('ORIGIN_', '').toLowerCase());
  if (live && topics.lost > 0) parts.push(`${topics.lost} ticks missing`);
  if (live && topics.sessions > 1) parts.push(`${topics.sessions} sessions`);
  if (recording) parts.push(recording.file.split('/').at(-1));
  put('facts', parts.join(', '));
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
  if (recording) askMoment();
  log.show($('log'), $('log_name'));
  if (status) panels.participants($('participants'), status.participants);
  if (status && !recording) {
    panels.topics($('topics'), status.topics, topics);
    panels.clients($('clients'), status.clients);
  }
  const problems = [...topics.problems, ...(status?.problems ?? [])];
  $('problems_card').hidden = problems.length === 0;
  if ($('problems').childElementCount !== problems.length || problems.some((problem, i) => $('problems').children[i].textContent !== problem)) {
    $('problems').replaceChildren(...problems.map((problem) => Object.assign(document.createElement('li'), { textContent: problem })));
  }
  return true;
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
  readLog();
  try {
    const reply = await fetch('/api/status', { headers: { 'X-Sinew-Token': token } });
    const next = await reply.json();
    if (next.participants) {
      status = next;
      showStatus();
    }
  } catch {
    status = undefined;
  }
  want(drawing.tables);
}

async function readLog() {
  try {
    const reply = await fetch(`/api/log?after=${log.last}`, { headers: { 'X-Sinew-Token': token } });
    if (reply.ok && log.add(await reply.json())) want(drawing.tables);
  } catch {
    // The server does not answer, which the page says elsewhere.
  }
}

async function showRecording(query) {
  const reply = await fetch('/api/recording');
  if (!reply.ok) throw new Error(await reply.text());
  const described = await reply.json();
  document.querySelectorAll('.live').forEach((element) => { element.hidden = true; });
  document.querySelector('.buttons').hidden = true;
  $('pause').hidden = true;
  recording = new Recording(described, topics);
  $('facts').title = recording.file;
  $('participants_card').hidden = !recording.has_participants;
  $('log_card').hidden = !recording.has_log;
  timeline = new Timeline(recording, $('timeline'), { on_move: moved, on_session: () => plots.restart() });
  const asked = query.get('session');
  const there = asked === null || (Number(asked) >= 1 && Number(asked) <= recording.sessions.length && Number.isInteger(Number(asked)));
  if (!there) say(`session=${asked}: the recording has 1 to ${recording.sessions.length}; the first one is shown`);
  const at = query.get('at');
  const session = there && asked !== null ? Number(asked) : 1;
  timeline.select(session, at === null || Number.isNaN(Number(at)) ? plots.window_s : Number(at));
  addChannels(described.topics);
}

// The moment of the recording, or its session, has changed.
function moved() {
  plots.at_s = recording.at_s;
  if (plots.zoomed) plots.zoom();
  recording.show();
  refreshRecording();
  for (const job of Object.values(drawing)) want(job);
}

function playOn(now_ms) {
  if (timeline?.step(now_ms)) want(drawing.play);
  return false;
}

async function refreshRecording() {
  try {
    while (await recording.load(plots.window_s)) {
      for (const job of Object.values(drawing)) want(job);
    }
  } catch (error) {
    say(error.message);
  }
}

async function askMoment() {
  try {
    const [rows, lines] = await Promise.all([recording.participants(), recording.log()]);
    if (rows) status = { participants: rows };
    if (lines) log.set(lines);
    if (rows || lines) want(drawing.tables);
  } catch (error) {
    say(error.message);
  }
}

async function startRobot() {
  const reply = await fetch('/robot.urdf');
  if (!reply.ok) return;
  const { RobotView } = await import('./robot.js');
  $('scene').replaceChildren();
  try {
    robot = new RobotView($('scene'), await reply.text(), info.robot, () => want(drawing.robot));
    want(drawing.robot);
  } catch (error) {
    $('scene').innerHTML = '<p class="empty"></p>';
    $('scene').firstChild.textContent = `The robot cannot be drawn: ${error.message}`;
  }
}

function drawRobot() {
  if (!robot) return false;
  robot.pose(topics.newest('joint_state'), topics.newest('sim_body_truth'));
  return robot.draw();
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
  for (const id of ['log_level', 'log_name']) {
    $(id).addEventListener('change', () => {
      log.choose($('log_level').value, $('log_name').value);
      want(drawing.tables);
    });
  }
  $('window').addEventListener('change', () => {
    plots.window_s = Number($('window').value);
    plots.zoom();
    if (recording) refreshRecording();
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
  if (info.mode === 'recording') {
    await showRecording(query);
  } else {
    connection = new Connection(`ws://${location.host}/?token=${token}`, {
      advertise: addChannels,
      message: onMessage,
      state: (text) => { connected = text; want(drawing.tables); },
      report: say,
    });
    readStatus();
    setInterval(readStatus, STATUS_MS);
  }
  if (info.robot) startRobot();
  want(drawing.tables);
}

document.addEventListener('visibilitychange', () => frames.hide(document.hidden));

// For tests and for whoever wants to know: what the page costs and what it missed.
window.sinew = {
  topics, plots,
  figures: () => ({
    seconds: (performance.now() - figures.began_ms) / 1000, received: figures.received, samples: topics.samples, lost: topics.lost,
    message_ms: figures.message_ms, plot_ms: plots.task_ms, plot_draws: plots.draws, plot_cost_ms: drawing.plots.cost_ms,
    robot_ms: robot?.task_ms ?? 0, robot_frames: robot?.frames ?? 0, signals: topics.table.columns.size, state: connected,
  }),
};

start().catch((error) => say(`The page cannot start: ${error.message}`));
