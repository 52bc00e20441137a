/* SPDX-License-Identifier: MIT */
#include "vectors.h"

#include "hex.h"

/* A row's frame, and of a Modbus frame what unit 1 was asked where it brings no values. */
#define FRAME(source, name, direction, hex)                                                                  \
    {                                                                                                        \
        source, source ": " name, direction, hex, 0, { 0 }                                                   \
    }
#define REQUEST(source, name, hex)  FRAME(source, name ", request", VECTOR_REQUEST, hex)
#define RESPONSE(source, name, hex) FRAME(source, name ", response", VECTOR_RESPONSE, hex)
#define BOTH(source, name, hex)     FRAME(source, name ", both ways", VECTOR_BOTH, hex)
#define ASKED(function, first, operand)                                                                      \
    {                                                                                                        \
        1, function, first, operand, {0}, 0                                                                  \
    }

enum { READ = 0x03, WRITE = 0x06, WRITE_MANY = 0x10 };

auto_vector_t auto_vectors[AUTO_ROWS] = {
    {RESPONSE("A16 2(4)", "auto frame: 1953 mm", "FF 07 A1 A7"), 1, {1953}},
    {RESPONSE("A05 1(3)", "auto frame: 1000 2000 1953 3562 mm", "FF 03 E8 07 D0 07 A1 0D EA 60"),
     4,
     {1000, 2000, 1953, 3562}},
};

/* The request of the exception is the one that the datasheet's text gives with it. */
modbus_vector_t modbus_vectors[MODBUS_ROWS] = {
    {REQUEST("A16 6(4) ex 1", "read processed", "01 03 01 00 00 01 85 F6"), ASKED(READ, 0x0100, 1)},
    {RESPONSE("A16 6(4) ex 1", "read processed: 754 mm", "01 03 02 02 F2 38 A1"),
     {1, READ, 0x0100, 1, {754}, 0}},
    {REQUEST("A16 6(4) ex 2", "read real-time", "01 03 01 01 00 01 D4 36"), ASKED(READ, 0x0101, 1)},
    {RESPONSE("A16 6(4) ex 2", "read real-time: 751 mm", "01 03 02 02 EF F8 A8"),
     {1, READ, 0x0101, 1, {751}, 0}},
    {BOTH("A16 6(4) ex 3", "set address 5", "01 06 02 00 00 05 48 71"), ASKED(WRITE, 0x0200, 5)},
    {BOTH("A16 6(4) ex 4", "set automatic mode", "01 06 02 02 00 01 E8 72"), ASKED(WRITE, 0x0202, 1)},
    {BOTH("A16 6(4) ex 5", "set real-time output", "01 06 02 07 00 01 F8 73"), ASKED(WRITE, 0x0207, 1)},
    {BOTH("A16 6(4) ex 6", "set negative polarity", "01 06 02 05 00 00 98 73"), ASKED(WRITE, 0x0205, 0)},
    {BOTH("A16 6(4) last", "set threshold 2000 mm", "01 06 02 06 07 D0 6B DF"), ASKED(WRITE, 0x0206, 2000)},
    {REQUEST("A05 3(4)1 ex 1", "read probe 1", "01 03 01 06 00 01 65 F7"), ASKED(READ, 0x0106, 1)},
    {RESPONSE("A05 3(4)1 ex 1", "read probe 1: 316 mm", "01 03 02 01 3C B9 C5"),
     {1, READ, 0x0106, 1, {316}, 0}},
    {REQUEST("A05 3(4)1 ex 2", "read probe 2", "01 03 01 07 00 01 34 37"), ASKED(READ, 0x0107, 1)},
    {RESPONSE("A05 3(4)1 ex 2", "read probe 2: 2331 mm", "01 03 02 09 1B FE 1F"),
     {1, READ, 0x0107, 1, {2331}, 0}},
    {REQUEST("A05 3(4)1 ex 3", "read probes 2 3 4", "01 03 01 07 00 03 B5 F6"), ASKED(READ, 0x0107, 3)},
    {RESPONSE("A05 3(4)1 ex 3", "read probes 2 3 4: 250 659 2426 mm", "01 03 06 00 FA 02 93 09 7A 8F 47"),
     {1, READ, 0x0107, 3, {250, 659, 2426}, 0}},
    {BOTH("A05 3(4)2", "set address 5", "01 06 02 00 00 05 48 71"), ASKED(WRITE, 0x0200, 5)},
    {REQUEST("HPS table 9", "interface version", "01 03 00 01 00 03 54 0B"), ASKED(READ, 0x0001, 3)},
    {REQUEST("HPS table 11", "interface configuration", "01 03 00 02 00 04 E5 C9"), ASKED(READ, 0x0002, 4)},
    {REQUEST("HPS table 13", "sensor details", "01 03 00 03 00 0B F4 0D"), ASKED(READ, 0x0003, 11)},
    {RESPONSE("HPS command #3", "sensor details: 2019-09-23 version 3.9; the text says 19/09/27 and Ver. 2.1",
              "01 03 16 B0 00 39 00 25 42 34 57 14 20 34 38 35 01 06 07 05 13 09 17 03 09 1A DC"),
     {1,
      READ,
      0x0003,
      11,
      {0xB000, 0x3900, 0x2542, 0x3457, 0x1420, 0x3438, 0x3501, 0x0607, 0x0513, 0x0917, 0x0309},
      0}},
    {REQUEST("HPS table 15", "AFE temperature", "01 03 00 04 00 01 C5 CB"), ASKED(READ, 0x0004, 1)},
    {REQUEST("HPS table 17", "single measurement; the exception example misprints the CRC as C5 C8",
             "01 03 00 08 00 04 C5 CB"),
     ASKED(READ, 0x0008, 4)},
    {RESPONSE("HPS command #5", "single measurement: 2083 mm; magnitude 723.1744; ambient 1; precision 0",
              "01 03 08 08 23 DC B2 07 01 00 00 FD 41"),
     {1, READ, 0x0008, 4, {2083, 0xDCB2, 0x0701, 0}, 0}},
    {REQUEST("HPS table 19", "factory reset", "01 03 00 09 00 01 54 08"), ASKED(READ, 0x0009, 1)},
    {RESPONSE("HPS table 20", "factory reset: success", "01 03 02 00 01 79 84"),
     {1, READ, 0x0009, 1, {1}, 0}},
    {BOTH("HPS tables 21 22", "warm-up 5 s", "01 06 00 0A 00 05 69 CB"), ASKED(WRITE, 0x000A, 5)},
    {BOTH("HPS tables 25 26", "baud 19200", "01 06 00 11 00 01 18 0F"), ASKED(WRITE, 0x0011, 1)},
    {BOTH("HPS tables 27 28", "no measurement at power-on", "01 06 00 12 00 00 29 CF"),
     ASKED(WRITE, 0x0012, 0)},
    {BOTH("HPS tables 29 30", "termination on", "01 06 00 13 00 FF 38 4F"), ASKED(WRITE, 0x0013, 0x00FF)},
    {RESPONSE("HPS table 38", "reconnect time", "01 10 00 20 00 02 40 02"), ASKED(WRITE_MANY, 0x0020, 2)},
    {RESPONSE("HPS abnormal response", "exception 02 to 03: illegal address", "01 83 02 C0 F1"),
     {1, READ, 0x0008, 4, {0}, 2}},
};

dyp_vector_t dyp_vectors[DYP_ROWS] = {
    {REQUEST("A05 2(3)3", "all probes", "55 AA 01 01 01"), 1, 0x01, {0}},
    {RESPONSE("A05 2(3)3", "all probes: printed sum is 60", "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62"),
     1,
     0x01,
     {1000, 2000, 1953, 3562}},
    {REQUEST("A05 2(3)4", "probe 1", "55 AA 01 10 10"), 1, 0x10, {0}},
    {RESPONSE("A05 2(3)4", "probe 1", "55 AA 01 10 07 A1 B8"), 1, 0x10, {1953}},
    {BOTH("A05 2(3)5", "set address 5", "55 AA 05 03 07"), 5, 0x03, {0}},
};

/* The last is the check value that every catalogue of CRCs gives for "123456789". */
crc_vector_t crc_vectors[CRC_ROWS] = {
    {"HPS-167S appendix data1", "63", 0x69FF, {0xFF, 0x69}, 0, {0}},
    {"HPS-167S appendix data2", "8C", 0xE5BE, {0xBE, 0xE5}, 0, {0}},
    {"HPS-167S appendix data3", "7D", 0x617F, {0x7F, 0x61}, 0, {0}},
    {"HPS-167S appendix data4", "AA BB CC", 0x4523, {0x23, 0x45}, 0, {0}},
    {"HPS-167S appendix data5", "00 00 AA BB CC", 0x8576, {0x76, 0x85}, 0, {0}},
    {"HPS-167S appendix data6", "01 03 00 03 00 0B", 0x0DF4, {0xF4, 0x0D}, 0, {0}},
    {"HPS-167S appendix sample_data", "01 01 01 06 D9 FC 8C 02 01 00 01", 0xF102, {0x02, 0xF1}, 0, {0}},
    {"check value of 123456789", "31 32 33 34 35 36 37 38 39", 0x4B37, {0x37, 0x4B}, 0, {0}},
};

static void fill_in(vector_t *frame) { frame->length = hex_parse(frame->hex, frame->bytes); }

__attribute__((constructor)) static void fill_in_bytes(void)
{
    for (unsigned i = 0; i != AUTO_ROWS; i++) fill_in(&auto_vectors[i].frame);
    for (unsigned i = 0; i != MODBUS_ROWS; i++) fill_in(&modbus_vectors[i].frame);
    for (unsigned i = 0; i != DYP_ROWS; i++) fill_in(&dyp_vectors[i].frame);
    for (unsigned i = 0; i != CRC_ROWS; i++)
        crc_vectors[i].length = hex_parse(crc_vectors[i].hex, crc_vectors[i].bytes);
}
