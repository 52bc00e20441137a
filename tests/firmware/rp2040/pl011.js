// SPDX-License-Identifier: MIT
// ARM's PL011 as the RP2040 has it (datasheet 4.2), with time: rp2040js's own sends in no time, knows no FIFO level, no
// time-out, no BUSY and no errors. Written from the datasheet and ARM's manual (DDI 0183), of which it also holds the
// firmware to what they forbid: see `violations`.
'use strict';

const R = {
  DR: 0x00, FR: 0x18, IBRD: 0x24, FBRD: 0x28, LCR_H: 0x2c, CR: 0x30, IFLS: 0x34, IMSC: 0x38, RIS: 0x3c, MIS: 0x40,
  ICR: 0x44, DMACR: 0x48,
};
const FE = 1 << 8, PE = 1 << 9, BE = 1 << 10, OE = 1 << 11; // DR
const UARTEN = 1, TXE = 1 << 8, RXE = 1 << 9; // CR
const BRK = 1, PEN = 2, EPS = 4, STP2 = 8, FEN = 16; // LCR_H
const RXDMAE = 1; // DMACR
const DREQ_UART0_RX = 21; // the datasheet's 2.5.3.1; UART1's is two further
const INT_RX = 1 << 4, INT_TX = 1 << 5, INT_RT = 1 << 6;
const DEPTH = 32;
const RX_LEVELS = [4, 8, 16, 24, 28]; // of IFLS: so many or more
const TX_LEVELS = [4, 8, 16, 24, 28]; // so many or fewer
const TIME_OUT_BITS = 32;

class Pl011 {
  constructor(mcu, number, clkPeri = 125e6) {
    Object.assign(this, {mcu, number, clkPeri, clock: mcu.clock});
    this.violations = [];
    this.sent = []; // {value, start, end, bit, format} of each character, times in ns
    this.breaks = []; // {on, at}
    this.onSent = null; // called when a character's last stop bit has left
    this.inReset = true;
    this.shift = this.clock.createAlarm(() => this.shifted());
    this.timeOut = this.clock.createAlarm(() => this.raise(INT_RT));
    this.reset();
  }

  reset() {
    this.registers = {[R.IBRD]: 0, [R.FBRD]: 0, [R.LCR_H]: 0, [R.CR]: TXE | RXE, [R.IFLS]: 0x12, [R.IMSC]: 0,
      [R.DMACR]: 0};
    this.divider = 0; // as LCR_H's write has taken it over, in 64ths
    this.status = 0; // RIS
    this.tx = [];
    this.rx = [];
    this.overrun = false;
    this.leaving = null; // the character in the shift register
    this.shift.cancel();
    this.timeOut.cancel();
    this.update();
    this.request();
  }

  get lcr() { return this.registers[R.LCR_H]; }
  get enabled() { return (this.registers[R.CR] & UARTEN) !== 0; }
  get baud() { return this.clkPeri * 4 / this.divider; }
  get bitNs() { return 1e9 / this.baud; }
  get depth() { return this.lcr & FEN ? DEPTH : 1; }
  get rxLevel() { return this.lcr & FEN ? RX_LEVELS[this.registers[R.IFLS] >> 3 & 7] : 1; }
  get txLevel() { return this.lcr & FEN ? TX_LEVELS[this.registers[R.IFLS] & 7] : 0; }
  get busy() { return this.tx.length > 0 || this.leaving !== null; }

  // 'E' and the like is what the parity bit says; the sensors' lines are 8 data bits.
  get format() {
    const parity = this.lcr & PEN ? (this.lcr & EPS ? 'E' : 'O') : 'N';
    return `${(this.lcr >> 5 & 3) + 5}${parity}${this.lcr & STP2 ? 2 : 1}`;
  }

  get bits() { return 1 + (this.lcr >> 5 & 3) + 5 + (this.lcr & PEN ? 1 : 0) + (this.lcr & STP2 ? 2 : 1); }

  violation(what) { this.violations.push(`UART${this.number} at ${this.clock.nanos} ns: ${what}`); }

  update() { this.mcu.setInterrupt(20 + this.number, (this.status & this.registers[R.IMSC]) !== 0); }

  // The DMA is asked for as long as there is a byte (UARTRXDMASREQ); rp2040js knows what to do with that.
  request() {
    const dreq = DREQ_UART0_RX + 2 * this.number;
    if (this.registers[R.DMACR] & RXDMAE && this.rx.length > 0) this.mcu.dma.setDREQ(dreq);
    else this.mcu.dma.clearDREQ(dreq);
  }

  raise(bit) { this.status |= bit; this.update(); }
  lower(bit) { this.status &= ~bit; this.update(); }

  readUint32(offset) {
    if (this.inReset) this.violation(`read at ${offset.toString(16)} while it is in reset`);
    switch (offset) {
      case R.DR: return this.readData();
      case R.FR:
        return (this.busy ? 1 << 3 : 0) | (this.rx.length === 0 ? 1 << 4 : 0) | (this.tx.length >= this.depth ? 1 << 5 : 0) |
          (this.rx.length >= this.depth ? 1 << 6 : 0) | (this.tx.length === 0 ? 1 << 7 : 0);
      case R.RIS: return this.status;
      case R.MIS: return this.status & this.registers[R.IMSC];
      default:
        if (offset in this.registers) return this.registers[offset];
        this.violation(`read of register ${offset.toString(16)}`);
        return 0;
    }
  }

  writeUint32Atomic(offset, value, alias) {
    const before = offset in this.registers ? this.registers[offset] : 0;
    this.write(offset, [value, before ^ value, before | value, before & ~value][alias] >>> 0);
  }

  write(offset, value) {
    if (this.inReset) this.violation(`write at ${offset.toString(16)} while it is in reset`);
    switch (offset) {
      case R.DR: this.writeData(value & 0xff); break;
      case R.ICR: this.lower(value); break;
      case R.IMSC: this.registers[R.IMSC] = value & 0x7ff; this.update(); break;
      case R.CR: this.registers[R.CR] = value; this.begin(); break;
      case R.LCR_H: this.writeLineControl(value); break;
      case R.DMACR: this.registers[R.DMACR] = value; this.request(); break;
      case R.IBRD: case R.FBRD: case R.IFLS: this.registers[offset] = value; break;
      default: this.violation(`write of register ${offset.toString(16)}`);
    }
  }

  writeLineControl(value) {
    const changed = this.lcr ^ value;
    if (this.enabled && changed & ~BRK) this.violation('LCR_H changes while the UART is enabled');
    if (this.leaving && changed & ~BRK) this.violation('LCR_H changes while a character leaves');
    if (changed & BRK) this.breaks.push({on: (value & BRK) !== 0, at: this.clock.nanos});
    if (changed & FEN) this.rx = [];
    this.registers[R.LCR_H] = value;
    this.divider = this.registers[R.IBRD] * 64 + this.registers[R.FBRD];
  }

  // ---- transmitter ----

  writeData(value) {
    if (this.tx.length >= this.depth) this.violation('a byte is written to a full FIFO');
    else this.tx.push(value);
    if (this.tx.length > this.txLevel) this.lower(INT_TX);
    this.begin();
  }

  begin() {
    if (this.leaving || this.tx.length === 0 || !this.enabled || !(this.registers[R.CR] & TXE) || this.divider === 0) return;
    // A start bit begins with the next sixteenth of a bit, of a divider that runs on between characters.
    const tick = this.bitNs / 16;
    const start = Math.ceil(this.clock.nanos / tick - 1e-6) * tick;
    this.leaving = {value: this.tx.shift(), start, end: start + this.bits * this.bitNs, bit: this.bitNs, format: this.format};
    if (this.tx.length === this.txLevel) this.raise(INT_TX);
    this.shift.schedule(this.leaving.end - this.clock.nanos);
  }

  shifted() {
    const character = this.leaving;
    this.leaving = null;
    this.sent.push(character);
    this.begin();
    if (this.onSent) this.onSent(character);
  }

  // ---- receiver ----

  // A character whose last bit ends now. errors: of DR.
  receive(value, errors = 0) {
    if (!this.enabled || !(this.registers[R.CR] & RXE)) return;
    if (this.rx.length >= this.depth) {
      this.overrun = true;
      return;
    }
    this.rx.push(value | errors | (this.overrun ? OE : 0));
    this.overrun = false;
    if (this.rx.length >= this.rxLevel) this.raise(INT_RX);
    this.timeOut.schedule(TIME_OUT_BITS * this.bitNs);
    this.request();
  }

  readData() {
    if (this.rx.length === 0) {
      this.violation('a byte is read from an empty FIFO');
      return 0;
    }
    const entry = this.rx.shift();
    if (this.rx.length < this.rxLevel) this.lower(INT_RX);
    if (this.rx.length === 0) {
      this.timeOut.cancel();
      this.lower(INT_RT);
      this.request();
    }
    return entry;
  }
}

module.exports = {Pl011, FE, PE, BE, OE};
