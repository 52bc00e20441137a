/* SPDX-License-Identifier: MIT */
#include "channel.h"

static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    channel_t *const channel = ctx;
    if (!channel->selected) return 0;
    const int count = channel->uart->read(channel->uart->ctx, bytes, capacity, rx);
    if (count > 0 && channel->fresh) {
        rx->flags |= FATHOM_RX_OVERRUN;
        channel->fresh = false;
    }
    return count;
}

fathom_uart_t channel_uart(channel_t *channel)
{
    fathom_uart_t uart = {0};
    uart.read = read;
    uart.ctx = channel;
    return uart;
}

void channel_turn(channel_t *from, channel_t *to, const fathom_pin_t *select, bool to_is_high)
{
    uint8_t bytes[8];
    fathom_rx_t rx = {0};
    from->selected = false;
    select->set(select->ctx, to_is_high);
    int dropped;
    do {
        dropped = to->uart->read(to->uart->ctx, bytes, sizeof bytes, &rx);
    } while (dropped > 0);
    to->selected = true;
    to->fresh = true;
}
