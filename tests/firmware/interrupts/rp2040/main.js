// SPDX-License-Identifier: MIT
//     node main.js --list         the names of the scenarios
//     node main.js NAME DEPTH     one of them: 1 each event alone, 2 two together, 3 all pairs of boundaries
// rp2040js is in NODE_PATH, the image in the folder FATHOM_IMAGES.
'use strict';
const {Enumeration} = require('./enumerate.js');
const {scenarios} = require('./scenarios.js');

const [name, depth] = process.argv.slice(2);
if (name === '--list') {
  for (const scenario of scenarios) console.log(scenario.name);
} else {
  const scenario = scenarios.find((one) => one.name === name);
  if (!scenario) throw new Error(`there is no scenario ${name}`);
  process.exitCode = new Enumeration(scenario, Number(depth)).run() ? 0 : 1;
}
