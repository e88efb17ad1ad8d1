// When what is drawn. A job is drawn when something it shows has changed (`want`), at most every `least_ms`, and so seldom
// that it takes no more than `share` of the time (but every `most_ms`): a machine that draws slowly gets fewer pictures, and
// the rest of the page stays quick. Nothing is asked of the browser while nothing has changed; a hidden tab draws nothing.
//
// The cost of a job is its own time, and its part of layout, painting and what is drawn outside of this thread. A `heavy`
// job (3-D) bears the latter alone when it was in one of the last frames.

const FRAME_MS = 17;  // between two frames of a display; what the browser needs longer is its work for the last ones
const EARLY_MS = FRAME_MS / 2;  // a job is drawn in the frame that is nearest to its time
const FRAMES_BEHIND = 3;  // pictures that may wait to be made

// A browser as the frames need it; tests have another one.
const browser = {
  now: () => performance.now(),
  after: (ms, call) => setTimeout(call, ms),
  cancel: (timer) => clearTimeout(timer),
  frame: (call) => requestAnimationFrame(call),
  // Runs when layout and painting of this frame are done, which belong to its cost.
  painted: (call) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => { port1.close(); call(); };
    port2.postMessage(0);
  },
};

export class Frames {
  constructor(host = browser) {
    this.host = host;
    this.jobs = [];
    this.timer = undefined;   // until the browser is asked for a frame
    this.timer_ms = Infinity;
    this.asked_ms = undefined;  // since when a frame is asked for
    this.hidden = false;
    this.drawn = [];          // jobs of the last frames, a list each, the newest first
  }

  // draw(now_ms): true when it has drawn. Returns the job.
  add({ least_ms, most_ms = 1000, share, heavy = false, draw }) {
    const job = { least_ms, most_ms, share, heavy, draw, wanted: false, next_ms: -Infinity, began_ms: 0, cost_ms: 0 };
    this.jobs.push(job);
    return job;
  }

  want(job) {
    if (job.wanted) return;
    job.wanted = true;
    this.plan();
  }

  hide(hidden) {
    this.hidden = hidden;
    this.drawn = [];  // the time until the tab is seen again is nobody's cost
    this.plan();
  }

  // Asks for a frame when the first of the wanted jobs may be drawn.
  plan() {
    if (this.hidden || this.asked_ms !== undefined) return;
    let next_ms = Infinity;
    for (const job of this.jobs) if (job.wanted && job.next_ms < next_ms) next_ms = job.next_ms;
    if (next_ms === Infinity) return;
    const now_ms = this.host.now();
    const wait_ms = next_ms - EARLY_MS - now_ms;
    if (wait_ms < 1) {
      this.host.cancel(this.timer);
      this.timer_ms = Infinity;
      this.ask();
    } else if (next_ms < this.timer_ms) {
      this.host.cancel(this.timer);
      this.timer_ms = next_ms;
      this.timer = this.host.after(wait_ms, () => {
        this.timer_ms = Infinity;
        if (!this.hidden && this.asked_ms === undefined) this.ask();
      });
    }
  }

  ask() {
    this.asked_ms = this.host.now();
    this.host.frame(() => this.frame());
  }

  frame() {
    const now_ms = this.host.now();
    this.charge(now_ms - this.asked_ms - FRAME_MS);  // it was waiting for the pictures of the last ones
    const drawn = [];
    this.drawn = [drawn, ...this.drawn].slice(0, FRAMES_BEHIND);
    try {
      if (!this.hidden) for (const job of this.jobs) if (job.wanted && job.next_ms <= now_ms + EARLY_MS) this.draw(job, now_ms, drawn);
    } finally {  // a job that throws does not stop the others
      const done_ms = this.host.now();
      this.asked_ms = undefined;
      if (drawn.length > 0) this.host.painted(() => this.charge(this.host.now() - done_ms));
      this.plan();
    }
  }

  draw(job, now_ms, drawn) {
    job.wanted = false;
    job.began_ms = this.host.now();
    const has_drawn = job.draw(now_ms);
    job.cost_ms = this.host.now() - job.began_ms;
    this.wait(job);
    if (has_drawn) drawn.push(job);
  }

  wait(job) { job.next_ms = job.began_ms + Math.max(job.least_ms, Math.min(job.cost_ms / job.share, job.most_ms)); }

  // More cost of what was drawn. Jobs of one frame share it, since nobody knows whose it is.
  charge(more_ms) {
    if (!(more_ms > 0)) return;
    const heavy = [...new Set(this.drawn.flat())].filter((job) => job.heavy);
    const jobs = heavy.length > 0 ? heavy : this.drawn[0] ?? [];
    for (const job of jobs) {
      job.cost_ms += more_ms / jobs.length;
      this.wait(job);
    }
  }
}

// Calls when the element comes into the window or leaves it.
export function watchVisibility(element, call) {
  new IntersectionObserver((entries) => call(entries.at(-1).isIntersecting)).observe(element);
}
