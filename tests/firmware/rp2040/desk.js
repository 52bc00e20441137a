// SPDX-License-Identifier: MIT
// images/desk.c: the port's functions called one at a time.
'use strict';
const {Machine} = require('./machine.js');

const RAM = 0x20000000;
const ASK = 0, OPERATION = 4, ARGUMENTS = 8, RESULT = 40, FLAGS = 44, LAST_US = 48, BYTES = 52;
const OPERATIONS = ['begin', 'read', 'write', 'sent', 'setLine', 'setBreak', 'idle', 'output', 'set', 'input', 'get', 'now',
  'counter', 'leavesInUs'];
const TIMED = 1; // FATHOM_RX_TIMED
const PARITY = {N: 0, E: 1, O: 2};

class Desk {
  constructor(options) {
    this.machine = new Machine('desk', options);
    this.base = this.machine.symbols.get('desk') - RAM;
    this.machine.run(0.1); // to where it looks at the desk
  }

  word(offset, value) {
    const {sramView} = this.machine.mcu;
    if (value === undefined) return sramView.getUint32(this.base + offset, true);
    return sramView.setUint32(this.base + offset, value, true);
  }

  bytes(count) { return [...this.machine.mcu.sram.subarray(this.base + BYTES, this.base + BYTES + count)]; }

  // Calls it, and returns at once; see `call`.
  ask(operation, ...given) {
    if (this.word(ASK) !== 0) throw new Error('the desk is at work');
    given.forEach((value, i) => this.word(ARGUMENTS + 4 * i, Number(value)));
    this.word(OPERATION, OPERATIONS.indexOf(operation));
    this.word(ASK, 1);
    this.machine.core.waiting = false;
  }

  get isDone() { return this.word(ASK) === 0; }

  // Calls it, runs until it has returned, and returns what it did.
  call(operation, ...given) {
    this.ask(operation, ...given);
    this.machine.until(() => this.isDone, 2000);
    return this.word(RESULT) | 0;
  }

  // line: '19200 8E1'. driver: a GPIO. clk: clk_peri as the firmware is told.
  begin(line, {number = 1, tx = 4, rx = 5, driver = 255, clk = 125e6} = {}) {
    return this.call('begin', ...Desk.line(line), number, tx, rx, driver, clk);
  }

  setLine(line) { return this.call('setLine', ...Desk.line(line)); }

  static line(text) {
    const [, baud, parity, stop] = /^(\d+) 8([NEO])(\d)$/.exec(text);
    return [Number(baud), PARITY[parity], Number(stop)];
  }

  write(bytes) {
    this.machine.mcu.sram.set(bytes, this.base + BYTES);
    return this.call('write', bytes.length);
  }

  // {bytes, flags} of one read, and lastUs if it is told.
  read(capacity = 256) {
    const count = this.call('read', capacity);
    const flags = this.word(FLAGS);
    const read = {bytes: this.bytes(count), flags: flags & ~TIMED};
    return flags & TIMED ? {...read, lastUs: this.word(LAST_US)} : read;
  }

  // Characters of `errors` (DR bits) come in one after another; it returns when the last one has come.
  receive(uart, values, errors = {}) {
    values.forEach((value, i) => {
      this.machine.run(uart.bits * uart.bitNs / 1e6);
      uart.receive(value, errors[i]);
    });
  }
}

module.exports = {Desk};
