// SPDX-License-Identifier: MIT
// The state of a machine, to come back to as often as wanted: core, memory, clock, and the peripherals that the image
// uses. What is kept of an object are its own members, with copies of arrays and plain objects.
'use strict';

const RAM = 0x20000000, DATA_SIZE = 0x1000, STACK_SIZE = 0x800, RAM_SIZE = 0x40000;

function copy(value) {
  if (Array.isArray(value) || ArrayBuffer.isView(value)) return value.slice();
  return value !== null && typeof value === 'object' && value.constructor === Object ? {...value} : value;
}

class Snapshots {
  // roots: objects beside those of the machine.
  constructor(machine, roots) {
    const {mcu, core} = machine;
    const timer = mcu.peripherals[0x40054];
    this.machine = machine;
    this.roots = [core, timer, ...timer.alarms, ...machine.uart, mcu.sio, ...mcu.gpio.slice(0, 8), ...roots];
    for (const [name, address] of machine.symbols)
      if (address >= RAM + DATA_SIZE && address < RAM + RAM_SIZE - STACK_SIZE) throw new Error(`${name} is not kept`);
  }

  take() {
    const {mcu, clock, running} = this.machine;
    const alarms = [];
    for (let alarm = clock.nextAlarm; alarm !== null; alarm = alarm.next) alarms.push([alarm, alarm.nanos]);
    return {
      members: this.roots.map((root) => Object.keys(root).map((name) => [name, copy(root[name])])),
      data: mcu.sram.slice(0, DATA_SIZE),
      stack: mcu.sram.slice(RAM_SIZE - STACK_SIZE, RAM_SIZE),
      nanos: clock.nanos, alarms, running: running.slice(),
    };
  }

  restore(kept) {
    const {mcu, clock} = this.machine;
    this.roots.forEach((root, i) => {
      for (const [name, value] of kept.members[i]) root[name] = copy(value);
    });
    mcu.sram.set(kept.data, 0);
    mcu.sram.set(kept.stack, RAM_SIZE - STACK_SIZE);
    clock.nanosCounter = kept.nanos;
    let next = null;
    for (let i = kept.alarms.length - 1; i >= 0; i--) {
      const [alarm, nanos] = kept.alarms[i];
      Object.assign(alarm, {nanos, next, scheduled: true});
      next = alarm;
    }
    clock.nextAlarm = next;
    this.machine.running = kept.running.slice();
  }
}

module.exports = {Snapshots, LOWEST_STACK: RAM + RAM_SIZE - STACK_SIZE};
