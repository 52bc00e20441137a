// SPDX-License-Identifier: MIT
// examples/rp2040/hps167s_battery.c: power for one reading, then sleep, also for longer than the clock takes to wrap.
'use strict';
const {assert, test} = require('./runner.js');
const {Machine} = require('./machine.js');
const {FE, BE} = require('./pl011.js');
const {Hps167s, Terminal, MS, READING, MEASURING, NEVER, NO_RESPONSE, WRAP_NS} = require('./devices.js');

const IMAGE = 'hps167s_battery';
const IMAGE_75 = 'battery_75';
const DE = 6, POWER = 7;
const MINUTE_MS = 60000;
const WARM_UP_MS = 5000; // HPS-167S 1.1

// Hears nothing without power and for 5 s after it; where its power is switched, noise comes out of the transceiver.
class Switched extends Hps167s {
  constructor(machine, options) {
    super(machine, options);
    this.power = machine.record(POWER);
    machine.pin(POWER).addListener(() => machine.after(100, () => options.uart.receive(0, FE | BE)));
  }

  hear(character) {
    const last = this.power[this.power.length - 1];
    if (last.high && character.start - last.at >= WARM_UP_MS * MS) super.hear(character);
    else this.early = (this.early || 0) + 1;
  }
}

function start(image, responses, options) {
  const machine = new Machine(image, options);
  const hps = new Switched(machine, {uart: machine.uart[1], driver: DE, responses});
  return {machine, hps, terminal: new Terminal(machine)};
}

const lines = ({terminal}, count, minutes) => terminal.first(count, minutes * MINUTE_MS);

// [{from, to}] in ms
function powered({hps}) {
  const times = hps.power.filter(({at}) => at > 0);
  const spans = [];
  for (const {high, at} of times)
    if (high) spans.push({from: at / MS, to: Infinity});
    else if (spans.length > 0) spans[spans.length - 1].to = at / MS;
  return spans;
}

function assertEvery(minutes, spans) {
  spans.forEach(({from, to}, i) => {
    // A request that was asked just before the end of the warm-up takes its time-out of 500 ms.
    assert.ok(to - from > WARM_UP_MS && to - from < WARM_UP_MS + 600, `power for ${to - from} ms`);
    const late = from - spans[0].from - i * minutes * MINUTE_MS;
    assert.ok(Math.abs(late) < 1, `${late} ms off the ${minutes} minutes`);
  });
}

test('every ten minutes it gets power, warms up, is read once and loses power again', () => {
  const bench = start(IMAGE, [MEASURING]);
  assert.deepStrictEqual(lines(bench, 4, 31), Array(4).fill(READING));
  const spans = powered(bench);
  assert.strictEqual(spans.length, 4);
  assert.strictEqual(bench.hps.transactions.length, 4, 'one measurement each time');
  assert.ok(bench.hps.early > 0, 'it was asked while it warmed up');
  assertEvery(10, spans);
});

test('the core sleeps for more than 99.9 % of the time', () => {
  const bench = start(IMAGE, [MEASURING]);
  lines(bench, 3, 21);
  assert.ok(bench.machine.awake(0.001) > 0);
});

test('a sensor that does not answer is an error, and it does not keep its power', () => {
  const bench = start(IMAGE, [NEVER, MEASURING]);
  assert.deepStrictEqual(lines(bench, 2, 11), [NO_RESPONSE, READING]);
  for (const {from, to} of powered(bench)) assert.ok(to - from < WARM_UP_MS + 1200, `power for ${to - from} ms`);
});

test('readings go on after a sleep that is longer than the clock takes to wrap', () => {
  const bench = start(IMAGE_75, [MEASURING]);
  assert.deepStrictEqual(lines(bench, 4, 226), Array(4).fill(READING));
  assertEvery(75, powered(bench));
  assert.ok(bench.machine.clock.nanos > 3 * WRAP_NS);
});

test('the clock may wrap while it warms up, is asked, or sleeps', () => {
  for (const early of [1, 2500, 5000, 5010, 5500, 59999, 60001]) { // ms from reset to the wrap
    const bench = start(IMAGE, [MEASURING], {startUs: 2 ** 32 - early * 1000});
    assert.deepStrictEqual(lines(bench, 2, 11), [READING, READING]);
    assert.ok(bench.machine.clock.nanos > WRAP_NS);
    assertEvery(10, powered(bench));
  }
});
