// Tables of the page: joints, participants, topics, buses, clients.

const STALE_S = 3;  // a participant reports once a second

const words = (name, prefix) => (typeof name === 'string' ? name.replace(prefix, '').toLowerCase().replaceAll('_', ' ') : '-');
const fixed = (number, digits) => (Number.isFinite(number) ? number.toFixed(digits) : '-');

// Rows of [text, class] or text; the first row is the head.
function fill(table, head, rows, empty) {
  const cell = (tag, value) => {
    const element = document.createElement(tag);
    const [text, kind] = Array.isArray(value) ? value : [value, ''];
    element.textContent = text;
    if (kind) element.className = kind;
    return element;
  };
  const line = (tag, values) => {
    const row = document.createElement('tr');
    row.append(...values.map((value) => cell(tag, value)));
    return row;
  };
  const body = rows.length > 0 ? rows.map((row) => line('td', row)) : [line('td', [[empty, 'empty']])];
  if (rows.length === 0) body[0].firstChild.colSpan = head.length;
  // A head stands over its column as the values do.
  const heads = head.map((text, i) => [text, rows.length > 0 && Array.isArray(rows[0][i]) && rows[0][i][1].startsWith('number') ? 'number' : '']);
  table.replaceChildren(line('th', heads), ...body);
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
      ? words(residual.state[j], 'RESIDUAL_') + (alarm ? `: ${words(residual.follows[j], 'CAUSE_')}` : '') : '-';
    const contact = regime && regime.contact[j] !== 'CONTACT_NONE' ? ` ${words(regime.contact[j], 'CONTACT_')}` : '';
    rows.push([
      [names?.[j] ?? `joint ${j}`, state.valid[j] ? '' : 'bad'],
      [fixed(state.position_rad[j], 3), 'number'],
      [fixed(state.torque_Nm[j], 2), 'number'],
      [prediction?.valid[j] ? fixed(prediction.torque_Nm[j], 2) : '-', 'number'],
      [actuator ? fixed(actuator.chamber_pressure_bar[j], 2) : '-', 'number'],
      regime ? words(regime.regime[j], 'REGIME_').toUpperCase() + contact : '-',
      [residual ? fixed(residual.residual_Nm[j], 3) : '-', 'number'],
      [follows, alarm ? 'bad' : ''],
    ]);
  }
  fill(table, ['joint', 'rad (m)', 'Nm (N)', 'predicted', 'bar', 'regime', 'residual', 'follows'], rows, '');
}

export function participants(table, rows) {
  fill(table, ['participant', 'state', 'cycles/s', 'stale', 'missed', 'CPU %', 'MB', 'age s', 'message'], rows.map((row) => [
    [row.name, ''],
    [row.standby && row.state === 'active' ? 'standby' : row.state, row.state === 'fault' ? 'bad' : row.state === 'active' ? 'good' : ''],
    [fixed(row.cycles_Hz, 0), 'number'], [row.stale_inputs, 'number'],
    [row.missed_ticks, 'number'], [row.cpu_percent === null ? '-' : fixed(row.cpu_percent, 0), 'number'],
    [fixed(row.resident_MB, 0), 'number'], [fixed(row.age_s, 1), row.age_s > STALE_S ? 'number bad' : 'number'],
    [row.message, 'wide'],
  ]), 'no participant heard');
}

export function topics(table, rows, received) {
  fill(table, ['topic', '1/s', 'age s', 'messages', 'ticks missing'], rows.map((row) => {
    const here = received.topics.get(row.name);
    const plotted = here && here.signals.length > 0;
    return [row.name, [fixed(row.rate_Hz, 0), 'number'], [fixed(row.age_s, 1), 'number'], [row.messages, 'number'],
      [plotted ? here.lost : '-', plotted && here.lost > 0 ? 'number bad' : 'number']];
  }), 'nothing heard');
}

export function buses(table, status) {
  const rows = [];
  for (let i = 0; status && i < status.bus_count; ++i) {
    rows.push([`bus ${i}`, status.up[i] ? ['up', 'good'] : ['down', 'bad'], [fixed(status.load_percent[i], 0), 'number'],
      [fixed(status.answer_p50_us[i], 0), 'number'], [fixed(status.answer_max_us[i], 0), 'number'],
      [status.frames_dropped[i] + status.frames_lost[i], 'number'], [status.error_frames[i], 'number']]);
  }
  table.parentElement.hidden = rows.length === 0;
  fill(table, ['', 'state', 'load %', 'answer us', 'worst', 'lost', 'errors'], rows, '');
}

export function clients(table, rows) {
  fill(table, ['client', 'subscriptions', 'sent', 'waiting', 'lost'], rows.map((row) => [row.address, [row.subscriptions, 'number'],
    [row.sent, 'number'], [row.waiting, 'number'], [row.lost, row.lost > 0 ? 'number bad' : 'number']]), 'none');
}
