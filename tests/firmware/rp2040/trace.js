// SPDX-License-Identifier: MIT
// Which instructions of an image were executed, and where each has led: for tests/coverage, which names a folder in
// FATHOM_TRACE; ../avr/trace.h says what it keeps there. Without that it does nothing.
'use strict';
const fs = require('fs');

const folder = process.env.FATHOM_TRACE;
const images = new Map(); // path: Set of "FROM TO"

function follow(core, path) {
  if (folder === undefined) return;
  if (images.size === 0) process.on('exit', write);
  if (!images.has(path)) images.set(path, new Set());
  const pairs = images.get(path);
  const seen = new Map(); // from: a list of to
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
    const to = core.PC & ~1;
    const ways = seen.get(from);
    if (ways === undefined) seen.set(from, [to]);
    else if (ways.includes(to) || ways.length === 8) return cycles;
    else ways.push(to);
    pairs.add(`${from.toString(16)} ${to.toString(16)}`);
    return cycles;
  };
}

function write() {
  let runs = 0;
  for (const [path, pairs] of images)
    fs.writeFileSync(`${folder}/rp2040-${process.pid}-${runs++}.trace`, `${path}\n${[...pairs].join('\n')}\n`);
}

module.exports = {follow};
