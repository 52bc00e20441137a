// SPDX-License-Identifier: MIT
// examples/rp2040/hps167s_rs485.c: an HPS-167S over RS-485 with its driver-enable, and images/both.c: the same without
// sleep, beside an A16.
'use strict';
const {assert, test, figure} = require('./runner.js');
const {Machine} = require('./machine.js');
const {PE, FE} = require('./pl011.js');
const {
  A16, Hps167s, Terminal, CHARACTER_NS, T3_5_NS, US, MS, READING, MEASURING, NO_RESPONSE, CHECKSUM, WRAP_NS,
} = require('./devices.js');

const EXAMPLE = 'hps167s_rs485';
const BOTH = 'both';
const DI = 4, RO = 5, DE = 6, TRIGGER = 2, ECHO = 3;
const UART1_IRQ = 21;
const LOOPS = {fine: 0, coarse: 20000}; // us

function start(image, responses, options) {
  const machine = new Machine(image, options);
  const hps = new Hps167s(machine, {uart: machine.uart[1], driver: DE, responses});
  return {machine, hps, terminal: new Terminal(machine)};
}

const lines = ({terminal}, count, ms = 3000) => terminal.first(count, ms);

// From before the first start bit until the last stop bit has left, and no more than a character longer.
function assertDriven({hps}, most = CHARACTER_NS) {
  const highs = [];
  hps.driver.forEach(({high, at}, i) => {
    if (high) highs.push({from: at, to: i + 1 < hps.driver.length ? hps.driver[i + 1].at : Infinity});
  });
  assert.ok(hps.transactions.length > 0 && highs.length >= hps.transactions.length);
  let longest = 0;
  hps.transactions.forEach(({start: from, end}, i) => {
    assert.ok(highs[i].from <= from, `driven ${highs[i].from - from} ns too late`);
    if (highs[i].to === Infinity) return; // still leaving
    assert.ok(highs[i].to >= end, `let go ${end - highs[i].to} ns too early`);
    assert.ok(highs[i].to <= end + most, `let go ${highs[i].to - end} ns after the end`);
    longest = Math.max(longest, highs[i].to - end);
  });
  return longest;
}

// Nothing within a character: the longest silence in a request.
function assertNoGaps({hps}) {
  for (const {characters} of hps.transactions)
    for (let i = 1; i < characters.length; i++)
      assert.ok(characters[i].start - characters[i - 1].end < characters[i].bit / 8);
}

function assertSilence({hps}) {
  for (let i = 1; i < hps.transactions.length; i++) {
    const before = hps.transactions[i - 1];
    const silence = hps.transactions[i].start - (before.answered || before.end);
    assert.ok(silence >= T3_5_NS, `only ${silence} ns of silence`);
  }
}

test('the datasheet\'s response becomes its reading, again and again', () => {
  const bench = start(EXAMPLE, [MEASURING]);
  assert.deepStrictEqual(lines(bench, 5), Array(5).fill(READING));
  assertNoGaps(bench);
  assertSilence(bench);
  assertDriven(bench);
  figure('rp2040_uart_interrupt', bench.machine.interrupts.get(UART1_IRQ), 'cycles');
});

test('the line is 19200 8E1: divider, format and pins', () => {
  const bench = start(EXAMPLE, [MEASURING]);
  lines(bench, 1);
  const {machine} = bench;
  const uart = machine.uart[1];
  // 125 MHz / 16 / 19200 = 406.901: 406 and 58 / 64 (57.67)
  assert.strictEqual(uart.divider, 406 * 64 + 58);
  assert.strictEqual(uart.lcr, 0x76); // WLEN 8, FEN, EPS, PEN
  assert.ok(Math.abs(uart.baud / 19200 - 1) < 0.0001);
  for (const gpio of [DI, RO]) assert.strictEqual(machine.pin(gpio).functionSelect, 2);
  assert.ok(machine.pin(RO).inputEnable && machine.pin(RO).pullupEnabled);
  assert.strictEqual(machine.pin(DE).functionSelect, 5);
  assert.strictEqual(bench.hps.driver[0].high, false);
});

// The second response of three is damaged at that byte, and the port counts it.
function assertDamaged(index, error, parity, framing) {
  const bench = start(EXAMPLE, [MEASURING, {after: 3000, errors: {[index]: error}}, MEASURING]);
  const said = lines(bench, 3, 6000);
  assert.ok(said[1] === CHECKSUM || said[1] === NO_RESPONSE, said[1]);
  assert.deepStrictEqual([said[0], said[2]], [READING, READING]);
  assert.deepStrictEqual([0, 2].map((offset) => bench.machine.halfword('rs485', offset)), [parity, framing]);
}

test('a byte with wrong parity damages its response, whichever it is', () => {
  for (const index of [0, 1, 3, 11, 12]) assertDamaged(index, PE, 1, 0);
});

test('a byte without a stop bit damages its response', () => assertDamaged(4, FE, 0, 1));

test('transactions go on across the wrap of the clock', () => {
  // In steps of 100 us over a whole transaction, so that the wrap comes upon each part of it.
  for (let early = 1000; early < 21000; early += 700) {
    const bench = start(EXAMPLE, [MEASURING], {startUs: 2 ** 32 - early});
    assert.deepStrictEqual(lines(bench, 3), Array(3).fill(READING));
    assert.ok(bench.machine.clock.nanos > WRAP_NS);
    assertDriven(bench);
    assertSilence(bench);
  }
});

test('it sleeps while it waits', () => {
  const bench = start(EXAMPLE, [MEASURING]);
  lines(bench, 10);
  figure('rp2040_hps167s_cpu_share', (bench.machine.awake(0.01) * 100).toFixed(3), '%');
});

for (const [loop, round] of Object.entries(LOOPS)) {
  test(`a ${loop} loop reads an HPS-167S and an A16 side by side, each pulse within 1 us`, () => {
    const bench = start(BOTH, [MEASURING], {scratch: {2: round}});
    const {machine} = bench;
    // A shorter time of flight in the fine loop, which is simulated instruction by instruction.
    new A16(machine, {rx: TRIGGER, tx: ECHO, pulses: [10100, 3000], before: round === 0 ? 20000 : 110000});
    const cost = {idle: new Map(), ready: 0};
    machine.watch('poll_hps167s', (_, result, cycles) => {
      if (result === 0) cost.ready = Math.max(cost.ready, cycles);
      else cost.idle.set(cycles, (cost.idle.get(cycles) || 0) + 1);
    });
    const isPulse = (line) => !line.endsWith('raw 2083');
    machine.until(() => machine.ended || bench.terminal.lines.some(isPulse), 500);
    const said = bench.terminal.lines;
    const pulse = Number(/^target \d+ mm, raw (\d+)$/.exec(said.find(isPulse))[1]);
    assert.ok(Math.abs(pulse - 10100) <= 1, `${pulse} us`);
    assert.ok(said.length > 1 && said.every((line) => isPulse(line) || line === READING));
    assertDriven(bench);
    assertNoGaps(bench);
    assertSilence(bench);
    if (round !== 0) return;
    const [idle] = [...cost.idle].reduce((most, each) => (each[1] > most[1] ? each : most));
    figure('rp2040_poll_idle', idle, 'cycles');
    figure('rp2040_poll_with_response', cost.ready, 'cycles');
  });
}

// From one request to the next: 8 + 13 characters, the device's time, and one silence. With 5 ms the device is slow
// enough that the pace of 54 a second, 18.5 ms, does not count.
const SLOW = {after: 5000};
const LEAST_NS = 21 * CHARACTER_NS + SLOW.after * US + T3_5_NS;

function assertBusTime(name, image, options) {
  const bench = start(image, [SLOW], options);
  bench.machine.until(() => bench.hps.transactions.length >= 6, 300);
  const {transactions} = bench.hps;
  const took = (transactions[5].start - transactions[1].start) / 4;
  figure(name, ((took / LEAST_NS - 1) * 100).toFixed(2), '%');
  assert.ok(took <= 1.01 * LEAST_NS, `${took} ns, the line allows ${LEAST_NS}`);
}

test('a poll takes 1 % longer at most than the line and one silence allow, in a fine loop', () => {
  assertBusTime('rp2040_poll_bus_time', BOTH, {scratch: {2: 0}});
});

// The receiver tells of the last byte 32 bits late, 1.67 ms; but when that was, so the silence is not longer for it.
test('a poll takes 1 % longer at most also asleep', () => {
  assertBusTime('rp2040_poll_bus_time_asleep', EXAMPLE);
});
