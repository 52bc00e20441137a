#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom publish's discovery messages: each key is one that Home Assistant documents, with the type that it documents, and
what it names is there."""
import re

import e2e
import mqtt

MQTT = 'https://www.home-assistant.io/integrations/mqtt/'
SENSOR = 'https://www.home-assistant.io/integrations/sensor.mqtt/'
BINARY = 'https://www.home-assistant.io/integrations/binary_sensor.mqtt/'
SENSOR_CLASSES = 'https://www.home-assistant.io/integrations/sensor/#device-class'
BINARY_CLASSES = 'https://www.home-assistant.io/integrations/binary_sensor/#device-class'

# What may stand there: the key, the page that has it in its list of configuration variables, and its type there.
OF_ALL = {
    'availability': list,
    'availability_mode': str,
    'device': dict,
    'device_class': str,
    'expire_after': int,
    'name': str,
    'qos': int,
    'state_topic': str,
    'unique_id': str,
    'value_template': str,
}
DOCUMENTED = {
    'sensor': (SENSOR, {**OF_ALL, 'state_class': str, 'unit_of_measurement': str}),
    'binary_sensor': (BINARY, OF_ALL),
    'availability': (SENSOR, {'topic': str}),
    'device': (SENSOR, {'identifiers': list, 'name': str, 'model': str}),
}
REQUIRED = {'sensor': {'state_topic'}, 'binary_sensor': {'state_topic'}, 'availability': {'topic'}}
# "It is recommended to add information about the origin": #discovery-payload
ORIGIN = (MQTT + '#discovery-payload', {'name': str, 'sw_version': str})
# <discovery_prefix>/<component>/[<node_id>/]<object_id>/config, of these characters; "Best practice for entities with a unique_id
# is to set <object_id> to unique_id and omit the <node_id>": #discovery-topic
TOPIC = (MQTT + '#discovery-topic', re.compile(r'^homeassistant/(sensor|binary_sensor)/([a-zA-Z0-9_-]+)/config$'))
# The classes that are sent, and the units that their page allows for them.
CLASSES = {
    'sensor': (SENSOR_CLASSES, {'distance': {'km', 'm', 'cm', 'mm', 'mi', 'nmi', 'yd', 'in'},
                                'temperature': {'°C', '°F', 'K'}}),
    'binary_sensor': (BINARY_CLASSES, {'problem': {None}}),
}


class Discovery(mqtt.Case):
    def setUp(self):
        super().setUp()
        self.broker()
        link = self.path('bus')
        self.sim(f'a16:1:modbus hps167s:7 a05:2:modbus --distance 1500 --link {link}')
        self.subscriber = self.subscribe('#')
        self.site = self.config(self.line(
            link, 'tank a16:1:modbus level: {mounting: 2300, height: 2000, capacity: 5000}',
            'gate hps167s:7 temperature: 1, alarm: {when: near<1600, unknown: on, no-response: on}',
            'bumper.1 a05:2:modbus probes: "1,2"'), top='interval: 250')
        self.publisher = self.publish(self.site)
        self.wait_for(self.subscriber, '/bumper.1/2/state')
        self.wait_for(self.subscriber, '/gate/alarm')
        self.entities = [one for one in self.messages(self.subscriber) if one.topic.startswith('homeassistant/')]

    def check_keys(self, what, has, page, documented):
        for key, value in has.items():
            self.assertIn(key, documented, f'{what}: {page} has no such key')
            self.assertIs(type(value), documented[key], f'{what}: {key}: see {page}')

    def test_each_key_is_documented_and_has_the_documented_type(self):
        for one in self.entities:
            component = one.topic.split('/')[1]
            page, documented = DOCUMENTED[component]
            self.check_keys(one, one.json, page, {**documented, 'origin': dict})
            self.assertLessEqual(REQUIRED[component], set(one.json), page)
            self.check_keys(one, one.json['device'], *DOCUMENTED['device'])
            self.check_keys(one, one.json['origin'], *ORIGIN)
            self.assertEqual(one.json['availability_mode'], 'all')
            for entry in one.json['availability']:
                self.check_keys(one, entry, *DOCUMENTED['availability'])
            page, classes = CLASSES[component]
            if 'device_class' in one.json:
                self.assertIn(one.json.get('unit_of_measurement'), classes[one.json['device_class']], page)

    def test_each_entity_has_its_topic_and_an_id_of_its_own(self):
        ids = []
        for one in self.entities:
            page, pattern = TOPIC
            found = pattern.match(one.topic)
            self.assertTrue(found, f'{one.topic}: see {page}')
            self.assertEqual(found[2], one.json['unique_id'], page)
            ids.append(one.json['unique_id'])
        self.assertEqual(sorted(ids), [
            'fathom_mill_bumper_1_1_distance', 'fathom_mill_bumper_1_2_distance', 'fathom_mill_gate_alarm',
            'fathom_mill_gate_distance', 'fathom_mill_gate_temperature', 'fathom_mill_tank_distance',
            'fathom_mill_tank_filled', 'fathom_mill_tank_level'])

    def test_they_are_retained(self):
        late = self.subscribe('homeassistant/#')
        self.assertTrue(late.hear(lambda: len(self.messages(late)) == len(self.entities)))
        self.assertTrue(all(one.is_retained for one in self.messages(late)))

    def test_the_topics_that_they_name_are_published_and_have_what_the_templates_want(self):
        topics = {one.topic: one for one in self.messages(self.subscriber)}
        for one in self.entities:
            state = topics[one.json['state_topic']]
            for member in re.findall(r'value_json\.(\w+)', one.json['value_template']):
                self.assertIn(member, state.json, one)
            for entry in one.json['availability']:
                self.assertEqual(topics[entry['topic']].payload, 'online')

    def test_a_value_expires_after_three_intervals_and_the_time_to_open_a_port_and_an_alarm_does_not(self):
        for one in self.entities:
            self.assertEqual(one.json.get('expire_after'), None if one.topic.endswith('_alarm/config') else 30, one)


if __name__ == '__main__':
    e2e.main()
