// SPDX-License-Identifier: MIT
// What may happen before an instruction. Each gets the bench and its number in the run, 0 or 1, and returns false where it
// cannot: no character leaves, say. What belongs to a time comes by time: the core stands still until then, as it does
// behind a miss of flash or in an interrupt that is not the port's.
'use strict';
const {FE, PE} = require('../../rp2040/pl011.js');
const {ECHO, DRIVER_ALARM, INT_RT} = require('./bench.js');

const PARITY = 4, FRAMING = 8, OVERRUN = 16; // FATHOM_RX_
const VALUES = [0xa1, 0xd3];
const PAUSE_NS = 25e6;
const IRQ = {driverAlarm: 1, edges: 13, serial: 20, uart: 21};

// hal.h: what comes in while the line settings change is garbage, or lost.
function canArrive(uart) { return uart.enabled && uart.rx.length < uart.depth; }

function arrive(uart, bytes, value, errors, flags) {
  if (!canArrive(uart)) return false;
  bytes.push({value, flags});
  uart.receive(value, errors);
  return true;
}

function behind(uart, bytes, value) {
  uart.overrun = canArrive(uart);
  return arrive(uart, bytes, value, 0, OVERRUN);
}

function standStillTo(bench, ns) {
  if (ns < bench.ns) return false;
  bench.stall(ns - bench.ns);
  return true;
}

function left(bench, uart) {
  return uart.leaving !== null && standStillTo(bench, uart.leaving.end);
}

function spurious(bench, irq) {
  bench.pend(irq);
  return true;
}

const EVENTS = {
  byte: (bench, n) => arrive(bench.uart, bench.truth.bytes, VALUES[n], 0, 0),
  flawed: (bench, n) => arrive(bench.uart, bench.truth.bytes, ~VALUES[n] & 0xff, PE | FE, PARITY | FRAMING),
  behind: (bench, n) => behind(bench.uart, bench.truth.bytes, VALUES[n] + 1),
  // The receive time-out of what waits in the FIFO.
  silence: (bench) => {
    const {uart} = bench;
    if (uart.rx.length === 0 || !bench.isScheduled(uart.timeOut)) return false;
    uart.timeOut.cancel();
    uart.raise(INT_RT);
    return true;
  },
  // A character has left; all have; the alarm of the driver is due.
  left: (bench) => left(bench, bench.uart),
  gone: (bench) => {
    const {uart} = bench;
    return uart.leaving !== null && standStillTo(bench, uart.leaving.end + uart.tx.length * uart.bits * uart.bitNs);
  },
  alarm: (bench) => {
    const {armed, clockAlarm} = bench.timer.alarms[DRIVER_ALARM];
    return armed && standStillTo(bench, clockAlarm.nanos);
  },
  // Nothing but time, longer than any alarm of the scenarios.
  pause: (bench) => standStillTo(bench, bench.ns + PAUSE_NS),
  edge: (bench) => {
    const {edges} = bench.truth;
    edges.push(bench.ns);
    bench.machine.pin(ECHO).setInputValue(edges.length % 2 !== 0);
    return true;
  },
  // Interrupts that come although their cause has gone.
  spuriousUart: (bench) => spurious(bench, IRQ.uart),
  spuriousAlarm: (bench) => spurious(bench, IRQ.driverAlarm),
  spuriousEdge: (bench) => spurious(bench, IRQ.edges),

  serialByte: (bench, n) => arrive(bench.serial, bench.truth.serialBytes, VALUES[n], 0, 0),
  serialFlawed: (bench, n) => arrive(bench.serial, bench.truth.serialBytes, ~VALUES[n] & 0xff, PE | FE, PARITY | FRAMING),
  serialBehind: (bench, n) => behind(bench.serial, bench.truth.serialBytes, VALUES[n] + 1),
  serialLeft: (bench) => left(bench, bench.serial),
  spuriousSerial: (bench) => spurious(bench, IRQ.serial),
};

// Those for which time passes come first of two in one instant.
const TAKES_TIME = new Set(['left', 'gone', 'alarm', 'pause', 'serialLeft']);

// [{event, number}] in the order in which they happen in one instant.
function inInstant(events) {
  return [...events.filter(({event}) => TAKES_TIME.has(event)), ...events.filter(({event}) => !TAKES_TIME.has(event))];
}

module.exports = {EVENTS, inInstant, OVERRUN, PARITY, FRAMING};
