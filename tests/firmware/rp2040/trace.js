// SPDX-License-Identifier: MIT
// Which instructions of an image were executed, and where each has led: for tests/verify/coverage, which names a folder in
// FATHOM_TRACE; ../avr/trace.h says what it keeps there. Without that it does nothing. Of one instruction four places are
// kept.
'use strict';
const fs = require('fs');

const FLASH = 0x10000000, HALFWORDS = 1 << 17, WAYS = 4;
const folder = process.env.FATHOM_TRACE;
const images = new Map(); // path: for each halfword of flash where it led, 0: nowhere

function follow(core, path) {
  if (folder === undefined) return;
  if (images.size === 0) process.on('exit', write);
  if (!images.has(path)) images.set(path, new Uint32Array(HALFWORDS * WAYS));
  const ledTo = images.get(path);
  // An interrupt is entered before the instruction that is then executed, which is the handler's first.
  let from = 0;
  const enter = core.exceptionEntry.bind(core);
  core.exceptionEntry = (number) => {
    enter(number);
    from = core.PC & ~1;
  };
  const execute = core.executeInstruction.bind(core);
  core.executeInstruction = () => {
    from = core.PC & ~1;
    const cycles = execute();
    const halfword = (from - FLASH) >> 1;
    if (halfword >= 0 && halfword < HALFWORDS) {
      const to = core.PC & ~1;
      const end = (halfword + 1) * WAYS;
      let at = halfword * WAYS;
      while (at !== end && ledTo[at] !== to && ledTo[at] !== 0) at++;
      if (at !== end) ledTo[at] = to;
    }
    return cycles;
  };
}

function write() {
  let runs = 0;
  for (const [path, ledTo] of images) {
    const lines = [path];
    ledTo.forEach((to, i) => {
      if (to !== 0) lines.push(`${(FLASH + 2 * Math.floor(i / WAYS)).toString(16)} ${to.toString(16)}`);
    });
    fs.writeFileSync(`${folder}/rp2040-${process.pid}-${runs++}.trace`, `${lines.join('\n')}\n`);
  }
}

module.exports = {follow};
