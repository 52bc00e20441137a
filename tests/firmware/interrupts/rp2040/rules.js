// SPDX-License-Identifier: MIT
// What the headers say, whatever came first. Each returns what is wrong, or null.
'use strict';
const {US} = require('./bench.js');
const {OVERRUN} = require('./events.js');

const TIMED = 1; // FATHOM_RX_TIMED
const WAKE_US = 30; // the longest way into the port's sleep and out of it, with two interrupts
const IDLE_IRQ = 2;
const NEWS = new Set(['edge', 'byte', 'silence']); // where they interrupt
const TICK_US = 2; // what is lost where whole microseconds are reckoned with
const TIME_OUT_BITS = 32;

function within(value, fromUs, toUs) {
  return ((value - Math.floor(fromUs)) >>> 0) <= Math.ceil(toUs) - Math.floor(fromUs);
}

// hal.h: "now_us is monotonic"; fathom_rp2040.h: "us". Each reading is the time at some instant of its call.
function checkNow({run}, {returned}) {
  const [begin, end] = [run.beginNs / US, run.endNs / US];
  if (!within(returned.firstUs, begin, end)) return 'the clock is wrong';
  if (!within(returned.secondUs, returned.firstUs, end)) return 'the second reading is wrong, or earlier';
  return null;
}

// hal.h: "in how many microseconds from now, at most, the last stop bit will have left"; "a bit too long at most".
function checkLeaves({run, uart}, {returned}) {
  const last = uart.sent.length === 0 ? 0 : uart.sent[uart.sent.length - 1].end / US;
  const us = returned.firstUs;
  if (us + TICK_US < last - run.endNs / US) return 'more leaves than it says';
  const mostUs = Math.max(0, last - run.beginNs / US) + uart.bitNs / US + WAKE_US;
  return us > mostUs ? 'it is more than a bit too long' : null;
}

// hal.h: "True when the last stop bit of all that was written has left the pin." fathom_rp2040.h: "is exact".
function checkSent({run}, {returned}) {
  if (returned.result !== 0 && run.isBusy) return 'it is not sent';
  return returned.result === 0 && !run.wasBusy ? 'it is sent' : null;
}

// The level at some instant of the call.
function checkLevel({run, truth}, isHigh) {
  const before = truth.edges.filter((at) => at < run.beginNs).length;
  const all = truth.edges.filter((at) => at <= run.endNs).length;
  for (let edges = before; edges <= all; edges++) if (edges % 2 === isHigh) return null;
  return 'that is not the level';
}

// fathom_rp2040.h: "Sleeps (WFI) until an interrupt comes or max_us have passed, and returns; at once if there is news."
// Of what is no news only what comes after the look at it has to end the sleep.
function checkIdle({run, truth}, result, {given}) {
  const us = (run.endNs - run.beginNs) / US;
  const woke = run.entered.filter(({isInPath, irq}) => isInPath && irq !== IDLE_IRQ);
  const isNews = run.raised.some(({event}) => NEWS.has(event));
  const slackUs = WAKE_US + truth.stalledNs / US;
  if (us > given.mostUs + slackUs) return 'it sleeps too long';
  if (given.hasNews && us > slackUs) return 'it sleeps in spite of news';
  if (isNews && woke.length !== 0 && run.endNs - woke[0].at > slackUs * US) return 'it sleeps through what should wake it';
  const hasNews = given.hasNews || run.entered.some(({at}) => at < run.beginNs);
  return woke.length === 0 && !hasNews && us + TICK_US < given.mostUs ? 'it wakes of nothing' : null;
}

// Each byte once, in order, alone with the flags that are its own: hal.h, "One call never spans an error".
function checkBytes(sent, reads, mayDrop) {
  let at = 0;
  for (const {bytes, flags} of reads) {
    if ((flags & ~TIMED) !== 0 && bytes.length !== 1) return 'a flag is not of one byte';
    for (const byte of bytes) {
      let hasLost = false;
      while (mayDrop && at < sent.length && sent[at].value !== byte) {
        at++;
        hasLost = true;
      }
      if (at === sent.length) return 'a byte that was never sent, or one that came twice';
      if (sent[at].value !== byte) return 'a byte is lost, or out of order';
      if ((flags & ~TIMED) !== (sent[at].flags | (hasLost ? OVERRUN : 0))) return 'the flags of a byte are not its own';
      at++;
    }
  }
  return at === sent.length || mayDrop ? null : 'a byte is lost';
}

// hal.h: "Clock at the end of the last byte". It is that of a byte of which the time-out came 32 bits later.
function checkTimes({truth, uart}, {reads}, {call, isLate}) {
  if (call === 'setLine' || isLate) return null; // 32 bits of the rate before; as long as the ring was full
  const slackUs = WAKE_US + truth.stalledNs / US;
  const bitUs = uart.bitNs / US;
  for (const {flags, firstUs} of reads)
    if ((flags & TIMED) !== 0 &&
        !truth.silences.some((at) => Math.abs((at / US - TIME_OUT_BITS * bitUs - firstUs) | 0) <= slackUs))
      return 'the time of a byte is wrong';
  return null;
}

function isSame(values, expected) {
  return values.length === expected.length && values.every((value, i) => value === expected[i]);
}

// fathom_rp2040.h: "The driver is high from before that until BUSY has ended"; "one bit longer at most, and what other
// interrupts take".
function checkWire({truth, uart, serial}, {isSent}, {hasDriver}) {
  if (!isSame(uart.sent.map(({value}) => value), truth.sent)) return 'what is on the wire is not what was written';
  if (!isSame(serial.sent.map(({value}) => value), truth.serialSent)) return 'what is on the other wire is not it';
  if (isSent !== 1) return 'the request never counts as sent';
  if (!hasDriver) return truth.levels.length === 0 ? null : 'there is no driver';
  const {levels} = truth;
  if (truth.hasBreak) return null;
  if (levels.length !== 0 && levels[levels.length - 1].high) return 'the driver stays on';
  const longNs = uart.bitNs + WAKE_US * US + truth.stalledNs;
  for (const {start, end} of uart.sent) {
    const on = levels.findIndex(({high, at}, i) => high && at <= start && levels[i + 1].at >= end);
    if (on < 0) return 'the driver cuts a byte off';
  }
  for (const {high, at} of levels)
    if (!high && !uart.sent.some(({end}) => at >= end && at - end <= longNs)) return 'the driver stays on too long';
  return null;
}

const OF_CALL = {
  now: checkNow, leaves: checkLeaves, sent: checkSent, idle: checkIdle,
  take: (bench, {returned}) => checkLevel(bench, returned.isHigh),
  level: (bench, {returned}) => checkLevel(bench, returned.result),
};

function checkRules(bench, result, scenario) {
  const {truth, machine} = bench;
  const own = OF_CALL[scenario.call];
  const violations = [...machine.warnings, ...bench.uart.violations, ...bench.serial.violations];
  return (violations.length === 0 ? null : violations[0]) || (own ? own(bench, result, scenario) : null) ||
    checkBytes(truth.bytes, result.reads, scenario.mayDrop) ||
    checkBytes(truth.serialBytes, result.serialReads, scenario.mayDrop) ||
    checkTimes(bench, result, scenario) || checkWire(bench, result, scenario) ||
    (result.pulses.includes(-1) ? 'a pulse that never was' : null);
}

module.exports = {checkRules};
