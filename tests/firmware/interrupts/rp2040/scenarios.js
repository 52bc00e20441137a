// SPDX-License-Identifier: MIT
// Each call of the port that shares something with an interrupt, with what decides which way it goes. Instructions that
// none of them carries out are found by run.py.
'use strict';
const {EVENTS, OVERRUN, PARITY, FRAMING} = require('./events.js');
const {FE, PE, OE} = require('../../rp2040/pl011.js');
const {NO_DRIVER, NO_IDLE, NO_PIN, US} = require('./bench.js');

const FLAWED = PARITY | FRAMING;
const BYTES = 160, RING = 64, SERIAL_RING = 128;
const PARITIES = {N: 0, E: 1, O: 2};

// ---- what is there when the path begins ----

function receive(bench, count, errors = 0, flags = 0) {
  for (let i = 0; i < count; i++) {
    const value = bench.truth.bytes.length + 1;
    bench.truth.bytes.push({value, flags});
    bench.uart.receive(value, errors);
    bench.rest();
  }
}

function receiveSerial(bench, count, errors = 0, flags = 0) {
  for (let i = 0; i < count; i++) {
    const value = bench.truth.serialBytes.length + 1;
    bench.truth.serialBytes.push({value, flags});
    bench.serial.receive(value, errors);
    bench.rest();
  }
}

const request = (length) => ({length, bytes: Array.from({length}, (_, i) => 0x31 + i)});
const write = (length) => (bench) => bench.call('write', request(length));
const serialWrite = (length) => (bench) => bench.call('serialWrite', request(length));
const bytes = (count) => (bench) => receive(bench, count);
const serialBytes = (count) => (bench) => receiveSerial(bench, count);
const both = (...parts) => (bench) => parts.forEach((part) => part(bench));

// The index of the ring, and a byte that counts on, wrap behind the second byte from here.
const atTheEnd = (receiveOne, call, all) => (bench) => {
  for (let i = 0; i < 254; i++) {
    receiveOne(bench, 1);
    if (i % 50 === 49 || i === 253) {
      while (bench.call(call, {length: BYTES}).result > 0) continue;
      bench.truth[all].length = 0;
    }
  }
};
const wraps = atTheEnd(receive, 'read', 'bytes');
const serialWraps = atTheEnd(receiveSerial, 'serialRead', 'serialBytes');

function flawedSecond(bench) {
  receive(bench, 1);
  receive(bench, 1, PE | FE, FLAWED);
  receive(bench, 1);
}

function serialFlawedSecond(bench) {
  receiveSerial(bench, 1);
  receiveSerial(bench, 1, PE | FE, FLAWED);
  receiveSerial(bench, 1);
}

// With errors of DR, the counters as they are or at their end.
const erroneous = (errors, isCounted) => (bench) => {
  if (!isCounted) bench.poke('port', 0, Array(6).fill(0xff));
  const flags = (errors & PE ? PARITY : 0) | (errors & FE ? FRAMING : 0) | (errors & OE ? OVERRUN : 0);
  receive(bench, 1, errors, flags);
};

function framingUncounted(bench) {
  bench.poke('port', 2, [0xff, 0xff]);
  receive(bench, 1, PE | FE | OE, FLAWED | OVERRUN);
}

function serialLeft(bench) {
  EVENTS.serialLeft(bench);
  bench.rest();
}

// The time-out of three bytes has come, and one more came behind.
function silent(bench) {
  receive(bench, 3);
  EVENTS.silence(bench);
  bench.rest();
  receive(bench, 1);
}

// All characters have left, and the alarm for the driver has not come.
function gone(bench) {
  bench.call('write', request(2));
  const {uart} = bench;
  while (uart.busy) bench.step();
}

function inBreak(bench) { bench.call('setBreak', {flags: 1}); }

function pass(bench, us) {
  bench.machine.clock.tick(us * US);
  bench.rest();
}

function edges(bench, ...afterUs) {
  for (const us of afterUs) {
    pass(bench, us);
    EVENTS.edge(bench);
    bench.rest();
  }
}
const armed = (...afterUs) => (bench) => {
  bench.call('arm');
  edges(bench, ...afterUs);
};
// It rose before arm: the pulse counts for nothing.
const stale = (...afterUs) => (bench) => {
  edges(bench, 500);
  bench.call('arm');
  edges(bench, 500, ...afterUs);
};
const FULL = [100, 300, 100, 608, 100, 1172, 100, 2248];

// Of the clock's 2^32 us.
function nearTheEnd(bench) { bench.machine.clock.tick(2 ** 32 * US - 600 - bench.ns); }

// News that idle is told of first.
function old(bench) { bench.call('idle', {mostUs: 0}); }

// ---- the paths ----

const RECEIVED = ['byte', 'flawed', 'behind', 'silence'];
const SPURIOUS = ['spuriousUart', 'spuriousAlarm', 'spuriousEdge'];
const SENDING = ['left', 'gone', 'alarm', 'byte', 'edge', ...SPURIOUS];
const SERIAL = ['serialByte', 'serialFlawed', 'serialBehind', 'spuriousSerial', 'byte'];
const SERIAL_SENDING = ['serialLeft', 'serialByte', 'spuriousSerial'];

const scenarios = [];
function add(name, call, {prepare = () => {}, given = {}, events, pairs = events.slice(0, 2), without = 0, mayDrop = false,
  startUs = 0, isForgetful = false, isLate = false}) {
  scenarios.push({name, call, prepare, given, events, pairs, without, mayDrop, startUs, isForgetful, isLate,
    hasDriver: (without & NO_DRIVER) === 0});
}

const NOW = {events: ['edge', 'byte', 'alarm', 'spuriousUart'], prepare: write(2)};
add('now', 'now', NOW);
add('now_wraps', 'now', {...NOW, prepare: both(write(2), nearTheEnd), startUs: 2 ** 32 - 700});

function read(name, prepare, length = BYTES, more = {}) {
  add(`read_${name}`, 'read', {prepare, given: {length}, events: [...RECEIVED, 'edge', 'spuriousUart'],
    pairs: ['byte', 'silence', 'flawed'], ...more});
}
read('empty', () => {});
read('one', bytes(1));
read('three', bytes(3));
read('four', bytes(4));
read('in_part', bytes(7), 2);
read('nothing', bytes(3), 0);
read('wraps', both(wraps, bytes(3)));
read('flawed_second', flawedSecond);
for (const errors of [PE, FE, OE, PE | FE, PE | OE, FE | OE, PE | FE | OE])
  for (const isCounted of [true, false])
    read(`error_${errors.toString(16)}${isCounted ? '' : '_uncounted'}`, erroneous(errors, isCounted), BYTES,
      {events: ['byte', 'silence']});
read('framing_uncounted', framingUncounted, BYTES, {events: ['byte', 'silence']});
read('silent', silent);
read('silent_in_part', silent, 2);
read('no_idle', bytes(3), BYTES, {without: NO_IDLE});
read('leaving', both(write(40), bytes(3)), BYTES, {events: ['byte', 'silence', 'left', 'alarm'], pairs: ['byte', 'left']});
read('full', bytes(RING + 3), 1, {isLate: true});
read('full_whole', bytes(RING + 3), BYTES, {isLate: true, events: ['byte']});

function line(name, call, prepare, given = {}, more = {}) {
  add(name, call, {prepare, given, events: SENDING, pairs: ['left', 'gone', 'alarm', 'byte'], ...more});
}
line('write_one', 'write', () => {}, request(1), {events: ['pause', ...SENDING]});
line('write_most', 'write', bytes(3), request(35), {events: ['left', 'alarm', 'byte', 'silence', 'spuriousUart', 'spuriousAlarm']});
line('write_nothing', 'write', () => {}, request(0));
line('write_too_much', 'write', () => {}, request(61));
line('write_leaving', 'write', write(2), request(2));
line('write_gone', 'write', gone, request(2));
line('write_gone_more', 'write', gone, request(34), {events: ['left', 'alarm', 'spuriousUart', 'spuriousAlarm']});
line('write_in_break', 'write', inBreak, request(2));
line('write_no_driver', 'write', () => {}, request(2), {without: NO_DRIVER, events: ['left', 'gone', 'byte', 'edge']});
line('sent', 'sent', () => {});
line('sent_leaving', 'sent', write(2));
line('sent_long', 'sent', write(36), {}, {events: ['left', 'byte', 'edge', ...SPURIOUS]});
line('sent_gone', 'sent', gone);
line('leaves', 'leaves', () => {});
line('leaves_leaving', 'leaves', write(2));
line('leaves_gone', 'leaves', gone);
line('break_on', 'setBreak', () => {}, {flags: 1});
line('break_on_leaving', 'setBreak', write(1), {flags: 1});
line('break_on_gone', 'setBreak', gone, {flags: 1});
line('break_off', 'setBreak', inBreak, {flags: 0});
line('break_on_no_driver', 'setBreak', () => {}, {flags: 1}, {without: NO_DRIVER, events: ['left', 'gone', 'byte', 'edge']});
line('pin_high', 'pin', write(1), {flags: 1});
line('pin_low', 'pin', gone, {flags: 0});

function rate(name, prepare, baud, parity, stopBits) {
  add(`line_${name}`, 'setLine', {prepare, given: {baud, parity: PARITIES[parity] ?? 3, stopBits},
    events: ['byte', 'silence', 'alarm', 'gone', 'spuriousUart'], pairs: []});
}
rate('same', write(1), 19200, 'E', 1);
rate('same_rate', bytes(2), 19200, 'N', 1);
rate('stop_bits', () => {}, 19200, 'E', 2);
rate('new', gone, 9600, 'O', 2);
rate('fastest', () => {}, 7812500, 'N', 1);
rate('over_fastest', () => {}, 7900000, 'N', 1);
rate('slowest', () => {}, 118, 'N', 1);
rate('leaving', write(1), 9600, 'E', 1);
rate('in_break', inBreak, 9600, 'E', 1);
rate('too_fast', () => {}, 20000000, 'E', 1);
rate('too_slow', () => {}, 100, 'E', 1);
rate('none', () => {}, 0, 'E', 1);
rate('no_parity', () => {}, 9600, '?', 1);
rate('no_stop', () => {}, 9600, 'E', 0);

function pulse(name, call, prepare, more = {}) {
  add(name, call, {prepare, events: ['edge', 'byte', 'spuriousEdge', 'spuriousUart'], pairs: ['edge', 'spuriousEdge'], ...more});
}
pulse('arm', 'arm', armed(100, 300));
pulse('arm_high', 'arm', armed(500));
pulse('take', 'take', () => {});
pulse('take_high', 'take', armed(500));
pulse('take_one', 'take', armed(100, 300));
pulse('take_no_pin', 'take', armed(100, 300), {without: NO_PIN});
pulse('take_stale', 'take', stale());
pulse('take_stale_and_one', 'take', stale(100, 300));
pulse('take_full', 'take', armed(...FULL));
pulse('take_full_and_high', 'take', armed(...FULL, 100));
pulse('level', 'level', armed(100));
pulse('edges_begin', 'edgesBegin', armed(100, 300), {isForgetful: true});

function sleep(name, prepare, mostUs, more = {}) {
  add(name, 'idle', {prepare, given: {mostUs, hasNews: name === 'idle_news'},
    events: ['edge', 'byte', 'silence', 'alarm', 'pause', ...SPURIOUS],
    pairs: ['edge', 'byte'], ...more});
}
sleep('idle', old, 250);
sleep('idle_three', both(bytes(3), old), 250);
sleep('idle_leaving', both(write(1), old), 250);
sleep('idle_news', armed(100), 250);
sleep('idle_nothing', old, 0);
sleep('idle_short', old, 1);
sleep('idle_long', both(write(1), old), 2 ** 31);
sleep('idle_no_deadline', both(write(1), old), 2 ** 32 - 1);

function serial(name, call, prepare, given, events, more = {}) {
  add(`serial_${name}`, call, {prepare, given, events, ...more});
}
serial('read_empty', 'serialRead', () => {}, {length: BYTES}, SERIAL);
serial('read_one', 'serialRead', serialBytes(1), {length: BYTES}, SERIAL);
serial('read_wraps', 'serialRead', both(serialWraps, serialBytes(3)), {length: BYTES}, SERIAL);
serial('read_in_part', 'serialRead', serialBytes(3), {length: 2}, SERIAL);
serial('read_flawed_second', 'serialRead', serialFlawedSecond, {length: BYTES}, SERIAL);
serial('read_flawed', 'serialRead', (bench) => receiveSerial(bench, 1, PE | FE, FLAWED), {length: BYTES}, SERIAL);
serial('read_full', 'serialRead', serialBytes(SERIAL_RING), {length: 1}, ['serialByte', 'serialBehind'], {mayDrop: true});
serial('read_leaving', 'serialRead', both(serialWrite(3), serialBytes(1)), {length: BYTES}, SERIAL_SENDING);
serial('write_one', 'serialWrite', () => {}, request(1), SERIAL_SENDING);
serial('write_most', 'serialWrite', serialBytes(1), request(8), SERIAL_SENDING);
serial('write_nothing', 'serialWrite', () => {}, request(0), SERIAL_SENDING);
serial('write_too_much', 'serialWrite', () => {}, request(9), SERIAL_SENDING);
serial('write_leaving', 'serialWrite', serialWrite(3), request(2), SERIAL_SENDING);
serial('leaves', 'serialLeaves', () => {}, {}, SERIAL_SENDING);
serial('leaves_leaving', 'serialLeaves', serialWrite(3), {}, SERIAL_SENDING);
serial('leaves_most_left', 'serialLeaves', both(serialWrite(8), serialLeft, serialLeft, serialLeft), {}, SERIAL_SENDING);

module.exports = {scenarios};
