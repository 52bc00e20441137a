// SPDX-License-Identifier: MIT
// The sketch hps_probe in a build with FATHOM_ARDUINO_NO_TIMER0 (build.py), where the vector is the sketch's.
#include <SoftwareSerial.h> // so that PlatformIO finds it
#include <fathom_arduino.h>

#include "hps_probe/hps_probe.ino"

ISR(TIMER0_COMPA_vect) {}
