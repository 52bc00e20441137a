// SPDX-License-Identifier: MIT
// The tests of one file, in their order, when all of it has been read. The last line is "N passed, 0 failed". With
// FATHOM_FIRST_FAILURE in the environment the first one that fails is the last.
'use strict';
const assert = require('assert');
const {Machine} = require('./machine.js');

const tests = [];

function test(name, body) {
  if (tests.push({name, body}) === 1) setImmediate(run);
}

// A measured value that may be worth keeping.
function figure(name, value, unit) {
  console.log(`figure ${name} ${value} ${unit}`);
}

function run() {
  let passed = 0, failed = 0;
  for (const {name, body} of tests) {
    try {
      body();
      Machine.change(null);
      console.log(`passed  ${name}`);
      passed++;
    } catch (error) {
      failed++;
      Machine.current = null;
      console.log(`FAILED  ${name}\n${error.stack}`);
      if (process.env.FATHOM_FIRST_FAILURE) break;
    }
  }
  console.log(`${passed} passed, ${failed} failed`);
  process.exitCode = failed === 0 ? 0 : 1;
}

module.exports = {assert, test, figure};
