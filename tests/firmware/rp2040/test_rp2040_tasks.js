// SPDX-License-Identifier: MIT
// examples/rp2040/tasks.c: a task for each of two lines, and one that blinks.
'use strict';
const {assert, test} = require('./runner.js');
const {Machine} = require('./machine.js');
const {Answering, A16_REAL_TIME} = require('./answering.js');
const {Hps167s, MS, MEASURING, NEVER, WRAP_NS} = require('./devices.js');

const IMAGE = 'tasks';
const DE = 6, NEAR = 15, LAMP = 25;
const TANK_MM = 751, GATE_MM = 2083, NONE = 65535; // of the datasheets' examples
const UNUSED = 0x5afe5afe, STACK_WORDS = 320;

function start({tank = 50000, gate = [MEASURING], ...options} = {}) {
  const machine = new Machine(IMAGE, options);
  return {
    machine,
    tank: new Answering(machine, machine.uart[0], A16_REAL_TIME, tank),
    gate: new Hps167s(machine, {uart: machine.uart[1], driver: DE, responses: gate}),
    lamp: machine.record(LAMP),
    near: machine.record(NEAR),
  };
}

// tasks_reading_t
function reading({machine}, name) {
  const at = machine.symbols.get(name);
  const [readings, errors, mm, status] = [0, 4, 8, 12].map((offset) => machine.mcu.readUint32(at + offset));
  return {readings, errors, mm, status: status | 0};
}

const both = (bench) => ['tank', 'gate'].map((name) => reading(bench, name));

function assertReadings({readings}, least, most) {
  assert.ok(readings >= least && readings <= most, `${readings} readings, not ${least} to ${most}`);
}

// From now on: the lamp changes every 250 ms, as if it were alone.
function assertBlinks({lamp}, ms) {
  const changes = lamp.filter(({at}, i) => i > 0 && lamp[i - 1].high !== lamp[i].high);
  assert.ok(changes.length >= Math.floor(ms / 250) - 1, `${changes.length} changes`);
  for (let i = 1; i < changes.length; i++) {
    const off = (changes[i].at - changes[0].at) / MS - i * 250;
    assert.ok(Math.abs(off) < 0.5, `${off} ms off`);
  }
}

test('each task reads its own sensor at its own pace, while the lamp blinks', () => {
  const bench = start();
  bench.machine.run(3000);
  const [tank, gate] = both(bench);
  assert.deepStrictEqual([tank.mm, tank.status, tank.errors], [TANK_MM, 0, 0]);
  assert.deepStrictEqual([gate.mm, gate.status, gate.errors], [GATE_MM, 0, 0]);
  // One in 120 ms and one in 18.519 ms: 25 and 162 in 3 s, less one that is under way.
  assertReadings(tank, 24, 25);
  assertReadings(gate, 160, 162);
  assert.deepStrictEqual(bench.tank.strays, []);
  assertBlinks(bench, 3000);
});

test('a line that is dead holds up neither the other one nor the lamp', () => {
  const bench = start({gate: [NEVER]});
  bench.machine.run(3000);
  const [tank, gate] = both(bench);
  assertReadings(tank, 24, 25);
  assert.strictEqual(tank.errors, 0);
  assert.deepStrictEqual([gate.readings, gate.mm, gate.status], [0, NONE, -3]); // FATHOM_ERR_NO_RESPONSE
  assert.ok(gate.errors >= 2);
  assertBlinks(bench, 3000);
});

test('what one task has read another one acts on within a millisecond', () => {
  const bench = start();
  bench.machine.until(() => reading(bench, 'tank').readings === 1, 500);
  const read = bench.machine.clock.nanos;
  bench.machine.run(2);
  const near = bench.near[bench.near.length - 1];
  assert.ok(near.high && near.at - read < MS, `high after ${near.at - read} ns`); // 751 mm
  bench.tank.after = undefined;
  bench.machine.run(1500);
  assert.strictEqual(reading(bench, 'tank').mm, NONE);
  assert.strictEqual(bench.near[bench.near.length - 1].high, false); // 2083 mm are not near
});

test('every register that a function has to keep comes back with its task', () => {
  const bench = start();
  const {machine} = bench;
  const {core} = machine;
  const KEPT = [4, 5, 6, 7, 8, 9, 10, 11];
  const away = new Map(); // stack pointer of a task that is not running: its registers, and what stood in for them
  let pattern = 1, came = 0;
  const comeBack = () => {
    const mine = away.get(core.SP);
    if (!mine) return;
    away.delete(core.SP);
    came++;
    assert.deepStrictEqual(KEPT.map((r) => core.registers[r]), mine.stood);
    KEPT.forEach((r, i) => { core.registers[r] = mine.held[i]; });
  };
  machine.watched.set(machine.address('task_switch'), () => {
    const stood = KEPT.map(() => (pattern = Math.imul(pattern, 1664525) + 1013904223 | 0) >>> 0);
    away.set(core.SP, {held: KEPT.map((r) => core.registers[r]), stood});
    KEPT.forEach((r, i) => { core.registers[r] = stood[i]; });
    machine.watched.set(core.LR & ~1, comeBack);
    assert.strictEqual(core.SP % 8, 0, 'the stack is aligned where a function is called');
  });
  bench.machine.run(1000);
  assert.ok(came > 100, `${came} switches`);
  assert.ok(reading(bench, 'tank').readings > 5 && reading(bench, 'gate').readings > 40);
});

test('an interrupt that comes while a task changes places does no harm', () => {
  const bench = start();
  const {machine} = bench;
  const from = machine.address('task_switch');
  // Before each of its 15 instructions in turns, once in each pass.
  let turn = 0, isDue = true;
  for (let i = 0; i < 15; i++)
    machine.watched.set(from + 2 * i, () => {
      if (isDue && turn % 15 === i) machine.mcu.setInterrupt(20, true);
      if (turn % 15 === i) isDue = false;
      if (i < 14 || isDue) return;
      isDue = true;
      turn++;
    });
  let taken = 0;
  const {core} = machine;
  const enter = core.exceptionEntry.bind(core);
  core.exceptionEntry = (number) => {
    if (number === 36 && core.PC >= from && core.PC < from + 40) taken++;
    enter(number);
    if (number === 36) machine.uart[0].update(); // as it really is
  };
  bench.machine.run(2000);
  assert.ok(turn > 100 && taken > 100, `${taken} interrupts in ${turn} passes`);
  assert.ok(reading(bench, 'tank').readings >= 15 && reading(bench, 'gate').readings >= 100);
  assert.strictEqual(reading(bench, 'tank').errors + reading(bench, 'gate').errors, 0);
});

test('what is given right before the core would sleep keeps it awake', () => {
  const bench = start();
  const {machine} = bench;
  const enter = machine.core.exceptionEntry.bind(machine.core);
  machine.core.exceptionEntry = (number) => {
    enter(number);
    if (number === 36) machine.uart[0].update(); // as it really is
  };
  let calls = 0, given = 0, since = null, longest = 0;
  machine.watch('fathom_rp2040_idle', () => {
    if (since !== null) longest = Math.max(longest, machine.clock.nanos - since);
    since = null;
  }, () => {
    if (since !== null || ++calls % 3 !== 0) return; // back from the interrupt, or not its turn
    given++;
    since = machine.clock.nanos;
    machine.mcu.setInterrupt(20, true); // which comes before its first instruction
  });
  bench.machine.run(1000);
  assert.ok(given > 50, `${given} times`);
  assert.ok(longest > 0 && longest < 5000, `it slept for ${longest} ns`);
});

test('each stack has room to spare', () => {
  const bench = start({gate: [MEASURING, NEVER, MEASURING]});
  bench.machine.run(3000);
  for (const name of ['tank_task', 'gate_task', 'lamp_task']) {
    const [symbol] = [...bench.machine.symbols.keys()].filter((each) => each.split('.')[0] === name);
    const words = bench.machine.symbols.get(symbol) + 20;
    let left = 0;
    while (bench.machine.mcu.readUint32(words + 4 * left) === UNUSED) left++;
    assert.ok(left >= STACK_WORDS / 4, `${name}: ${left} words left`);
  }
});

test('all of them wait across the wrap of the clock', () => {
  for (let early = 100; early < 1000; early += 270) { // ms from reset to the wrap
    const bench = start({startUs: 2 ** 32 - early * 1000});
    bench.machine.run(2000);
    assert.ok(bench.machine.clock.nanos > WRAP_NS);
    const [tank, gate] = both(bench);
    assertReadings(tank, 15, 17);
    assertReadings(gate, 106, 108);
    assertBlinks(bench, 2000);
  }
});

test('the core sleeps when all tasks wait', () => {
  const bench = start();
  bench.machine.run(2000);
  bench.machine.awake(0.02);
});
