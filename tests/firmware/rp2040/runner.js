// SPDX-License-Identifier: MIT
// The tests of one file, in their order. The last line is "N passed, 0 failed".
'use strict';

const tests = [];

function test(name, run) {
  tests.push({name, run});
}

// A measured value that somebody may want to keep.
function figure(name, value, unit) {
  console.log(`figure ${name} ${value} ${unit}`);
}

process.on('exit', () => {
  let failed = 0;
  for (const {name, run} of tests) {
    try {
      run();
      console.log(`passed  ${name}`);
    } catch (error) {
      failed++;
      console.log(`FAILED  ${name}\n${error.stack}`);
    }
  }
  console.log(`${tests.length - failed} passed, ${failed} failed`);
  process.exitCode = failed === 0 && tests.length > 0 ? 0 : 1;
});

module.exports = {test, figure};
