/* SPDX-License-Identifier: MIT */
/* The table of the kinds of faults: their names, their texts and the protocols that they apply to. */
#include <string.h>

#include "internal/fault_parts.h"

enum {
    WITH_ADDRESS = FATHOM_SIM_MODBUS | FATHOM_SIM_DYP,
    WITH_COUNT = WITH_ADDRESS | FATHOM_SIM_STREAM,
    ANY = WITH_COUNT | FATHOM_SIM_HPS167
};

static const struct {
    const char *name;
    const char *text;
    uint8_t protocols;
} kinds[FATHOM_SIM_FAULT_END] = {
    [FATHOM_SIM_FAULT_STUCK] = {"stuck", "the value of the frame before", ANY},
    [FATHOM_SIM_FAULT_INTERFERENCE] = {"interference", "reports interference (a16, a05)", ANY},
    [FATHOM_SIM_FAULT_FAULT] = {"fault", "reports that it has failed (hps167s)", ANY},
    [FATHOM_SIM_FAULT_NO_TARGET] = {"no-target", "reports that there is no target", ANY},
    [FATHOM_SIM_FAULT_UNIT] = {"unit", "from another unit, checksum right", WITH_ADDRESS},
    [FATHOM_SIM_FAULT_FUNCTION] = {"function", "another function, checksum right", WITH_ADDRESS},
    [FATHOM_SIM_FAULT_COUNT] = {"count", "a value less or more, checksum right", WITH_COUNT},
    [FATHOM_SIM_FAULT_EXCEPTION] = {"exception", "a Modbus exception, any of 1..255", FATHOM_SIM_MODBUS},
    [FATHOM_SIM_FAULT_FLIP_BIT] = {"flip-bit", "one bit is wrong", ANY},
    [FATHOM_SIM_FAULT_FLIP_BYTE] = {"flip-byte", "one byte is wrong", ANY},
    [FATHOM_SIM_FAULT_DROP] = {"drop", "a byte is missing", ANY},
    [FATHOM_SIM_FAULT_INSERT] = {"insert", "a byte more between two others", ANY},
    [FATHOM_SIM_FAULT_TRUNCATE] = {"truncate", "the end is missing", ANY},
    [FATHOM_SIM_FAULT_TRAILING] = {"trailing", "1..4 bytes more at the end", ANY},
    [FATHOM_SIM_FAULT_PARITY] = {"parity", "a byte with a parity error", ANY},
    [FATHOM_SIM_FAULT_FRAMING] = {"framing", "a byte with a framing error", ANY},
    [FATHOM_SIM_FAULT_OVERRUN] = {"overrun", "a byte that the UART lost", ANY},
    [FATHOM_SIM_FAULT_SPLIT] = {"split", "a pause of 10 ms inside the frame", ANY},
    [FATHOM_SIM_FAULT_DUPLICATE] = {"duplicate", "the frame comes twice", ANY},
    [FATHOM_SIM_FAULT_DELAY] = {"delay", "20 ms later, in time", ANY},
    [FATHOM_SIM_FAULT_LATE] = {"late", "1.5 s later, after a time-out", ANY},
    [FATHOM_SIM_FAULT_SILENCE] = {"silence", "no frame at all", ANY},
    [FATHOM_SIM_FAULT_POWER_CYCLE] = {"power-cycle", "off in mid-frame, back after 2 s", ANY},
    [FATHOM_SIM_FAULT_NOISE] = {"noise", "1..8 random bytes before or after it", ANY},
    [FATHOM_SIM_FAULT_UNASKED] = {"unasked", "an unsolicited frame besides", ANY},
    [FATHOM_SIM_FAULT_BREAK] = {"break", "a break before the frame", ANY},
    [FATHOM_SIM_FAULT_ECHO] = {"echo", "the line repeats what the host sends",
                               WITH_ADDRESS | FATHOM_SIM_HPS167},
    [FATHOM_SIM_FAULT_CLOCK_JUMP] = {"clock-jump", "the host's clock jumps forward by 10 s", ANY},
};

static bool exists(uint8_t kind) { return kind != 0 && kind < FATHOM_SIM_FAULT_END; }

const char *fathom_sim_fault_name(uint8_t kind) { return exists(kind) ? kinds[kind].name : NULL; }

const char *fathom_sim_fault_text(uint8_t kind) { return exists(kind) ? kinds[kind].text : NULL; }

uint8_t fathom_sim_fault_find(const char *name)
{
    for (uint8_t kind = 1; kind < FATHOM_SIM_FAULT_END; kind++)
        if (strcmp(name, kinds[kind].name) == 0) return kind;
    return 0;
}

uint8_t fathom_sim_fault_protocols(uint8_t kind) { return exists(kind) ? kinds[kind].protocols : 0; }

bool fathom_sim_fault_applies(uint8_t kind, const fathom_sim_device_t *device)
{
    uint8_t spoken = device->period_us != 0 ? FATHOM_SIM_STREAM : 0;
    for (uint8_t i = 0; i < FATHOM_SIM_PROTOCOLS && device->listens && device->protocols[i] != NULL; i++)
        spoken |= device->protocols[i]->id;
    if (kind == FATHOM_SIM_FAULT_INTERFERENCE && device->model->optical) return false;
    if (kind == FATHOM_SIM_FAULT_FAULT && !device->model->optical) return false;
    return (fathom_sim_fault_protocols(kind) & spoken) != 0;
}
