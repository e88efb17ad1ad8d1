// A client of the Foxglove WebSocket protocol that connects again by itself.

// The first: many messages in a frame (tools/view/protocol.h); servers of others have the second alone.
const BATCHES = 'sinew.batch.v1';
const SUBPROTOCOL = 'foxglove.websocket.v1';
const MESSAGE_DATA = 1;
const HEAD_BYTES = 13;  // opcode, subscription, stamp
const LENGTH_BYTES = 4;
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;

export class Connection {
  // handlers: advertise(channels), message(topic, DataView), state(text), report(text).
  constructor(url, handlers) {
    this.url = url;
    this.handlers = handlers;
    this.wanted = new Set();
    this.wait_ms = FIRST_WAIT_MS;
    this.open();
  }

  open() {
    this.channels = new Map();  // topic -> channel number
    this.subscribed = new Map();  // subscription -> topic
    this.next = 1;
    this.handlers.state('connecting');
    this.socket = new WebSocket(this.url, [BATCHES, SUBPROTOCOL]);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onmessage = (event) => this.take(event.data);
    this.socket.onclose = () => {
      this.handlers.state('disconnected');
      setTimeout(() => this.open(), this.wait_ms);
      this.wait_ms = Math.min(2 * this.wait_ms, LONGEST_WAIT_MS);
    };
  }

  // Topics from now on; those that are not there yet are subscribed to when they are.
  subscribe(topics) {
    for (const topic of topics) this.wanted.add(topic);
    const taken = new Set(this.subscribed.values());
    const subscriptions = [];
    for (const topic of this.wanted) {
      if (taken.has(topic) || !this.channels.has(topic)) continue;
      const id = this.next++;
      this.subscribed.set(id, topic);
      subscriptions.push({ id, channelId: this.channels.get(topic) });
    }
    if (subscriptions.length > 0) this.socket.send(JSON.stringify({ op: 'subscribe', subscriptions }));
  }

  take(data) {
    if (typeof data === 'string') {
      const message = JSON.parse(data);
      if (message.op === 'serverInfo') {
        this.wait_ms = FIRST_WAIT_MS;
        this.handlers.state('connected');
      } else if (message.op === 'advertise') {
        for (const channel of message.channels) this.channels.set(channel.topic, channel.id);
        this.handlers.advertise(message.channels);
        this.subscribe([]);
      } else if (message.op === 'status') {
        this.handlers.report(message.message);
      }
      return;
    }
    const view = new DataView(data);
    if (this.socket.protocol !== BATCHES) {
      this.takeMessage(view, 0, view.byteLength);
      return;
    }
    for (let at = 0; at < view.byteLength;) {
      const size = view.getUint32(at, true);
      at += LENGTH_BYTES;
      this.takeMessage(view, at, size);
      at += size;
    }
  }

  // A message data frame of `size` bytes from `at` on.
  takeMessage(view, at, size) {
    if (view.getUint8(at) !== MESSAGE_DATA) return;
    const topic = this.subscribed.get(view.getUint32(at + 1, true));
    if (topic !== undefined) this.handlers.message(topic, new DataView(view.buffer, at + HEAD_BYTES, size - HEAD_BYTES));
  }
}
