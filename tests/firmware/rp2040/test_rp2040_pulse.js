// SPDX-License-Identifier: MIT
// examples/rp2040/a16_pulse.c: the whole PWM cycle of an A16 (A16 1).
'use strict';
const {assert, test, figure} = require('./runner.js');
const {Machine} = require('./machine.js');
const {A16, Terminal, MS, NO_RESPONSE, WRAP_NS} = require('./devices.js');

const IMAGE = 'a16_pulse';
const TRIGGER = 2, ECHO = 3, IO_IRQ_BANK0 = 13;
const CYCLE_MS = 221; // the datasheet: more than 220

function start(pulses, options, image = IMAGE) {
  const machine = new Machine(image, options);
  const a16 = new A16(machine, {rx: TRIGGER, tx: ECHO, pulses, ...options});
  return {machine, a16, terminal: new Terminal(machine)};
}

// Runs until so many lines of text have come, and returns them.
const lines = ({terminal}, count) => terminal.first(count, (count + 2) * CYCLE_MS);

const mm = (us) => Math.round(us * 4 / 23); // S[cm] = T[us] / 57.5
const measured = (line) => Number(/raw (\d+)$/.exec(line)[1]);

function assertTarget(line, us) {
  assert.ok(Math.abs(measured(line) - us) <= 1, `${line}, but the pulse had ${us} us`);
  assert.match(line, /^target \d+ mm, raw \d+$/);
  assert.strictEqual(Number(/\d+/.exec(line)[0]), mm(measured(line)));
}

function assertCycle(before, behind) {
  const cycle = behind.at - before.at;
  assert.ok(cycle >= CYCLE_MS * MS && cycle < (CYCLE_MS + 0.1) * MS, `a cycle of ${cycle} ns`);
}

test('the pulses of the datasheet are readings, each within 1 us of its width', () => {
  const bench = start([0, 3000, 10100, 86250, 94000]);
  const said = lines(bench, 5);
  assert.strictEqual(said[0], NO_RESPONSE); // no pulse, a cut wire
  assertTarget(said[1], 3000);
  assertTarget(said[2], 10100);
  assertTarget(said[3], 86250);
  assert.match(said[4], /^no target, raw (94000|94001|93999)$/);
  figure('rp2040_edge_interrupt', bench.machine.interrupts.get(IO_IRQ_BANK0), 'cycles');
});

test('the trigger is low for 2 ms, once every 221 ms', () => {
  const bench = start([3000, 3000, 3000, 3000]);
  lines(bench, 4);
  const {triggers} = bench.a16;
  assert.ok(triggers.length >= 4);
  for (const {low} of triggers) assert.ok(low >= 2 * MS && low < 2.05 * MS, `low for ${low} ns`);
  for (let i = 1; i < triggers.length; i++)
    assertCycle(triggers[i - 1], triggers[i]);
});

const FIRST_US = 114000; // about when the first pulse begins, after reset

test('a pulse during which the clock wraps is right, also between whole microseconds', () => {
  for (const width of [2999.6, 3000.4, 50000.5, 91000.9]) {
    const bench = start([width], {startUs: 2 ** 32 - FIRST_US - Math.floor(width / 2)});
    assertTarget(lines(bench, 1)[0], width);
    const [rise, fall] = bench.a16.edges;
    assert.ok(rise < WRAP_NS && fall > WRAP_NS, `from ${rise - WRAP_NS} to ${fall - WRAP_NS}`);
  }
});

test('a cycle whose time-out is beyond the wrap ends in time', () => {
  const bench = start([0, 3000], {startUs: 2 ** 32 - FIRST_US});
  const said = lines(bench, 2);
  assert.strictEqual(said[0], NO_RESPONSE);
  assertTarget(said[1], 3000);
  const [before, behind] = bench.a16.triggers;
  assert.ok(before.at < WRAP_NS && behind.at > WRAP_NS);
  assertCycle(before, behind);
});

test('edges that both wait when the interrupt runs give no width, and the next pulse counts', () => {
  const bench = start([10100, 10100]);
  const {machine} = bench;
  const flicker = () => { // low and high again between two instructions
    machine.pin(ECHO).setInputValue(false);
    machine.pin(ECHO).setInputValue(true);
  };
  machine.pin(TRIGGER).addListener((state) => {
    if (state === 1 && bench.a16.triggers.length === 1) machine.after(115000, flicker);
  });
  const said = lines(bench, 2);
  assert.strictEqual(said[0], NO_RESPONSE);
  assertTarget(said[1], 10100);
});

test('a spike that ends at any instruction of the interrupt is noise, and the pulse after it is read', () => {
  for (let instructions = 1; instructions < 90; instructions++) {
    const bench = start([10100], {before: 20000});
    const {machine} = bench;
    const echo = machine.pin(ECHO);
    machine.pin(TRIGGER).addListener((state) => {
      if (state !== 1) return;
      machine.after(5000, () => {
        const one = machine.beforeInstruction(instructions, () => echo.setInputValue(false));
        machine.after(100, () => { // if it sleeps again before that
          if (one.isDue) echo.setInputValue(false);
          one.isDue = false;
        });
        echo.setInputValue(true);
      });
    });
    assertTarget(lines(bench, 1)[0], 10100);
  }
});

test('pins are set up: SIO, input enabled, the text at UART0 with 115200 8N1', () => {
  const bench = start([3000]);
  const {machine} = bench;
  lines(bench, 1);
  assert.strictEqual(machine.pin(TRIGGER).functionSelect, 5);
  assert.strictEqual(machine.pin(ECHO).functionSelect, 5);
  assert.ok(machine.pin(ECHO).inputEnable && !machine.pin(ECHO).outputEnable);
  assert.ok(!machine.pin(ECHO).pullupEnabled && !machine.pin(ECHO).pulldownEnabled);
  assert.strictEqual(machine.pin(0).functionSelect, 2);
  assert.strictEqual(machine.uart[0].format, '8N1');
  // 125 MHz / 16 / 115200 = 67.817: 67 and 52 / 64
  assert.strictEqual(machine.uart[0].divider, 67 * 64 + 52);
});

test('it sleeps between the edges', () => {
  const bench = start([3000, 3000]);
  lines(bench, 2);
  bench.machine.awake(0.001);
});
