// SPDX-License-Identifier: MIT
// The port's UART, function by function.
'use strict';
const {assert, test} = require('./runner.js');
const {Desk} = require('./desk.js');
const {FE, PE, BE} = require('./pl011.js');

const PARITY = 4, FRAMING = 8, OVERRUN = 16; // FATHOM_RX_...
const RING = 64, FIFO = 32;
const bytesUpTo = (count) => Array.from({length: count}, (_, i) => (i * 7 + 1) & 0xff);

function begin(line, where = {}, options) {
  const desk = new Desk(options);
  assert.strictEqual(desk.begin(line, where), 1);
  return {desk, machine: desk.machine, uart: desk.machine.uart[where.number === undefined ? 1 : where.number]};
}

// With its driver at GPIO 6, whose levels are in `levels`.
function beginDriven(line, options) {
  const bench = begin(line, {driver: 6}, options);
  return {...bench, levels: bench.machine.record(6)};
}

// All that waits, with no flags.
function readAll({desk}, capacity) {
  const heard = [];
  for (let more = [0]; more.length > 0;) {
    const got = desk.read(capacity);
    assert.strictEqual(got.flags, 0);
    heard.push(...(more = got.bytes));
  }
  return heard;
}

const TIMER = 0x40054, DE_ALARM = 1;

test('line settings become the divider and LCR_H of the datasheet', () => {
  // 125 MHz / 16 / baud, and the fraction in 64ths, rounded; LCR_H: 0x70 for 8 bits and FIFOs, 2 parity, 4 even, 8 stops.
  const table = [
    ['9600 8N1', 813, 51, 0x70], // 813.802
    ['9600 8N2', 813, 51, 0x78],
    ['19200 8E1', 406, 58, 0x76], // 406.901
    ['19200 8O1', 406, 58, 0x72],
    ['57600 8E1', 135, 41, 0x76], // 135.634
    ['115200 8E1', 67, 52, 0x76], // 67.817
    ['230400 8E2', 33, 58, 0x7e], // 33.908
    ['7812500 8N1', 1, 0, 0x70], // the fastest
    ['120 8N1', 65104, 11, 0x70], // 65104.167
  ];
  for (const [line, whole, fraction, format] of table) {
    const bench = begin(line);
    assert.strictEqual(bench.uart.divider, whole * 64 + fraction, line);
    assert.strictEqual(bench.uart.lcr, format, line);
    assert.strictEqual(bench.uart.format, line.split(' ')[1]);
  }
  const bench = begin('9600 8N1', {clk: 48e6}); // 48 MHz / 16 / 9600 = 312.5
  assert.strictEqual(bench.uart.divider, 312 * 64 + 32);
});

test('what cannot be reached within 2.5 % is refused, and the settings before still hold', () => {
  const bench = begin('19200 8E1');
  const before = bench.uart.divider;
  for (const line of ['0 8N1', '8100000 8N1', '100000000 8N1', '116 8N1', '1 8N1', '9600 8N3', '9600 8N0']) {
    assert.strictEqual(bench.desk.setLine(line), -1, line);
    assert.strictEqual(bench.uart.divider, before);
    assert.strictEqual(bench.uart.lcr, 0x76);
  }
  assert.strictEqual(bench.desk.call('setLine', 9600, 3, 1), -1); // no parity of that number
  assert.strictEqual(bench.desk.setLine('8000000 8N1'), 1); // 2.4 % off
  assert.strictEqual(bench.desk.setLine('117 8N1'), 1); // 1.9 % off
});

test('begin refuses pins that are not of this UART', () => {
  const pins = {0: [[0, 1], [12, 13], [16, 17], [28, 29]], 1: [[4, 5], [8, 9], [20, 21], [24, 25]]};
  const desk = new Desk();
  for (const number of [0, 1]) {
    for (const [tx, rx] of pins[number]) {
      assert.strictEqual(desk.begin('9600 8N1', {number, tx, rx}), 1, `${tx} ${rx}`);
      assert.strictEqual(desk.machine.pin(tx).functionSelect, 2);
      assert.strictEqual(desk.machine.pin(rx).functionSelect, 2);
    }
    for (const [tx, rx] of pins[1 - number]) assert.strictEqual(desk.begin('9600 8N1', {number, tx, rx}), 0);
  }
  const wrong = [{tx: 5, rx: 4}, {tx: 6}, {rx: 7}, {tx: 36}, {rx: 37}, {driver: 30}, {number: 2, tx: 4, rx: 5}];
  for (const where of wrong) assert.strictEqual(desk.begin('9600 8N1', where), 0, JSON.stringify(where));
});

test('set_line waits until the last byte has left, and keeps what was received', () => {
  const bench = begin('19200 8E1');
  bench.desk.receive(bench.uart, [1, 2, 3]);
  assert.strictEqual(bench.desk.write([9, 8]), 2);
  assert.strictEqual(bench.desk.setLine('19200 8E1'), 1); // as it is
  assert.strictEqual(bench.desk.setLine('9600 8N1'), 0);
  bench.machine.until(() => bench.uart.sent.length === 2);
  assert.strictEqual(bench.desk.setLine('9600 8N1'), 1);
  assert.strictEqual(bench.uart.divider, 813 * 64 + 51);
  assert.deepStrictEqual(bench.desk.read().bytes, [1, 2, 3]);
});

test('a request of any length leaves whole, in order and without a gap', () => {
  for (const [line, length] of [['19200 8E1', 1], ['19200 8E1', 8], ['115200 8N1', 32], ['115200 8E1', 33], ['230400 8E1', 200]]) {
    const bench = begin(line, {driver: 6});
    const request = bytesUpTo(length);
    assert.strictEqual(bench.desk.write(request), length);
    bench.machine.until(() => bench.uart.sent.length === length && !bench.uart.busy);
    assert.deepStrictEqual(bench.uart.sent.map(({value}) => value), request);
    bench.uart.sent.forEach(({start}, i, all) => {
      if (i > 0) assert.ok(start - all[i - 1].end < all[i].bit / 8, `a gap before byte ${i} of ${length}`);
    });
  }
});

test('write takes all or nothing, and the caller may reuse his memory', () => {
  const bench = begin('19200 8E1');
  assert.strictEqual(bench.desk.write(bytesUpTo(201)), -1); // more than request_size
  assert.strictEqual(bench.desk.write([]), -1);
  assert.strictEqual(bench.desk.write(bytesUpTo(100)), 100);
  assert.strictEqual(bench.desk.write([255, 255]), 0);
  bench.machine.until(() => bench.uart.sent.length === 100);
  assert.deepStrictEqual(bench.uart.sent.map(({value}) => value), bytesUpTo(100));
});

test('sent is exact: false until the last stop bit has left, then true', () => {
  const bench = begin('9600 8N1');
  bench.desk.write([1, 2, 3]);
  let last;
  bench.uart.onSent = (character) => { last = character; };
  for (;;) {
    const asked = bench.machine.clock.nanos;
    const sent = bench.desk.call('sent') === 1;
    const over = bench.uart.sent.length === 3;
    if (sent) {
      assert.ok(over && bench.machine.clock.nanos - last.end < 10000);
      break;
    }
    assert.ok(!over || last.end >= asked);
  }
});

// A bit of 9600 baud is 104 us, and a call takes some microseconds.
test('when the request has left is told to a bit', () => {
  const bench = begin('9600 8N1');
  assert.strictEqual(bench.desk.call('leavesInUs'), 0);
  bench.desk.write([1, 2, 3]);
  bench.machine.until(() => bench.uart.sent.length === 1);
  const left = bench.desk.call('leavesInUs');
  const asked = bench.machine.clock.nanos;
  bench.machine.until(() => bench.uart.sent.length === 3);
  const took = (bench.uart.sent[2].end - asked) / 1000;
  assert.ok(left >= took && left < took + 120, `${left} ${took}`);
  bench.machine.run(0.1);
  assert.strictEqual(bench.desk.call('leavesInUs'), 0);
});

test('the driver is on from before the first start bit until the last stop bit has left, at every rate', () => {
  for (const [line, bits] of [['9600 8N1', 10], ['19200 8E1', 11], ['115200 8E1', 11], ['230400 8E2', 12]])
    for (const length of [1, 8, 33, 200]) {
      const {levels, ...bench} = beginDriven(line);
      bench.desk.write(bytesUpTo(length));
      bench.machine.until(() => levels.length === 2);
      assert.strictEqual(bench.uart.sent.length, length);
      const [first, last] = [bench.uart.sent[0], bench.uart.sent[length - 1]];
      assert.ok(levels[0].high && levels[0].at <= first.start);
      assert.ok(!levels[1].high && levels[1].at >= last.end, `${last.end - levels[1].at} ns too early`);
      assert.ok(levels[1].at - last.end <= 2 * first.bit + 5000, `${levels[1].at - last.end} ns too late`);
      assert.ok(Math.abs(first.end - first.start - bits * first.bit) < 1);
    }
});

test('the driver stays on if a request follows at once', () => {
  const {levels, ...bench} = beginDriven('19200 8E1');
  bench.desk.write([1, 2, 3]);
  for (let n = 0; n < 5; n++) {
    while (bench.desk.call('sent') === 0);
    bench.desk.write([4, 5, 6]);
  }
  bench.machine.run(5);
  const low = levels.filter(({high}) => !high).map(({at}) => at);
  assert.strictEqual(bench.uart.sent.length, 18);
  for (const {start, end: over} of bench.uart.sent) assert.ok(!low.some((at) => at > start && at < over));
  assert.ok(!levels[levels.length - 1].high);
});

test('the driver is let go in time when the clock wraps while bytes leave', () => {
  for (let early = 0; early < 8; early++) {
    const {levels, ...bench} = beginDriven('19200 8E1', {startUs: 2 ** 32 - 1000});
    // 573 us a character: its end, and the alarm for it, come at the wrap, a microsecond apart from run to run.
    bench.machine.runTo(2 ** 32 - 580 + early);
    bench.desk.write([1]);
    bench.machine.until(() => levels.length === 2, 3);
    assert.ok(bench.machine.us > 2 ** 32);
    assert.ok(levels[1].at >= bench.uart.sent[0].end);
  }
});

test('a break holds TX low and the driver high; nothing is written meanwhile', () => {
  const {levels, ...bench} = beginDriven('9600 8N1');
  bench.desk.write([1]);
  assert.strictEqual(bench.desk.call('setBreak', 1), 0);
  bench.machine.until(() => bench.uart.sent.length === 1);
  assert.strictEqual(bench.desk.call('setBreak', 1), 1);
  assert.deepStrictEqual(bench.uart.breaks.map(({on}) => on), [true]);
  bench.machine.mcu.peripherals[TIMER].fireAlarm(DE_ALARM); // of the byte before, held up by another interrupt
  bench.machine.run(3);
  assert.ok(levels[levels.length - 1].high);
  assert.strictEqual(bench.desk.write([2]), 0);
  assert.strictEqual(bench.desk.setLine('19200 8E1'), 0);
  assert.strictEqual(bench.desk.call('setBreak', 0), 1);
  assert.deepStrictEqual(bench.uart.breaks.map(({on}) => on), [true, false]);
  assert.ok(!levels[levels.length - 1].high);
  assert.strictEqual(bench.desk.write([2]), 1);
});

test('bytes are read in order, as many as there is room for, also those that the FIFO still holds', () => {
  const bench = begin('19200 8E1');
  assert.deepStrictEqual(bench.desk.read(), {bytes: [], flags: 0});
  for (let count = 1; count <= 12; count++) {
    bench.desk.receive(bench.uart, bytesUpTo(count));
    const first = bench.desk.read(3).bytes;
    assert.deepStrictEqual([...first, ...bench.desk.read().bytes], bytesUpTo(count));
    assert.deepStrictEqual(bench.desk.read().bytes, []);
  }
});

test('ring and FIFO hold 96 bytes and go on after that, many times over the wrap of their indices', () => {
  const bench = begin('115200 8N1');
  for (let turn = 0; turn < 12; turn++) {
    const sent = bytesUpTo(RING + FIFO).map((value) => (value + turn) & 0xff);
    bench.desk.receive(bench.uart, sent);
    assert.deepStrictEqual(readAll(bench, 50), sent);
  }
  assert.strictEqual(bench.desk.call('counter', 2), 0);
});

test('bytes that found no room are told as an overrun, before the byte that came after them', () => {
  const bench = begin('115200 8N1');
  const sent = bytesUpTo(RING + FIFO + 5);
  bench.desk.receive(bench.uart, sent);
  assert.deepStrictEqual(readAll(bench), sent.slice(0, RING + FIFO));
  bench.desk.receive(bench.uart, [77, 78]);
  assert.deepStrictEqual(bench.desk.read(), {bytes: [77], flags: OVERRUN});
  assert.deepStrictEqual(bench.desk.read(), {bytes: [78], flags: 0});
  assert.strictEqual(bench.desk.call('counter', 2), 1);
});

test('a byte with an error is told alone: a read ends before and after it', () => {
  for (const [error, flag, counter] of [[PE, PARITY, 0], [FE, FRAMING, 1], [FE | BE, FRAMING, 1], [PE | FE, PARITY | FRAMING, 0]]) {
    const bench = begin('19200 8E1');
    bench.desk.receive(bench.uart, [1, 2, 3, 4, 5, 6], {2: error, 3: error});
    assert.deepStrictEqual(bench.desk.read(), {bytes: [1, 2], flags: 0});
    assert.deepStrictEqual(bench.desk.read(), {bytes: [3], flags: flag});
    assert.deepStrictEqual(bench.desk.read(), {bytes: [4], flags: flag});
    assert.deepStrictEqual(bench.desk.read(), {bytes: [5, 6], flags: 0});
    assert.strictEqual(bench.desk.call('counter', counter), 2);
  }
});

test('where the receiver\'s time-out has come a read ends, and the time of its last byte is told', () => {
  for (const startUs of [0, 2 ** 32 - 4500]) { // and across the wrap
    const bench = begin('19200 8E1', {}, {startUs});
    for (let turn = 0; turn < 100; turn++) { // over the wrap of the ring's indices
      const ends = [];
      for (const values of [[1, 2, 3, 4, 5], [6, 7]]) {
        bench.desk.receive(bench.uart, values);
        ends.push(bench.machine.us);
        bench.machine.run(turn % 2 === 0 ? 2 : 0.1); // 32 bits are 1.67 ms
      }
      if (turn % 2 === 0) {
        // The second silence is the one that is still known.
        const got = bench.desk.read();
        assert.deepStrictEqual(got.bytes, [1, 2, 3, 4, 5, 6, 7]);
        const off = (got.lastUs - Math.floor(ends[1])) >> 0;
        assert.ok(off >= 0 && off <= 3, `off by ${off} us`);
      } else {
        assert.deepStrictEqual(bench.desk.read(), {bytes: [1, 2, 3, 4, 5, 6, 7], flags: 0});
      }
      assert.deepStrictEqual(bench.desk.read(), {bytes: [], flags: 0});
    }
    bench.desk.receive(bench.uart, [1, 2, 3]);
    bench.machine.run(2);
    bench.desk.receive(bench.uart, [4, 5]);
    assert.deepStrictEqual(bench.desk.read().bytes, [1, 2, 3]);
    assert.deepStrictEqual(bench.desk.read(), {bytes: [4, 5], flags: 0});
  }
});
