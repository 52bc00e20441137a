# SPDX-License-Identifier: MIT
"""Faults that the targets have to find, each planted alone in a copy."""
import dataclasses


@dataclasses.dataclass
class Fault:
    file: str
    old: str
    new: str
    target: str
    says: str  # of the line by which it is found
    seconds: int = 40


RTU = 'src/codec/modbus_rtu.c'
TCP = 'port/libmodbus/tcp.c'

FAULTS = [
    Fault(RTU, 'if (frame[SIZE] != (2u * count)) return FATHOM_ERR_MALFORMED;', '', 'modbus_rtu',
          'what a response means'),
    Fault(RTU, '(count > capacity) || ', '', 'modbus_rtu', 'heap-buffer-overflow'),
    Fault(RTU, '(at[0] * 256u) + at[1]', '(at[0] * 256u) + at[0]', 'libmodbus', 'both read the same values'),
    Fault('src/codec/crc16_small.c', '0x4400', '0x4401', 'figures', 'both sources say the same'),
    Fault('src/codec/hps167s_registers.c', 'exponent > FATHOM_HPS167S_MAX_EXPONENT', 'exponent > 31', 'hps167s',
          'which distance means something'),
    Fault('src/codec/dyp_55aa.c', ': (COMMAND + 1);', ': COMMAND;', 'dyp', 'more are needed to know'),
    Fault('src/engine/stream.c', 'if (after_gap || (count_of_bytes == 0u)) stream->to_whole',
          'if (after_gap) stream->to_whole', 'dyp', 'only in a believable place', 60),
    Fault('src/engine/line.c', 'MAX_READS = 16', 'MAX_READS = 17', 'line', 'at most 16 reads'),
    Fault('src/engine/line_response.c', 'is_whole && (protocol->check(frame, length) == 0u);', 'is_whole;', 'line',
          'line.h: '),
    Fault('src/engine/line_request.c', 'if (*link != NULL) return FATHOM_ERR_BUSY;', '', 'line', ''),
    Fault('src/sensor/dyp.c', ' && (value <= window->max_mm)', '', 'drivers',
          'a distance that the sensor cannot measure'),
    Fault('src/sensor/dyp.c', 'uint8_t kind = fathom_dyp_meaning(&measurement->window, value);',
          'uint8_t kind = fathom_dyp_meaning(&measurement->window, value);\n    sample->raw = value;', 'drivers',
          '*sample is untouched'),
    Fault(TCP, 'word_at(adu + TRANSACTION) != port->transaction', 'adu[TRANSACTION + 1] != (port->transaction & 0xFF)',
          'tcp', 'fathom_libmodbus.h: '),
    Fault(TCP, 'length < LEAST_LENGTH || length > MOST_LENGTH', 'length < LEAST_LENGTH', 'tcp', 'SO_RCVLOWAT'),
    Fault('examples/fathom/decode/decode.c', 'piece.protocol == 0 || piece.is_damaged', 'piece.protocol == 0', 'decode',
          '0 when every byte is part of a good frame'),
    Fault('examples/fathom/shared/options.c', 'if (sum > max) return false;', '', 'options', 'number_parse'),
    Fault('examples/fathom/commission/record.c', 'if (record_at(record, unit.address) != NULL)',
          'if (record == NULL)', 'files', 'an address stands there once'),
    Fault('examples/fathom/publish/config_file.c', "if (text[i] < ' ' ||", 'if (text[i] == 0 ||', 'site',
          'nothing that drives a terminal'),
]
