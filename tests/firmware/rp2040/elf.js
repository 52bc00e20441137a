// SPDX-License-Identifier: MIT
// What a 32-bit little-endian ELF file has to be asked: its loadable segments and its symbols.
'use strict';
const fs = require('fs');

const LOAD = 1; // PT_LOAD
const SYMBOLS = 2; // SHT_SYMTAB

function readElf(path) {
  const file = fs.readFileSync(path);
  const word = (at) => file.readUInt32LE(at);
  const half = (at) => file.readUInt16LE(at);
  if (word(0) !== 0x464c457f || file[4] !== 1 || file[5] !== 1) throw new Error(`${path}: no ELF file of this kind`);

  const segments = [];
  for (let i = 0, at = word(28); i < half(44); i++, at += half(42)) {
    const from = word(at + 4);
    const length = word(at + 16);
    if (word(at) === LOAD && length > 0) segments.push({address: word(at + 12), bytes: file.subarray(from, from + length)});
  }

  const symbols = new Map();
  const section = (index) => word(32) + index * half(46);
  for (let i = 0; i < half(48); i++) {
    if (word(section(i) + 4) !== SYMBOLS) continue;
    const names = word(section(word(section(i) + 24)) + 16);
    const from = word(section(i) + 16);
    for (let at = from; at < from + word(section(i) + 20); at += 16) {
      const name = names + word(at);
      symbols.set(file.toString('latin1', name, file.indexOf(0, name)), word(at + 4));
    }
  }
  return {segments, symbols};
}

module.exports = {readElf};
