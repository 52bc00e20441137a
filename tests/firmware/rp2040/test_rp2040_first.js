// SPDX-License-Identifier: MIT
// examples/rp2040/first.c: an HPS-167S over RS-485, printed by printf; and some of examples/first/MODE.c.
'use strict';
const {assert, test} = require('./runner.js');
const {Machine} = require('./machine.js');
const {A16, Hps167s, Terminal, MEASURING, NEVER} = require('./devices.js');

const TRIGGER = 2, INPUT = 3, DE = 6;
const FRAME = [0xff, 0x07, 0xa1, 0xa7]; // A16 2(3): 1953 mm
const NO_RESPONSE = /^no reading \(NO_RESPONSE\)\. [A-Z].*\.$/;
const STALE = /^no reading \(STALE\)\. [A-Z].*\.$/;

function start(image) {
  const machine = new Machine(image);
  return {machine, terminal: new Terminal(machine)};
}

test('it prints each reading of an HPS-167S', () => {
  const {machine, terminal} = start('first');
  new Hps167s(machine, {uart: machine.uart[1], driver: DE, responses: [MEASURING]});
  assert.deepStrictEqual(terminal.first(5, 3000), Array(5).fill('2083 mm'));
  assert.strictEqual(machine.uart[0].format, '8N1');
  assert.strictEqual(machine.uart[0].divider, 67 * 64 + 52); // 125 MHz / 16 / 115200 = 67.817: 67 and 52 / 64
});

test('it prints an error and what to check while the sensor does not respond, and goes on after that', () => {
  const {machine, terminal} = start('first');
  new Hps167s(machine, {uart: machine.uart[1], driver: DE, responses: [MEASURING, NEVER, MEASURING]});
  const lines = terminal.first(3, 6000);
  assert.match(lines[1], NO_RESPONSE);
  assert.deepStrictEqual([lines[0], lines[2]], ['2083 mm', '2083 mm']);
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
