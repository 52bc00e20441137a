// SPDX-License-Identifier: MIT
// Sleep, the clock and the pins of the port.
'use strict';
const {assert, test} = require('./runner.js');
const {Desk} = require('./desk.js');

const NO_DEADLINE = 0xffffffff;

// How long idle(max_us) takes, in us, with nothing else happening.
function slept(desk, max) {
  desk.call('idle', 0); // forgets old news
  const from = desk.machine.us;
  desk.call('idle', max);
  return desk.machine.us - from;
}

test('idle sleeps for as long as it may, and no longer', () => {
  const desk = new Desk();
  for (const max of [1, 2, 5, 100, 1000, 250000]) {
    const took = slept(desk, max);
    assert.ok(took > max - 1 && took < max + 3, `${took} us instead of ${max}`);
  }
});

test('idle ends in time across the wrap of the clock', () => {
  for (let early = 1; early < 40; early += 3) {
    const desk = new Desk({startUs: 2 ** 32 - 200});
    desk.machine.runTo(2 ** 32 - early);
    const took = slept(desk, 20);
    assert.ok(took > 19 && took < 23, `${took} us`);
  }
});

test('idle returns when a byte has come, and when a request has left', () => {
  const desk = new Desk();
  desk.begin('19200 8E1', {driver: 6});
  const uart = desk.machine.uart[1];
  desk.call('idle', 0);
  desk.machine.after(5000, () => uart.receive(1));
  let from = desk.machine.us;
  desk.call('idle', NO_DEADLINE);
  // One byte alone: after the receiver's time-out of 32 bits.
  const late = desk.machine.us - from - 5000 - 32e6 / 19200;
  assert.ok(late >= 0 && late < 10, `${late} us`);
  assert.deepStrictEqual(desk.read().bytes, [1]);

  desk.call('idle', 0);
  desk.machine.after(5000, () => [1, 2, 3, 4].forEach((value) => uart.receive(value)));
  from = desk.machine.us;
  desk.call('idle', NO_DEADLINE);
  assert.ok(desk.machine.us - from - 5000 < 10); // four at once
  desk.read();

  desk.call('idle', 0);
  desk.write([1, 2, 3]);
  // The driver's alarm may look more than once.
  for (let looks = 0; looks < 3 && desk.call('sent') === 0; looks++) desk.call('idle', NO_DEADLINE);
  assert.strictEqual(desk.call('sent'), 1);
});

test('the clock counts microseconds and wraps', () => {
  const desk = new Desk({startUs: 2 ** 32 - 500});
  assert.strictEqual(desk.machine.tick, 0x200 | 12); // ENABLE, and 12 periods of clk_ref's 12 MHz (4.7.6)
  for (let i = 0; i < 20; i++) {
    const from = Math.floor(desk.machine.us);
    const now = desk.call('now') >>> 0;
    const past = (now - from) >>> 0;
    assert.ok(past <= Math.ceil(desk.machine.us) - from, `${now} after ${from}`);
    desk.machine.run(0.05);
  }
  assert.ok(desk.machine.us > 2 ** 32);
});

test('an output begins at the level that was asked for, without another one before', () => {
  for (const high of [0, 1]) {
    const desk = new Desk();
    const levels = desk.machine.record(7);
    desk.call('output', 7, high);
    assert.deepStrictEqual(levels.map((level) => level.high), [high === 1]);
    desk.call('set', 1 - high);
    desk.call('set', high);
    assert.deepStrictEqual(levels.map((level) => level.high), [high, 1 - high, high].map(Boolean));
  }
});

test('an input tells the level of its pin, with the pull-up or with none', () => {
  const desk = new Desk();
  for (const pull of [1, 0]) {
    desk.call('input', 22, pull);
    const pin = desk.machine.pin(22);
    assert.strictEqual(pin.pullupEnabled, pull === 1);
    assert.ok(!pin.pulldownEnabled && !pin.outputEnable && pin.inputEnable);
    for (const level of [true, false, true]) {
      pin.setInputValue(level);
      assert.strictEqual(desk.call('get'), level ? 1 : 0);
    }
  }
});
