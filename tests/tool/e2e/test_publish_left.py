#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What runs of fathom publish leave at a broker: after each run there is what is true, and nothing of an earlier run is
available. It needs real time: CTest runs one such file at a time."""
import collections
import json
import os
import random
import shutil
import signal
import socket
import tempfile

import e2e
import mqtt

ROUNDS = int(os.environ.get('FATHOM_ROUNDS', '8'))  # of restarts()
OFFLINE_S = 70  # the longest pause before it connects again, and some more

LEVEL = 'level: {mounting: 2300, height: 2000, capacity: 5000}'
ALARM = 'alarm: {when: near<1600, unknown: on, no-response: on}'
TANK, GATE, BUMPER = f'tank a16:1:modbus {LEVEL}', f'gate hps167s:7 {ALARM}', f'bumper a05:2:modbus probes: "1,2", {ALARM}'


def own(name, *words):
    return {f'fathom/mill/{name}/{word}' for word in ('counters', 'availability', *words)}


def entities(*ids, prefix='homeassistant'):
    return {f'{prefix}/{"binary_sensor" if one.endswith("alarm") else "sensor"}/fathom_mill_{one}/config' for one in ids}


# By hand: what is retained of these sensors.
SITE = {'fathom/mill/status', 'fathom/mill/publisher'}
TANK_OWN, TANK_HA = own('tank'), entities('tank_distance', 'tank_level', 'tank_filled')
GATE_OWN, GATE_HA = own('gate', 'alarm'), entities('gate_distance', 'gate_alarm')
BUMPER_OWN = own('bumper', '1/alarm', '2/alarm')
BUMPER_HA = entities('bumper_1_distance', 'bumper_1_alarm', 'bumper_2_distance', 'bumper_2_alarm')
ALL = SITE | TANK_OWN | TANK_HA | GATE_OWN | GATE_HA | BUMPER_OWN | BUMPER_HA

STATUS = '{"name":"x","availability":[{"topic":"%s/status"},{"topic":"%s/x/availability"}],"origin":{"name":"%s"}}'
# Of another site, also below a sensor's name and with the beginning of this one's, and of other programs.
FOREIGN = {
    'fathom/mill/tank/status': 'online',
    'fathom/mill/tank/7/availability': 'online',
    'fathom/mill/tank/a/alarm': '{"boot":"0123456789abcdef"}',
    'fathom/mill/tank/cistern/alarm': '{"boot":"0123456789abcdef"}',
    'fathom/mill/tank/cistern/counters': '{"boot":"0123456789abcdef"}',
    'fathom/miller/tank/availability': 'online',
    'fathom/miller/tank/counters': '{"boot":"0123456789abcdef"}',
    'fathom/mill/note': 'grease the door',
    'fathom/mill/door/availability': 'online',
    'fathom/mill/tank/alarm': 'red',
    'fathom/mill/door/counters': '17',
    'homeassistant/sensor/fathom_mill_tank_x_distance/config': STATUS % ('fathom/mill/tank', 'fathom/mill/tank', 'fathom'),
    'homeassistant/sensor/fathom_miller_x_distance/config': STATUS % ('fathom/miller', 'fathom/miller', 'fathom'),
    'homeassistant/sensor/mine/config': STATUS % ('fathom/mill', 'fathom/mill', 'my script'),
    'homeassistant/sensor/door/distance/config': '{"name":"door","state_topic":"fathom/mill/tank/state"}',
    'homeassistant/binary_sensor/door/config': '{"name":"door","state_topic":"fathom/mill/status"}',
}


class Case(mqtt.Case):
    def setUp(self):
        super().setUp()
        self.bus, self.keeps = self.path('bus'), True
        self.sim(f'a16:1:modbus hps167s:7 a05:2:modbus --distance 1500 --link {self.bus}')

        # In memory: a broker that saves waits for the disk.
        self.saved = tempfile.mkdtemp(dir='/dev/shm' if os.path.isdir('/dev/shm') else None)
        self.addCleanup(shutil.rmtree, self.saved, True)

    def broker(self, *lines, **options):
        """With what the one before has saved, if it keeps that; quiet about clients that come and go."""
        return super().broker(f'persistence {str(self.keeps).lower()}', f'persistence_location {self.saved}/', 'connection_messages false', *lines,
                              **options)

    def move(self):
        """The next broker is another one."""
        self.number = mqtt.free_port()
        self.saved = tempfile.mkdtemp(dir=self.saved)

    def begin(self, *sensors, top='', **options):
        return self.publish(self.config(self.line(self.bus, *sensors), top=f'interval: 100\n{top}', **options))

    def retained(self):
        """What a client that comes now gets: {topic: payload}."""
        late = self.subscribe('#')
        self.post(mqtt.READY, 'y')
        late.expect(f'^0 {mqtt.READY} y')
        late.end(signal.SIGKILL)  # after SIGTERM some go on
        return {one.topic: one.payload for one in self.messages(late) if one.is_retained}

    def becomes(self, topics, seconds=e2e.PATIENCE):
        """Until that is retained, and all sensors are available."""
        found = {}
        for _ in range(int(seconds * 5)):
            found = self.retained()
            states = {payload for topic, payload in found.items() if topic.endswith(('/availability', '/status'))}
            if set(found) == set(topics) and states == {'online'}:
                return found
            self.publisher.has_ended(0.2)
        self.assertEqual(sorted(found), sorted(topics))
        self.fail(f'not all are online: {found}')


class Left(Case):
    def change(self, *sensors, gone=(), come=(), how=signal.SIGKILL, top='', broker=False):
        """A run with all sensors ends, and one with these begins; meanwhile the broker too."""
        mosquitto = self.broker()
        self.publisher = self.begin(TANK, GATE, BUMPER)
        self.becomes(ALL)
        self.publisher.end(how)
        if broker:
            mosquitto.end(signal.SIGTERM)
            self.broker()
        self.publisher = self.begin(*sensors, top=top)
        return self.becomes(ALL - set(gone) | set(come))

    def test_a_sensor_with_another_name(self):
        for how, broker in ((signal.SIGKILL, False), (signal.SIGTERM, True)):
            found = self.change(TANK.replace('tank', 'cistern'), GATE, BUMPER, how=how, broker=broker, gone=TANK_OWN | TANK_HA,
                                come=own('cistern') | entities('cistern_distance', 'cistern_level', 'cistern_filled'))
            boot = json.loads(found['fathom/mill/publisher'])['boot']
            self.assertEqual({json.loads(text)['boot'] for text in found.values() if '"boot"' in text}, {boot})
            self.publisher.end()
            self.move()

    def test_a_sensor_that_was_removed(self):
        self.change(TANK, GATE, gone=BUMPER_OWN | BUMPER_HA)

    def test_names_that_change_places(self):
        self.change(TANK.replace('tank', 'gate'), GATE.replace('gate', 'tank'),
                    gone=TANK_HA | GATE_OWN | GATE_HA | BUMPER_OWN | BUMPER_HA,
                    come=own('gate') | own('tank', 'alarm') | entities(
                        'gate_distance', 'gate_level', 'gate_filled', 'tank_distance', 'tank_alarm'))

    def test_an_alarm_and_a_level_that_were_removed(self):
        self.change('tank a16:1:modbus', 'gate hps167s:7', BUMPER,
                    gone=entities('tank_level', 'tank_filled', 'gate_alarm') | {'fathom/mill/gate/alarm'})

    def test_a_probe_that_was_removed(self):
        self.change(TANK, GATE, BUMPER.replace('1,2', '1'), gone=entities('bumper_2_distance', 'bumper_2_alarm') |
                    {'fathom/mill/bumper/2/alarm'})

    def test_another_discovery_prefix(self):
        moved = {one.replace('homeassistant/', 'ha/x/') for one in TANK_HA | GATE_HA | BUMPER_HA}
        self.change(TANK, GATE, BUMPER, top='discovery: ha/x', gone=TANK_HA | GATE_HA | BUMPER_HA, come=moved)
        self.publisher.end()
        self.publisher = self.begin(TANK, GATE, top='discovery: ha/x')
        self.becomes(ALL - BUMPER_OWN - BUMPER_HA - TANK_HA - GATE_HA | {one for one in moved if 'bumper' not in one})

    def test_no_discovery(self):
        self.change(TANK, GATE, BUMPER, top='discovery: off', gone=TANK_HA | GATE_HA | BUMPER_HA)

    def test_what_others_have_stays(self):
        self.broker()
        for topic, text in FOREIGN.items():
            self.post(topic, text)
        self.publisher = self.begin(TANK)
        found = self.becomes_of(SITE | TANK_OWN | TANK_HA)
        self.publisher.end()
        self.publisher = self.begin(GATE)
        found = self.becomes_of(SITE | GATE_OWN | GATE_HA)
        self.assertEqual({topic: text for topic, text in found.items() if topic in FOREIGN}, FOREIGN)

    def becomes_of(self, topics):
        for _ in range(e2e.PATIENCE * 5):
            found = self.retained()
            if set(found) == topics | set(FOREIGN) and found['fathom/mill/status'] == 'online':
                return found
            self.publisher.has_ended(0.2)
        return self.assertEqual(sorted(found), sorted(topics | set(FOREIGN)))

    def test_thousands_of_messages_of_others_hide_none(self):
        self.broker()
        self.publisher = self.begin(TANK)
        self.becomes(SITE | TANK_OWN | TANK_HA)
        self.publisher.end()
        with socket.create_connection(('127.0.0.1', self.number)) as other:
            other.sendall(b'\x10\x0d\0\x04MQTT\x04\x02\0\0\0\x01o')  # MQTT 3.1.1, 3.1
            for number in range(3000):
                text = f'homeassistant/sensor/{number:04}/config{{"name":"x","state_topic":"door/{number:0400}"}}'.encode()
                length = len(text) + 2
                other.sendall(bytes([0x31, length & 127 | 128, length >> 7, 0, 32]) + text)  # retained: 3.3
            other.sendall(b'\xe0\0')
            self.assertEqual(other.recv(4), b'\x20\x02\0\0')
            self.assertEqual(other.recv(1), b'')  # the broker has read all of it
        self.publisher = self.begin(GATE)
        late = self.subscribe()
        self.wait_for(late, 'gate/availability', lambda one: one.payload == 'online')
        self.wait_for(late, 'mill/status', lambda one: one.payload == 'online')
        again = self.subscribe('fathom/mill/tank/#', 'homeassistant/sensor/fathom_mill_tank_distance/config',
                               'homeassistant/sensor/2999/config')
        self.wait_for(again, '2999/config')
        self.assertEqual([one.topic for one in self.messages(again)], ['homeassistant/sensor/2999/config'])

    def test_the_ids_of_an_earlier_version_are_deleted_before_the_new_ones_come(self):
        """Home Assistant gives the new entity the name of the old one only if that is gone."""
        self.broker()
        name = 'water_tank.1'
        ids = 'fathom_mill_water__5ftank__2e1_distance', 'fathom_mill_water_tank_1_distance'
        new, old = (f'homeassistant/sensor/{one}/config' for one in ids)
        self.publisher = self.begin(TANK.replace('tank', name).replace(LEVEL, ''))
        found = self.becomes(SITE | own(name) | {new})
        self.publisher.end()
        self.post(old, found[new].replace(*ids))
        subscriber = self.subscribe('#')
        self.publisher = self.begin(TANK.replace('tank', name).replace(LEVEL, ''))
        self.wait_for(subscriber, 'fathom/mill/status', lambda one: one.payload == 'online')
        live = [repr(one)[:len(old) + 1] for one in self.messages(subscriber) if not one.is_retained]
        self.assertLess(live.index(f'{old} '), live.index(f'{new} '[:len(old) + 1]))
        self.becomes(SITE | own(name) | {new})

    def test_another_broker_at_a_reload_leaves_nothing_available_at_the_first(self):
        self.broker()
        first = self.number
        self.publisher = self.begin(GATE)
        self.becomes(SITE | GATE_OWN | GATE_HA)
        self.move()
        self.broker()
        self.config(self.line(self.bus, GATE), top='interval: 100')
        self.publisher.send(signal.SIGHUP)
        self.becomes(SITE | GATE_OWN | GATE_HA)
        self.number = first
        self.assertEqual(self.retained()['fathom/mill/status'], 'offline')

    def test_a_user_who_may_not_read_is_named_and_the_site_is_online(self):
        with open(self.path('acl'), 'w', encoding='ascii') as file:
            print('topic write #\n\nuser sub\ntopic readwrite #', file=file)
        self.broker(f'acl_file {self.path("acl")}')
        subscriber = self.subscribe('#', options=('-u', 'sub'))
        publisher = self.begin(GATE)
        publisher.expect(r'broker 127\.0\.0\.1 port \d+: it does not send back what this client published, so messages of '
                         r'earlier sensors stay there\. Let the user read fathom/mill/# and the discovery messages\.$', 'err')
        self.wait_for(subscriber, 'fathom/mill/status', lambda one: one.payload == 'online')

    @e2e.each(brokers_that_are_killed_and_sensors_that_are_renamed=True, brokers_that_keep_nothing=False)
    def restarts(self, keeps):
        """A broker that is killed comes back with what it had when it saved: that can be an earlier run's. Or with nothing, and then
        a run that goes on has to send everything again."""
        self.keeps, chance, told = keeps, random.Random(39), collections.Counter()
        files = (TANK, GATE, BUMPER), (TANK.replace('tank', 'cistern'), GATE), (GATE.replace('gate', 'tank'), BUMPER)
        truths = (ALL, SITE | own('cistern') | entities('cistern_distance', 'cistern_level', 'cistern_filled') | GATE_OWN | GATE_HA,
                  SITE | own('tank', 'alarm') | entities('tank_distance', 'tank_alarm') | BUMPER_OWN | BUMPER_HA)
        lines = 'autosave_on_changes true', 'autosave_interval 20'
        mosquitto, number = self.broker(*lines), 0
        self.publisher = self.begin(*files[number])
        for turn in range(ROUNDS):
            self.publisher.has_ended(chance.choice((0, 0.1, 0.7)))
            what = chance.choice(('broker', 'tool', 'tool', 'both'))
            told[what] += 1
            if what != 'tool':
                self.post(mqtt.READY, 'x')  # Mosquitto forgets a signal before it serves clients
                mosquitto.end(chance.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM)))
            if what != 'broker':
                self.publisher.end(chance.choice((signal.SIGKILL, signal.SIGTERM)))
                number = chance.randrange(3)
                self.publisher = self.begin(*files[number])
            if what != 'tool':
                mosquitto = self.broker(*lines)
            if turn % 10 == 7:
                self.check(files[number], truths[number])
        self.check(files[number], truths[number])
        self.assertGreater(told['broker'] + told['both'], ROUNDS // 4, told)

    def check(self, sensors, truth):
        found = self.becomes(truth, OFFLINE_S)
        boot = json.loads(found['fathom/mill/publisher'])['boot']
        self.assertEqual({json.loads(text)['boot'] for text in found.values() if '"boot"' in text}, {boot}, sensors)
        alarms = {topic: json.loads(text)['alarm'] for topic, text in found.items() if topic.endswith('/alarm')}
        self.assertEqual(set(alarms.values()), {'on'}, alarms)  # 1500 mm are below 1600


class Shown(Case):
    """What Home Assistant shows as available after a start is of this start: at each message, in their order."""

    def shown(self, subscriber, boot, is_over):
        """How often a message arrived while the sensor was available, once the first run was over."""
        has, count = {}, 0
        for one in self.messages(subscriber):
            has[one.topic] = one.payload
            is_over |= one.topic == 'fathom/mill/status' and one.payload == 'offline'
            if is_over and has.get('fathom/mill/status') == has.get('fathom/mill/gate/availability') == 'online':
                count += 1
                for topic in ('fathom/mill/gate/alarm', 'fathom/mill/gate/state'):
                    self.assertNotIn(boot, has.get(topic, ''), f'message {count}: {one}')
        return count

    def test_no_alarm_and_no_reading_of_an_earlier_run_is_available(self):
        for is_late in (False, True):
            mosquitto = self.broker()
            first = self.begin(GATE)
            subscriber = self.subscribe('fathom/#')
            self.wait_for(subscriber, 'gate/alarm', lambda one: one.json['alarm'] == 'on')
            boot = self.wait_for(subscriber, 'mill/publisher')[0].json['boot']
            first.end(signal.SIGKILL)
            self.wait_for(subscriber, 'mill/status', lambda one: one.payload == 'offline')
            if is_late:
                mosquitto.end()
            second = self.begin(GATE.replace('near<1600', 'near<600'))
            if is_late:
                second.expect('Connection refused', 'err')
                second.has_ended(1)
                self.broker()
                subscriber = self.subscribe('fathom/#')
            if not subscriber.hear(lambda: self.shown(subscriber, boot, is_late) > 5):
                subscriber.fail('the sensor is not available')
            self.assertEqual(self.messages(subscriber, 'gate/alarm')[-1].json['alarm'], 'off')
            got = [(one.topic.split('/')[-1], one.payload) for one in self.messages(subscriber)
                   if not one.is_retained and boot not in one.payload]
            new = got[next(i for i, (_, text) in enumerate(got) if '"boot"' in text):]
            if not is_late:  # else the subscriber may come later than the availability
                self.assertLess([topic for topic, _ in new].index('availability'), new.index(('status', 'online')))
            second.end()
            self.move()


if __name__ == '__main__':
    e2e.main()
