// Tables of the page: joints, participants, topics, buses, clients.

import { commonUnit, jointUnit } from './units.js';

const STALE_S = 3;  // a participant reports once a second
const OLD_S = 0.25;  // behind the joint_state, or since it came: values are dimmed
const OLD_TOPIC_S = 2;  // at least, and
const OLD_PERIODS = 20;  // of the topic
const NOTHING = '-';
const OF_HEAD = new Set(['number', 'wide', 'minor']);  // minor: a phone has no room for it

const words = (name, prefix) => (typeof name === 'string' ? name.replace(prefix, '').toLowerCase().replaceAll('_', ' ') : NOTHING);
const fixed = (number, digits) => (Number.isFinite(number) ? number.toFixed(digits).replace(/^-(0\.?0*)$/, '$1') : NOTHING);
const textOf = (value) => String(Array.isArray(value) ? value[0] : value);
const kindOf = (value) => (Array.isArray(value) ? value[1] : '');

// Writes what has changed, so that a table that stays as it is costs no layout.
function put(element, value) {
  const text = textOf(value);
  const kind = kindOf(value);
  if (element.shown !== text) {
    element.textContent = text;
    element.shown = text;
    if (kind.includes('wide')) element.title = text;
  }
  if ((element.kind ?? '') !== kind) {
    element.className = kind;
    element.kind = kind;
  }
}

// A class with `old` when the values are: the page dims them.
const dimmed = (kind, old) => (old ? `${kind} old`.trim() : kind);

// Whether a message is too old to be shown as what is now: behind the joint_state by its stamp.
export const isOld = (state, message) => message !== undefined && (state.header.stamp_ns - message.header.stamp_ns) * 1e-9 > OLD_S;

// Rows of [text, class] or text under a head. A column that nothing fills is left out; without rows there is one line, under the first head.
export function fill(table, head, rows, empty) {
  const kept = head.map((_, i) => i).filter((i) => i === 0 || rows.some((row) => !['', NOTHING].includes(textOf(row[i]))));
  // A head stands over its column as the values do.
  const heads = kept.map((i) => [head[i], rows.length > 0 ? kindOf(rows[0][i]).split(' ').filter((word) => OF_HEAD.has(word)).join(' ') : '']);
  const lines = [heads, ...(rows.length > 0 ? rows.map((row) => kept.map((i) => row[i])) : [[[empty, 'empty']]])];
  while (table.rows.length > lines.length) table.deleteRow(-1);
  lines.forEach((line, i) => {
    const row = table.rows[i] ?? table.insertRow();
    if (row.cells.length !== line.length) row.replaceChildren(...line.map(() => document.createElement(i === 0 ? 'th' : 'td')));
    line.forEach((value, j) => put(row.cells[j], value));
  });
}

// age_s: since the joint_state came; 0 of a recording.
export function joints(table, topics, names, age_s = 0) {
  const state = topics.newest('joint_state');
  if (!state) return fill(table, ['joint', 'position', 'torque', 'state'], [], 'no joint_state yet');
  const actuator = topics.newest('actuator_state');
  const regime = topics.newest('regime');
  const residual = topics.newest('residual');
  const prediction = topics.newest('torque_prediction');
  const all_old = age_s > OLD_S;
  const old = (message) => all_old || isOld(state, message);
  const kinds = state.joint_kind.slice(0, state.joint_count);
  const [length, force] = [commonUnit('rad', kinds), commonUnit('Nm', kinds)];
  const rows = [];
  for (let j = 0; j < state.joint_count; ++j) {
    const alarm = residual?.alarm[j];
    const follows = residual && residual.state[j] !== 'RESIDUAL_LOST'
      ? words(residual.state[j], 'RESIDUAL_') + (alarm ? `: ${words(residual.follows[j], 'CAUSE_')}` : '') : NOTHING;
    const contact = regime && regime.contact[j] !== 'CONTACT_NONE' ? ` ${words(regime.contact[j], 'CONTACT_')}` : '';
    // Joints of both kinds: each number has its unit.
    const with_unit = (number, digits, unit, common) => {
      const text = fixed(number, digits);
      return common || text === NOTHING ? text : `${text} ${jointUnit(unit, kinds[j])}`;
    };
    const lost = all_old || state.age_us[j] * 1e-6 > OLD_S;  // the last known ones
    rows.push([
      [names?.[j] ?? `joint ${j}`, state.valid[j] ? '' : 'bad'],
      [with_unit(state.position_rad[j], 3, 'rad', length), dimmed('number', lost)],
      [with_unit(state.torque_Nm[j], 2, 'Nm', force), dimmed('number', lost)],
      [prediction?.valid[j] ? with_unit(prediction.torque_Nm[j], 2, 'Nm', force) : NOTHING, dimmed('number minor', old(prediction))],
      [actuator ? fixed(actuator.chamber_pressure_bar[j], 2) : NOTHING, dimmed('number', old(actuator))],
      [regime ? words(regime.regime[j], 'REGIME_').toUpperCase() + contact : NOTHING, dimmed('', old(regime))],
      [residual ? with_unit(residual.residual_Nm[j], 3, 'Nm', force) : NOTHING, dimmed('number', old(residual))],
      [follows, dimmed(alarm ? 'bad' : '', old(residual))],
    ]);
  }
  return fill(table, ['joint', length ?? 'position', force ?? 'torque', 'predicted', 'bar', 'regime', 'residual', 'follows'], rows, '');
}

// Rows as /api/status and /api/recording/participants have them.
export function participants(table, rows) {
  const several = new Set(rows.map((row) => row.host)).size > 1;
  fill(table, ['participant', 'host', 'state', 'cycles/s', 'stale', 'missed', 'CPU %', 'MB', 'age s', 'message'], rows.map((row) => {
    const old = row.age_s > STALE_S;
    const count = (number) => [number, dimmed(number > 0 ? 'number bad' : 'number', old)];
    const number = (value, digits) => [value === null ? NOTHING : fixed(value, digits), dimmed('number minor', old)];
    return [
      [row.name, dimmed('', old)], several ? [row.host, dimmed('minor', old)] : NOTHING,
      [row.standby && row.state === 'active' ? 'standby' : row.state,
        dimmed(row.state === 'fault' ? 'bad' : row.state === 'active' ? 'good' : '', old)],
      number(row.cycles_Hz, 0), count(row.stale_inputs), count(row.missed_ticks), number(row.cpu_percent, 0), number(row.resident_MB, 0),
      [fixed(row.age_s, 1), old ? 'number bad' : 'number'], [row.message, dimmed('wide', old)],
    ];
  }), 'no participant heard');
}

export function topics(table, rows, received) {
  fill(table, ['topic', '1/s', 'age s', 'messages', 'ticks missing'], rows.map((row) => {
    const here = received.topics.get(row.name);
    const plotted = here && here.signals.length > 0;
    const old = row.age_s > Math.max(OLD_TOPIC_S, OLD_PERIODS / Math.max(row.rate_Hz, 1e-3));
    return [[row.name, dimmed('', old)], [fixed(row.rate_Hz, 0), dimmed('number', old)], [fixed(row.age_s, 1), dimmed('number', old)],
      [row.messages, dimmed('number', old)], [plotted ? here.lost : NOTHING, dimmed(plotted && here.lost > 0 ? 'number bad' : 'number', old)]];
  }), 'nothing heard');
}

export function buses(table, status) {
  const rows = [];
  for (let i = 0; status && i < status.bus_count; ++i) {
    rows.push([`bus ${i}`, status.up[i] ? ['up', 'good'] : ['down', 'bad'], [fixed(status.load_percent[i], 0), 'number'],
      [fixed(status.answer_p50_us[i], 0), 'number minor'], [fixed(status.answer_max_us[i], 0), 'number minor'],
      [status.frames_dropped[i] + status.frames_lost[i], 'number'], [status.error_frames[i], 'number'],
      // Recordings of earlier builds lack the body nodes' counts.
      [status.body_samples_missed?.[i] ?? NOTHING, 'number'], [status.body_nodes_lost?.[i] ?? NOTHING, 'number']]);
  }
  table.closest('.card').hidden = rows.length === 0;
  fill(table, ['bus', 'state', 'load %', 'answer us', 'worst us', 'frames lost', 'error frames', 'body samples missed', 'body nodes lost'],
    rows, '');
}

export function clients(table, rows) {
  fill(table, ['client', 'subscriptions', 'sent', 'waiting', 'lost'], rows.map((row) => [row.address, [row.subscriptions, 'number'],
    [row.sent, 'number'], [row.waiting, 'number'], [row.lost, row.lost > 0 ? 'number bad' : 'number']]), 'none');
}
