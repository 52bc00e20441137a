#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""At SIGHUP fathom publish reads its file again, and sensors that have not changed go on; and its messages to systemd.
It needs real time: CTest runs one such file at a time."""
import os
import re
import signal
import socket
import time

import e2e
import mqtt

READ_AGAIN = r'site.yaml was read again\.$'


class Case(mqtt.Case):
    def setUp(self):
        super().setUp()
        self.broker()
        self.subscriber = self.subscribe('#')
        for name, sensor in (('one', 'hps167s:7'), ('two', 'a16:1:modbus hps167s:8')):
            self.sim(f'{sensor} --link {self.path(name)}')
        self.one = self.line(self.path('one'), 'gate hps167s:7 interval: 50')

    def two(self, *sensors):
        return self.line(self.path('two'), *sensors)

    def begin(self, *lines, **options):
        self.publisher = self.publish(self.config(*lines, **options))

    def change(self, *lines, **options):
        self.config(*lines, **options)
        self.publisher.send(signal.SIGHUP)
        self.publisher.expect(READ_AGAIN, 'err')

    def has(self, topic, count=1):
        """So many more of them come."""
        before = len(self.messages(self.subscriber, topic))
        return mqtt.states(self.wait_for(self.subscriber, topic, count=before + count))

    def check_nothing_is_missing(self, topic, longest=5):
        """Nothing was lost, nothing has failed, and none was much later than the others."""
        states = mqtt.states(self.messages(self.subscriber, topic))
        self.assertEqual([state['seq'] for state in states], list(range(1, len(states) + 1)))
        self.assertEqual({state['status'] for state in states}, {'target'}, states)
        times = [float(state['utc'][17:-1]) for state in states]
        self.assertLess(max((later - before) % 60 for before, later in zip(times, times[1:])), longest)


class Changes(Case):
    def test_a_sensor_on_another_port_comes_and_goes_and_the_first_loses_nothing(self):
        self.begin(self.one)
        self.has('/gate/state', 3)
        self.change(self.one, self.two('tank a16:1:modbus'))
        self.has('/tank/state', 2)
        self.change(self.one)
        self.wait_for(self.subscriber, '/tank/availability', lambda one: one.payload == '')
        self.wait_for(self.subscriber, 'fathom_mill_tank_distance/config', lambda one: one.payload == '')
        count = len(self.messages(self.subscriber, '/tank/state'))
        self.has('/gate/state', 10)
        self.assertEqual(len(self.messages(self.subscriber, '/tank/state')), count)
        self.check_nothing_is_missing('/gate/state')
        available = [one.payload for one in self.messages(self.subscriber, '/gate/availability')]
        self.assertNotIn('offline', available[available.index('online'):])

    def test_a_sensor_on_the_same_line_comes_and_goes_and_the_first_goes_on(self):
        gate = 'gate hps167s:8 interval: 100'
        self.begin(self.two(gate))
        self.has('/gate/state', 3)
        self.change(self.two(gate, 'tank a16:1:modbus interval: 300'))
        self.has('/tank/state', 2)
        self.change(self.two(gate))
        self.has('/gate/state', 5)
        self.check_nothing_is_missing('/gate/state', longest=10)

    def test_a_level_may_be_added(self):
        self.begin(self.one)
        self.has('/gate/state', 3)
        self.change(self.one.replace('interval', 'level: {mounting: 9000, height: 9000, capacity: 1}, interval'))
        self.has('/gate/level', 2)
        self.check_nothing_is_missing('/gate/state')

    def test_another_name_of_the_site_is_another_topic_and_the_one_before_is_deleted(self):
        self.begin(self.one)
        self.has('mill/gate/state', 3)
        path = self.config(self.one)
        with open(path, encoding='utf-8') as file:
            text = file.read()
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text.replace('site: mill', 'site: moor'))
        self.publisher.send(signal.SIGHUP)
        self.publisher.expect(READ_AGAIN, 'err')
        self.has('moor/gate/state', 3)
        late = self.subscribe('#')
        self.wait_for(late, 'moor/status', lambda one: one.payload == 'online')
        self.wait_for(late, 'moor/gate/state')
        self.assertEqual([one for one in self.messages(late) if one.is_retained and 'mill' in one.topic], [])


class Wrong(Case):
    def test_a_file_that_is_wrong_is_told_and_the_one_before_goes_on(self):
        self.begin(self.one)
        self.has('/gate/state', 3)
        self.config(self.one.replace('interval: 50', 'interval: fast'))
        self.publisher.send(signal.SIGHUP)
        self.publisher.expect(r"site\.yaml:\d+: sensors: interval is 'fast'\. It takes a whole number from 0 to 2147483 ms\.$", 'err')
        self.publisher.expect(r'nothing has changed\.$', 'err')
        self.has('/gate/state', 3)
        self.check_nothing_is_missing('/gate/state')
        self.change(self.one)
        self.has('/gate/state', 3)
        self.check_nothing_is_missing('/gate/state')


class Manager(Case):
    """What systemd would be told."""

    def setUp(self):
        super().setUp()
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.socket.close)
        self.socket.bind(self.path('notify'))
        self.socket.settimeout(e2e.PATIENCE)

    def told(self, pattern):
        """Up to a datagram like that."""
        got = []
        while not got or not re.fullmatch(pattern, got[-1]):
            got.append(self.socket.recv(4096).decode())
        return got

    def test_it_is_ready_reloads_tells_how_it_is_and_stops(self):
        path = self.config(self.one)
        self.publisher = self.publish(path, env={**os.environ, 'NOTIFY_SOCKET': self.path('notify')})
        self.assertNotIn('STOPPING=1', self.told('READY=1'))
        self.told(r'STATUS=1 sensors, 0 away; broker 127\.0\.0\.1 connected; dropped 0')
        self.publisher.send(signal.SIGHUP)
        reloading = self.told(r'RELOADING=1\nMONOTONIC_USEC=\d+')[-1]
        self.assertLess(abs(int(reloading.split('=')[-1]) / 1e6 - time.monotonic()), e2e.PATIENCE)
        self.told('READY=1')
        self.publisher.send(signal.SIGTERM)
        self.told('STOPPING=1')
        self.ends(self.publisher, 0)

    def test_the_watchdog_is_told_that_all_is_well_in_half_of_its_time(self):
        path = self.config(self.one)
        self.publisher = self.publish(path, env={**os.environ, 'NOTIFY_SOCKET': self.path('notify'),
                                                 'WATCHDOG_USEC': '1000000'})
        self.told(r'STATUS=.*\nWATCHDOG=1')
        # Half a second each. On a busy machine some come later, so this waits for three that do not.
        deadline, began, in_time = time.monotonic() + e2e.PATIENCE, time.monotonic(), 0
        while in_time < 3:
            self.told(r'STATUS=.*\nWATCHDOG=1')
            began, before = time.monotonic(), began
            in_time += began - before < 0.75
            self.assertLess(began, deadline)

    def test_a_name_without_a_file_is_a_socket_too(self):
        name = '\0fathom-' + self.folder.rsplit('-', 1)[1]
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as other:
            other.bind(name)
            other.settimeout(e2e.PATIENCE)
            self.publish(self.config(self.one), env={**os.environ, 'NOTIFY_SOCKET': '@' + name[1:]})
            self.assertEqual(other.recv(4096), b'READY=1')


if __name__ == '__main__':
    e2e.main()
