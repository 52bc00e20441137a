/* SPDX-License-Identifier: MIT */
/*
 * Everything that the datasheets leave open, one row a choice. Included several times with other meanings of
 * the three words:
 *   RANGE(name, kinds, section, what the text says, low end, high end, usual)
 *   LIST(name, kinds, section, what the text says, {value, weight, meaning}...); the first value is the usual
 *   MISPRINT(...) is a LIST in which the print contradicts itself and one reading is most likely a misprint.
 * "A16 2(2)" is chapter 2, paragraph (2) of the A16 text; "HPS #5" is the chapter "Command #5".
 * "Not printed" means that the text is silent; the ends are then taken from the nearest printed figure.
 */

/* Every device: the wire. */
RANGE(any_power_on_us, K_ALL | K_PWM | K_SWITCH | K_RELAY, "A05 1(1), HPS #7",
      "time from power to life is not printed", 10000, 2000000, 500000)
LIST(any_power_on_glitch, K_ALL, "all", "what TX does at power-on is not printed", {-1, 6, "nothing"},
     {0x00, 1, "one byte 00"}, {0xFF, 1, "one byte FF"})
RANGE(any_byte_gap_tenths, K_ALL, "HPS 2.2.3", "gaps in a frame up to 1.5 characters", 0, 15, 0)
LIST(any_wrong_line, K_HEARS, "A16 5(2), A05 2(1), HPS table 6",
     "a byte with other line settings: not printed", {0, 1, "dropped"}, {1, 1, "taken as a noise byte"})
LIST(any_break_as, K_HEARS, "all", "a break on the line is not printed", {0, 1, "nothing"},
     {1, 1, "a noise byte 00"})
LIST(any_heard_while_sending, K_PAIR, "A05 2(1), HPS 2.2.1", "half duplex; nothing more is printed",
     {0, 1, "deaf while sending"}, {1, 1, "a noise byte"})
LIST(any_response_jitter, K_RESPONSES, "A05 2(3)1", "times are printed as spans",
     {0, 1, "always the drawn time"}, {1, 1, "each time anew, from the shortest to the drawn one"})

/* A16 and A05: Modbus. */
LIST(mb_frame_end, K_MODBUS, "A16 6(1), A05 3(1)", "Modbus-RTU; no gap is printed",
     {0, 2, "silence of 3.5 characters"}, {1, 1, "the length, no silence needed"}, {2, 1, "silence of 20 ms"})
LIST(mb_busy, K_MODBUS, "A16 6(2), A05 3(2)", "a request while one is being served: not printed",
     {0, 1, "ignored"}, {1, 1, "served afterwards"})
LIST(mb_zero_broadcast, K_MODBUS, "A16 6(3), A05 3(3)", "broadcast is 0xFF; address 0 is in the range",
     {0, 1, "request to 0 ignored"}, {1, 1, "write to 0 done, not answered"})
LIST(mb_ff_read, K_MODBUS, "A16 6(3), A05 3(3)", "0xFF is broadcast; whether answered is not printed",
     {0, 1, "no response"}, {1, 1, "response from the own address"}, {2, 1, "response from FF"})
LIST(mb_ff_write, K_MODBUS, "A16 6(3), A05 3(3)", "0xFF is broadcast; whether answered is not printed",
     {0, 1, "done, no response"}, {1, 1, "done, response from the own address"},
     {2, 1, "done, response from FF"})
LIST(mb_address_ff, K_MODBUS, "A16 6(3), A05 3(3)", "setting FF is out of the range 00..FE", V_EXCEPTION(3),
     V_SILENCE, V_ECHOED)
LIST(mb_address_high, K_MODBUS, "A16 6(3), A05 3(3)", "setting 0100 and more is out of the range",
     V_EXCEPTION(3), V_SILENCE, V_ECHOED, {8, 1, "the low byte is taken"})
LIST(mb_address_effect, K_MODBUS, "A16 6(4)3, A05 3(4)2",
     "the printed response is from the old address; then silent", {0, 2, "after the response"},
     {1, 1, "at the next power-on"})
LIST(mb_address_kept, K_MODBUS, "A16 6(3), A05 3(3)", "only 0202 is said not to be kept", {1, 3, "kept"},
     {0, 1, "lost at power-off"})
LIST(mb_illegal_function, K_MODBUS, "A16 6(1), A05 3(1)", "only 03 and 06 are printed, no exceptions",
     V_EXCEPTION(1), V_SILENCE)
LIST(mb_unknown_register, K_MODBUS, "A16 6(3), A05 3(3)", "registers outside the table: not printed",
     V_EXCEPTION(2), V_SILENCE, V_EXCEPTION(3))
LIST(mb_read_only_write, K_MODBUS, "A16 6(3), A05 3(3)", "writing a read-only register: not printed",
     V_EXCEPTION(2), V_SILENCE, V_EXCEPTION(3))
LIST(mb_bad_count, K_MODBUS, "A16 6(2), A05 3(2)", "0 or more than 125 registers: not printed",
     V_EXCEPTION(3), V_SILENCE, V_EXCEPTION(2))
LIST(mb_bad_length, K_MODBUS, "A16 6(2), A05 3(2)", "right CRC, wrong number of bytes: not printed",
     V_SILENCE, V_EXCEPTION(3))
RANGE(mb_flash_us, K_MODBUS, "A16 6(3), A05 3(3)", "time of a write is not printed", 0, 100000, 5000)

/* A16. */
MISPRINT(a16_start_bytes, K_A16_FRAMES, "A16 2(3)", "table: 0XFF 0XFF, 1 byte; example: one FF",
         {1, 5, "one FF"}, {2, 1, "two FF, the sum over one of them"})
RANGE(a16_period_us, K_A16_FREE, "A16 2(2)", "period of the automatic frames is not printed", 50000, 3000000,
      500000)
RANGE(a16_processed_us, K_A16_SLOW, "A16 2(2)", "response time 2.5~7.5 s, processed", 2500000, 7500000,
      5000000)
RANGE(a16_realtime_us, K_A16_SLOW, "A16 2(2)", "response time about 500 ms, real time", 400000, 600000,
      500000)
LIST(a16_settling, K_A16_SLOW, "A16 2(2)", "the way from the old to the new value: not printed",
     {0, 1, "the old value until the end"}, {1, 1, "sliding mean over the response time"})
LIST(a16_before_ready, K_A16_SLOW, "A16 2(2)", "value before the first response time is over: not printed",
     {0, 1, "no frame; the register reads 0"}, {1, 1, "0"}, {2, 1, "the newest measurement"},
     {3, 1, "the value for no target"})
LIST(a16_nothing, K_A16, "A16 1(2)", "no object: 94 ms with PWM; UART and Modbus not printed",
     {65535, 1, "FFFF"}, {65534, 1, "FFFE"}, {65533, 1, "FFFD"}, {0, 1, "0"}, {16348, 1, "94 ms as mm"},
     {-1, 1, "last value"}, {-2, 1, "no frame; the register reads FFFF"})
RANGE(a16_level_stable_us, K_A16_AUTO, "A16 2(2)", "how long RX must stand is not printed", 0, 500000, 0)
LIST(a16_level_switch, K_A16_AUTO, "A16 2(2)", "what follows a change of the level: not printed",
     {0, 1, "the other value at once"}, {1, 1, "the other value settles anew"})
RANGE(a16_trigger_width_us, K_TRIGGERED, "A16 1(2), 3(2)", "falling edge pulse, no width printed", 0, 1000, 0)
LIST(a16_trigger_edge, K_TRIGGERED, "A16 1(2), 3(2)", "falling edge pulse",
     {0, 1, "time counts from the falling edge"}, {1, 1, "time counts from the pulse's end"})
RANGE(a16_t2_us, K_A16_CONTROLLED, "A16 3(3)", "T2 = 90~110 ms", 90000, 110000, 100000)
LIST(a16_t2_to, K_A16_CONTROLLED, "A16 3(3)", "where T2 ends is not in the text",
     {0, 1, "first byte's start"}, {1, 1, "last byte's end"})
RANGE(a16_t1_us, K_A16_CONTROLLED, "A16 3(2)", "period must be greater than 120 ms", 110000, 120000, 120000)
LIST(a16_early_trigger, K_TRIGGERED, "A16 1(2), 3(2)", "a trigger that comes too early: not printed",
     {0, 1, "ignored"}, {1, 1, "starts the measurement anew"}, {2, 1, "served when T1 is over"})
LIST(a16_trigger_at_power_on, K_TRIGGERED, "A16 1(2), 3(2)", "what power-on does is not printed",
     {0, 2, "nothing"}, {1, 1, "RX low counts as a falling edge"}, {2, 1, "always one measurement"})
LIST(a16_sample_at, K_A16_CONTROLLED, "A16 3(2)", "measures after the edge, sends when done",
     {0, 1, "value of the trigger's time"}, {1, 1, "value of the response's time"})
RANGE(a16_response_us, K_A16_MODBUS, "A16 3(3), 6",
      "Modbus response time is not printed; a measurement 110 ms", 1000, 110000, 10000)
LIST(a16_address_zero, K_A16_MODBUS, "A16 6(3)", "range 0x00~0xFE", {8, 1, "settable, answers at 0"},
     {7, 1, "settable, does not answer at 0"})
LIST(a16_first_command, K_A16_RS232, "A16 5", "send a command to switch to Modbus", {0, 1, "it is served"},
     {1, 1, "it only switches"})
LIST(a16_switch_by, K_A16_RS232, "A16 5", "send a command to switch to Modbus",
     {0, 1, "a request to this sensor"}, {1, 1, "any frame with a right CRC"})
LIST(a16_linger, K_A16_RS232, "A16 5", "automatic frames after the switch: not printed", {0, 1, "none"},
     {1, 1, "one"}, {2, 1, "two"})
LIST(a16_linger_when, K_A16_RS232, "A16 5", "as above", {0, 1, "before the response"},
     {1, 1, "right behind the response"}, {2, 1, "at the next periods"})
LIST(a16_mode_read, K_A16_MODBUS, "A16 6(3)", "0202 is write-only", V_EXCEPTION(2), V_SILENCE,
     {8, 1, "reads as the mode"})
LIST(a16_mode_value, K_A16_RS232, "A16 6(3)", "0202: values other than 0 and 1 not printed", V_EXCEPTION(3),
     V_SILENCE, V_ECHOED, {8, 1, "as 1"})
LIST(a16_mode_rs485, K_A16_RS485, "A16 5, 6(4)4", "RS485 has only Modbus mode, 0202 leads back to automatic",
     V_ECHOED, V_SILENCE, V_EXCEPTION(2), V_EXCEPTION(3))
LIST(a16_type_default, K_A16_MODBUS, "A16 6(3)", "0207: no default printed", {0, 1, "processed"},
     {1, 1, "real time"})
LIST(a16_flag_value, K_A16_MODBUS, "A16 6(3)", "0205, 0207: values other than 0 and 1 not printed",
     V_EXCEPTION(3), V_SILENCE, V_ECHOED, {8, 1, "as 1"})
LIST(a16_type_rs485, K_A16_RS485, "A16 6(3)", "0207 only valid for RS232", V_TAKEN, V_ECHOED, V_SILENCE,
     V_EXCEPTION(2))
LIST(a16_type_kept, K_A16_MODBUS, "A16 6(3)", "only 0202 is said not to be kept", {1, 1, "kept"},
     {0, 1, "lost at power-off"})
LIST(a16_switch_registers, K_A16_MODBUS, "A16 6(3)", "0205, 0206 only valid for switch output", V_TAKEN,
     V_ECHOED, V_SILENCE, V_EXCEPTION(2))
LIST(a16_two_values, K_A16_MODBUS, "A16 6(2)", "quantity 2 from 0100: not printed", {8, 1, "served"},
     V_SILENCE, V_EXCEPTION(2), V_EXCEPTION(3))
LIST(a16_holes, K_A16_MODBUS, "A16 6(2)", "reading across registers that are not in the table",
     V_EXCEPTION(2), V_SILENCE, V_EXCEPTION(3), {8, 1, "they read as 0"})

RANGE(a16_pwm_rise_us, K_PWM, "A16 1(2), 1(3)",
      "from the falling edge to the pulse; T1 of about 110 ms is in a drawing", 0, 115000, 110000)
RANGE(a16_pwm_cycle_us, K_PWM, "A16 1(2)", "cycle period must be greater than 220 ms", 210000, 220000, 220000)
RANGE(a16_pwm_nothing_us, K_PWM, "A16 1(2)", "a fixed pulse of about 94 ms", 93000, 96000, 94000)
LIST(a16_pwm_speed, K_PWM, "A16 1(4)", "348 m/s, or simplified T / 57.5", {575, 1, "57.5 us a cm"},
     {574, 1, "348 m/s"})
LIST(a16_switch_first, K_SWITCH, "A16 4(2)", "level before the first decision: not printed", {0, 1, "low"},
     {1, 1, "high"})
LIST(a16_switch_equal, K_SWITCH, "A16 4(2)", "less, or greater; equal is not printed",
     {0, 1, "ends both rows"}, {1, 1, "as less"}, {2, 1, "as greater"})
LIST(a16_switch_nothing, K_SWITCH, "A16 4(2)", "no object: not printed", {2, 1, "as greater"},
     {0, 1, "ends both rows"}, {3, 1, "no measurement"})

/* A05. */
RANGE(a05_relay_period_us, K_RELAY, "A05 4(1)", "period of the measurements is not printed", 100000, 1000000,
      300000)
LIST(a05_relay_hold, K_RELAY, "A05 4(1)", "pull-in and cut-off time will be maintained for 1 second",
     {0, 1, "each state lasts 1 s"}, {1, 1, "a change waits for 1 s"})
LIST(a05_relay_equal, K_RELAY, "A05 4(1)", "less than the threshold; equal is open", {0, 1, "open"},
     {1, 1, "closed"})
MISPRINT(a05_uart_parity, K_A05_UART, "A05 1(1)", "the table's parity cell is empty; RS485 prints NO",
         {'N', 6, "none"}, {'E', 1, "even"}, {'O', 1, "odd"})
RANGE(a05_period_us, K_A05_UART, "A05 1(1)", "period of the automatic frames is not printed", 50000, 3000000,
      300000)
RANGE(a05_processed_us, K_A05_UART, "A05 1(1)", "response time 300~1500 ms, processed", 300000, 1500000,
      900000)
RANGE(a05_realtime_us, K_A05_UART, "A05 1(1)", "response time about 300 ms, real time", 250000, 350000,
      300000)
LIST(a05_settling, K_A05_UART, "A05 1(1)", "the way from the old to the new value: not printed",
     {0, 1, "the old value until the end"}, {1, 1, "sliding mean over the response time"})
LIST(a05_before_ready, K_A05_UART, "A05 1(1)", "value before the first response time is over: not printed",
     {0, 1, "no frame"}, {1, 1, "0"}, {2, 1, "the newest measurement"}, {3, 1, "the value for no target"})
LIST(a05_level_rule, K_A05_UART, "A05 1(1)", "RX is read and recorded within one second of power-on",
     {0, 1, "at one instant"}, {1, 1, "low once in the second is low"}, {2, 1, "low all the second is low"})
RANGE(a05_level_instant_us, K_A05_UART, "A05 1(1)", "the instant within one second", 0, 1000000, 500000)
LIST(a05_before_level, K_A05_UART, "A05 1(1)", "output before the level is recorded: not printed",
     {0, 1, "no frame"}, {1, 1, "frames with the processed value"})
LIST(a05_nothing, K_A05, "A05 4(2)", "probe cannot measure an object: no value printed", {65535, 1, "FFFF"},
     {65534, 1, "FFFE"}, {65533, 1, "FFFD"}, {0, 1, "0"}, {4500, 1, "450 cm, end of the threshold's range"},
     {-1, 1, "last value"})
LIST(a05_unfitted, K_A05, "A05 4(2)", "interface not connected with a probe: no value printed",
     {65535, 1, "FFFF"}, {65534, 1, "FFFE"}, {65533, 1, "FFFD"}, {0, 1, "0"},
     {300, 1, "300, like a distance"}, {-1, 1, "a05_unfitted_value"}, {-2, 1, "any value, each time anew"},
     {-3, 1, "as the fitted probe before it"})
RANGE(a05_unfitted_value, K_A05, "A05 1(2)", "16 bits, no limit printed", 0, 65535, 10000)
LIST(a05_unfitted_alone, K_A05, "A05 2(3)4, 3(3)", "asking only for a probe that is not fitted: not printed",
     {8, 2, "answered with the value"}, V_SILENCE, V_EXCEPTION(2), V_EXCEPTION(4))
LIST(a05_first_command, K_A05_UART, "A05 1(1)", "after a Modbus command it switches to controlled",
     {0, 1, "it is served"}, {1, 1, "it only switches"})
LIST(a05_switch_by, K_A05_UART, "A05 1(1)", "after receiving the Modbus command",
     {0, 1, "a request to this sensor"}, {1, 1, "any frame with a right CRC"})
LIST(a05_linger, K_A05_UART, "A05 1(1)", "automatic frames after the switch: not printed", {0, 1, "none"},
     {1, 1, "one"}, {2, 1, "two"})
LIST(a05_linger_when, K_A05_UART, "A05 1(1)", "as above", {0, 1, "before the response"},
     {1, 1, "right behind the response"}, {2, 1, "at the next periods"})
LIST(a05_back_us, K_A05_UART, "A05 1(1)", "the way back to automatic output is not printed",
     {0, 2, "only power-off"}, {1000000, 1, "1 s without a command"}, {10000000, 1, "10 s without a command"})
RANGE(a05_all_us, K_A05_RS485, "A05 2(3)1", "t2 = 200~210 ms, all probes", 200000, 210000, 205000)
RANGE(a05_one_us, K_A05_RS485, "A05 2(3)1", "t2 = 65~75 ms, one probe", 65000, 75000, 70000)
LIST(a05_t2_from, K_A05_RS485, "A05 2(3)1", "where t2 begins is not in the text", {0, 1, "the request's end"},
     {1, 1, "the request's start"})
LIST(a05_t2_to, K_A05_RS485, "A05 2(3)1", "where t2 ends is not in the text", {0, 1, "the response's start"},
     {1, 1, "the response's end"})
LIST(a05_early, K_A05_RS485, "A05 2(3)1", "t1 >= 250 ms and >= 100 ms required; earlier: not printed",
     {0, 1, "ignored"}, {1, 1, "served"}, {2, 1, "served when t1 is over"})
LIST(a05_dyp_ff, K_A05_RS485, "A05 2(3)2", "0xFF is broadcast; whether answered is not printed",
     {0, 1, "no response"}, {1, 1, "response from the own address"}, {2, 1, "response from FF"})
LIST(a05_dyp_address_zero, K_A05_RS485, "A05 2(3)2, 3(3)", "range 01~FE with DYP, 00~FE with Modbus",
     {0, 1, "not taken, silence"}, {8, 1, "taken"})
LIST(a05_dyp_address_ff, K_A05_RS485, "A05 2(3)2", "address FF is out of the range", {0, 1, "silence"},
     {9, 1, "answered, not taken"})
LIST(a05_dyp_address_effect, K_A05_RS485, "A05 2(3)5", "when the new address counts is not printed",
     {0, 2, "at once"}, {1, 1, "at the next power-on"})
MISPRINT(a05_dyp_address_response, K_A05_RS485, "A05 2(3)5",
         "example: the request again; table: 10, Data_H, Data_L", {0, 5, "as the example"},
         {1, 1, "as the table, data 0"})
MISPRINT(a05_all_sum, K_A05_RS485, "A05 2(3)3", "formula gives 62 in the example, 60 is printed",
         {0, 5, "the formula"}, {1, 1, "as printed: without address and command"})
LIST(a05_dyp_search, K_A05_RS485, "A05 2(3)2", "bytes before 55 AA: not printed", {0, 1, "the frame is lost"},
     {1, 1, "55 AA is found anywhere"})
RANGE(a05_modbus_one_us, K_A05, "A05 3(3)", "response time about 100 ms", 65000, 120000, 100000)
RANGE(a05_modbus_more_us, K_A05, "A05 3(3)(1)", "several probes: longer response time, each more", 1000,
      120000, 100000)
RANGE(a05_response_us, K_A05, "A05 3(3)", "response time of 0200 and refusals is not printed", 1000, 110000,
      10000)
LIST(a05_address_zero, K_A05, "A05 2(3)2, 3(3)", "range 01~FE with DYP, 00~FE with Modbus",
     {8, 1, "settable, answers at 0"}, {7, 1, "settable, does not answer at 0"}, V_SILENCE, V_EXCEPTION(3))
LIST(a05_past_end, K_A05, "A05 3(3)(1)", "several probes, but only up to 0109", V_EXCEPTION(2), V_SILENCE,
     V_EXCEPTION(3), {7, 1, "answered up to the end only"})
LIST(a05_alias_end, K_A05, "A05 3(3)(2)", "table: 0010..0013; remark: same function as 0106~0108",
     {1, 1, "0013 is probe 4"}, {0, 1, "0013 is unknown"})
LIST(a05_alias_many, K_A05, "A05 3(3)(1)(2)", "several from 0106~0108; 0010.. have the same function",
     {8, 1, "several from 0010 too"}, V_SILENCE, V_EXCEPTION(2), V_EXCEPTION(3))
LIST(a05_sample_at, K_A05, "A05 3(3)", "measures after the command", {0, 1, "value of the request's time"},
     {1, 1, "value of the response's time"})

/* HPS-167S: the wire and the requests. */
LIST(hps_gap_inside, K_HPS, "HPS 2.2.3", "more than 1.5 characters of silence in a frame: discard it",
     {0, 1, "discarded"}, {1, 1, "only 3.5 characters end a frame"})
LIST(hps_gap_before, K_HPS, "HPS 2.2.3", "3.5 characters between frames, also after its own",
     {0, 1, "not needed"}, {1, 1, "a request without them is lost"})
LIST(hps_other_parity, K_HPS, "HPS 2.2.2", "even is required and default; odd and none can also be used",
     {0, 2, "only even is heard"}, {1, 1, "heard, answered with even"}, {2, 1, "heard, answered alike"})
LIST(hps_busy, K_HPS_VALUES, "HPS 2.2.1", "a request while one is being served: not printed",
     {0, 1, "ignored"}, {1, 1, "served afterwards"})
RANGE(hps_response_us, K_HPS, "HPS 2.2.3", "3.5 characters at least; the longest is not printed (6 Hz)", 2006,
      166667, 5000)
RANGE(hps_measure_us, K_HPS_VALUES, "HPS table 1, #5", "6~54 Hz", 18519, 166667, 18519)
RANGE(hps_flash_us, K_HPS, "HPS #7", "time of a write to FLASH is not printed", 0, 100000, 5000)
LIST(hps_illegal_function, K_HPS, "HPS table 39, 2.5", "01 illegal function code", {1, 3, "exception 01"},
     V_SILENCE)
LIST(hps_unknown_register, K_HPS, "HPS table 39", "02 illegal address; 03 illegal count",
     {2, 3, "exception 02"}, V_EXCEPTION(3), V_EXCEPTION(1), V_SILENCE)
LIST(hps_wrong_count, K_HPS, "HPS table 39", "02: combination of address and length; 03: count",
     V_EXCEPTION(3), V_EXCEPTION(2), V_SILENCE, {8, 1, "served as with the right count"})
LIST(hps_wrong_length, K_HPS, "HPS table 39", "03: the implied length is incorrect", V_EXCEPTION(3),
     V_SILENCE)
LIST(hps_bad_crc, K_HPS, "HPS 2.2.4.1, abnormal", "2.2.4.1: function | 0x80; abnormal response: no response",
     {0, 4, "silence"}, V_EXCEPTION(3), V_EXCEPTION(4))

/* HPS-167S: warm-up and unasked output. */
LIST(hps_warm_measure, K_HPS, "HPS #7", "no measurement data during warm-up", V_SILENCE, V_EXCEPTION(4),
     V_EXCEPTION(1), {7, 1, "abnormal packet"})
LIST(hps_warm_other, K_HPS, "HPS #7", "other commands during warm-up: not printed", {8, 2, "served"},
     V_SILENCE)
LIST(hps_warm_effect, K_HPS, "HPS #7", "modify the warm-up time after power-on",
     {0, 1, "from the next power-on"}, {1, 1, "at once, counted from power-on"})
LIST(hps_warm_large, K_HPS, "HPS #2, #7", "written as 16 bits, reported as 8", V_EXCEPTION(3), V_SILENCE,
     {8, 1, "the low byte is taken"}, {7, 1, "255 is taken"})
LIST(hps_reported, K_HPS, "HPS #2, #10, #11", "set for the next power-on: what #2 tells is not printed",
     {0, 1, "the value set"}, {1, 1, "the value in use"})
LIST(hps_unasked, K_HPS, "HPS 2.2.1, #2, #5, #15", "slaves only answer; but continuous output mode",
     {0, 1, "never sends unasked"}, {1, 1, "sends unasked when #10 is on"})
RANGE(hps_unasked_us, K_HPS, "HPS #5, table 1", "6~54 Hz", 18519, 166667, 18519)
LIST(hps_unasked_warm, K_HPS, "HPS #7, #15", "no measurement data during warm-up", {0, 1, "nothing"},
     {1, 1, "abnormal packets"})
LIST(hps_unasked_request, K_HPS, "HPS #2", "time to resume communication under continuous output",
     {0, 1, "goes on"}, {1, 1, "pauses for the reconnection time"}, {2, 1, "stops until power-on"})
LIST(hps_unasked_idle, K_HPS, "HPS 2.2.1", "a busy line: not printed", {0, 1, "does not listen before"},
     {1, 1, "waits for 3.5 characters of silence"})
LIST(hps_auto_out, K_HPS, "HPS #10", "factory default on; may have been set", {255, 2, "on"}, {0, 1, "off"})
LIST(hps_termination, K_HPS, "HPS #11", "factory default on; may have been set", {255, 2, "on"},
     {0, 1, "off"})
LIST(hps_switch_value, K_HPS, "HPS #10, #11", "values other than 00 and FF: not printed", V_EXCEPTION(3),
     V_SILENCE, V_ECHOED, {8, 1, "taken as FF"})

/* HPS-167S: reconnection time, rate, ID. */
LIST(hps_reconnect_ms, K_HPS, "HPS #2, #15", "default not printed; 32 bits of ms", {180, 1, ""}, {0, 1, ""},
     {1, 1, ""}, {18, 1, ""}, {100, 1, "no multiple of 18"}, {1000, 1, "no multiple of 18"},
     {4294967295, 1, "FFFFFFFF"})
LIST(hps_reconnect_order, K_HPS, "HPS #2, #15", "order of the four bytes is not printed",
     {0, 1, "high byte first"}, {1, 1, "low byte first"}, {2, 1, "low word first"})
LIST(hps_reconnect_odd, K_HPS, "HPS #15", "an integer multiple of 18; others: not printed", V_TAKEN,
     V_EXCEPTION(3), V_SILENCE, {7, 1, "taken, rounded down"})
LIST(hps_reconnect_effect, K_HPS, "HPS #15", "when it counts is not printed", {0, 1, "at once"},
     {1, 1, "at the next power-on"})
LIST(hps_reconnect_kept, K_HPS, "HPS #15", "FLASH is not mentioned", {1, 1, "kept"},
     {0, 1, "lost at power-off"})
LIST(hps_baud_code, K_HPS, "HPS #2, #9", "one byte; 01 or any other code is 19200", {1, 2, "19200"},
     {0, 1, "19200"}, {5, 1, "19200"}, {255, 1, "19200"}, {2, 0, "57600"}, {3, 0, "115200"}, {4, 0, "230400"})
LIST(hps_baud_effect, K_HPS, "HPS #9", "when it counts is not printed",
     {0, 2, "after the response at the old rate"}, {1, 1, "at once, response at the new rate"},
     {2, 1, "at the next power-on"})
LIST(hps_baud_kept, K_HPS, "HPS #9", "FLASH is not mentioned", {1, 2, "kept"}, {0, 1, "lost at power-off"})
LIST(hps_baud_other, K_HPS, "HPS #9", "all other codes are 19200; what #2 then tells is not printed",
     {0, 1, "the code as set"}, {1, 1, "01"})
LIST(hps_id_response, K_HPS, "HPS #8", "takes effect immediately; Device ID of the response: 0x01",
     {0, 1, "response from the old ID"}, {1, 1, "response from the new ID"})
LIST(hps_id_range, K_HPS, "HPS 2.2.1, table 39", "1 to 32; others: not printed", V_EXCEPTION(3), V_SILENCE,
     V_EXCEPTION(4), V_ECHOED, {8, 1, "33..247 are taken, others exception 03"})
LIST(hps_broadcast_reset, K_HPS, "HPS 2.2.1, #6", "broadcast for writes; the reset is a read",
     {0, 1, "ignored"}, {1, 1, "done, not answered"})

/* HPS-167S: values. */
LIST(hps_sample_at, K_HPS_VALUES, "HPS #5", "starts a measurement", {0, 1, "value of the request's time"},
     {1, 1, "value of the response's time"})
RANGE(hps_over_range, K_HPS_VALUES, "HPS #5", "over-range indication of 65.53 meters", 65530, 65535, 65530)
LIST(hps_over_magnitude, K_HPS_VALUES, "HPS #5", "signal too low; no magnitude printed", {0, 1, "0"},
     {16, 1, "0010, exponent 0"}, {-1, 1, "as with a target"})
LIST(hps_over_precision, K_HPS_VALUES, "HPS #5", "out of range; no precision printed", {0, 1, "0"},
     {65535, 1, "FFFF"})
RANGE(hps_far_mm, K_HPS_VALUES, "HPS table 1", "18 m with a white target, text speaks of more than 20 m",
      18000, 60000, 18000)
LIST(hps_near, K_HPS_VALUES, "HPS table 1", "minimum 0.08 m; nearer: not printed", {0, 1, "true value"},
     {1, 1, "80"}, {2, 1, "0"}, {3, 1, "over-range"})
RANGE(hps_deviation_mm, K_HPS_VALUES, "HPS #12", "inherent deviation of a sensor, 15 mm in the example", -20,
      20, 0)
LIST(hps_magnitude, K_HPS_VALUES, "HPS #5", "two bytes, no limit", {0xDCB2, 1, "as printed"}, {1, 1, ""},
     {65535, 1, ""})
LIST(hps_magnitude_exp, K_HPS_VALUES, "HPS #5", "one byte, no limit", {7, 1, "as printed"}, {0, 1, ""},
     {16, 1, ""}, {31, 1, ""}, {255, 1, ""})
LIST(hps_ambient, K_HPS_VALUES, "HPS #5", "one byte, no limit", {1, 1, "as printed"}, {0, 1, ""},
     {254, 1, ""}, {255, 1, ""})
LIST(hps_precision, K_HPS_VALUES, "HPS #5", "two bytes, no limit", {0, 1, "as printed"}, {1, 1, ""},
     {1000, 1, ""}, {65534, 1, ""})
LIST(hps_abnormal_exp, K_HPS_VALUES, "HPS #5", "abnormal packet: Magnitude 0x00; exponent not printed",
     {0, 1, "00"}, {255, 1, "FF"})
LIST(hps_fault_single, K_HPS, "HPS #5, table 39", "failure: abnormal packet in continuous, 04 device failed",
     {7, 1, "abnormal packet"}, V_EXCEPTION(4), V_SILENCE)
LIST(hps_fault_every, K_HPS_VALUES, "HPS #5", "how often measurements fail is not printed",
     {0, 2, "never by itself"}, {20, 1, "one in 20"}, {100, 1, "one in 100"})
LIST(hps_fault_packets, K_HPS, "HPS #15", "sends out abnormal data packets", {0, 1, "at every period"},
     {1, 1, "once a failure"})
LIST(hps_core_in_fault, K_HPS, "HPS #3, #4, table 39", "#3 and #4 with a failed sensor: not printed",
     {8, 1, "served"}, V_EXCEPTION(4), V_SILENCE)
LIST(hps_temperature, K_HPS, "HPS #4", "Fahrenheit; scale and sign not printed",
     {77, 1, "25 C, whole degrees"}, {14, 1, "-10 C"}, {131, 1, "55 C"}, {770, 1, "tenths"}, {0, 1, ""},
     {65535, 1, "FFFF"}, {32767, 1, "7FFF"}, {32768, 1, "8000"})
LIST(hps_details, K_HPS, "HPS #1, #3", "contents of version, date, UUID", {0, 1, "as printed"},
     {1, 1, "any bytes"})

/* HPS-167S: settings of the measurement, load, reset. */
LIST(hps_offset_sum, K_HPS, "HPS #12", "written on top of an older one: not printed", {0, 1, "replaces it"},
     {1, 1, "is added"})
LIST(hps_offset_effect, K_HPS, "HPS #12", "saved, and loaded each time the sensor is powered on",
     {0, 1, "at once"}, {1, 1, "at the next power-on or #13"})
LIST(hps_offset_large, K_HPS, "HPS #12", "small-scale deviations; beyond 1000 mm: not printed", V_TAKEN,
     V_EXCEPTION(3), V_SILENCE)
LIST(hps_below_zero, K_HPS_VALUES, "HPS #12", "distance plus offset below 0: not printed", {0, 1, "0"},
     {1, 1, "16 bits wrap around"})
LIST(hps_load_scope, K_HPS, "HPS #13", "FF is the factory-set parameter; which ones is not printed",
     {0, 1, "offset and filter"}, {1, 1, "all but ID and rate"}, {2, 1, "all"})
LIST(hps_load_value, K_HPS, "HPS #13", "values other than 00 and FF: not printed", V_EXCEPTION(3), V_SILENCE,
     V_ECHOED)
LIST(hps_filter_range, K_HPS, "HPS #14", "recommended within +-100; beyond: not printed", V_TAKEN,
     V_EXCEPTION(3), V_SILENCE, {7, 1, "held at +-100, echoed as sent"})
LIST(hps_filter_kept, K_HPS, "HPS #14", "FLASH is not mentioned", {1, 1, "kept"}, {0, 1, "lost at power-off"})
RANGE(hps_filter_lag_us, K_HPS, "HPS #14", "a larger value sacrifices sensitivity; delay a step", 0, 5000, 0)
LIST(hps_reset_order, K_HPS, "HPS #6", "after executing it the ID is 0x01; printed response from 0x01",
     {0, 1, "response first, from the old ID at the old rate"},
     {1, 1, "ID and rate first, response from 01 at 19200"}, {2, 1, "ID first, rate at the next power-on"})
LIST(hps_reset_scope, K_HPS, "HPS #6", "all settings of the RS485 interface firmware",
     {0, 1, "not offset and filter"}, {1, 1, "offset and filter too"})
LIST(hps_reset_restart, K_HPS, "HPS #6", "what follows is not printed", {0, 1, "goes on"},
     {1, 1, "restarts, warms up again"})

/* HPS-167 with a UART: no datasheet; the sections name what public programs do. */
LIST(hps167_unknown, K_HPS167, "CRC of HPS", "three bytes before the distance: 01 01 01 in an example",
     {1, 1, "01"}, {0, 1, "00"}, {0x0A, 1, "0A"}, {0x0D, 1, "0D"}, {-1, 2, "any bytes"})
LIST(hps167_frame_end, K_HPS167, "requests of 10 bytes", "how a request ends is not known",
     {0, 1, "with its length"}, {1, 1, "with a silence of 3.5 characters"})
RANGE(hps167_reply_us, K_HPS167, "stop, temperature", "programs wait 1 to 500 ms", 100, 100000, 2500)
LIST(hps167_single_beside, K_HPS167, "single", "while it sends continuously: not known",
     {0, 1, "answered besides"}, {1, 1, "ends the output"}, {2, 1, "ignored"})
LIST(hps167_text, K_HPS167, "power-on", "sends Hypersen; whether a line ends is not known",
     {8, 2, "Hypersen"}, {10, 1, "with CR LF"}, {0, 1, "nothing"})
LIST(hps167_temperature, K_HPS167, "temperature", "two bytes, divided by 100 in one program", {2500, 1, ""},
     {0, 1, ""}, {65535, 1, ""}, {0x0A0D, 1, ""})
