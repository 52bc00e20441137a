/* SPDX-License-Identifier: MIT */
/* fathom.hpp: the classes over the drivers, without exceptions, RTTI and the C++ library. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <new>
#include <type_traits>

#include "fathom/fathom.hpp"

extern "C" {
#include "fake.h"
#include "suite.h"
}

static const suite_t suite = {};

namespace
{

/* A line on a fake UART, with the members that a bus has. */
struct bus_t {
    fathom_line_t line;
    fathom_modbus_t modbus;
    fathom_line_parts_t parts;
    uint8_t frame[32];
    fake_t fake;

    void set_up(bool asks)
    {
        fake_init(&fake);
        memset(&line, 0, sizeof line);
        parts = fathom_line_parts_t();
        parts.uart = &fake.uart;
        parts.clock = &fake.clock;
        parts.frame = frame;
        parts.frame_size = sizeof frame;
        parts.echo = FATHOM_LINE_ECHO_OFF;
        parts.silence_us = 2006; /* 3.5 characters of 11 bits at 19200 baud */
        modbus = fathom_modbus_t();
        assert_int_equal(asks ? fathom_line_init(&line, &parts) : fathom_line_init_listening(&line, &parts),
                         FATHOM_OK);
        if (asks) modbus = fathom_modbus_client(&line);
    }

    /* Polls until there is a result, at most for so long. */
    template <class Sensor> fathom_status_t run(Sensor &sensor, uint32_t us)
    {
        for (; us != 0; us -= 500) {
            const fathom_status_t status = sensor.poll();
            if (status != FATHOM_PENDING) return status;
            fake.now_us += 500;
        }
        return FATHOM_PENDING;
    }
};

bus_t bus;

/* A16 2(4): 1953 mm. */
const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};
/* HPS-167S table 17: the request of command #5; and the printed response: 2083 mm. */
const uint8_t hps_request[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB};
const uint8_t hps_response[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

/* Memory that holds neither zeros nor an old object. */
template <class T> struct dirty {
    alignas(T) uint8_t bytes[sizeof(T)];
    T *object;
    template <class... Arguments> explicit dirty(Arguments &...arguments)
    {
        memset(bytes, 0xA5, sizeof bytes);
        object = new (bytes) T(arguments...);
    }
};

template <class Sensor> void expect_nothing(const Sensor &sensor, fathom_status_t status)
{
    assert_int_equal(sensor.status(), status);
    assert_false(sensor.has_target());
    assert_false(sensor.is(FATHOM_NEAR));
    assert_int_equal(sensor.distance_mm(), 0);
    assert_int_equal(sensor.probe(), 0);
    assert_int_equal(sensor.age_us(0), UINT32_MAX);
    assert_int_equal(sensor.is_error(), status != FATHOM_PENDING);
}

template <class Sensor> void has_no_copy()
{
    static_assert(!std::is_copy_constructible<Sensor>::value && !std::is_copy_assignable<Sensor>::value, "");
    static_assert(!std::is_move_constructible<Sensor>::value && !std::is_move_assignable<Sensor>::value, "");
    static_assert(!std::is_polymorphic<Sensor>::value && std::is_trivially_destructible<Sensor>::value, "");
}

/* No more than the driver, the reading, the address and one byte. */
template <class Sensor> void has_the_size_of(size_t driver)
{
    static_assert(alignof(Sensor) <= sizeof(void *), "");
    assert_true(sizeof(Sensor) <= driver + sizeof(fathom_sample_t) + 3 * sizeof(void *));
}

} // namespace

TEST(a_local_object_knows_nothing_before_the_first_poll)
{
    dirty<fathom::a16_auto> tank(bus);
    expect_nothing(*tank.object, FATHOM_PENDING);
    assert_string_equal(tank.object->status_name(), "PENDING");
    assert_string_equal(tank.object->result_name(), "PENDING");
    bus.set_up(false);
    assert_int_equal(tank.object->begin(), FATHOM_OK);
    expect_nothing(*tank.object, FATHOM_PENDING);
    assert_int_equal(tank.object->poll(), FATHOM_PENDING);
    expect_nothing(*tank.object, FATHOM_PENDING);
}

TEST(a_frame_becomes_a_distance_and_no_old_distance_outlives_an_error)
{
    bus.set_up(false);
    dirty<fathom::a16_auto> tank(bus);
    assert_int_equal(tank.object->begin(nullptr), FATHOM_OK);
    fake_receive(&bus.fake, 20000, mm_1953, sizeof mm_1953);
    assert_int_equal(bus.run(*tank.object, 100000), FATHOM_OK);
    assert_true(tank.object->has_target());
    assert_true(tank.object->is(FATHOM_TARGET));
    assert_int_equal(tank.object->distance_mm(), 1953);
    assert_int_equal(tank.object->probe(), 1);
    assert_int_equal(tank.object->sample().distance_mm, 1953);
    assert_string_equal(tank.object->result_name(), "TARGET");
    assert_false(tank.object->is_error());

    /* Nothing new: the reading stays. */
    assert_int_equal(tank.object->poll(), FATHOM_PENDING);
    assert_int_equal(tank.object->distance_mm(), 1953);

    /* Silent for 2 s. */
    assert_int_equal(bus.run(*tank.object, 2100000), FATHOM_ERR_STALE);
    expect_nothing(*tank.object, FATHOM_ERR_STALE);
    assert_string_equal(tank.object->status_name(), "STALE");
    assert_string_equal(tank.object->result_name(), "STALE");
    assert_string_equal(tank.object->advice(), fathom_status_advice(FATHOM_ERR_STALE));
}

TEST(begin_has_the_config_of_the_driver)
{
    const fathom_a16_auto_config_t config = [] {
        fathom_a16_auto_config_t made = {};
        made.stale_us = 300000;
        return made;
    }();
    bus.set_up(false);
    dirty<fathom::a16_auto> tank(bus);
    assert_int_equal(tank.object->begin(&config), FATHOM_OK);
    assert_int_equal(bus.run(*tank.object, 299000), FATHOM_PENDING);
    assert_int_equal(bus.run(*tank.object, 20000), FATHOM_ERR_STALE);
}

TEST(a_begin_that_fails_is_the_status_and_a_new_begin_forgets_the_reading)
{
    fathom_a16_auto_config_t wrong = {};
    wrong.stale_us = UINT32_C(1) << 31; /* a16_auto.h: at most 2^31 - 1 */
    bus.set_up(false);
    dirty<fathom::a16_auto> tank(bus);
    assert_int_equal(tank.object->begin(), FATHOM_OK);
    fake_receive(&bus.fake, 20000, mm_1953, sizeof mm_1953);
    assert_int_equal(bus.run(*tank.object, 100000), FATHOM_OK);
    tank.object->end();
    assert_int_equal(tank.object->begin(&wrong), FATHOM_ERR_ARGUMENT);
    expect_nothing(*tank.object, FATHOM_ERR_ARGUMENT);
    assert_int_equal(tank.object->begin(), FATHOM_OK);
    expect_nothing(*tank.object, FATHOM_PENDING);
}

TEST(the_age_of_a_reading_grows_with_the_clock_and_across_its_wrap)
{
    bus.set_up(false);
    bus.fake.now_us = UINT32_MAX - 30000;
    dirty<fathom::a16_auto> tank(bus);
    assert_int_equal(tank.object->begin(), FATHOM_OK);
    fake_receive(&bus.fake, 20000, mm_1953, sizeof mm_1953);
    assert_int_equal(bus.run(*tank.object, 100000), FATHOM_OK);
    const uint32_t time_us = tank.object->sample().time_us;
    assert_int_equal(tank.object->age_us(time_us), 0);
    assert_int_equal(tank.object->age_us(time_us + 1500000), 1500000);
}

template <class Sensor> void a_poll_after_a_failed_begin_is_refused(Sensor &sensor)
{
    assert_int_equal(sensor.status(), FATHOM_ERR_ARGUMENT);
    for (int i = 0; i < 3; i++) assert_int_equal(sensor.poll(), FATHOM_ERR_ARGUMENT);
    expect_nothing(sensor, FATHOM_ERR_ARGUMENT);
}

TEST(after_a_begin_that_failed_each_poll_of_every_class_is_refused)
{
    /* Once the bus is refused, once the configuration: each has a value that its header excludes. */
    for (int is_set_up = 0; is_set_up <= 1; is_set_up++) {
#define ON_LINE(name, asks, member, value)                                                                   \
    {                                                                                                        \
        fathom_##name##_config_t config = {};                                                                \
        config.member = value;                                                                               \
        memset(&bus, 0, sizeof bus);                                                                         \
        if (is_set_up != 0) bus.set_up(asks);                                                                \
        dirty<fathom::name> sensor(bus);                                                                     \
        assert_int_equal(sensor.object->begin(&config), FATHOM_ERR_ARGUMENT);                                \
        a_poll_after_a_failed_begin_is_refused(*sensor.object);                                              \
    }
        ON_LINE(a16_auto, false, stale_us, UINT32_C(1) << 31)
        ON_LINE(a05_auto, false, stale_us, UINT32_C(1) << 31)
        ON_LINE(hps167s_auto, false, address, 33)
        ON_LINE(a16_modbus, true, modbus.address, 255)
        ON_LINE(a05_modbus, true, modbus.address, 255)
        ON_LINE(a05_dyp, true, modbus.address, 255)
        ON_LINE(hps167s, true, modbus.address, 33)
        ON_LINE(hps167_uart, true, modbus.address, 1)
    }

    const fathom_output_t none = {};
    const fathom_capture_t nothing = {};
    const fathom_pin_t no_pin = {};
    bus.set_up(false);
    dirty<fathom::a16_controlled> controlled(bus);
    assert_int_equal(controlled.object->begin(none), FATHOM_ERR_ARGUMENT);
    a_poll_after_a_failed_begin_is_refused(*controlled.object);
    dirty<fathom::a16_pwm> pulse;
    assert_int_equal(pulse.object->begin(nothing, bus.fake.clock, none), FATHOM_ERR_ARGUMENT);
    a_poll_after_a_failed_begin_is_refused(*pulse.object);
    dirty<fathom::a16_switch> door;
    assert_int_equal(door.object->begin(no_pin, bus.fake.clock), FATHOM_ERR_ARGUMENT);
    a_poll_after_a_failed_begin_is_refused(*door.object);
    dirty<fathom::a05_relay> relay;
    assert_int_equal(relay.object->begin(no_pin, bus.fake.clock), FATHOM_ERR_ARGUMENT);
    a_poll_after_a_failed_begin_is_refused(*relay.object);
}

TEST(a_bus_that_is_not_set_up_is_refused)
{
    memset(&bus, 0, sizeof bus);
    dirty<fathom::hps167s> gate(bus);
    dirty<fathom::a16_auto> tank(bus);
    assert_int_equal(gate.object->begin(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(tank.object->begin(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(gate.object->poll(), FATHOM_ERR_ARGUMENT);
    expect_nothing(*gate.object, FATHOM_ERR_ARGUMENT);
}

TEST(a_sensor_that_is_asked_sends_its_request_and_returns_its_response)
{
    bus.set_up(true);
    dirty<fathom::hps167s> gate(bus);
    assert_int_equal(gate.object->begin(), FATHOM_OK);
    assert_int_equal(bus.run(*gate.object, 10000), FATHOM_PENDING);
    assert_int_equal(bus.fake.written, 1);
    assert_int_equal(bus.fake.writes[0].length, sizeof hps_request);
    assert_memory_equal(bus.fake.writes[0].bytes, hps_request, sizeof hps_request);
    fake_receive(&bus.fake, 0, hps_response, sizeof hps_response);
    assert_int_equal(bus.run(*gate.object, 10000), FATHOM_OK);
    assert_int_equal(gate.object->distance_mm(), 2083);

    /* hps167s.h: 500 ms without a response. */
    assert_int_equal(bus.run(*gate.object, 600000), FATHOM_ERR_NO_RESPONSE);
    expect_nothing(*gate.object, FATHOM_ERR_NO_RESPONSE);
    assert_string_equal(gate.object->result_name(), "NO_RESPONSE");
}

TEST(end_cancels_the_request_in_progress)
{
    bus.set_up(true);
    dirty<fathom::hps167s> gate(bus);
    assert_int_equal(gate.object->begin(), FATHOM_OK);
    assert_int_equal(bus.run(*gate.object, 10000), FATHOM_PENDING);
    assert_non_null(bus.line.head);
    gate.object->end();
    assert_null(bus.line.head);
}

TEST(a_contact_is_near_or_far_and_has_no_distance)
{
    struct contact {
        static bool get(void *ctx) { return *static_cast<bool *>(ctx); }
    };
    bool level = true; /* less than the threshold: positive polarity, A16 4(2) */
    const fathom_pin_t pin = {nullptr, contact::get, &level};
    bus.set_up(false);
    dirty<fathom::a16_switch> door;
    assert_int_equal(door.object->begin(pin, bus.fake.clock), FATHOM_OK);
    assert_int_equal(bus.run(*door.object, 1000000), FATHOM_OK);
    assert_true(door.object->is(FATHOM_NEAR));
    assert_false(door.object->is(FATHOM_FAR));
    assert_false(door.object->has_target());
    assert_int_equal(door.object->distance_mm(), 0);
    assert_string_equal(door.object->result_name(), "NEAR");
    level = false;
    assert_int_equal(bus.run(*door.object, 900000), FATHOM_OK);
    assert_string_equal(door.object->result_name(), "FAR");
}

TEST(objects_cannot_be_copied_and_are_no_larger_than_their_parts)
{
#define EACH(name)                                                                                           \
    has_no_copy<fathom::name>();                                                                             \
    has_the_size_of<fathom::name>(sizeof(fathom_##name##_t));
    EACH(a16_auto)
    EACH(a16_controlled)
    EACH(a16_pwm)
    EACH(a16_modbus)
    EACH(a16_switch)
    EACH(a05_auto)
    EACH(a05_dyp)
    EACH(a05_modbus)
    EACH(a05_relay)
    EACH(hps167s)
    EACH(hps167s_auto)
    EACH(hps167_uart)
}
