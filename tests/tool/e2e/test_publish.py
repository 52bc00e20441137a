#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom publish: what a subscriber gets of the sensors, by a broker and a subscriber that others wrote."""
import datetime
import re
import signal

import e2e
import mqtt

ONLINE = ('online', 'offline')


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

    def test_the_median_the_level_and_the_alarm_of_a_sensor_are_its_own(self):
        # 2300 - 1500 = 800 mm of 2000, 400 of 1000 per mille, of 5000
        subscriber, _ = self.begin(
            'tank a16:1:modbus median: 3, level: {mounting: 2300, height: 2000, capacity: 5000}',
            'gate hps167s:7 alarm: {when: near<1600/1700, unknown: on, no-response: on}, interval: 100',
            sim='a16:1:modbus hps167s:7 --distance 1500', top='interval: 250')
        level = mqtt.states(self.wait_for(subscriber, '/tank/level'))[0]
        self.assertEqual(list(level), ['utc', 'status', 'level_mm', 'level_per_mille', 'volume', 'boot', 'seq', 'age_ms',
                                       'dropped'])
        self.assertEqual((level['level_mm'], level['level_per_mille'], level['volume']), (800, 400, 2000))
        alarm = mqtt.states(self.wait_for(subscriber, '/gate/alarm'))[0]
        self.assertEqual(list(alarm), ['utc', 'alarm', 'is_on', 'distance_mm', 'boot', 'seq', 'age_ms', 'dropped'])
        self.assertEqual((alarm['alarm'], alarm['is_on'], alarm['distance_mm']), ('on', True, 1500))
        self.wait_for(subscriber, '/gate/state', count=2)
        topics = {one.topic for one in self.messages(subscriber)}
        self.assertNotIn('fathom/mill/gate/level', topics)
        self.assertNotIn('fathom/mill/tank/alarm', topics)

    def test_each_probe_of_an_a05_has_its_topic(self):
        subscriber, _ = self.begin('bumper a05:2:modbus probes: "1,3"', sim='a05:2:modbus --distance 900')
        for probe in (1, 3):
            self.assertEqual(mqtt.states(self.wait_for(subscriber, f'/bumper/{probe}/state'))[0]['distance_mm'], 900)
        self.wait_for(subscriber, '/bumper/3/state', count=2)
        self.assertEqual({one.topic for one in self.messages(subscriber, '/state')},
                         {'fathom/mill/bumper/1/state', 'fathom/mill/bumper/3/state'})

    def test_a_temperature_stands_in_the_state(self):
        subscriber, _ = self.begin('gate hps167s:7 temperature: 1, interval: 200', sim='hps167s:7')
        self.wait_for(subscriber, '/gate/state', lambda one: isinstance(one.json['temperature_degc'], float))

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
    """It listens to none."""

    def test_what_others_write_into_its_topics_changes_nothing_and_nothing_is_subscribed_to(self):
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
        broker.expect('Received PUBLISH from fathom-mill', 'err')
        broker.end()
        said = broker.said['err'].decode()
        self.assertEqual(re.findall(r'Received SUBSCRIBE from (?!sub\d)\S+', said), [])
        self.assertEqual(re.findall(r'Sending PUBLISH to fathom-mill', said), [])


if __name__ == '__main__':
    e2e.main()
