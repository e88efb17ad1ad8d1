// Tables of the page: joints, participants, topics, buses, clients.

const STALE_S = 3;  // a participant reports once a second
const NOTHING = '-';

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

// Rows of [text, class] or text under a head. A column that nothing fills is left out; without rows there is one line.
export function fill(table, head, rows, empty) {
  const kept = head.map((_, i) => i).filter((i) => i === 0 || rows.length === 0 || rows.some((row) => !['', NOTHING].includes(textOf(row[i]))));
  // A head stands over its column as the values do.
  const heads = kept.map((i) => [head[i], rows.length > 0 ? /^(number|wide|)/.exec(kindOf(rows[0][i]))[0] : '']);
  const lines = [heads, ...(rows.length > 0 ? rows.map((row) => kept.map((i) => row[i])) : [[[empty, 'empty']]])];
  while (table.rows.length > lines.length) table.deleteRow(-1);
  lines.forEach((line, i) => {
    const row = table.rows[i] ?? table.insertRow();
    if (row.cells.length !== line.length) row.replaceChildren(...line.map(() => document.createElement(i === 0 ? 'th' : 'td')));
    line.forEach((value, j) => put(row.cells[j], value));
    if (i > 0) row.cells[0].colSpan = rows.length === 0 ? heads.length : 1;
  });
}

export function joints(table, topics, names) {
  const state = topics.newest('joint_state');
  if (!state) return fill(table, ['joint', 'position', 'torque', 'state'], [], 'no joint_state yet');
  const actuator = topics.newest('actuator_state');
  const regime = topics.newest('regime');
  const residual = topics.newest('residual');
  const prediction = topics.newest('torque_prediction');
  const rows = [];
  for (let j = 0; j < state.joint_count; ++j) {
    const alarm = residual?.alarm[j];
    const follows = residual && residual.state[j] !== 'RESIDUAL_LOST'
      ? words(residual.state[j], 'RESIDUAL_') + (alarm ? `: ${words(residual.follows[j], 'CAUSE_')}` : '') : NOTHING;
    const contact = regime && regime.contact[j] !== 'CONTACT_NONE' ? ` ${words(regime.contact[j], 'CONTACT_')}` : '';
    rows.push([
      [names?.[j] ?? `joint ${j}`, state.valid[j] ? '' : 'bad'],
      [fixed(state.position_rad[j], 3), 'number'],
      [fixed(state.torque_Nm[j], 2), 'number'],
      [prediction?.valid[j] ? fixed(prediction.torque_Nm[j], 2) : NOTHING, 'number'],
      [actuator ? fixed(actuator.chamber_pressure_bar[j], 2) : NOTHING, 'number'],
      regime ? words(regime.regime[j], 'REGIME_').toUpperCase() + contact : NOTHING,
      [residual ? fixed(residual.residual_Nm[j], 3) : NOTHING, 'number'],
      [follows, alarm ? 'bad' : ''],
    ]);
  }
  return fill(table, ['joint', 'rad (m)', 'Nm (N)', 'predicted', 'bar', 'regime', 'residual', 'follows'], rows, '');
}

// Rows as /api/status and /api/recording/participants have them.
export function participants(table, rows) {
  const several = new Set(rows.map((row) => row.host)).size > 1;
  fill(table, ['participant', 'host', 'state', 'cycles/s', 'stale', 'missed', 'CPU %', 'MB', 'age s', 'message'], rows.map((row) => [
    [row.name, ''], several ? row.host : NOTHING,
    [row.standby && row.state === 'active' ? 'standby' : row.state, row.state === 'fault' ? 'bad' : row.state === 'active' ? 'good' : ''],
    [fixed(row.cycles_Hz, 0), 'number'], [row.stale_inputs, 'number'],
    [row.missed_ticks, 'number'], [row.cpu_percent === null ? NOTHING : fixed(row.cpu_percent, 0), 'number'],
    [fixed(row.resident_MB, 0), 'number'], [fixed(row.age_s, 1), row.age_s > STALE_S ? 'number bad' : 'number'],
    [row.message, 'wide'],
  ]), 'no participant heard');
}

export function topics(table, rows, received) {
  fill(table, ['topic', '1/s', 'age s', 'messages', 'ticks missing'], rows.map((row) => {
    const here = received.topics.get(row.name);
    const plotted = here && here.signals.length > 0;
    return [row.name, [fixed(row.rate_Hz, 0), 'number'], [fixed(row.age_s, 1), 'number'], [row.messages, 'number'],
      [plotted ? here.lost : NOTHING, plotted && here.lost > 0 ? 'number bad' : 'number']];
  }), 'nothing heard');
}

export function buses(table, status) {
  const rows = [];
  for (let i = 0; status && i < status.bus_count; ++i) {
    rows.push([`bus ${i}`, status.up[i] ? ['up', 'good'] : ['down', 'bad'], [fixed(status.load_percent[i], 0), 'number'],
      [fixed(status.answer_p50_us[i], 0), 'number'], [fixed(status.answer_max_us[i], 0), 'number'],
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
