// Flattened IDL to types, and CDR bytes to numbers by them: the subset that our topics use (idl/README.md),
// XCDR version 1 (RTPS 2.5, 10.2). Offsets count from the first byte after the 4-byte header.
//
// 64-bit integers become numbers: exact to 2^53, stamps of today to 256 ns.

const SIZES = {
  bool: 1, octet: 1, char: 1, int16: 2, uint16: 2, int32: 4, uint32: 4, int64: 8, uint64: 8, float: 4, double: 8, enum: 4,
};

const HIGH_WORD = 2 ** 32;  // the sum rounds once, as the conversion of a BigInt does, which would be made for every message

const READ = {
  bool: (view, at) => view.getUint8(at),
  octet: (view, at) => view.getUint8(at),
  char: (view, at) => view.getUint8(at),
  int16: (view, at, little) => view.getInt16(at, little),
  uint16: (view, at, little) => view.getUint16(at, little),
  int32: (view, at, little) => view.getInt32(at, little),
  uint32: (view, at, little) => view.getUint32(at, little),
  int64: (view, at, little) => view.getInt32(little ? at + 4 : at, little) * HIGH_WORD + view.getUint32(little ? at : at + 4, little),
  uint64: (view, at, little) => view.getUint32(little ? at + 4 : at, little) * HIGH_WORD + view.getUint32(little ? at : at + 4, little),
  float: (view, at, little) => view.getFloat32(at, little),
  double: (view, at, little) => view.getFloat64(at, little),
  enum: (view, at, little) => view.getUint32(at, little),
};

const WORDS = {
  boolean: 'bool', octet: 'octet', uint8: 'octet', char: 'char', short: 'int16', 'unsigned short': 'uint16', long: 'int32',
  'unsigned long': 'uint32', 'long long': 'int64', 'unsigned long long': 'uint64', float: 'float', double: 'double',
};

const HEADER_BYTES = 4;

class Tokens {
  constructor(text) {
    const bare = text.replace(/\/\*[\s\S]*?\*\//g, ' ').replace(/\/\/[^\n]*/g, ' ').replace(/^\s*#[^\n]*/gm, ' ');
    this.list = bare.match(/[A-Za-z_][A-Za-z0-9_]*(?:::[A-Za-z_][A-Za-z0-9_]*)*|\d+|[@{}<>[\](),;:=]|"[^"]*"/g) ?? [];
    this.at = 0;
  }
  get done() { return this.at >= this.list.length; }
  peek() { return this.list[this.at]; }
  next() { return this.list[this.at++]; }
  expect(token) {
    const found = this.next();
    if (found !== token) throw new Error(`IDL: '${found}', expected '${token}'`);
  }
}

// Types by their scoped name. Throws Error naming what was expected.
export function parseIdl(text) {
  const tokens = new Tokens(text);
  const types = new Map();
  const scope = [];
  const scoped = (name) => [...scope, name].join('::');
  const find = (name) => {
    for (let depth = scope.length; depth >= 0; --depth) {
      const type = types.get([...scope.slice(0, depth), name].join('::'));
      if (type) return type;
    }
    throw new Error(`IDL: no type '${name}', expected one that stands before`);
  };
  const bound = (close) => {
    let count = 0;
    if (tokens.peek() === ',' || tokens.peek() === '<' || tokens.peek() === '[') {
      tokens.next();
      count = Number(tokens.next());
    }
    if (close) tokens.expect(close);
    return count;
  };
  const typeOf = () => {
    let word = tokens.next();
    if (word === 'string') return { kind: 'string', bound: tokens.peek() === '<' ? bound('>') : 0 };
    if (word === 'sequence') {
      tokens.expect('<');
      const element = typeOf();
      return { kind: 'sequence', element, bound: bound('>') };
    }
    while (word === 'unsigned' || (word.endsWith('long') && tokens.peek() === 'long')) word += ` ${tokens.next()}`;
    return WORDS[word] ? { kind: WORDS[word] } : find(word);
  };
  const annotations = () => {
    while (tokens.peek() === '@') {
      tokens.next();
      const name = tokens.next();
      if (['appendable', 'mutable', 'optional'].includes(name)) throw new Error(`IDL: @${name} changes the encoding, expected @final`);
      if (tokens.peek() === '(') while (tokens.next() !== ')') { /* its value */ }
    }
  };
  const struct = () => {
    const type = { kind: 'struct', name: scoped(tokens.next()), members: [] };
    tokens.expect('{');
    while (tokens.peek() !== '}') {
      annotations();
      const member = typeOf();
      for (let more = true; more;) {
        const name = tokens.next();
        const count = tokens.peek() === '[' ? bound(']') : 0;
        type.members.push({ name, type: count ? { kind: 'array', element: member, count } : member });
        more = tokens.peek() === ',';
        if (more) tokens.next();
      }
      tokens.expect(';');
    }
    tokens.expect('}');
    tokens.expect(';');
    types.set(type.name, type);
  };
  const enumeration = () => {
    const type = { kind: 'enum', name: scoped(tokens.next()), values: [] };
    tokens.expect('{');
    while (tokens.peek() !== '}') {
      annotations();
      type.values.push(tokens.next());
      if (tokens.peek() === ',') tokens.next();
    }
    tokens.expect('}');
    tokens.expect(';');
    types.set(type.name, type);
  };
  while (!tokens.done) {
    annotations();
    const word = tokens.next();
    if (word === 'module') {
      scope.push(tokens.next());
      tokens.expect('{');
    } else if (word === '}') {
      if (scope.length === 0) throw new Error("IDL: '}' without its module");
      scope.pop();
      tokens.expect(';');
    } else if (word === 'struct') {
      struct();
    } else if (word === 'enum') {
      enumeration();
    } else {
      throw new Error(`IDL: '${word}', expected module, struct or enum`);
    }
  }
  if (scope.length > 0) throw new Error(`IDL: no end of module ${scope.at(-1)}`);
  return types;
}

const aligned = (at, size) => at + ((size - (at % size)) % size);

// A whole message as an object; enums are their names (numbers where there is none, or without `names`). Throws where the
// bytes end early.
export function decode(type, view, names = true) {
  const little = (view.getUint8(1) & 1) === 1;
  let at = 0;
  const value = (of) => {
    if (of.kind === 'struct') {
      const out = {};
      for (const member of of.members) out[member.name] = value(member.type);
      return out;
    }
    if (of.kind === 'array') return Array.from({ length: of.count }, () => value(of.element));
    if (of.kind === 'sequence' || of.kind === 'string') {
      at = aligned(at, 4);
      const count = view.getUint32(HEADER_BYTES + at, little);
      at += 4;
      if (HEADER_BYTES + at + count > view.byteLength) throw new RangeError('CDR: a length beyond the end of the message');
      if (of.kind === 'sequence') return Array.from({ length: count }, () => value(of.element));
      const bytes = new Uint8Array(view.buffer, view.byteOffset + HEADER_BYTES + at, Math.max(count - 1, 0));
      at += count;
      return new TextDecoder().decode(bytes);
    }
    at = aligned(at, SIZES[of.kind]);
    const number = READ[of.kind](view, HEADER_BYTES + at, little);
    at += SIZES[of.kind];
    if (of.kind === 'enum') return (names ? of.values[number] : undefined) ?? number;
    return of.kind === 'bool' ? number !== 0 : number;
  };
  return value(type);
}

// Offset after a value of a type that begins at `at`; undefined when its size varies.
function after(type, at) {
  if (type.kind === 'struct') return type.members.reduce((end, member) => (end === undefined ? end : after(member.type, end)), at);
  if (type.kind === 'array') {
    let end = at;
    for (let i = 0; i < type.count && end !== undefined; ++i) end = after(type.element, end);
    return end;
  }
  const size = SIZES[type.kind];
  return size === undefined ? undefined : aligned(at, size) + size;
}

// A function (DataView) -> number for a path such as "header.tick" or "position_rad[0]". Throws Error: there is no such
// number.
export function getter(type, path) {
  const steps = path.match(/[^.[\]]+/g) ?? [];
  let at = 0;
  let now = type;
  for (const step of steps) {
    if (now.kind === 'struct') {
      const index = now.members.findIndex((member) => member.name === step);
      if (index < 0) throw new Error(`${type.name}: no field '${path}'`);
      for (const member of now.members.slice(0, index)) at = at === undefined ? at : after(member.type, at);
      now = now.members[index].type;
    } else if (now.kind === 'array' && Number(step) < now.count) {
      for (let i = 0; i < Number(step) && at !== undefined; ++i) at = after(now.element, at);
      now = now.element;
    } else if (now.kind === 'sequence' && /^\d+$/.test(step)) {
      at = undefined;
      now = now.element;
    } else {
      throw new Error(`${type.name}: no field '${path}'`);
    }
  }
  const read = READ[now.kind];
  if (!read) throw new Error(`${type.name}: '${path}' is no number`);
  if (at === undefined) {  // something before it varies in size
    return (view) => {
      const value = steps.reduce((object, step) => object?.[step], decode(type, view, false));
      return Number(value ?? NaN);
    };
  }
  const offset = HEADER_BYTES + aligned(at, SIZES[now.kind]);
  return (view) => read(view, offset, (view.getUint8(1) & 1) === 1);
}

// Paths of all numbers of a message; of arrays the first `most` elements.
export function numberPaths(type, most = 12, prefix = '') {
  const paths = [];
  for (const member of type.members) {
    const path = prefix + member.name;
    const element = member.type.kind === 'array' ? member.type.element : member.type;
    if (element.kind === 'struct') {
      if (member.type.kind === 'struct') paths.push(...numberPaths(element, most, `${path}.`));
    } else if (READ[element.kind]) {
      const count = member.type.kind === 'array' ? Math.min(member.type.count, most) : 0;
      if (count === 0) paths.push(path);
      for (let i = 0; i < count; ++i) paths.push(`${path}[${i}]`);
    }
  }
  return paths;
}
