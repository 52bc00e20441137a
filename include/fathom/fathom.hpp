/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPP
#define FATHOM_HPP

#include "fathom/fathom.h"

/**
 * @file
 * @brief A small class for each driver, for C++11 and later.
 *
 * An object has the driver, the newest reading, and the address of its line or transport. The classes have no virtual
 * functions, and use no heap, no exceptions and no RTTI. Their functions are inline and call those of C.
 * include/COST.md has what an object costs over the same program in C.
 *
 * @code
 * static fathom_posix_bus_t bus;                  // or the bus of another port
 * static fathom::hps167s gate(bus);
 *
 * if (gate.begin() != FATHOM_OK) return 1;        // after the bus was opened
 * for (;;) {
 *     if (gate.poll() == FATHOM_PENDING) continue;
 *     if (gate.has_target()) use(gate.distance_mm());
 *     else report(gate.result_name());
 * }
 * @endcode
 *
 * 1. **Bus.** A bus is any object with the members `line` (fathom_line_t) and `modbus` (fathom_modbus_t). Each port has
 *    one. The constructor only stores an address, so bus and sensor may be global objects in any files.
 *
 * 2. **Order.** Set up the bus, call begin(), then call poll() in the loop. Without begin(), poll() must not be called.
 *    begin() accepts the configuration of the driver, which may be a local variable; without one, all members have
 *    their defaults. If begin() fails, each poll() returns FATHOM_ERR_ARGUMENT until a begin() succeeds, so keep the
 *    error of begin(): status() has it only until the first poll(). Call end() before an object is destroyed while its
 *    bus is still in use.
 *
 * 3. **Everything else.** `driver` is the driver of C, for all functions of its header: for example
 *    `fathom_hps167s_power_on(&gate.driver)`. That header has the errors, the limits and the longest wait.
 *
 * 4. **Context.** The rules of the driver apply. An object cannot be copied or moved.
 */

namespace fathom
{

/** @brief The newest result of a sensor: the base of all classes below. */
class newest
{
  public:
    /**
     * @brief Returns the newest result of poll() that was not FATHOM_PENDING.
     *
     * Before the first one: FATHOM_PENDING, or the error of begin().
     */
    fathom_status_t status() const { return static_cast<fathom_status_t>(status_ + FATHOM_PENDING); }

    /** @brief Returns the newest result as a name, such as "NO_RESPONSE" (fathom_status_name()). */
    const char *status_name() const { return fathom_status_name(status()); }

    /** @brief Returns the kind of the newest reading, such as "TARGET" or "NO_TARGET", or else status_name(). */
    const char *result_name() const
    {
        if (status() != FATHOM_OK) return status_name();
        switch (sample_.kind) {
        case FATHOM_TARGET:
            return "TARGET";
        case FATHOM_NO_TARGET:
            return "NO_TARGET";
        case FATHOM_FAULT:
            return "FAULT";
        case FATHOM_NEAR:
            return "NEAR";
        case FATHOM_FAR:
            return "FAR";
        default:
            return "UNKNOWN";
        }
    }

    /**
     * @brief Returns what to check after the newest result, as a sentence (fathom_status_advice()).
     *
     * Not for an AVR: constants are in its RAM, and the 1.7 KB of all sentences are more than an Uno has left.
     */
    const char *advice() const { return fathom_status_advice(status()); }

    /** @brief Returns the newest reading, of fathom_sample_t. Valid only while status() is FATHOM_OK. */
    const fathom_sample_t &sample() const { return sample_; }

    /**
     * @brief Returns true if the newest result is an error, and no reading.
     *
     * False with FATHOM_PENDING, and with every reading, also one without a distance, such as FATHOM_NO_TARGET.
     */
    bool is_error() const { return status() < 0; }

    /**
     * @brief Returns the time since the newest reading, from its `time_us`, in microseconds.
     * @param now_us  The clock of the sensor's line, capture or contact, now.
     * @return The age, which wraps after 71.6 minutes without a poll(). UINT32_MAX if the newest result is no reading.
     */
    uint32_t age_us(uint32_t now_us) const
    {
        return status() == FATHOM_OK ? fathom_elapsed_us(now_us, sample_.time_us) : UINT32_MAX;
    }

    /** @brief Returns true if the newest result is a reading of this kind, such as FATHOM_NEAR. */
    bool is(fathom_sample_kind_t kind) const { return status() == FATHOM_OK && sample_.kind == kind; }

    /** @brief Returns true if the newest result is a distance. An object nearer than the range is no target. */
    bool has_target() const { return is(FATHOM_TARGET); }

    /** @brief Returns the distance in millimetres. 0 unless has_target(): no old value outlives an error. */
    uint16_t distance_mm() const { return has_target() ? sample_.distance_mm : 0; }

    /** @brief Returns the probe of the newest reading: 1 to 4 for an A05, 1 for the others. 0 if there is none. */
    uint8_t probe() const { return status() == FATHOM_OK ? sample_.probe : 0; }

  protected:
    /** @brief Nothing is known yet. */
    newest() : status_(0) {}

    /**
     * @brief Keeps the result of an init function, and returns it.
     * @param status  The result. After FATHOM_OK, nothing is known yet.
     * @return `status`
     */
    fathom_status_t begun(fathom_status_t status)
    {
        status_ = static_cast<int8_t>(status != FATHOM_OK ? status - FATHOM_PENDING : 0);
        return status;
    }

    /**
     * @brief Keeps a result of poll(), and returns it.
     * @param status  The result. FATHOM_PENDING changes nothing.
     * @return `status`
     */
    fathom_status_t keep(fathom_status_t status)
    {
        if (status != FATHOM_PENDING) status_ = static_cast<int8_t>(status - FATHOM_PENDING);
        return status;
    }

    /** @brief The newest reading. */
    fathom_sample_t sample_;

  private:
    newest(const newest &) = delete;
    newest &operator=(const newest &) = delete;
    int8_t status_; /* less FATHOM_PENDING, so that a global object is right before its constructor runs */
};

/** @brief A16, UART automatic, or RS232 before its first Modbus request (a16_auto.h). */
class a16_auto : public newest
{
  public:
    typedef fathom_a16_auto_config_t config_t; /**< The configuration. */

    /**
     * @brief Stores the address of the line.
     * @param bus  The bus, with the member `line`. Must stay valid as long as this object.
     */
    template <class Bus> explicit a16_auto(Bus &bus) : line_(&bus.line) {}

    /**
     * @brief Initialises the driver, as fathom_a16_auto_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_auto_init().
     */
    fathom_status_t begin(const fathom_a16_auto_config_t *config = nullptr)
    {
        return begun(fathom_a16_auto_init(&driver, line_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a16_auto_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a16_auto_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a16_auto_deinit(). */
    void end() { fathom_a16_auto_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a16_auto_t driver;

  private:
    fathom_line_t *line_;
};

/** @brief A16, UART controlled: one distance for each trigger (a16_controlled.h). */
class a16_controlled : public newest
{
  public:
    typedef fathom_a16_controlled_config_t config_t; /**< The configuration. */

    /**
     * @brief Stores the address of the line.
     * @param bus  The bus, with the member `line`. Must stay valid as long as this object.
     */
    template <class Bus> explicit a16_controlled(Bus &bus) : line_(&bus.line) {}

    /**
     * @brief Initialises the driver, as fathom_a16_controlled_init().
     * @param trigger  The trigger: fathom_output_pin() or fathom_output_line_break(). Copied.
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_controlled_init().
     */
    fathom_status_t begin(const fathom_output_t &trigger,
                          const fathom_a16_controlled_config_t *config = nullptr)
    {
        return begun(fathom_a16_controlled_init(&driver, line_, &trigger, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a16_controlled_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a16_controlled_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a16_controlled_deinit(). */
    void end() { fathom_a16_controlled_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a16_controlled_t driver;

  private:
    fathom_line_t *line_;
};

/** @brief A16, PWM: one pulse for each trigger (a16_pwm.h). */
class a16_pwm : public newest
{
  public:
    typedef fathom_a16_pwm_config_t config_t; /**< The configuration. */

    /** @brief Does nothing. */
    a16_pwm() {}

    /**
     * @brief Initialises the driver, as fathom_a16_pwm_init().
     * @param capture  The capture of the pulses. Must stay valid.
     * @param clock    The clock. Must stay valid.
     * @param trigger  The trigger. Copied.
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_pwm_init().
     */
    fathom_status_t begin(const fathom_capture_t &capture, const fathom_clock_t &clock,
                          const fathom_output_t &trigger, const fathom_a16_pwm_config_t *config = nullptr)
    {
        return begun(fathom_a16_pwm_init(&driver, &capture, &clock, &trigger, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a16_pwm_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a16_pwm_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a16_pwm_deinit(). */
    void end() { fathom_a16_pwm_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a16_pwm_t driver;
};

/** @brief A16, Modbus RTU on RS485 or RS232 (a16_modbus.h). */
class a16_modbus : public newest
{
  public:
    typedef fathom_a16_modbus_config_t config_t; /**< The configuration. */

    /**
     * @brief Stores the address of the transport.
     * @param bus  The bus, with the member `modbus`. Must stay valid as long as this object.
     */
    template <class Bus> explicit a16_modbus(Bus &bus) : modbus_(&bus.modbus) {}

    /**
     * @brief Initialises the driver, as fathom_a16_modbus_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_modbus_init().
     */
    fathom_status_t begin(const fathom_a16_modbus_config_t *config = nullptr)
    {
        return begun(fathom_a16_modbus_init(&driver, modbus_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a16_modbus_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a16_modbus_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a16_modbus_deinit(). */
    void end() { fathom_a16_modbus_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a16_modbus_t driver;

  private:
    const fathom_modbus_t *modbus_;
};

/** @brief A16, switch output: near or far (a16_switch.h). */
class a16_switch : public newest
{
  public:
    /** @brief Does nothing. */
    a16_switch() {}

    /**
     * @brief Initialises the driver, as fathom_a16_switch_init().
     * @param pin      The pin of the contact. Must stay valid.
     * @param clock    The clock. Must stay valid.
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a16_switch_init().
     */
    fathom_status_t begin(const fathom_pin_t &pin, const fathom_clock_t &clock,
                          const fathom_a16_switch_config_t *config = nullptr)
    {
        return begun(fathom_a16_switch_init(&driver, &pin, &clock, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a16_switch_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a16_switch_sensor(&driver); }

    /** @brief The driver of C. */
    fathom_a16_switch_t driver;
};

/** @brief A05, UART automatic: four distances (a05_auto.h). */
class a05_auto : public newest
{
  public:
    typedef fathom_a05_auto_config_t config_t; /**< The configuration. */

    /**
     * @brief Stores the address of the line.
     * @param bus  The bus, with the member `line`. Must stay valid as long as this object.
     */
    template <class Bus> explicit a05_auto(Bus &bus) : line_(&bus.line) {}

    /**
     * @brief Initialises the driver, as fathom_a05_auto_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a05_auto_init().
     */
    fathom_status_t begin(const fathom_a05_auto_config_t *config = nullptr)
    {
        return begun(fathom_a05_auto_init(&driver, line_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a05_auto_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a05_auto_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a05_auto_deinit(). */
    void end() { fathom_a05_auto_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a05_auto_t driver;

  private:
    fathom_line_t *line_;
};

/** @brief A05, the protocol `55 AA` on RS485 (a05_dyp.h). */
class a05_dyp : public newest
{
  public:
    typedef fathom_a05_dyp_config_t config_t; /**< The configuration. */

    /**
     * @brief Stores the address of the line.
     * @param bus  The bus, with the member `line`. Must stay valid as long as this object.
     */
    template <class Bus> explicit a05_dyp(Bus &bus) : line_(&bus.line) {}

    /**
     * @brief Initialises the driver, as fathom_a05_dyp_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a05_dyp_init().
     */
    fathom_status_t begin(const fathom_a05_dyp_config_t *config = nullptr)
    {
        return begun(fathom_a05_dyp_init(&driver, line_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a05_dyp_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a05_dyp_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a05_dyp_deinit(). */
    void end() { fathom_a05_dyp_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a05_dyp_t driver;

  private:
    fathom_line_t *line_;
};

/** @brief A05, Modbus RTU on RS485 or UART (a05_modbus.h). */
class a05_modbus : public newest
{
  public:
    typedef fathom_a05_modbus_config_t config_t; /**< The configuration. */

    /**
     * @brief Stores the address of the transport.
     * @param bus  The bus, with the member `modbus`. Must stay valid as long as this object.
     */
    template <class Bus> explicit a05_modbus(Bus &bus) : modbus_(&bus.modbus) {}

    /**
     * @brief Initialises the driver, as fathom_a05_modbus_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a05_modbus_init().
     */
    fathom_status_t begin(const fathom_a05_modbus_config_t *config = nullptr)
    {
        return begun(fathom_a05_modbus_init(&driver, modbus_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a05_modbus_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a05_modbus_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_a05_modbus_deinit(). */
    void end() { fathom_a05_modbus_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_a05_modbus_t driver;

  private:
    const fathom_modbus_t *modbus_;
};

/** @brief A05, relay output: near or far (a05_relay.h). */
class a05_relay : public newest
{
  public:
    /** @brief Does nothing. */
    a05_relay() {}

    /**
     * @brief Initialises the driver, as fathom_a05_relay_init().
     * @param pin      The pin of the contact. Must stay valid.
     * @param clock    The clock. Must stay valid.
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_a05_relay_init().
     */
    fathom_status_t begin(const fathom_pin_t &pin, const fathom_clock_t &clock,
                          const fathom_a05_relay_config_t *config = nullptr)
    {
        return begun(fathom_a05_relay_init(&driver, &pin, &clock, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_a05_relay_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_a05_relay_sensor(&driver); }

    /** @brief The driver of C. */
    fathom_a05_relay_t driver;
};

/** @brief HPS-167S, Modbus RTU on RS485 (hps167s.h). */
class hps167s : public newest
{
  public:
    /**
     * @brief Stores the address of the transport.
     * @param bus  The bus, with the member `modbus`. Must stay valid as long as this object.
     */
    template <class Bus> explicit hps167s(Bus &bus) : modbus_(&bus.modbus) {}

    /**
     * @brief Initialises the driver, as fathom_hps167s_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_hps167s_init().
     */
    fathom_status_t begin(const fathom_hps167s_config_t *config = nullptr)
    {
        return begun(fathom_hps167s_init(&driver, modbus_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_hps167s_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_hps167s_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_hps167s_deinit(). */
    void end() { fathom_hps167s_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_hps167s_t driver;

  private:
    const fathom_modbus_t *modbus_;
};

/** @brief HPS-167S, its unsolicited frames (hps167s_auto.h). */
class hps167s_auto : public newest
{
  public:
    /**
     * @brief Stores the address of the line.
     * @param bus  The bus, with the member `line`. Must stay valid as long as this object.
     */
    template <class Bus> explicit hps167s_auto(Bus &bus) : line_(&bus.line) {}

    /**
     * @brief Initialises the driver, as fathom_hps167s_auto_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_hps167s_auto_init().
     */
    fathom_status_t begin(const fathom_hps167s_auto_config_t *config = nullptr)
    {
        return begun(fathom_hps167s_auto_init(&driver, line_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_hps167s_auto_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_hps167s_auto_sensor(&driver); }

    /** @brief Cancels what is in progress, as fathom_hps167s_auto_deinit(). */
    void end() { fathom_hps167s_auto_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_hps167s_auto_t driver;

  private:
    fathom_line_t *line_;
};

/** @brief HPS-167 or HPS-166 with a UART (hps167_uart.h). */
class hps167_uart : public newest
{
  public:
    /**
     * @brief Stores the address of the line.
     * @param bus  The bus, with the member `line`. Must stay valid as long as this object.
     */
    template <class Bus> explicit hps167_uart(Bus &bus) : line_(&bus.line) {}

    /**
     * @brief Initialises the driver, as fathom_hps167_uart_init().
     * @param config   The configuration, read only during the call. NULL: the defaults.
     * @return As fathom_hps167_uart_init().
     */
    fathom_status_t begin(const fathom_hps167_uart_config_t *config = nullptr)
    {
        return begun(fathom_hps167_uart_init(&driver, line_, config));
    }

    /** @brief Returns the result of fathom_poll(), without waiting. fathom::newest has the newest one. */
    fathom_status_t poll() { return keep(fathom_hps167_uart_poll(&driver, &sample_)); }

    /** @brief Returns the sensor for fathom_due_us(), fathom_wait() and the read function of a bus. */
    fathom_sensor_t sensor() { return fathom_hps167_uart_sensor(&driver); }

    /** @brief Stops the continuous output, as fathom_hps167_uart_deinit(). */
    void end() { fathom_hps167_uart_deinit(&driver); }

    /** @brief The driver of C. */
    fathom_hps167_uart_t driver;

  private:
    fathom_line_t *line_;
};

} // namespace fathom

#endif
