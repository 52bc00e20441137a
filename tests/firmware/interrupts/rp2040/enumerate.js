// SPDX-License-Identifier: MIT
// All boundaries of a scenario's path, all its events at each, and the serial orders that the results are compared with.
'use strict';
const {Bench, Hang} = require('./bench.js');
const {EVENTS, inInstant} = require('./events.js');
const {outcome} = require('./outcome.js');
const {checkRules} = require('./rules.js');

const ALONE = 1, TOGETHER = 2, PAIRS = 3;
const MOST_COMPLAINTS = 8;
// Of a serial order: 0 and 1 are before the path, 2 and 3 after it; two in one slot are in one instant. Of two alike the
// first stays the first.
const SLOTS_OF_ONE = [[0], [2]];
const SLOTS_ALIKE = [[0, 1], [0, 0], [0, 2], [2, 3], [2, 2]];
const SLOTS_OF_TWO = [...SLOTS_ALIKE, [1, 0], [2, 0], [3, 2]];

class Enumeration {
  constructor(scenario, depth) {
    Object.assign(this, {scenario, depth});
    this.bench = new Bench(scenario);
    this.snapshots = this.bench.snapshots;
    this.figures = {boundaries: 0, alone: 0, deferred: 0, together: 0, pairs: 0};
    this.covered = new Set();
    this.wrongs = 0;
    this.serials = new Map(); // events: what may come of them
    scenario.prepare(this.bench);
    this.bench.rest();
    this.bench.run.entered = [];
    this.base = this.snapshots.take();
  }

  complain(what) {
    if (++this.wrongs > MOST_COMPLAINTS) return;
    const where = this.bench.run.raised.map(({event, at}) => `${event} at ${at.toString(16)}`).join(' and ');
    console.log(`wrong ${this.scenario.name}: ${where}: ${what}`);
  }

  // ---- a run ----

  raise(event, number) {
    const {bench} = this;
    const {run} = bench;
    const before = bench.pending;
    if (!EVENTS[event](bench, number)) return false;
    const pended = bench.pending & ~before;
    run.raised.push({event, number, at: bench.pc, canEnter: bench.canEnter(pended), isBehind: before !== 0, step: run.step,
      pended});
    return true;
  }

  toBegin() {
    const {bench, scenario} = this;
    Object.assign(bench.run, {steps: 0, isArmed: true});
    bench.ask(scenario.call, scenario.given);
    while (!bench.run.isInPath) bench.step();
  }

  // The rest of the run, and what came of it.
  toEnd(after = () => {}) {
    const {bench, scenario} = this;
    while (bench.run.isArmed) bench.step();
    bench.rest();
    const returned = bench.done(scenario.call, scenario.given);
    after();
    bench.settle();
    return outcome(bench, scenario.call, returned);
  }

  // ---- serial orders ----

  serial(events, slots) {
    const {bench} = this;
    this.snapshots.restore(this.base);
    const pass = (slot) => {
      const here = events.map((event, number) => ({event, number})).filter((_, i) => slots[i] === slot);
      for (const {event, number} of inInstant(here)) EVENTS[event](bench, number);
      bench.rest();
    };
    pass(0);
    pass(1);
    this.toBegin();
    const result = this.toEnd(() => {
      pass(2);
      pass(3);
    });
    const wrong = checkRules(bench, result, this.scenario);
    if (wrong) this.complain(`${events.join(' and ')} in ${slots.join(' and ')}: ${wrong}`);
    return result.seen;
  }

  // Leaves the machine as it was.
  serialsOf(events) {
    const key = events.join(' ');
    if (!this.serials.has(key)) {
      const kept = this.snapshots.take();
      const isAlike = events[0] === events[1];
      const all = events.length === 1 ? SLOTS_OF_ONE : isAlike ? SLOTS_ALIKE : SLOTS_OF_TWO;
      this.serials.set(key, new Set(all.map((slots) => this.serial(events, slots))));
      this.snapshots.restore(kept);
    }
    return this.serials.get(key);
  }

  // ---- comparison ----

  // What came alone where it could interrupt has done so there.
  wasThere() {
    const {raised, entered} = this.bench.run;
    const [first] = raised;
    if (raised.length !== 1 || first.pended === 0 || first.isBehind) return null;
    const there = entered.find(({irq, step}) => step >= first.step && (first.pended >> irq & 1) !== 0);
    if (!there) return 'its interrupt never came';
    const isThere = there.step === first.step && there.from === first.at;
    if (!isThere) this.figures.deferred++;
    return isThere === first.canEnter ? null : 'its interrupt did not come at that boundary';
  }

  // fathom_rp2040_edges_init once more: hal.h, "what was captured before is forgotten".
  get isForgetful() { return this.scenario.isForgetful && this.bench.run.raised.some(({event}) => event === 'edge'); }

  finish(figure) {
    const {bench} = this;
    let wrong = null;
    this.figures[figure]++;
    try {
      if (figure === 'alone') this.aside();
      const result = this.toEnd();
      wrong = checkRules(bench, result, this.scenario) || this.wasThere();
      const events = bench.run.raised.slice().sort((a, b) => a.number - b.number).map(({event}) => event);
      if (!wrong && !this.isForgetful && !this.serialsOf(events).has(result.seen))
        wrong = `no serial order comes to this: ${result.seen}`;
    } catch (error) {
      wrong = error instanceof Hang ? error.message : error.stack;
    }
    if (wrong) this.complain(wrong);
  }

  // ---- boundaries ----

  // What of the path is carried out only behind the first event is broken into as well, once.
  aside() {
    const {bench, snapshots} = this;
    const begin = snapshots.take();
    const {core} = bench.machine;
    while (bench.run.isArmed) {
      if (core.IPSR === 0 && !core.interruptsUpdated && !this.covered.has(bench.pc)) this.breakAside();
      bench.step();
    }
    snapshots.restore(begin);
  }

  breakAside() {
    const here = this.snapshots.take();
    this.covered.add(this.bench.pc);
    for (const second of this.scenario.events) {
      if (this.raise(second, 1)) this.finish('pairs');
      this.snapshots.restore(here);
    }
  }

  // Both in one instant.
  together(here, first, second) {
    this.snapshots.restore(here);
    const happened = inInstant([{event: first, number: 0}, {event: second, number: 1}])
      .filter(({event, number}) => this.raise(event, number));
    if (happened.length === 2) this.finish('together');
  }

  // The second at each boundary behind this one, those of the first one's interrupt among them.
  later() {
    const {bench} = this;
    bench.step();
    while (bench.run.isArmed) {
      const here = this.snapshots.take();
      for (const second of this.scenario.pairs) {
        if (this.raise(second, 1)) this.finish('pairs');
        this.snapshots.restore(here);
      }
      bench.step();
    }
  }

  atBoundary(here) {
    const {events, pairs} = this.scenario;
    events.forEach((first, i) => {
      this.snapshots.restore(here);
      if (!this.raise(first, 0)) return;
      const raised = this.depth === PAIRS && pairs.includes(first) ? this.snapshots.take() : null;
      this.finish('alone');
      if (this.depth >= TOGETHER) events.slice(i).forEach((second) => this.together(here, first, second));
      if (raised === null) return;
      this.snapshots.restore(raised);
      this.later();
    });
    this.snapshots.restore(here);
  }

  // false: something was wrong.
  run() {
    const {bench} = this;
    this.toBegin();
    const begin = this.snapshots.take();
    for (; bench.run.isArmed; bench.step()) this.covered.add(bench.pc);
    this.snapshots.restore(begin);
    for (; bench.run.isArmed; bench.step()) {
      this.figures.boundaries++;
      this.atBoundary(this.snapshots.take());
    }
    const instructions = bench.run.step;
    this.finishAlone();
    for (const address of [...this.covered].sort()) console.log(`covered ${address.toString(16)}`);
    console.log(`figures ${this.scenario.name},${Object.values(this.figures).join()}`);
    if (this.figures.boundaries !== instructions) this.complain(`${this.figures.boundaries} boundaries, ${instructions} steps`);
    return this.wrongs === 0;
  }

  // The path that nothing broke into.
  finishAlone() {
    const wrong = checkRules(this.bench, this.toEnd(), this.scenario);
    if (wrong) this.complain(wrong);
  }
}

module.exports = {Enumeration};
