// SPDX-License-Identifier: MIT
// An RP2040 (rp2040js) that runs an image: time, pins, UARTs (pl011.js), and what the code costs.
//
// How far the cycles can be trusted: rp2040js counts what ARM's manual gives for each instruction of a Cortex-M0+, no
// wait for SIO, 3 or 4 more for a peripheral, and flash as fast as RAM. It leaves out the entry to an interrupt (15) and
// the return (13), and misses in the cache before the flash, some 50 cycles each: true for code in RAM or in the cache.
'use strict';
const assert = require('assert');
const {Simulator} = require('rp2040js');
const {readElf} = require('./elf.js');
const {Pl011} = require('./pl011.js');

const FLASH = 0x10000000, RAM = 0x20000000;
const CYCLE_NS = 8; // 125 MHz
const US = 1000, MS = 1000000;
const RESETS = 0x4000c, UARTS = [0x40034, 0x40038], RESET_OF_UART0 = 22;
const WATCHDOG = 0x40058, TICK = 0x2c;
const SCRATCH0 = 0x4005800c, SCRATCH1 = 0x40058010, ENDED = 0x454e4421; // examples/rp2040/board.h

class Machine {
  // image: rp2040_IMAGE.elf. startUs: what TIMER shows at reset, up to 2^32. scratch: {number: value} of the watchdog's registers.
  constructor(image, {startUs = 0, scratch = {}} = {}) {
    Machine.change(this);
    this.mcu = new Simulator().rp2040;
    this.clock = this.mcu.clock;
    this.core = this.mcu.core;
    this.clock.nanosCounter = startUs * US;
    this.warnings = [];
    const ignore = () => {};
    const keep = (where, what) => this.warnings.push(`${where}: ${what}`);
    this.mcu.logger = {debug: ignore, info: ignore, warn: keep, error: keep};

    this.uart = UARTS.map((page, number) => (this.mcu.peripherals[page] = new Pl011(this.mcu, number)));
    this.watchResets();
    this.watchTick();
    this.mendPrimask();
    const path = `${process.env.FATHOM_IMAGES}/rp2040_${image}.elf`;
    const {segments, symbols} = readElf(path);
    this.symbols = symbols;
    for (const {address, bytes} of segments) this.mcu.flash.set(bytes, address - FLASH);
    for (const [number, value] of Object.entries(scratch)) this.mcu.writeUint32(SCRATCH0 + 4 * number, value);
    this.core.VTOR = FLASH;
    this.core.reset();
    this.interrupts = new Map(); // number: cycles of the longest one
    this.watchInterrupts();
    this.watched = new Map(); // address: what to call with the machine
  }

  // RESETS of rp2040js resets nothing. Here all UARTs begin in reset, as they do on the chip.
  watchResets() {
    const resets = this.mcu.peripherals[RESETS];
    const write = resets.writeUint32.bind(resets);
    resets.reset = 0x1ffffff;
    resets.writeUint32 = (offset, value) => {
      write(offset, value);
      resets.reset_done = ~resets.reset & 0x1ffffff;
      this.uart.forEach((uart, number) => {
        uart.inReset = (resets.reset >> (RESET_OF_UART0 + number) & 1) !== 0;
        if (uart.inReset) uart.reset();
      });
    };
  }

  // rp2040js's TIMER counts microseconds, whatever its tick is set to. So that is kept for the test.
  watchTick() {
    const watchdog = this.mcu.peripherals[WATCHDOG];
    const write = watchdog.writeUint32.bind(watchdog);
    watchdog.writeUint32 = (offset, value) => {
      if (offset === TICK) this.tick = value;
      write(offset, value);
    };
  }

  // With PRIMASK set WFI ends, but the exception waits (ARMv6-M B1.5.19); rp2040js would take it there.
  mendPrimask() {
    const {core} = this;
    const check = core.checkForInterrupts.bind(core);
    core.checkForInterrupts = () => (core.PM ? core.waiting && this.hasPending : check());
  }

  get hasPending() { return (this.core.pendingInterrupts & this.core.enabledInterrupts) !== 0; }

  // The longest run of each interrupt, without those that interrupted it.
  watchInterrupts() {
    const {core} = this;
    this.running = [];
    const [enter, leave] = [core.exceptionEntry.bind(core), core.exceptionReturn.bind(core)];
    core.exceptionEntry = (number) => {
      this.running.push({number: number - 16, since: core.cycles, others: 0});
      enter(number);
    };
    core.exceptionReturn = (value) => {
      leave(value);
      const {number, since, others} = this.running.pop();
      const all = core.cycles - since;
      if (this.running.length > 0) this.running[this.running.length - 1].others += all;
      this.interrupts.set(number, Math.max(this.interrupts.get(number) || 0, all - others));
    };
  }

  address(name) {
    if (!this.symbols.has(name)) throw new Error(`the image has no ${name}`);
    return this.symbols.get(name) & ~1;
  }

  // Calls `enter` whenever the function begins and `leave` when it has returned: both get the machine, leave also the
  // result and the cycles, interrupts included. No recursion.
  watch(name, leave, enter = () => {}) {
    this.watched.set(this.address(name), () => {
      const [back, stack, since] = [this.core.LR & ~1, this.core.SP, this.core.cycles];
      enter(this);
      const before = this.watched.get(back);
      this.watched.set(back, () => {
        if (before) before();
        if (this.core.SP !== stack) return;
        if (before) this.watched.set(back, before);
        else this.watched.delete(back);
        leave(this, this.core.registers[0], this.core.cycles - since);
      });
    });
  }

  get us() { return this.clock.nanos / US; }
  get ended() { return this.mcu.readUint32(SCRATCH1) === ENDED; }
  get status() { return this.mcu.readUint32(SCRATCH0); }

  after(us, callback) { this.clock.createAlarm(callback).schedule(us * US); }

  // Runs until `done` says so, looked at after each instruction; it has to within `ms`.
  until(done, ms = 5000) {
    const {core, clock, watched} = this;
    const end = clock.nanos + ms * MS;
    while (!done()) {
      if (clock.nanos > end) throw new Error(`nothing after ${ms} ms`);
      if (core.waiting && this.hasPending) core.waiting = false;
      if (core.waiting) {
        if (clock.nextAlarm === null) throw new Error('it sleeps, and nothing will ever wake it');
        clock.tick(clock.nanosToNextAlarm);
        continue;
      }
      const at = watched.get(core.PC & ~1);
      if (at) at();
      clock.tick(core.executeInstruction() * CYCLE_NS);
    }
  }

  run(ms) {
    let isOver = false;
    this.after(ms * MS / US, () => { isOver = true; });
    this.until(() => isOver || this.ended, ms + 1);
  }

  runTo(us) { this.run((us - this.us) * US / MS); }

  // The one that runs; when the next one begins, or the test ends, it has to be well.
  static change(machine) {
    if (Machine.current) Machine.current.assertWell();
    Machine.current = machine;
  }

  // The firmware did nothing that the manuals forbid, or the simulator does not know.
  assertWell() {
    const ended = this.ended ? [`the firmware ended with ${this.status}`] : [];
    assert.deepStrictEqual([...ended, ...this.warnings, ...this.uart.flatMap((uart) => uart.violations)], []);
  }

  // Of all the time the core is awake for so much, and for less than `most`.
  awake(most) {
    const share = this.core.cycles / (this.us * 125);
    assert.ok(share < most, `awake for ${share} of the time`);
    return share;
  }

  // Calls `callback` before the instruction that is so many from now, 1 for the next; returns {isDue}, false after that.
  beforeInstruction(number, callback) {
    const {core} = this;
    const step = core.executeInstruction;
    const waiting = {isDue: true};
    core.executeInstruction = () => {
      if (waiting.isDue && --number === 0) {
        waiting.isDue = false;
        core.executeInstruction = step;
        callback();
      }
      return step.call(core);
    };
    return waiting;
  }

  halfword(name, offset) { return this.mcu.sramView.getUint16(this.symbols.get(name) - RAM + offset, true); }

  pin(gpio) { return this.mcu.gpio[gpio]; }

  // The levels that an output takes: [{high, at}], times in ns.
  record(gpio) {
    const levels = [];
    this.pin(gpio).addListener((state) => {
      if (state <= 1) levels.push({high: state === 1, at: this.clock.nanos});
    });
    return levels;
  }
}

module.exports = {Machine, US, MS};
