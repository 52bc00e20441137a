// SPDX-License-Identifier: MIT
// The tests of one file, in their order; its last statement is run(). The last line is "N passed, 0 failed".
'use strict';

const tests = [];

function test(name, body) {
  tests.push({name, body});
}

// A measured value that somebody may want to keep.
function figure(name, value, unit) {
  console.log(`figure ${name} ${value} ${unit}`);
}

function run() {
  let failed = 0;
  for (const {name, body} of tests) {
    try {
      body();
      console.log(`passed  ${name}`);
    } catch (error) {
      failed++;
      console.log(`FAILED  ${name}\n${error.stack}`);
    }
  }
  console.log(`${tests.length - failed} passed, ${failed} failed`);
  process.exitCode = failed === 0 && tests.length > 0 ? 0 : 1;
}

module.exports = {test, figure, run};
