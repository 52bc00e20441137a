#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Home Assistant's own schemas and templates take each discovery payload of fathom publish, and the states of its entities.
home_assistant.txt pins the packages, which pip brings from PyPI into the build folder, once. Exit status 77: pip cannot."""
import glob
import json
import os
import sys
import zipfile

import e2e
import mqtt

PACKAGES = os.path.join(os.environ.get('FATHOM_BUILD') or os.path.join(e2e.ROOT, 'build'), 'tests', 'tool', 'home_assistant')
LEVEL = 'level: {mounting: 9000, height: 9000, capacity: 1}'
ALARM = 'alarm: {when: near<1600, unknown: on, no-response: off}'
# Each mode, of which those of the bus respond. The others have no port: they are found all the same.
BUS = (f'tank a16:1:modbus median: 3, {LEVEL}, {ALARM}', f'gate_1.x hps167s:7 temperature: 1, {LEVEL}, {ALARM}',
       f'bumper a05:2:modbus probes: "1,2,4", {LEVEL}, {ALARM}', 'Tank hps167s:9:modbus timeout: 50')
ALONE = (f'a a16:auto {ALARM}', f'b a16:controlled {LEVEL}', f'c a05:auto {LEVEL}, {ALARM}', f'd a05:2:dyp {ALARM}',
         f'e hps167s:3:auto {LEVEL}, {ALARM}')
PINS = (('trigger: 1\n    echo: 2', f'f a16:pwm {LEVEL}, {ALARM}'), ('in: 3', f'g a16:switch {ALARM}'), ('in: 4', f'h a05:relay {ALARM}'))


def bring():
    """Unpacks all packages but Home Assistant, which Python imports from its file. Returns why not, if pip cannot."""
    wheels, unpacked = os.path.join(PACKAGES, 'wheels'), os.path.join(PACKAGES, 'unpacked')
    if not os.path.isdir(unpacked):
        why = e2e.download(os.path.join(e2e.HERE, 'home_assistant.txt'), wheels)
        if why:
            return why
        for wheel in glob.glob(os.path.join(wheels, '*.whl')):
            if not os.path.basename(wheel).startswith('homeassistant-'):
                zipfile.ZipFile(wheel).extractall(unpacked + '.part')
        os.rename(unpacked + '.part', unpacked)
    sys.path[:0] = [unpacked, *glob.glob(os.path.join(wheels, 'homeassistant-*.whl'))]
    return None


class Schemas(mqtt.Case):
    def lines(self):
        yield self.line(self.path('bus'), *BUS)
        for number, sensor in enumerate(ALONE):
            yield self.line(self.path(f'none{number}'), sensor)
        for number, (keys, sensor) in enumerate(PINS):
            yield self.line(f'gpiochip{number}\n    {keys}', sensor)

    def begin(self):
        self.broker()
        subscriber = self.subscribe('#')
        self.sim(f'a16:1:modbus hps167s:7 a05:2:modbus --distance 1500 --link {self.path("bus")}')
        self.publish(self.config(*self.lines(), top='interval: 100'))
        for topic in ('tank/alarm', 'gate_1.x/alarm', 'bumper/4/alarm'):
            self.wait_for(subscriber, topic, lambda one: one.json['alarm'] == 'on')
        self.wait_for(subscriber, 'mill/status')
        self.wait_for(subscriber, 'Tank/state', lambda one: one.json['status'] == 'no_response')
        return self.messages(subscriber)

    def test_each_payload_and_each_state(self):
        from homeassistant.components import sensor
        from homeassistant.components.mqtt import binary_sensor as mqtt_binary, discovery, sensor as mqtt_sensor
        from homeassistant.helpers import template
        import voluptuous
        schemas = {'sensor': mqtt_sensor.PLATFORM_SCHEMA_MODERN, 'binary_sensor': mqtt_binary.PLATFORM_SCHEMA_MODERN}
        received, ids, rendered = self.begin(), set(), {}
        for one in received:
            if not one.topic.endswith('/config'):
                continue
            component, _, object_id = discovery.TOPIC_MATCHER.match(one.topic.removeprefix('homeassistant/')).groups()
            payload = json.loads(one.payload)
            with self.subTest(one.topic):
                entity = schemas[component](payload)
                self.assertEqual(object_id, entity['unique_id'])
                ids.add((component, object_id))
                if 'unit_of_measurement' in entity and 'device_class' in entity:
                    self.assertIn(entity['unit_of_measurement'], sensor.DEVICE_CLASS_UNITS[entity['device_class']])
                    self.assertIn(entity['state_class'], sensor.const.DEVICE_CLASS_STATE_CLASSES[entity['device_class']])
                for wrong in ({'unit': 'mm'}, {'qos': 3}, {'state_topic': 'a/#/b'}, {'value_template': '{{ 1'}, {'device_class': 'x'}):
                    self.assertRaises(voluptuous.Invalid, schemas[component], {**payload, **wrong})
            text = template._NO_HASS_ENV.from_string(payload['value_template'])
            rendered[object_id] = {text.render(value_json=json.loads(state.payload)) for state in received
                                   if state.topic == payload['state_topic']}
        self.assertEqual(len(ids), len([one for one in received if one.topic.endswith('/config')]))
        # By hand: tank 4, gate 5, bumper 3 * 4, Tank 1; a 2, b 3, c 4 * 4, d 4 * 2, e 4; f 4, g 2, h 2.
        self.assertEqual(len(ids), 63)
        self.assertLessEqual({'1500'}, rendered['fathom_mill_tank_distance'])
        self.assertEqual(rendered['fathom_mill_Tank_distance'], {'None'})
        self.assertEqual(rendered['fathom_mill_tank_alarm'], {'ON'})
        self.assertEqual(rendered['fathom_mill_h_distance'], {'port'})
        for object_id, texts in rendered.items():
            for text in texts:
                is_word = object_id.endswith(('_g_distance', '_h_distance'))  # of a contact
                number = '^port$' if is_word else r'^(None|-?\d+(\.\d+)?)$'
                self.assertRegex(text, '^(ON|OFF)$' if object_id.endswith('_alarm') else number, object_id)


if __name__ == '__main__':
    REASON = bring()
    if REASON is not None:
        print(f'Home Assistant is not there, so this is not tested: {REASON}')
        sys.exit(77)
    e2e.main()
