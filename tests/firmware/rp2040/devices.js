// SPDX-License-Identifier: MIT
// The far ends: an A16 with PWM output at two pins, an HPS-167S on a UART with an RS-485 driver, and a terminal.
'use strict';
const {US, MS} = require('./machine.js');

// Answers each falling edge of its RX with the next pulse (us; 0: none), `before` us later. Keeps each trigger,
// {at, low}, and each edge that it made, in ns.
class A16 {
  constructor(machine, {rx, tx, pulses, before = 110000}) {
    Object.assign(this, {machine, pulses: [...pulses], triggers: [], edges: []});
    const out = machine.pin(tx);
    out.setInputValue(false);
    let fell = null;
    machine.pin(rx).addListener((state) => {
      if (state === 0) fell = machine.clock.nanos;
      if (state !== 1 || fell === null) return;
      this.triggers.push({at: fell, low: machine.clock.nanos - fell});
      fell = null;
      const width = this.pulses.length > 0 ? this.pulses.shift() : 0;
      if (width > 0) machine.after(before, () => this.pulse(out, width));
    });
  }

  pulse(out, width) {
    const edge = (high) => {
      this.edges.push(this.machine.clock.nanos);
      out.setInputValue(high);
    };
    edge(true);
    this.machine.after(width, () => edge(false));
  }
}

// 01 03 00 08 00 04 C5 CB and 01 03 08 08 23 DC B2 07 01 00 00 FD 41 (HPS-167S table 17 and command #5).
const REQUEST = [0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xc5, 0xcb];
const RESPONSE = [0x01, 0x03, 0x08, 0x08, 0x23, 0xdc, 0xb2, 0x07, 0x01, 0x00, 0x00, 0xfd, 0x41];
const CHARACTER_NS = 11e9 / 19200; // 8E1
const T1_5_NS = 1.5 * CHARACTER_NS, T3_5_NS = 3.5 * CHARACTER_NS; // HPS-167S 2.2.3

// Takes requests from a UART and answers each by `responses`: {after, errors} in turns, the last one for ever. after: us
// from the request's end to the response's start, undefined: never. errors: {index: DR bits}. It hears only what leaves
// while the driver is on, and keeps each transaction: {start, end, answered} in ns.
class Hps167s {
  constructor(machine, {uart, driver, responses}) {
    Object.assign(this, {machine, uart, responses: [...responses], driver: machine.record(driver), transactions: [], heard: []});
    uart.onSent = (character) => this.hear(character);
  }

  hear(character) {
    const last = this.heard[this.heard.length - 1];
    if (last && character.start - last.end > T1_5_NS) this.heard = [];
    this.heard.push(character);
    if (this.heard.length < REQUEST.length) return;
    const frame = this.heard;
    this.heard = [];
    if (frame.some(({value, format}, i) => value !== REQUEST[i] || format !== '8E1')) return;
    const transaction = {start: frame[0].start, end: character.end, answered: null, characters: frame};
    this.transactions.push(transaction);
    const {after, errors} = this.responses.length > 1 ? this.responses.shift() : this.responses[0];
    if (after !== undefined) this.machine.after(after, () => this.answer(transaction, errors || {}));
  }

  answer(transaction, errors) {
    RESPONSE.forEach((value, i) => this.machine.after((i + 1) * CHARACTER_NS / US, () => {
      this.uart.receive(value, errors[i]);
      if (i === RESPONSE.length - 1) transaction.answered = this.machine.clock.nanos;
    }));
  }
}

const READING = 'target 2083 mm, raw 2083'; // what is printed of RESPONSE
const MEASURING = {after: 3000}; // what the device takes
const NEVER = {after: undefined};
const NO_RESPONSE = 'error -3', CHECKSUM = 'error -4', STALE = 'error -7';
const WRAP_NS = 2 ** 32 * US; // of TIMER

// The lines of text that UART 0 has sent.
class Terminal {
  constructor(machine) {
    Object.assign(this, {machine, lines: []});
    let line = '';
    machine.uart[0].onSent = ({value}) => {
      if (value !== 10) line += String.fromCharCode(value);
      else {
        this.lines.push(line);
        line = '';
      }
    };
  }

  // Runs until so many lines have come, within `ms`, and returns those.
  first(count, ms) {
    this.machine.until(() => this.lines.length >= count || this.machine.ended, ms);
    return this.lines.slice(0, count);
  }
}

module.exports = {
  A16, Hps167s, Terminal, CHARACTER_NS, T3_5_NS, US, MS, READING, MEASURING, NEVER, NO_RESPONSE, CHECKSUM, STALE, WRAP_NS,
};
