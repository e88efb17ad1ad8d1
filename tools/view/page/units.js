// Units of signals, from their names, and the least range that an axis has.

const TOKENS = new Set(['rad', 'rad2', 'Nm', 'N', 'm', 's', 's2', 'bar', 'A', 'V', 'W', 'J', 'kg', 'degC', 'Hz', 'ms', 'us', 'ns', 'MB', 'percent']);
const WRITTEN = { rad2: 'rad\u00b2', s2: 's\u00b2', degC: '\u00b0C', us: '\u00b5s', percent: '%' };
// docs/decisions/0003: the fields of a prismatic joint have metres for rad and newtons for Nm.
const OF_PRISMATIC = { rad: 'm', rad2: 'm\u00b2', Nm: 'N' };
const PRISMATIC = 'JOINT_PRISMATIC';
export const MINUS = ' - ';  // "A - B" is the difference of two signals

// Least ranges, so that the noise of a joint that stands still does not fill the plot: 25 counts of an encoder of 14 bits
// (0.4 mrad), velocities as such a count makes them within a tick of 240 Hz, 1 % of the torque and current of the
// rig's drive, three times the noise of a pressure sensor, lengths as a lever of 0.2 m makes them from angles.
const LEAST = { rad: 0.01, 'rad/s': 0.1, 'rad/s\u00b2': 5, Nm: 0.3, m: 0.002, 'm/s': 0.02, 'm/s\u00b2': 1, N: 1.5, bar: 0.2, A: 0.1, V: 0.2,
  '\u00b0C': 1, '\u00b5s': 20, s: 1e-4 };

// The signals that a plotted name needs: itself, or both of a difference.
export const partsOf = (name) => name.split(MINUS);

// kinds: joint_state.joint_kind. Empty: it has no unit.
export function unitOf(name, kinds = []) {
  const signal = partsOf(name)[0];
  const field = signal.slice(signal.lastIndexOf('.') + 1);
  const index = /\[(\d+)\]$/.exec(field)?.[1];
  const words = field.replace(/\[.*$/, '').split('_');
  let first = words.length;
  while (first > 1 && TOKENS.has(words[first - 1])) --first;
  // Of a motor a number is the shaft's, whatever the joint is.
  const moves = index !== undefined && kinds[index] === PRISMATIC && words[0] !== 'motor';
  return words.slice(first).map((word) => (moves && OF_PRISMATIC[word]) || WRITTEN[word] || word).join('/');
}

// Of the joints: the one unit that all have, or undefined.
export function commonUnit(unit, kinds) {
  const units = new Set(kinds.map((kind) => jointUnit(unit, kind)));
  return units.size > 1 ? undefined : [...units][0] ?? unit;
}

// unit: rad or Nm.
export const jointUnit = (unit, kind) => (kind === PRISMATIC ? OF_PRISMATIC[unit] : unit);

export const leastRange = (unit) => LEAST[unit] ?? 0;

// From least to greatest, no narrower than the unit's least range.
export function widened(least, greatest, unit) {
  const lacking = leastRange(unit) - (greatest - least);
  return lacking > 0 ? [least - lacking / 2, greatest + lacking / 2] : [least, greatest];
}
