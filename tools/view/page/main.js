// The page: one state (topics, plots, robot). What has changed is drawn: plots at most 20, the robot 15, tables 4 times a
// second (frames.js).

import { Connection } from './connection.js';
import { Events, Recorders, SOURCES, faultOf } from './events.js';
import { Frames } from './frames.js';
import { Layouts, DEFAULT, readAddress, writeAddress } from './layouts.js';
import { LayoutMenu } from './layout_menu.js';
import { Log } from './log.js';
import { problemOf } from './names.js';
import { Overview } from './overview.js';
import { Past } from './past.js';
import { Topics } from './topics.js';
import { Plots } from './plots.js';
import { Recording } from './recording.js';
import { Survey } from './survey.js';
import { Timeline } from './timeline.js';
import { MINUS, partsOf, unitOf } from './units.js';
import * as panels from './panels.js';

// Shares of the time: of one core all drawing together takes no more than half.
const PLOTS = { least_ms: 50, share: 0.25 };
const ROBOT = { least_ms: 1000 / 15, most_ms: 3000, share: 0.2, heavy: true };
const OVERVIEW = { least_ms: 66, share: 0.1 };
const TABLES = { least_ms: 250, share: 0.05 };
const PLAY_MS = 50;
const STATUS_MS = 1000;
const CONFIRM_MS = 3000;
// Read for the tables, beside what is plotted.
const SHOWN = ['joint_state', 'actuator_state', 'regime', 'residual', 'torque_prediction', 'bus_status', 'sim_body_truth'];
// Kept, though not plotted, so that a signal that is added begins with its past; the others are large or no rows.
const NO_PAST = new Set(['component_snapshot', 'component_status', 'log', 'reservoir_state']);
const ADDRESS_MS = 500;  // browsers take 100 addresses in 30 s
const NOTED_TWICE_S = 5;  // a recorder of this page is heard of twice
// key (in the address), title, numbers of the joint that is chosen; ' - ' between two: their difference.
const DEFAULT_PLOTS = [
  ['position', 'Position', ['reference.position_rad', 'joint_state.position_rad']],
  ['error', 'Error: reference minus measured', [`reference.position_rad${MINUS}joint_state.position_rad`]],
  ['torque', 'Torque: computed from the current, and predicted', ['joint_state.torque_Nm', 'torque_prediction.torque_Nm']],
  ['pressure', 'Chamber pressure', ['pneumatic_state.target_pressure_bar', 'actuator_state.chamber_pressure_bar']],
  ['residual', 'Residual of the model', ['residual.residual_Nm']],
];
const OLD_PICTURE_S = 1;
const UNITS_OF_PLOT = 2;

const $ = (id) => document.getElementById(id);
const given = document.querySelector('meta[name=sinew-token]').content;
const token = given || new URLSearchParams(location.hash.slice(1)).get('token') || '';

const frames = new Frames();
const topics = new Topics(new Past());
const events = new Events();
const recorders = new Recorders();
const layouts = new Layouts(storage());
const drawing = {
  play: frames.add({ least_ms: PLAY_MS, share: 1, draw: playOn }),  // first: the others show the moment that it makes
  plots: frames.add({ ...PLOTS, draw: () => plots.draw() }),
  robot: frames.add({ ...ROBOT, draw: drawRobot }),
  overview: frames.add({ ...OVERVIEW, draw: drawOverview }),
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
let survey;
let overview;
let robot;
let names;
let extras = [];
let reported = '';
let came_ms;  // when the newest joint_state came
let noted_ns = -Infinity;
let asked_joint = false;  // by the address: it is to be there
const shown = { ...DEFAULT, signals: [], hide: [] };  // layouts.js
const refused = [];

// Not every page has one: a browser may refuse it.
function storage() {
  try {
    return window.localStorage;
  } catch {
    return undefined;
  }
}

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

function signalOf(topic_path) { return partsOf(topic_path).map((part) => `${part}[${shown.joint}]`).join(MINUS); }

const topicOf = (signal) => signal.slice(0, signal.indexOf('.'));
const kinds = () => topics.newest('joint_state')?.joint_kind;

// What is wrong is said until somebody takes it away; nothing of it is kept.
function refuse(problem) {
  if (!refused.includes(problem)) refused.push(problem);
  showRefused();
}

function showRefused() {
  $('refused').hidden = refused.length === 0;
  $('refused_list').replaceChildren(...refused.map((problem) => Object.assign(document.createElement('li'), { textContent: problem })));
}

// Takes away what is chosen and cannot be plotted, when the topics are known.
function checkChosen() {
  if (topics.topics.size === 0) return;
  for (const signal of [...shown.signals]) {
    const problem = problemOf(signal, topics.topics);
    if (!problem) continue;
    shown.signals.splice(shown.signals.indexOf(signal), 1);
    refuse(`'${signal}': ${problem}`);
  }
  for (const key of [...shown.hide]) {
    if (DEFAULT_PLOTS.some(([other]) => other === key)) continue;
    shown.hide.splice(shown.hide.indexOf(key), 1);
    refuse(`hide=${key}: no such plot; there are ${DEFAULT_PLOTS.map(([other]) => other).join(', ')}`);
  }
}

// The plots of the page that are not hidden, and their signals whose topics are there.
function wanted() {
  const own = DEFAULT_PLOTS.filter(([key]) => !shown.hide.includes(key)).flatMap(([, , list]) => list.map(signalOf));
  return [...own.filter((signal) => partsOf(signal).every((part) => topics.topics.has(topicOf(part)))), ...shown.signals];
}

// Columns for what is plotted now, subscriptions, and the plots themselves.
function choose() {
  checkChosen();
  const signals = new Set(topics.topics.size === 0 ? [] : wanted().flatMap(partsOf));
  for (const old of [...topics.table.columns.keys()]) if (!signals.has(old)) topics.unplot(old);
  for (const signal of signals) topics.plot(signal);
  const read = [...SHOWN, ...SOURCES, ...[...signals].map(topicOf)];
  connection?.subscribe([...read, ...[...topics.topics.keys()].filter((name) => !NO_PAST.has(name))]);
  recording?.want(read);
  if (recording) refreshRecording();
  arrange();
  changed();
  want(drawing.plots);
  want(drawing.overview);
}

// A plot is shown when one of its signals comes. The other signals: plots of two units at most.
function arrange() {
  const of = kinds();
  const come = (signal) => partsOf(signal).every((part) => topics.topics.get(topicOf(part))?.received > 0);
  DEFAULT_PLOTS.forEach(([key, , list], i) => {
    const here = shown.hide.includes(key) ? [] : list.map(signalOf).filter(come);
    plots.list[i].show(here, here.map((signal) => unitOf(signal, of)));
  });
  const units = [...new Set(shown.signals.map((signal) => unitOf(signal, of)))];
  const there = shown.signals.filter((signal) => topics.table.sources(signal));
  for (let i = 0; i < Math.max(extras.length, Math.ceil(units.length / UNITS_OF_PLOT)); ++i) {
    extras[i] ??= plots.add('More signals', { on_remove: removeSignal });
    const own = units.slice(UNITS_OF_PLOT * i, UNITS_OF_PLOT * (i + 1));
    const here = there.filter((signal) => own.includes(unitOf(signal, of)));
    extras[i].show(here, here.map((signal) => unitOf(signal, of)));
  }
}

function removeSignal(signal) {
  shown.signals.splice(shown.signals.indexOf(signal), 1);
  choose();
}

function addSignal(signal) {
  if (!signal || shown.signals.includes(signal)) return;
  refused.length = 0;
  showRefused();
  shown.signals.push(signal);
  choose();
}

// Shows what a layout has.
function apply(layout) {
  Object.assign(shown, { ...layout, signals: [...layout.signals], hide: [...layout.hide] });
  refused.length = 0;
  showRefused();
  checkJoint(true);
  plots.window_s = shown.window_s;
  $('window').value = shown.window_s;
  $('joint').value = shown.joint;
  plots.zoom();
  choose();
}

// The address says what is shown, soon.
let writing;
function changed() {
  writing ??= setTimeout(() => {
    writing = undefined;
    const place = recording ? { session: recording.session, at_s: recording.at_s, speed: recording.speed } : {};
    const search = writeAddress({ ...shown, ...place, configured: info.signals.length > 0 });
    if (search !== location.search) history.replaceState(null, '', `${location.pathname}${search}${location.hash}`);
  }, ADDRESS_MS);
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

// A session of the robot begins.
function restarted() {
  plots.restart();
  events.restart();
}

function onMessage(topic, view) {
  const begin = performance.now();
  if (topics.take(topic, view)) restarted();
  const { type, newest } = topics.topics.get(topic) ?? {};
  if (newest === view) {
    events.take(topic, type, view);
    if (topic === 'joint_state') came_ms = begin;
  }
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

// A joint that the robot does not have is not shown. True: another one is.
function checkJoint(asked) {
  const count = $('joint').length;
  if (count === 0 || shown.joint < count) return false;
  if (asked) refuse(`joint ${shown.joint}: the robot has ${count === 1 ? 'joint 0 only' : `joints 0 to ${count - 1}`}; joint 0 is shown`);
  shown.joint = 0;
  return true;
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
  put('missing', live && topics.lost > 0 ? `${topics.lost} ticks missing` : '');
  if (live && topics.sessions > 1) parts.push(`${topics.sessions} sessions`);
  if (recording) parts.push(recording.file.split('/').at(-1));
  put('facts', parts.join(', '));
  const count = state?.joint_count ?? 0;
  if (info.robot) names = info.robot.driven.length === count ? info.robot.driven : info.robot.moving.length === count ? info.robot.moving : undefined;
  if ($('joint').length !== count && count > 0) {
    $('joint').replaceChildren(...Array.from({ length: count }, (_, i) => new Option(names?.[i] ?? `joint ${i}`, i)));
    $('joint_label').hidden = false;
    if (checkJoint(asked_joint)) choose();
    $('joint').value = shown.joint;
  }
}

function showTables() {
  showState();
  arrange();
  plots.forgetZoom();
  const age_s = recording || came_ms === undefined ? 0 : (performance.now() - came_ms) / 1000;
  panels.joints($('joints'), topics, names, age_s);
  $('scene').classList.toggle('old', age_s > OLD_PICTURE_S);
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

// A recording has begun, of this page or of another logger: a mark at the newest tick.
function noteRecording(own) {
  const [name] = recorders.begun(status);
  const { stamp_ns } = events;
  if ((!own && name === undefined) || stamp_ns === undefined || (stamp_ns - noted_ns) * 1e-9 < NOTED_TWICE_S) return;
  noted_ns = stamp_ns;
  events.note(stamp_ns, 'recording started', 'note');
  want(drawing.plots);
}

async function readStatus() {
  readLog();
  try {
    const reply = await fetch('/api/status', { headers: { 'X-Sinew-Token': token } });
    const next = await reply.json();
    if (next.participants) {
      const recorded = status?.recording?.running;
      status = next;
      showStatus();
      noteRecording(recorded === false && status.recording.running);
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

async function showRecording(place) {
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
  topics.past = undefined;  // the recording has it
  survey = new Survey(recording, topics, () => { want(drawing.overview); want(drawing.plots); });
  overview = new Overview($('overview'), recording, survey, { on_pick: (time_s) => timeline.move(time_s), want: () => want(drawing.overview) });
  plots.marks = (start_ns) => survey.events.marks(start_ns);
  timeline = new Timeline(recording, $('timeline'), { on_move: moved, on_session: surveyed });
  const there = place.session === undefined || place.session <= recording.sessions.length;
  if (!there) refuse(`session=${place.session}: the recording has 1 to ${recording.sessions.length}; the first one is shown`);
  for (const topic of described.topics) topics.add(topic.topic, topic.schemaName, topic.schema);
  timeline.setSpeed(place.speed ?? 1);
  timeline.select(there ? place.session ?? 1 : 1, place.at_s ?? plots.window_s);
  if (place.at_s < 0 || place.at_s > recording.length_s) refuse(`at=${place.at_s}: the session has 0 to ${recording.length_s.toFixed(2)} s`);
  addChannels([]);
}

function surveyed() {
  plots.restart();
  survey.run().catch((error) => say(error.message));
}

// The moment of the recording, or its session, has changed.
function moved() {
  plots.at_s = recording.at_s;
  if (plots.zoomed && (recording.at_s < plots.zoomed[0] || recording.at_s > plots.zoomed[1])) plots.zoom();
  recording.show();
  changed();
  refreshRecording();
  for (const job of Object.values(drawing)) want(job);
}

function playOn(now_ms) {
  if (timeline?.step(now_ms)) want(drawing.play);
  return false;
}

async function refreshRecording() {
  try {
    while (await recording.load(plots.window_s, plots.zoomed?.[1])) {
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
  $('scene').querySelector('.empty')?.remove();
  try {
    $('camera').hidden = false;
    robot = new RobotView($('scene'), await reply.text(), info.robot, () => want(drawing.robot));
    want(drawing.robot);
  } catch (error) {
    $('camera').hidden = true;
    $('scene').append(Object.assign(document.createElement('p'), { className: 'empty', textContent: `The robot cannot be drawn: ${error.message}` }));
  }
}

function drawOverview() {
  if (!overview) return false;
  overview.joint = shown.joint;
  overview.span = plots.span(plots.table);
  return overview.draw();
}

// Keys of the page, where nobody types.
function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest?.('input, select, textarea, button, summary, [contenteditable]')) return;
  if (event.key === 'r' && robot) robot.resetCamera();
  else if (!timeline?.key(event.key, event.shiftKey)) return;
  event.preventDefault();
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
  const { shown: place, problems } = readAddress(location.search);
  for (const problem of problems) refuse(problem);
  for (const key of ['joint', 'window_s', 'hide']) if (place[key] !== undefined) shown[key] = place[key];
  asked_joint = place.joint !== undefined;
  shown.signals = [...new Set(place.signals ?? info.signals)];
  plots.window_s = shown.window_s;
  $('window').value = shown.window_s;
  plots.marks = (start_ns) => events.marks(start_ns);
  for (const [key, title] of DEFAULT_PLOTS) {
    plots.add(title, { on_hide: () => {
      shown.hide.push(key);
      choose();
    } });
  }
  new LayoutMenu($('layouts'), layouts, DEFAULT_PLOTS.map(([key, title]) => ({ key, title: title.split(':')[0] })),
    { shown: () => shown, apply, say: refuse });
  plots.on_change = () => {
    const paused = plots.paused !== undefined;
    $('pause').classList.toggle('on', paused);
    $('pause').textContent = paused ? 'Go on' : 'Pause';
    $('unzoom').hidden = !plots.zoomed;
    want(drawing.overview);
  };
  $('unzoom').addEventListener('click', () => plots.zoom());
  $('refused_close').addEventListener('click', () => {
    refused.length = 0;
    showRefused();
  });
  $('camera').addEventListener('click', () => robot?.resetCamera());
  document.addEventListener('keydown', onKey);
  // A list that was used keeps no keys.
  for (const list of document.querySelectorAll('select')) list.addEventListener('change', () => list.blur());
  $('pause').addEventListener('click', () => plots.pause(plots.paused === undefined));
  $('joint').addEventListener('change', () => {
    shown.joint = Number($('joint').value);
    choose();
  });
  for (const id of ['log_level', 'log_name']) {
    $(id).addEventListener('change', () => {
      log.choose($('log_level').value, $('log_name').value);
      want(drawing.tables);
    });
  }
  $('window').addEventListener('change', () => {
    plots.window_s = shown.window_s = Number($('window').value);
    plots.zoom();
    changed();
    if (recording) refreshRecording();
  });
  $('signal').addEventListener('change', () => {
    const signal = $('signal').value.trim();
    $('signal').value = '';
    addSignal(signal);
  });
  $('estop').addEventListener('click', () => command('estop'));
  $('disarm').addEventListener('click', () => command('disarm'));
  confirmed($('arm'), 'arm');
  confirmed($('reset'), 'reset');
  $('record').addEventListener('click', () => command(status?.recording.running ? 'record/stop' : 'record/start'));
  if (info.mode === 'recording') {
    await showRecording(place);
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
  topics, plots, events, shown, refused, timeline: () => timeline, survey: () => survey,
  figures: () => ({
    seconds: (performance.now() - figures.began_ms) / 1000, received: figures.received, samples: topics.samples, lost: topics.lost,
    message_ms: figures.message_ms, plot_ms: plots.task_ms, plot_draws: plots.draws, plot_cost_ms: drawing.plots.cost_ms,
    robot_ms: robot?.task_ms ?? 0, robot_frames: robot?.frames ?? 0, signals: topics.table.columns.size, state: connected,
  }),
};

start().catch((error) => say(`The page cannot start: ${error.message}`));
