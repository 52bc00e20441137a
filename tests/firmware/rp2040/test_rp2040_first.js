// SPDX-License-Identifier: MIT
// examples/rp2040/first.c: an A05 over RS-485 by 55 AA, printed by printf; and some of examples/first/MODE.c.
'use strict';
const {assert, test} = require('./runner.js');
const {Machine} = require('./machine.js');
const {Answering, A05_ALL_PROBES} = require('./answering.js');
const {A16, Hps167s, Terminal, MEASURING} = require('./devices.js');

const TRIGGER = 2, INPUT = 3, DE = 6;
const FRAME = [0xff, 0x07, 0xa1, 0xa7]; // A16 2(3): 1953 mm
const NO_RESPONSE = /^no reading \(NO_RESPONSE\)\. [A-Z].*\.$/;
const STALE = /^no reading \(STALE\)\. [A-Z].*\.$/;

function start(image) {
  const machine = new Machine(image);
  return {machine, terminal: new Terminal(machine)};
}

const PROBES = ['probe 1: 1000 mm', 'probe 2: 2000 mm', 'probe 3: 1953 mm', 'probe 4: 3562 mm'];
const AFTER_US = 205000; // A05 2(3)1: 200 to 210 ms

test('it prints the four distances of each response of an A05', () => {
  const {machine, terminal} = start('first');
  const a05 = new Answering(machine, machine.uart[1], A05_ALL_PROBES, AFTER_US);
  assert.deepStrictEqual(terminal.first(8, 3000), [...PROBES, ...PROBES]);
  assert.deepStrictEqual(a05.strays, []);
  assert.strictEqual(machine.uart[0].format, '8N1');
  assert.strictEqual(machine.uart[0].divider, 67 * 64 + 52); // 125 MHz / 16 / 115200 = 67.817: 67 and 52 / 64
});

test('it prints an error and what to check while the sensor does not respond, and goes on after that', () => {
  const {machine, terminal} = start('first');
  const a05 = new Answering(machine, machine.uart[1], A05_ALL_PROBES, undefined);
  assert.match(terminal.first(1, 3000)[0], NO_RESPONSE);
  a05.after = AFTER_US;
  machine.until(() => terminal.lines.includes(PROBES[3]), 20000);
  const first = terminal.lines.indexOf(PROBES[0]);
  assert.deepStrictEqual(terminal.lines.slice(first, first + 4), PROBES);
  for (const line of terminal.lines.slice(0, first)) assert.match(line, NO_RESPONSE);
});

test('first/hps167s.c prints the same readings with the probe', () => {
  const {machine, terminal} = start('first_hps167s');
  new Hps167s(machine, {uart: machine.uart[1], driver: DE, responses: [MEASURING]});
  assert.deepStrictEqual(terminal.first(2, 3000), Array(2).fill('probe 1: 2083 mm'));
});

test('first/a16_auto.c prints the frame of the datasheet, and an error after a silence', () => {
  const {machine, terminal} = start('first_a16_auto');
  machine.run(10); // the sensor begins after a silence
  FRAME.forEach((value, i) => machine.after((i + 1) * 10e6 / 9600, () => machine.uart[1].receive(value)));
  const lines = terminal.first(2, 5000);
  assert.strictEqual(lines[0], 'probe 1: 1953 mm');
  assert.match(lines[1], STALE);
});

test('first/a16_pwm.c prints the pulse of the datasheet, and an error without a pulse', () => {
  const {machine, terminal} = start('first_a16_pwm');
  new A16(machine, {rx: TRIGGER, tx: INPUT, pulses: [10000, 0]});
  const lines = terminal.first(2, 3000);
  assert.strictEqual(lines[0], 'probe 1: 1739 mm'); // A16 1: 173.9 cm
  assert.match(lines[1], NO_RESPONSE);
});

for (const [mode, high, low] of [['a16_switch', 'near', 'far'], ['a05_relay', 'far', 'near']]) {
  test(`first/${mode}.c prints the level of the pin`, () => {
    const {machine, terminal} = start(`first_${mode}`);
    machine.pin(INPUT).setInputValue(true);
    assert.strictEqual(terminal.first(1, 3000)[0], `probe 1: ${high}`);
    machine.pin(INPUT).setInputValue(false);
    const before = terminal.lines.length;
    machine.until(() => terminal.lines.length > before + 1, 3000);
    assert.strictEqual(terminal.lines[before + 1], `probe 1: ${low}`);
  });
}
