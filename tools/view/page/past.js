// Messages that came, so that a signal that is added begins with its past. Bounded: the oldest go, of whatever topic.

export const MOST_BYTES = 96 << 20;  // 40 s of all topics of the rig
const OF_EACH_BYTES = 120;  // what a message costs beside its payload
const TIDY = 4096;  // messages that are gone before their places are given back

export class Past {
  constructor(most_bytes = MOST_BYTES) {
    this.most_bytes = most_bytes;
    this.restart();
  }

  restart() {
    this.messages = [];  // [topic, view], as they came
    this.first = 0;
    this.bytes = 0;
  }

  keep(name, view) {
    this.messages.push([name, view]);
    this.bytes += view.byteLength + OF_EACH_BYTES;
    while (this.bytes > this.most_bytes && this.first < this.messages.length) {
      this.bytes -= this.messages[this.first][1].byteLength + OF_EACH_BYTES;
      this.messages[this.first++] = undefined;
    }
    if (this.first < TIDY || 2 * this.first < this.messages.length) return;
    this.messages = this.messages.slice(this.first);
    this.first = 0;
  }

  // Those of a topic, the oldest first.
  *of(name) {
    for (let i = this.first; i < this.messages.length; ++i) if (this.messages[i][0] === name) yield this.messages[i][1];
  }
}
