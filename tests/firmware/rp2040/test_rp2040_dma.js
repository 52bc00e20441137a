// SPDX-License-Identifier: MIT
// examples/rp2040/a16_dma.c: automatic frames of an A16 (A16 2) by DMA, with every silence between them; and
// images/dma_loop.c: the same in loops that are slow.
'use strict';
const {assert, test} = require('./runner.js');
const {Machine} = require('./machine.js');
const {PE, FE, OE} = require('./pl011.js');
const {Terminal, US, MS, STALE, WRAP_NS} = require('./devices.js');

const IMAGE = 'a16_dma';
const LOOP = 'dma_loop';
const RX = 5, UART1_IRQ = 21, DMA_IRQ_0 = 11, IO_IRQ_BANK0 = 13, TIMER_IRQ_0 = 0;
const SCRATCH3 = 0x40058018, SCRATCH4 = 0x4005801c;
const BIT_US = 1e6 / 9600;
const LOOK_MS = 32 * BIT_US / 1000;

const GOLDEN = [0xff, 0x07, 0xa1, 0xa7]; // A16 2(4): 1953 mm
// Where no silence is known, FF 01 FF FF over and over reads 65281 mm as well as 511, and neither is shown (stream.h).
const HELD_511 = [0xff, 0x01, 0xff, 0xff];
const frame = (mm) => [0xff, mm >> 8, mm & 0xff, 0xff + (mm >> 8) + mm & 0xff];
const says = (mm) => `target ${mm} mm, raw ${mm}`;

// The A16's TX: bits at the pin, and each character to the UART at the end of its stop bit.
class Sender {
  constructor(machine) {
    Object.assign(this, {machine, pin: machine.pin(RX), uart: machine.uart[1], level: true, ends: []});
    this.pin.setInputValue(true);
  }

  drive(level) {
    if (level !== this.level) this.pin.setInputValue(level);
    this.level = level;
  }

  // In `us` from now, without pauses. errors: {index: DR bits}
  send(us, bytes, errors = {}) {
    bytes.forEach((value, i) => {
      const begin = us + 10 * BIT_US * i;
      for (let bit = 0; bit < 8; bit++) this.machine.after(begin + BIT_US * (1 + bit), () => this.drive((value >> bit & 1) !== 0));
      this.machine.after(begin, () => this.drive(false));
      this.machine.after(begin + BIT_US * 9, () => this.drive(true));
      this.machine.after(begin + BIT_US * 10, () => {
        this.uart.receive(value, errors[i]);
        if (i === bytes.length - 1) this.ends.push(this.machine.clock.nanos);
      });
    });
  }

  // Frames every `ms`, the first one in 50 ms; each is planned shortly before, for a plan of many is slow.
  every(ms, [bytes, ...more], us = 50000) {
    this.send(us, bytes);
    if (more.length > 0) this.machine.after(us, () => this.every(ms, more, ms * 1000));
  }
}

function start(image, options) {
  const machine = new Machine(image, options);
  const interrupts = new Map();
  const enter = machine.core.exceptionEntry.bind(machine.core);
  machine.core.exceptionEntry = (number) => {
    interrupts.set(number - 16, (interrupts.get(number - 16) || 0) + 1);
    enter(number);
  };
  return {machine, a16: new Sender(machine), terminal: new Terminal(machine), interrupts};
}

function go({machine, terminal}, ms) {
  machine.run(ms);
  return terminal.lines;
}

const word = ({machine}, offset) => machine.mcu.readUint32(machine.symbols.get('a16_line') + offset);
const errors = (bench) => word(bench, 0);
const overruns = (bench) => word(bench, 4);

test('every frame is a reading, with no interrupt for a byte', () => {
  const bench = start(IMAGE);
  bench.a16.every(100, [GOLDEN, frame(700), frame(16000), GOLDEN]);
  assert.deepStrictEqual(go(bench, 500), [says(1953), says(700), says(16000), says(1953)]);
  const {interrupts} = bench;
  assert.strictEqual(interrupts.get(UART1_IRQ), undefined);
  assert.strictEqual(interrupts.get(IO_IRQ_BANK0), 4, 'a start bit');
  // A frame takes 1.25 times as long as a look; after that one sees that nothing has come. One more after begin.
  const looks = interrupts.get(TIMER_IRQ_0);
  assert.ok(looks >= 4 * 2 && looks <= 4 * 4 + 2, `${looks} looks`);
});

for (const ms of [0, 20, 250]) {
  test(`a loop of ${ms} ms shows 511 mm held still, which only known silences tell from 65281`, () => {
    const bench = start(LOOP, {scratch: {2: ms * 1000}});
    // A loop without a pause is simulated instruction by instruction.
    const frames = ms === 0 ? 3 : 30;
    bench.a16.every(100, Array(frames).fill(HELD_511));
    const said = go(bench, frames * 100 + 60);
    assert.ok(said.length >= (ms === 250 ? 10 : frames), `${said.length} readings`);
    for (const line of said) assert.strictEqual(line, says(511));
    assert.strictEqual(overruns(bench), 0);
    const time = bench.machine.mcu.readUint32(SCRATCH3) * US;
    const off = Math.min(...bench.a16.ends.map((end) => Math.abs(time - end)));
    // Polled in time, a reading has the time of the poll; else that of the look that saw its last byte.
    const most = ms === 20 ? 20 : LOOK_MS + 0.1;
    assert.ok(off < most * MS, `the time of the reading is ${off} ns off`);
  });
}

for (const before of [1000, 2500, 4500])
  test(`a loop in step with the frames, ${before} us after each, knows the silences that it never sees`, () => {
    const bench = start(LOOP, {scratch: {2: 250000}});
    for (let i = 1; i <= 12; i++) bench.a16.send(250000 * i - 40 * BIT_US - before + 100, HELD_511);
    const said = go(bench, 3050);
    assert.ok(said.length >= 10 && said.every((line) => line === says(511)), said.join('; '));
  });

test('in a slow loop a wrong byte does not take the frame right before it along', () => {
  const bench = start(LOOP, {scratch: {2: 250000}});
  // The first poll, at 250 ms, sees the port empty: before that the line drops all bytes.
  bench.a16.send(300000, [...frame(700), ...GOLDEN], {6: FE});
  assert.deepStrictEqual(go(bench, 850), [says(700)]);
  assert.strictEqual(errors(bench), 1);
});

test('in a slow loop a silence within a frame keeps both halves from being shown', () => {
  const bench = start(LOOP, {scratch: {2: 250000}});
  for (let i = 0; i < 8; i++) {
    bench.a16.send(50000 + 100000 * i, HELD_511.slice(0, 2));
    bench.a16.send(50000 + 100000 * i + 50000, HELD_511.slice(2));
  }
  assert.deepStrictEqual(go(bench, 1200), []);
});

for (const [first, bits] of [[2, 10], [3, 26]])
  test(`a pause of ${bits} bits after byte ${first} is no silence`, () => {
    const bench = start(IMAGE);
    for (let i = 0; i < 3; i++) {
      bench.a16.send(50000 + 100000 * i, GOLDEN.slice(0, first));
      bench.a16.send(50000 + 100000 * i + (10 * first + bits) * BIT_US, GOLDEN.slice(first));
    }
    assert.deepStrictEqual(go(bench, 400), Array(3).fill(says(1953)));
  });

test('a byte that the UART marks damages its frame and no other', () => {
  for (const flag of [PE, FE])
    for (const index of [0, 1, 3]) {
      const bench = start(IMAGE);
      bench.a16.send(50000, frame(700));
      bench.a16.send(150000, GOLDEN, {[index]: flag});
      bench.a16.send(250000, frame(16000));
      assert.deepStrictEqual(go(bench, 400), [says(700), says(16000)]);
      assert.strictEqual(errors(bench), 1);
    }
});

test('a byte before which the UART lost some does not complete a frame', () => {
  const bench = start(IMAGE);
  bench.a16.send(50000, frame(700));
  bench.a16.send(150000, GOLDEN, {2: OE});
  bench.a16.send(250000, GOLDEN);
  assert.deepStrictEqual(go(bench, 400), [says(700), says(1953)]);
});

test('a loop so slow that the ring overruns loses frames, says so, and shows no wrong one', () => {
  const bench = start(LOOP, {scratch: {2: 2000000}}); // 20 frames of 4 bytes, and 64 places
  bench.a16.every(100, Array(100).fill(HELD_511));
  const said = go(bench, 10200);
  assert.ok(said.length >= 4 && said.every((line) => line === says(511)), said.join('; '));
  assert.ok(overruns(bench) >= 4, `${overruns(bench)} overruns`);
  assert.strictEqual(bench.machine.mcu.readUint32(SCRATCH4), overruns(bench), 'the line knows of each');
});

test('frames without any pause between them are read before the ring is full', () => {
  const bench = start(IMAGE);
  bench.a16.send(50000, Array(120).fill(GOLDEN).flat());
  const said = go(bench, 700);
  assert.ok(said.length >= 10 && said.every((line) => line === says(1953)), said.join('; '));
  assert.strictEqual(overruns(bench), 0);
});

test('transfers end and begin again, and no byte is lost over it', () => {
  const bench = start(IMAGE);
  const distances = Array.from({length: 600}, (_, i) => 300 + 7 * i); // 2400 bytes in transfers of 1024
  bench.a16.every(20, distances.map(frame));
  assert.deepStrictEqual(go(bench, 600 * 20 + 100), distances.map(says));
  assert.strictEqual(bench.interrupts.get(DMA_IRQ_0), 2);
  assert.strictEqual(overruns(bench), 0);
});

test('frames go on across the wrap of the clock, and a silence is stale after it', () => {
  for (const early of [40, 51, 55, 58, 62, 155, 330]) { // ms from reset to the wrap
    const bench = start(IMAGE, {startUs: 2 ** 32 - early * 1000});
    bench.a16.every(100, [HELD_511, GOLDEN, HELD_511]);
    assert.deepStrictEqual(go(bench, 2700), [says(511), says(1953), says(511), STALE]);
    assert.ok(bench.machine.clock.nanos > WRAP_NS);
  }
});

test('the core sleeps while bytes come', () => {
  const bench = start(IMAGE);
  bench.a16.every(100, Array(20).fill(GOLDEN));
  go(bench, 2050);
  bench.machine.awake(0.005);
});
