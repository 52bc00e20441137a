#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom publish: what a subscriber gets of the sensors, by a broker and a subscriber that others wrote."""
import datetime
import re
import signal

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
# Of `fathom help publishing`.
ROW = r'^  ([a-zA-Z/]+)  +(\S.*(?:\n {21}\S.*)*)'
MEMBER = r'^  (\w+)  +((?:all|state|level|alarm)(?:, \w+)*)  +\S'

FILTERS = ('fathom/mill/+/counters', 'fathom/mill/+/availability', 'fathom/mill/+/alarm', 'fathom/mill/+/+/alarm',
           '+/sensor/+/config', '+/binary_sensor/+/config')


def is_target(message):
    return message.json['status'] == 'target'


class States(mqtt.Case):
    def begin(self, *sensors, sim='a16:1:modbus --distance 1500', top=''):
        self.broker()
        subscriber = self.subscribe()
        self.sim(f'{sim} --link {self.path("bus")}')
        publisher = self.publish(self.config(self.line(self.path('bus'), *sensors), top=top))
        return subscriber, publisher

    def test_a_reading_is_a_state_with_its_time_its_status_and_its_age(self):
        subscriber, _ = self.begin('tank a16:1:modbus interval: 250')
        got = self.wait_for(subscriber, '/tank/state', is_target, 3)
        self.assertEqual({one.topic for one in got}, {'fathom/mill/tank/state'})
        states = mqtt.states(got)
        for state in states:
            self.assertEqual(list(state), ['utc', 'status', 'distance_mm', 'boot', 'seq', 'age_ms', 'dropped'])
            self.assertEqual((state['status'], state['distance_mm'], state['dropped']), ('target', 1500, 0))
            self.assertRegex(state['boot'], '^[0-9a-f]{16}$')
            self.assertLess(state['age_ms'], 10000)
            then = datetime.datetime.strptime(state['utc'], '%Y-%m-%dT%H:%M:%S.%fZ')
            now = datetime.datetime.now(datetime.timezone.utc).replace(tzinfo=None)
            self.assertLess(abs((now - then).total_seconds()), e2e.PATIENCE)
        self.assertEqual([state['seq'] for state in states], [1, 2, 3])
        self.assertEqual(len({state['boot'] for state in states}), 1)
        self.assertFalse(any(one.is_retained for one in got))

    def test_a_sensor_that_does_not_answer_is_told_with_each_attempt_and_not_available_after_three(self):
        subscriber, _ = self.begin('ghost a16:9:modbus timeout: 100', 'tank a16:1:modbus', top='interval: 200')
        self.wait_for(subscriber, '/tank/availability', lambda one: one.payload == 'online')
        self.wait_for(subscriber, '/ghost/state', count=4)
        got = mqtt.states(self.messages(subscriber, '/ghost/state'))
        self.assertEqual({(one['status'], one['distance_mm']) for one in got}, {('no_response', None)})
        self.assertEqual({one.payload for one in self.messages(subscriber, '/ghost/availability')}, {'offline'})
        self.assertNotIn('offline', [one.payload for one in self.messages(subscriber, '/tank/availability')][1:])


class Availability(mqtt.Case):
    def begin(self):
        self.broker()
        sim = self.sim(f'a16:1:modbus --link {self.path("bus")}')
        subscriber = self.subscribe()
        path = self.config(self.line(self.path('bus'), 'tank a16:1:modbus'), top='interval: 250')
        publisher = self.publish(path)
        self.wait_for(subscriber, '/tank/availability', lambda one: one.payload == 'online')
        return sim, subscriber, publisher

    def last(self, subscriber, topic):
        return self.messages(subscriber, topic)[-1].payload

    def test_the_site_is_online_and_offline_at_its_end(self):
        _, subscriber, publisher = self.begin()
        self.assertEqual(self.last(subscriber, 'fathom/mill/status'), 'online')
        self.ends(publisher.end(signal.SIGTERM), 0)
        self.wait_for(subscriber, 'fathom/mill/status', lambda one: one.payload == 'offline')
        late = self.subscribe()
        got = self.wait_for(late, 'fathom/mill/status')
        self.assertEqual([(one.payload, one.is_retained) for one in got], [('offline', True)])

    def test_the_broker_tells_that_it_was_killed(self):
        _, subscriber, publisher = self.begin()
        publisher.end(signal.SIGKILL)
        self.wait_for(subscriber, 'fathom/mill/status', lambda one: one.payload == 'offline')

    def test_a_port_that_is_lost_is_told_and_waited_for(self):
        sim, subscriber, publisher = self.begin()
        sim.end()
        self.wait_for(subscriber, '/tank/availability', lambda one: one.payload == 'offline', 2)
        self.wait_for(subscriber, '/tank/state', lambda one: one.json['status'] == 'port')
        publisher.expect('Waiting until it is back', 'err')
        self.sim(f'a16:1:modbus --link {self.path("bus")}')
        self.wait_for(subscriber, '/tank/availability', lambda one: one.payload == 'online', 2)
        seqs = [state['seq'] for state in mqtt.states(self.messages(subscriber, '/tank/state'))]
        self.assertEqual(seqs, list(range(1, len(seqs) + 1)))

    def test_a_port_that_is_not_there_is_told_and_waited_for(self):
        self.broker()
        subscriber = self.subscribe()
        publisher = self.publish(self.config(self.line(self.path('bus'), 'tank a16:1:modbus')))
        self.assertEqual(mqtt.states(self.wait_for(subscriber, '/tank/state'))[0]['status'], 'port')
        self.wait_for(subscriber, '/tank/availability', lambda one: one.payload == 'offline')
        self.sim(f'a16:1:modbus --link {self.path("bus")}')
        self.wait_for(subscriber, '/tank/state', is_target)
        self.wait_for(subscriber, '/tank/availability', lambda one: one.payload == 'online')
        publisher.expect('it is there; reading begins', 'err')


class Alone(mqtt.Case):
    """It obeys none."""

    def test_what_others_write_changes_nothing_and_only_what_it_can_have_left_is_subscribed_to_and_not_for_long(self):
        broker = self.broker('log_type all')
        for topic, text in (('fathom/mill/status', 'offline'), ('fathom/mill/tank/state', '{"seq":99}'),
                            ('fathom/mill/tank/availability', 'x'), ('fathom/mill/tank/set', 'reset')):
            self.post(topic, text)
        self.sim(f'a16:1:modbus --link {self.path("bus")}')
        subscriber = self.subscribe()
        self.publish(self.config(self.line(self.path('bus'), 'tank a16:1:modbus'), top='interval: 250'))
        got = self.wait_for(subscriber, '/tank/state', lambda one: not one.is_retained, 3)
        self.assertEqual([one.json['seq'] for one in got if not one.is_retained], [1, 2, 3])
        self.wait_for(subscriber, 'fathom/mill/status', lambda one: not one.is_retained and one.payload == 'online')
        self.wait_for(subscriber, '/tank/availability', lambda one: not one.is_retained and one.payload == 'online')
        for filters in FILTERS:
            broker.expect(rf'^\d+: \t{re.escape(filters)} \(QoS 0\)$', 'err')
        for filters in FILTERS:
            broker.expect(rf'^\d+: \t{re.escape(filters)}$', 'err') # the end of that
        broker.end()
        said = broker.said['err'].decode()
        self.assertEqual(len(re.findall(r'Received SUBSCRIBE from (?!sub\d)\S+', said)), len(FILTERS))
        self.assertEqual(set(re.findall(r"Sending PUBLISH to fathom-mill .*'(\S+)'", said)) -
                         {'fathom/mill/tank/availability', 'fathom/mill/tank/counters',
                          'homeassistant/sensor/fathom_mill_tank_distance/config'}, set())


class Discovery(mqtt.Case):
    """Each key is one that Home Assistant documents, with the type that it documents, and what it names is there."""

    def check_keys(self, what, has, page, documented):
        for key, value in has.items():
            self.assertIn(key, documented, f'{what}: {page} has no such key')
            self.assertIs(type(value), documented[key], f'{what}: {key}: see {page}')

    def check_entity(self, one, topics):
        page, pattern = TOPIC
        found = pattern.match(one.topic)
        self.assertTrue(found, f'{one.topic}: see {page}')
        self.assertEqual(found[2], one.json['unique_id'], page)
        page, documented = DOCUMENTED[found[1]]
        self.check_keys(one, one.json, page, {**documented, 'origin': dict})
        self.assertLessEqual(REQUIRED[found[1]], set(one.json), page)
        self.check_keys(one, one.json['device'], *DOCUMENTED['device'])
        self.check_keys(one, one.json['origin'], *ORIGIN)
        self.assertEqual(one.json['availability_mode'], 'all')
        for entry in one.json['availability']:
            self.check_keys(one, entry, *DOCUMENTED['availability'])
            self.assertEqual(topics[entry['topic']].payload, 'online')
        page, classes = CLASSES[found[1]]
        if 'device_class' in one.json:
            self.assertIn(one.json.get('unit_of_measurement'), classes[one.json['device_class']], page)
        for member in re.findall(r'value_json\.(\w+)', one.json['value_template']):
            self.assertIn(member, topics[one.json['state_topic']].json, one)

    def test_each_entity_is_documented_retained_and_names_topics_that_have_what_it_wants(self):
        self.broker()
        link = self.path('bus')
        self.sim(f'a16:1:modbus hps167s:7 a05:2:modbus --distance 1500 --link {link}')
        subscriber = self.subscribe('#')
        self.publish(self.config(self.line(
            link, 'tank a16:1:modbus level: {mounting: 2300, height: 2000, capacity: 5000}',
            'gate hps167s:7 temperature: 1, alarm: {when: near<1600, unknown: on, no-response: on}',
            'bumper.1 a05:2:modbus probes: "1,2"'), top='interval: 250'))
        self.wait_for(subscriber, '/bumper.1/2/state')
        for name in ('tank', 'gate', 'bumper.1'):
            self.wait_for(subscriber, f'/{name}/availability', lambda one: one.payload == 'online')
        self.wait_for(subscriber, 'mill/status')
        self.wait_for(subscriber, '/gate/alarm', lambda one: one.json['alarm'] == 'on')
        topics = {one.topic: one for one in self.messages(subscriber)}
        entities = [one for one in topics.values() if one.topic.startswith('homeassistant/')]
        self.assertEqual(len(entities), 8)
        for one in entities:
            self.check_entity(one, topics)
        late = self.subscribe('homeassistant/#')
        self.assertTrue(late.hear(lambda: len(self.messages(late)) == len(entities)))
        self.assertTrue(all(one.is_retained for one in self.messages(late)))


class Manual(mqtt.Case):
    """`fathom help publishing`: its topics and their members are those that a subscriber receives."""

    def test_the_topics_and_their_members_are_those_that_arrive(self):
        page = self.run_fathom('help publishing').out
        topics = {name: ' '.join(text.split()) for name, text in re.findall(ROW, page[:page.index('An a05')], re.M)}
        members = re.findall(MEMBER, page[page.index('  member'):], re.M)
        self.assertEqual(len(members), 13, members)
        self.broker()
        subscriber = self.subscribe()
        self.sim(f'hps167s:7 --link {self.path("bus")}')
        level, alarm = 'level: {mounting: 9000, height: 9000, capacity: 1}', 'alarm: {when: near<99, unknown: on, no-response: on}'
        self.publish(self.config(self.line(self.path('bus'), f'gate hps167s:7 temperature: 1, {level}, {alarm}')))
        for topic in ('gate/state', 'gate/level', 'gate/alarm', 'gate/availability', 'gate/counters', 'mill/publisher'):
            self.wait_for(subscriber, topic)
        received = self.messages(subscriber)
        self.assertTrue(all(one.json for one in received if one.payload.startswith('{')))  # each is a record of schema.json
        self.assertEqual({name.replace('NAME', 'gate') for name in topics},
                         {one.topic.removeprefix('fathom/mill/') for one in received})
        for topic in ('state', 'level', 'alarm'):
            documented = [name for name, where in members if where == 'all' or topic in where.split(', ')]
            message = next(one for one in received if one.topic.endswith(f'gate/{topic}')).json
            self.assertEqual(sorted(documented), sorted(message), topic)
        publisher = next(one for one in received if one.topic.endswith('/publisher')).json
        self.assertEqual(topics['publisher'].split(':')[0], ', '.join(publisher))
        late = self.subscribe()
        self.wait_for(late, 'gate/state')
        self.assertEqual({one.topic.removeprefix('fathom/mill/').replace('gate', 'NAME')
                          for one in self.messages(late) if one.is_retained},
                         {name for name, text in topics.items() if 'retained' in text})


if __name__ == '__main__':
    e2e.main()
