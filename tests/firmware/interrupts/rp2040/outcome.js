// SPDX-License-Identifier: MIT
// What came of a run: all that the main loop, the wires and the pins can see of it. Times are not in it, but in rules.js.
'use strict';
const {OUTPUT, US} = require('./bench.js');

// As arm-none-eabi-gcc lays them out: fathom_rp2040_uart_t, fathom_serial_t and fathom_edges_t.
const COUNTERS = 0, SERIAL_COUNTERS = 260, RISES = 53, LOST = 54, MISSED = 55;
const TIMELESS = ['now', 'leaves', 'serialLeaves', 'idle'];
const BYTES = 160; // CALLS_BYTES
const EDGE_US = 3; // the entry to its interrupt, and what of a microsecond has gone

function isClose(us, expected, slackUs) {
  return Math.abs((us - expected) | 0) <= slackUs;
}

// The number of the pulse that it is; -1: of none.
function pulseOf({truth}, {firstUs, secondUs}) {
  const slackUs = EDGE_US + truth.stalledNs / US;
  for (let i = 0; i + 1 < truth.edges.length; i += 2) {
    const [rise, fall] = [truth.edges[i] / US, truth.edges[i + 1] / US];
    if (isClose(firstUs, fall - rise, slackUs) && isClose(secondUs, fall, slackUs)) return i / 2;
  }
  return -1;
}

function pulse(bench, taken) {
  return taken.result === 1 ? pulseOf(bench, taken) : `level ${taken.isHigh}`;
}

function drain(bench, call) {
  const reads = [];
  for (;;) {
    const read = bench.call(call, {length: BYTES});
    if (read.result === 0) return reads;
    reads.push(read);
    if (read.result < 0 || reads.length > 200) throw new Error(`${call} returns ${read.result}`);
  }
}

function takeRest(bench) {
  const pulses = [];
  for (;;) {
    const taken = bench.call('take');
    pulses.push(pulse(bench, taken));
    if (taken.result !== 1 || pulses.length > 8) return pulses;
  }
}

// returned: what the path's call has done. {seen, reads, serialReads}: `seen` is compared.
function outcome(bench, call, returned) {
  const {uart, serial, truth, machine} = bench;
  const reads = call === 'read' ? [returned] : [];
  const serialReads = call === 'serialRead' ? [returned] : [];
  const pulses = call === 'take' ? [pulse(bench, returned)] : [];
  reads.push(...drain(bench, 'read'));
  serialReads.push(...drain(bench, 'serialRead'));
  pulses.push(...takeRest(bench));
  const isSent = bench.call('sent').result;
  const seen = JSON.stringify({
    result: TIMELESS.includes(call) ? 0 : returned.result,
    reads: reads.map(({flags, bytes}) => [flags, bytes]), serialReads: serialReads.map(({flags, bytes}) => [flags, bytes]),
    pulses, isSent, isSerialSent: bench.call('serialLeaves').firstUs === 0,
    counters: [0, 2, 4].map((at) => bench.half('port', COUNTERS + at)),
    serialCounters: [0, 2, 4].map((at) => bench.half('serial', SERIAL_COUNTERS + at)),
    wire: uart.sent.map(({value, format}) => [value, format]), serialWire: serial.sent.map(({value}) => value),
    levels: truth.levels.map(({high}) => high), breaks: uart.breaks.map(({on}) => on),
    edges: [RISES, LOST, MISSED].map((at) => bench.byte('edges', at)),
    divider: uart.divider, lcr: uart.lcr, imsc: [uart.registers[0x38], serial.registers[0x38]],
    pins: machine.mcu.sio.gpioValue >> OUTPUT & 1, forced: bench.timer.intStatus,
  });
  return {seen, reads, serialReads, pulses, isSent, returned};
}

module.exports = {outcome};
