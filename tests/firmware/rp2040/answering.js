// SPDX-License-Identifier: MIT
// A device that knows one request and one response, of the datasheets' examples.
'use strict';

const A16_REAL_TIME = { // A16 6(4), example 2: 751 mm
  format: '8N1',
  baud: 9600,
  request: [0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xd4, 0x36],
  response: [0x01, 0x03, 0x02, 0x02, 0xef, 0xf8, 0xa8],
};

const A05_ALL_PROBES = { // A05 2(3)3: 1000, 2000, 1953, 3562 mm; the sum that is printed there is wrong
  format: '8N1',
  baud: 9600,
  request: [0x55, 0xaa, 0x01, 0x01, 0x01],
  response: [0x55, 0xaa, 0x01, 0x01, 0x03, 0xe8, 0x07, 0xd0, 0x07, 0xa1, 0x0d, 0xea, 0x62],
};

// Responses `after` us (undefined: never) after the request's last stop bit. Keeps when each request ended, in ns, and what
// else it heard.
class Answering {
  constructor(machine, uart, frames, after) {
    Object.assign(this, {machine, uart, frames, after, requests: [], strays: [], heard: []});
    uart.onSent = (character) => this.hear(character);
  }

  hear({value, format, start, end}) {
    const {request, format: wanted, baud} = this.frames;
    const bit = (end - start) * baud / 1e9 / 10;
    if (format !== wanted || Math.abs(bit - 1) > 0.025 || value !== request[this.heard.length]) {
      this.strays.push(value);
      this.heard = [];
      return;
    }
    this.heard.push(value);
    if (this.heard.length < request.length) return;
    this.heard = [];
    this.requests.push(end);
    if (this.after !== undefined) this.machine.after(this.after, () => this.send());
  }

  send() {
    const character = 10e6 / this.frames.baud;
    this.frames.response.forEach((value, i) => this.machine.after((i + 1) * character, () => this.uart.receive(value)));
  }
}

module.exports = {Answering, A05_ALL_PROBES, A16_REAL_TIME};
