// SPDX-License-Identifier: MIT
// The image "interrupts" on the machine of ../../rp2040: calls of the port, instruction by instruction.
//
// Besides what machine.js mends of rp2040js, an interrupt that waits goes on waiting when its cause has gone, and is
// cleared by its entry (ARMv6-M's NVIC, B3.4.1): rp2040js forgets it.
'use strict';
const {Machine} = require('../../rp2040/machine.js');
const {Snapshots, LOWEST_STACK} = require('./snapshot.js');

const RAM = 0x20000000, CYCLE_NS = 8, US = 1000;
const WATCHDOG = 0x40058, SCRATCH0 = 0x0c;
// calls.h
const CALL = {now: 1, read: 2, write: 3, sent: 4, leaves: 5, setLine: 6, setBreak: 7, arm: 8, take: 9, idle: 10, pin: 11,
  level: 12, edgesBegin: 13, serialRead: 14, serialWrite: 15, serialLeaves: 16};
const FIELD = {call: 0, length: 4, flags: 8, baud: 12, parity: 16, stopBits: 20, result: 24, firstUs: 28, secondUs: 32,
  isHigh: 36, bytes: 40};
const WITHOUT = 3, REPORT = 2;
const NO_DRIVER = 1, NO_IDLE = 2, NO_PIN = 4;
const READY = 1, BEGIN = 2, END = 3;
const ECHO = 3, DRIVER = 6, OUTPUT = 7;
const DRIVER_ALARM = 1;
const INT_RT = 1 << 6; // of the UART
const MOST_STEPS = 100000;

class Hang extends Error {}

class Bench {
  constructor({without = 0, startUs = 0}) {
    this.machine = new Machine('interrupts', {startUs, scratch: {[WITHOUT]: without}});
    const {core, mcu} = this.machine;
    this.timer = mcu.peripherals[0x40054];
    this.onEntry = null;
    // What has happened. bytes: {value, flags}; sent: values; edges, silences: ns; levels: of the driver.
    this.truth = {bytes: [], sent: [], serialBytes: [], serialSent: [], edges: [], levels: [], silences: [], stalledNs: 0, hasBreak: false};
    this.run = {report: 0, steps: 0, isArmed: false, raised: [], entered: [], step: 0, beginNs: 0, endNs: 0, wasBusy: false, isBusy: false, isInPath: false};
    core.levels = 0;
    this.snapshots = new Snapshots(this.machine, [this.truth, this.run]);
    this.latchInterrupts();
    this.watchReports();
    this.watchSilences();
    mcu.gpio[DRIVER].addListener((state) => {
      if (state <= 1) this.truth.levels.push({high: state === 1, at: this.machine.clock.nanos});
    });
    this.calls = this.machine.symbols.get('calls') - RAM;
    while (this.report !== READY || !core.waiting) this.step();
    this.truth.levels.length = 0;
  }

  latchInterrupts() {
    const {core} = this.machine;
    const [enter, leave] = [core.exceptionEntry.bind(core), core.exceptionReturn.bind(core)];
    core.setInterrupt = (irq, high) => {
      const bit = 1 << irq;
      const before = core.levels;
      core.levels = high ? before | bit : before & ~bit;
      if (high && (before & bit) === 0) this.pend(irq);
    };
    core.exceptionEntry = (number) => {
      const from = core.PC & ~1;
      enter(number);
      core.pendingInterrupts &= ~(1 << (number - 16));
      this.run.entered.push({irq: number - 16, from, step: this.run.step - 1, at: this.ns, isInPath: this.run.isInPath});
    };
    core.exceptionReturn = (value) => {
      const bit = 1 << (core.IPSR - 16);
      leave(value);
      if ((core.levels & bit) !== 0) core.pendingInterrupts |= bit;
    };
  }

  // It waits, whatever its line says.
  pend(irq) {
    const {core} = this.machine;
    core.pendingInterrupts |= 1 << irq;
    core.interruptsUpdated = true;
    if (core.waiting && core.checkForInterrupts()) core.waiting = false;
  }

  watchReports() {
    const watchdog = this.machine.mcu.peripherals[WATCHDOG];
    const write = watchdog.writeUint32.bind(watchdog);
    watchdog.writeUint32 = (offset, value) => {
      if (offset === SCRATCH0 + 4 * REPORT) this.reported(value);
      write(offset, value);
    };
  }

  watchSilences() {
    const {uart} = this;
    const raise = uart.raise.bind(uart);
    uart.raise = (bit) => {
      if (bit === INT_RT) this.truth.silences.push(this.ns);
      raise(bit);
    };
  }

  reported(value) {
    this.run.report = value;
    if (!this.run.isArmed) return; // a call that only looks at what came of the path
    if (value === BEGIN) Object.assign(this.run, {isInPath: true, beginNs: this.ns, wasBusy: this.isBusy});
    if (value === END) Object.assign(this.run, {isArmed: false, isInPath: false, endNs: this.ns, isBusy: this.isBusy});
  }

  get report() { return this.run.report; }
  get ns() { return this.machine.clock.nanos; }
  get uart() { return this.machine.uart[1]; }
  get serial() { return this.machine.uart[0]; }
  get pc() { return this.machine.core.PC & ~1; }
  get pending() { return this.machine.core.pendingInterrupts & this.machine.core.enabledInterrupts; }

  // Has something of UART1's request not left yet?
  get isBusy() { return this.uart.busy || this.uart.sent.length < this.truth.sent.length; }

  byte(name, offset) { return this.machine.mcu.sram[this.machine.symbols.get(name) - RAM + offset]; }

  half(name, offset) { return this.machine.halfword(name, offset); }

  poke(name, offset, bytes) { this.machine.mcu.sram.set(bytes, this.machine.symbols.get(name) - RAM + offset); }

  field(name, value) {
    const {sramView} = this.machine.mcu;
    if (value === undefined) return sramView.getUint32(this.calls + FIELD[name], true);
    return sramView.setUint32(this.calls + FIELD[name], value, true);
  }

  bytes(count) { return [...this.machine.mcu.sram.subarray(this.calls + FIELD.bytes, this.calls + FIELD.bytes + count)]; }

  // May one of these interrupts come before the next instruction?
  canEnter(irqs) {
    const {core} = this.machine;
    for (let irq = 0; irq < 26; irq++)
      if ((irqs >> irq & 1) !== 0 && core.exceptionPriority(16 + irq) < core.exceptionPriority(core.IPSR)) return !core.PM;
    return false;
  }

  // One instruction, or in a sleep the time to what comes next.
  step() {
    const {machine} = this;
    const {core, clock} = machine;
    if (++this.run.steps > MOST_STEPS) throw new Hang('it hangs');
    if (this.run.isInPath) this.run.step++;
    if (core.waiting && machine.hasPending) core.waiting = false;
    if (core.waiting) {
      if (clock.nextAlarm === null) throw new Hang('it sleeps, and nothing will ever wake it');
      clock.tick(clock.nanosToNextAlarm);
      return;
    }
    clock.tick(core.executeInstruction() * CYCLE_NS);
    if (core.SP < LOWEST_STACK) throw new Hang('the stack is deeper than what is kept');
    if (machine.ended) throw new Hang(`the image has ended with ${machine.status}`);
  }

  // Time passes, without an instruction: the core waits for the bus, say.
  stall(ns) {
    this.truth.stalledNs += ns;
    this.machine.clock.tick(ns);
  }

  // It sleeps and waits for a call.
  get isIdle() {
    const {core} = this.machine;
    return this.field('call') === 0 && core.waiting && this.pending === 0;
  }

  rest() {
    while (!this.isIdle) this.step();
  }

  isScheduled(wanted) {
    for (let alarm = this.machine.clock.nextAlarm; alarm !== null; alarm = alarm.next) if (alarm === wanted) return true;
    return false;
  }

  // Until nothing leaves any more, no alarm is set, and the time-out of what came is over.
  settle() {
    const wanted = [this.uart.shift, this.uart.timeOut, this.serial.shift, ...this.timer.alarms.map((one) => one.clockAlarm)];
    this.rest();
    while (wanted.some((alarm) => this.isScheduled(alarm)) || !this.isIdle) this.step();
  }

  ask(call, {length = 0, flags = 0, baud = 0, parity = 0, stopBits = 0, mostUs = 0, bytes = []} = {}) {
    Object.entries({length, flags, baud, parity, stopBits, firstUs: mostUs}).forEach(([name, value]) => this.field(name, value));
    this.machine.mcu.sram.set(bytes, this.calls + FIELD.bytes);
    this.field('call', CALL[call]);
    this.machine.core.waiting = false;
  }

  call(call, given) {
    this.ask(call, given);
    this.rest();
    return this.done(call, given);
  }

  // What a call that has returned has done.
  done(call, given = {}) {
    const result = this.field('result') | 0;
    if (call === 'write' && result > 0) this.truth.sent.push(...given.bytes.slice(0, result));
    if (call === 'serialWrite' && result > 0) this.truth.serialSent.push(...given.bytes.slice(0, result));
    if (call === 'setBreak') this.truth.hasBreak = true;
    const values = {result, flags: this.field('flags'), firstUs: this.field('firstUs'), secondUs: this.field('secondUs'),
      isHigh: this.field('isHigh') & 1};
    if (call === 'read' || call === 'serialRead') values.bytes = this.bytes(Math.max(0, result));
    return values;
  }
}

module.exports = {Bench, Hang, ECHO, DRIVER, OUTPUT, DRIVER_ALARM, NO_DRIVER, NO_IDLE, NO_PIN, INT_RT, END, US};
