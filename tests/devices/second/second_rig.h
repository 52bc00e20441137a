/* SPDX-License-Identifier: MIT */
/* The library at the other end of a second device's wire: a clock and a UART in simulated time. */
#ifndef SECOND_RIG_H
#define SECOND_RIG_H

#include "fathom/fathom.h"
#include "second_device.h"

enum { RIG_BYTES = 4096, RIG_FRAME = 32 };

/* How the program's loop comes round: when something is due or a byte has come; or at fixed times, without time
 * stamps of the port. */
typedef enum { RIG_WOKEN, RIG_EVERY_1_MS, RIG_EVERY_7_MS, RIG_EVERY_20_MS, RIG_LOOPS } rig_loop_t;

/* The damage that the rig does to the bytes of the device. */
typedef enum {
    RIG_UNHARMED,
    RIG_ONE_BIT,   /* some frames have one wrong bit */
    RIG_SOFT_UART, /* some bytes have one wrong bit, as behind a UART that samples in software */
    RIG_LOSSES     /* some bytes do not arrive, and the port does not report it */
} rig_damage_t;

typedef struct {
    second_device_t device;
    uint64_t now_us;
    uint32_t clock_begins_us; /* near the wrap for some seeds */
    rig_loop_t loop;
    bool has_stamps; /* the port knows when bytes came, by the rig's clock */

    fathom_clock_t clock;
    fathom_uart_t uart;
    fathom_edges_t edges; /* of the device's output, as an interrupt gives them */
    fathom_pin_t pin;     /* the same; low while the contact of a relay conducts */
    second_line_t set;    /* the host's UART */
    uint64_t sent_us;     /* when all that was written has left */
    bool in_break;
    struct {
        uint8_t value, flags;
        bool is_foreign; /* the device did not send it */
        bool is_wrong;   /* the device sent it with another value */
        uint64_t end_us;
    } bytes[RIG_BYTES]; /* A ring. The bytes that were read remain in it until newer bytes replace them. */
    size_t first, count;
    uint64_t received_count;
    unsigned marked_count; /* of these: bytes with a flag of the port */

    rig_damage_t damage;
    uint32_t damage_of_1000; /* of 1000 frames or bytes, as `damage` says */
    bool sees_parity;        /* the port marks each byte that has a wrong bit */
    uint64_t random;
    uint64_t frame_start_us; /* of the newest frame of the device */
    uint8_t
        bytes_to_damage; /* number of bytes up to the wrong one of this frame; 0: no byte is left to damage */
    uint64_t zero_us;    /* end of the next zero */
    uint64_t zeros_until_us; /* 0: no zeros have been sent */

    uint32_t writes; /* requests on the wire that change something */
    uint32_t to_all; /* of them: to unit 0 or 255, but for HPS-167S #10 and #11 */
    uint8_t last[RIG_FRAME];
    size_t last_len;

    fathom_line_parts_t line_parts;
    uint8_t frame[RIG_FRAME];
    fathom_line_t line;
    fathom_modbus_t modbus;
} rig_t;

/* A device on a wire, without power. The loop, the echo's being told and the clock's begin hang on the seed. */
void rig_open(rig_t *rig, const second_config_t *config);
void rig_power(rig_t *rig, bool on);
/* Off for so long, and on for so long. */
void rig_restart(rig_t *rig, uint64_t off_us, uint64_t on_us);
void rig_scene(rig_t *rig, int32_t mm1, int32_t mm2, int32_t mm3, int32_t mm4);

/* Time passes: once round the loop, of which something is due in due_us at the latest. */
void rig_pass(rig_t *rig, uint32_t due_us);
/* Damages `of_1000` of 1000 frames or bytes from now on. */
void rig_damage(rig_t *rig, rig_damage_t damage, uint32_t of_1000);
/* Replaces the bytes of the device by zeros without a pause for `us`. */
void rig_zeros(rig_t *rig, uint64_t us);
/* So long, with the line polled and nothing asked. */
void rig_wait(rig_t *rig, uint64_t us);

/* The library's clock at that time. */
uint32_t rig_clock_us(const rig_t *rig, uint64_t us);

#endif
