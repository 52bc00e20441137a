# SPDX-License-Identifier: MIT
ROWS = (
    ('base-of-usart-6', 'RM0090 2.3: where the USARTs are', 'firmware/stm32f4_alone',
     ('port/stm32f4/usart.c', '',
      '{(volatile uint32_t *)0x40011400u, &RCC_APB2ENR, 5, 71, 8},',
      '{(volatile uint32_t *)0x40011000u, &RCC_APB2ENR, 5, 71, 8},')),
    ('driver-dropped-when-empty', 'fathom_stm32f4.h: write drives `driver` until the last stop bit has left',
     'port/test_stm32f4',
     ('port/stm32f4/usart.c', 'fathom_stm32f4_usart_interrupt',
      'registers[CR1] = (control & ~(uint32_t)CR1_TXEIE) | CR1_TCIE;',
      '{ fathom_stm32f4_pin_set(&usart->driver, false); '
      'registers[CR1] = (control & ~(uint32_t)CR1_TXEIE) | CR1_TCIE; }')),
    ('captures-in-wrong-order', 'fathom_stm32f4.h: edges, in the order in which they came',
     'port/test_stm32f4',
     ('port/stm32f4/capture.c', 'fathom_stm32f4_tim2_interrupt',
      'const bool fall_first = ((why & (CC1 | CC2)) == (CC1 | CC2)) && is_fall_first;',
      'const bool fall_first = false; (void)is_fall_first;')),
    ('captures-across-the-wrap', 'hal.h: the clock wraps', 'port/test_stm32f4',
     ('port/stm32f4/capture.c', 'fathom_stm32f4_tim2_interrupt',
      'const bool is_fall_first = (rise_us == fall_us) ? captured->high : ((rise_us - fall_us) < (UINT32_MAX / 2u));',
      'const bool is_fall_first = rise_us == fall_us ? captured->high : rise_us > fall_us;')),
)
