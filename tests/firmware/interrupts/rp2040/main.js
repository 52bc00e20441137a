// SPDX-License-Identifier: MIT
//     node main.js --list                    the names of the scenarios
//     node main.js NAME DEPTH [NAME DEPTH]   some of them: 1 each event alone, 2 two together, 3 all pairs of boundaries
// rp2040js is in NODE_PATH, the image in the folder FATHOM_IMAGES.
'use strict';
const {Machine} = require('../../rp2040/machine.js');
const {Enumeration} = require('./enumerate.js');
const {scenarios} = require('./scenarios.js');

function run(name, depth) {
  const scenario = scenarios.find((one) => one.name === name);
  if (!scenario) throw new Error(`there is no scenario ${name}`);
  Machine.current = null; // the one before has said what was wrong
  try {
    return new Enumeration(scenario, depth).run();
  } catch (error) {
    console.log(`wrong ${name}: ${error.message}\n${error.stack}`);
    console.log(`figures ${name},0,0,0,0,0`);
    return false;
  }
}

const words = process.argv.slice(2);
if (words[0] === '--list') {
  for (const {name} of scenarios) console.log(name);
} else {
  for (let i = 0; i < words.length; i += 2) if (!run(words[i], Number(words[i + 1]))) process.exitCode = 1;
}
