#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom publish and a broker that is away, comes back, refuses it, or is not the one that it should be."""
import os
import re
import signal
import time

import e2e
import mqtt
import tcp_server


class Case(mqtt.Case):
    def begin(self, more='', *, broker='', top='interval: 100', **options):
        self.sim(f'hps167s:7 --link {self.path("bus")}')
        return self.publish(self.config(self.line(self.path('bus'), 'gate hps167s:7 ' + more), broker=broker, top=top),
                            **options)


class Away(Case):
    def test_what_was_measured_before_it_was_there_comes_in_order(self):
        publisher = self.begin()
        publisher.expect(r'broker 127\.0\.0\.1 port \d+: Connection refused; it is tried again and again', 'err')
        self.broker()
        subscriber = self.subscribe()
        got = self.wait_for(subscriber, '/gate/state', lambda one: one.json['age_ms'] < 50, 3)
        publisher.expect(r'broker 127\.0\.0\.1 port \d+: connected', 'err')
        states = mqtt.states(got)
        if states[0]['seq'] == 1:  # it was there before the subscriber else
            self.assertGreater(states[0]['age_ms'], 100)
        self.assertEqual([state['seq'] for state in states], list(range(states[0]['seq'], states[-1]['seq'] + 1)))
        self.assertEqual({state['dropped'] for state in states}, {0})
        self.assertEqual([state['utc'] for state in states], sorted(state['utc'] for state in states))

    def test_what_is_too_much_for_the_queue_is_dropped_counted_and_told(self):
        publisher = self.begin(top='interval: 100\nqueue: {messages: 5}')
        publisher.expect('Connection refused', 'err')
        publisher.has_ended(2)
        self.broker()
        subscriber = self.subscribe()
        self.wait_for(subscriber, '/gate/state', lambda one: one.json['age_ms'] < 50, 3)
        self.wait_for(subscriber, '/publisher', lambda one: one.json['dropped'] > 0)
        counters = self.messages(subscriber, '/publisher')[-1].json
        state = self.messages(subscriber, '/gate/state')[-1].json
        self.assertEqual(list(counters), ['utc', 'version', 'boot', 'uptime_s', 'sensors', 'queued', 'dropped'])
        self.assertEqual((counters['boot'], counters['dropped']), (state['boot'], state['dropped']))
        publisher.expect(rf'the queue was full: \d+ messages were dropped, {counters["dropped"]} since the start\.$', 'err')

    def test_one_that_is_killed_and_comes_back_gets_all_of_it(self):
        broker = self.broker()
        subscriber = self.subscribe()
        publisher = self.begin()
        self.wait_for(subscriber, '/gate/state', count=5)
        broker.end(signal.SIGKILL)
        publisher.expect(r'broker .*: the connection is lost; it is tried again and again', 'err')
        before = mqtt.states(self.messages(subscriber, '/gate/state'))
        broker = self.broker()
        again = self.subscribe()
        self.wait_for(again, '/gate/state', lambda one: one.json['age_ms'] < 50, 3)
        after = mqtt.states(self.messages(again, '/gate/state'))
        self.assertGreater(after[0]['seq'], 0)
        self.assertEqual(len({state['boot'] for state in before + after}), 1)
        self.assertEqual([state['seq'] for state in after], list(range(after[0]['seq'], after[-1]['seq'] + 1)))
        self.assertEqual({state['dropped'] for state in after}, {0})

    def test_all_that_is_retained_comes_again_to_one_that_has_kept_nothing(self):
        """Also a second time: without persistence, and no sensor changes meanwhile. An alarm keeps its number and its time."""
        broker = self.broker()
        subscriber = self.subscribe()
        publisher = self.begin('alarm: {when: near<9000, unknown: on, no-response: on}, temperature: 1')
        self.wait_for(subscriber, '/gate/alarm')
        self.wait_for(subscriber, '/gate/availability', lambda one: one.payload == 'online')
        before = self.retained()
        self.assertEqual(len(before), 8, before)
        for _ in range(2):
            broker.end(signal.SIGKILL)
            publisher.expect(r'the connection is lost', 'err')
            broker = self.broker()
            self.wait_for(self.subscribe(), '/gate/state', lambda one: one.json['age_ms'] < 50, 3)
            after = self.retained()
            self.assertEqual(sorted(before), sorted(after))
            for topic, one in after.items():
                if not topic.endswith(('/counters', '/publisher', '/alarm')):
                    self.assertEqual(one.payload, before[topic].payload, topic)
            alarm, old = (one['fathom/mill/gate/alarm'].json for one in (after, before))
            self.assertGreater(alarm.pop('age_ms'), old.pop('age_ms'))
            # By the clock when it is sent, which may be adjusted meanwhile.
            self.assertLess(abs(mqtt.utc(alarm.pop('utc')) - mqtt.utc(old.pop('utc'))), 0.1)
            self.assertEqual(alarm, old)

    def retained(self):
        """What a new subscriber gets, by topic."""
        late = self.subscribe('#')
        self.wait_for(late, '/gate/state')
        return {one.topic: one for one in self.messages(late) if one.is_retained}

    def test_readings_are_not_late_while_it_says_nothing(self):
        """A host that takes a connection and is silent."""
        server = tcp_server.Server(number=self.number)
        self.addCleanup(server.socket.close)
        publisher = self.begin()
        server.accept()
        self.addCleanup(lambda: server.client.close())
        publisher.has_ended(2)
        server.client.close()
        server.socket.close()
        self.broker()
        subscriber = self.subscribe()
        got = mqtt.states(self.wait_for(subscriber, '/gate/state', lambda one: one.json['age_ms'] < 50, 3))
        self.assertEqual([state['seq'] for state in got], list(range(got[0]['seq'], got[-1]['seq'] + 1)))

    def test_a_name_that_is_not_known_is_told(self):
        path = self.config(self.line(self.path('bus'), 'gate hps167s:7'))
        with open(path, encoding='utf-8') as file:
            text = file.read()
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text.replace('host: 127.0.0.1', 'host: no-such-broker.invalid'))
        self.publish(path).expect(r'broker no-such-broker\.invalid port \d+: its name is not known: ', 'err')


class Clock(Case):
    """A machine whose clock says 1970 at first."""

    NOTICE = r"this machine's clock says 1970-01-01\. Until it is set, readings have no date \(utc\)\."

    def begin_unset(self, more='', **options):
        with open(self.path('unset'), 'wb'):
            pass
        return self.begin(more, env=self.preload('clock_shim.c', UNSET_WHILE=self.path('unset')), **options)

    def test_what_waits_gets_its_date_from_the_clock_that_was_set_before_it_is_sent(self):
        publisher = self.begin_unset()
        publisher.expect(self.NOTICE, 'err')
        publisher.expect('Connection refused', 'err')
        began = time.time()
        os.remove(self.path('unset'))
        self.broker()
        got = mqtt.states(self.wait_for(self.subscribe(), '/gate/state', lambda one: one.json['age_ms'] < 50, 3))
        self.assertLess(abs(mqtt.utc(got[0]['utc']) - began), e2e.PATIENCE)
        times = [mqtt.utc(one['utc']) for one in got]
        self.assertEqual(times, sorted(times))

    def test_without_a_clock_there_is_no_date(self):
        self.broker()
        subscriber = self.subscribe()
        publisher = self.begin_unset('alarm: {when: near<9000, unknown: on, no-response: on}')
        for topic in ('state', 'alarm', 'counters'):
            self.assertIsNone(self.wait_for(subscriber, f'/gate/{topic}')[0].json['utc'], topic)
        self.assertIsNone(self.wait_for(subscriber, '/publisher')[0].json['utc'])
        os.remove(self.path('unset'))
        self.wait_for(subscriber, '/gate/state', lambda one: one.json['utc'] is not None)
        self.assertEqual(publisher.end().err.count('Until it is set'), 1)

    def test_rows_without_a_clock_have_no_date_and_that_is_told_once(self):
        sim = self.sim('a16:1:modbus')
        with open(self.path('unset'), 'wb'):
            pass
        for kind, row in (('csv', r'^a16:1,.*,\d+,,target,'), ('json', r'"time_us":\d+,"utc":null,"status":"target"')):
            done = self.ends(f'read a16:1 --port {sim} --count 2 --format {kind}', 0,
                             env=self.preload('clock_shim.c', UNSET_WHILE=self.path('unset')))
            self.assertEqual(len(re.findall(row, done.out, re.M)), 2, done.out)
            self.assertEqual(len(re.findall(self.NOTICE, done.err)), 1, done.err)


class Two(Case):
    """Publishers of one site."""

    def other(self, *, host='127.0.0.1', **options):
        """One without its port. With another host it is one of another computer, as far as this one can tell."""
        path = self.config(self.line(self.path('none'), 'gate hps167s:7'), name='other.yaml', **options)
        with open(path, encoding='utf-8') as file:
            text = file.read()
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text.replace('host: 127.0.0.1', f'host: {host}'))
        return self.publish(path)

    def test_the_second_one_of_a_computer_is_refused_and_names_the_first(self):
        self.broker()
        first = self.begin()
        self.wait_for(self.subscribe(), '/gate/state')
        for _ in range(2):
            self.ends(self.other(), 1, f'fathom: process {first.process.pid} publishes the site mill to broker 127.0.0.1 port '
                      f'{self.number} already. End that process, or write another site: into {self.path("other.yaml")}.\n')
        second = self.other(top='prefix: another')
        second.expect('no such device', 'err')
        with open(self.path('other.yaml'), encoding='utf-8') as file:
            text = file.read()
        with open(self.path('other.yaml'), 'w', encoding='utf-8') as file:
            file.write(text.replace('prefix: another', ''))
        second.send(signal.SIGHUP)
        second.expect(f'process {first.process.pid} publishes the site mill .* already', 'err')
        second.expect(r'nothing has changed\.', 'err')
        first.end(signal.SIGKILL)
        self.assertIsNone(second.done)
        self.other().expect('no such device', 'err')

    def test_that_of_another_computer_is_named_and_leaves_the_broker_to_the_one_that_has_sensors(self):
        self.broker()
        subscriber = self.subscribe()
        first = self.begin()
        self.wait_for(subscriber, '/gate/availability', lambda one: one.payload == 'online')
        second = self.other(host='localhost')
        second.expect(r'broker localhost port \d+: .*/other\.yaml:1: it accepts the client fathom-mill and soon closes the '
                      r'connection, again and again\. Another client probably has the same site, from which this id is made; each '
                      r'computer needs its own; it is tried again when a sensor responds\.$', 'err')
        self.wait_for(subscriber, '/gate/state', lambda one: one.json['age_ms'] < 50, 20)
        late = self.subscribe()
        for topic in ('/mill/status', '/gate/availability'):
            self.assertEqual([one.payload for one in self.wait_for(late, topic)], ['online'])
        self.assertLessEqual(len(self.messages(subscriber, 'mill/status')), 10)
        self.assertLessEqual(second.end().err.count('port '), 6)
        self.assertIsNone(first.done)

    @e2e.each(a_client_id_of_two_is_named=('client-id: own', r'site\.yaml:6: it accepts the client own .* has the same client-id; write another one'),
              a_site_of_two_is_named=('', r'site\.yaml:1: it accepts the client fathom-mill .* has the same site, from which this id is made'))
    def what_to_change(self, broker, words):
        self.broker()
        first = self.begin(broker=broker)
        self.wait_for(self.subscribe(), '/gate/state')
        second = self.other(host='localhost', broker=broker)
        first.expect(words, 'err')
        second.expect(words.replace('site', 'other', 1), 'err')
        self.assertEqual(first.said['err'].count(b'it accepts the client'), 1)


class Login(Case):
    def passwords(self):
        path = self.path('passwords')
        e2e.subprocess.run(['mosquitto_passwd', '-b', '-c', path, 'reader', 'right'], check=True)
        return self.broker(f'password_file {path}', anonymous=False)

    def secret(self, text):
        with open(self.path('secret'), 'w', encoding='ascii') as file:
            print(text, file=file)
        return self.path('secret')

    def test_a_password_from_a_file_is_right_once_it_is_changed(self):
        self.passwords()
        path = self.secret('wrong')
        publisher = self.begin(broker=f'user: reader\npassword-file: {path}')
        publisher.expect(rf'broker .*: {self.path("site.yaml")}:6: it refuses the user reader with the password of {path}; '
                         r'mend that, .*; it is tried again and again\.$', 'err')
        self.secret('right')
        subscriber = self.subscribe(options=['-u', 'reader', '-P', 'right'])
        self.wait_for(subscriber, '/gate/state', count=2)

    def test_a_password_as_a_credential(self):
        self.passwords()
        self.secret('right')
        self.begin(broker='user: reader\npassword-credential: secret',
                   env={**os.environ, 'CREDENTIALS_DIRECTORY': self.folder})
        self.wait_for(self.subscribe(options=['-u', 'reader', '-P', 'right']), '/gate/state', count=2)

    def test_without_a_name_it_says_that_one_is_wanted(self):
        self.passwords()
        self.begin().expect(r'it refuses a client without a name; write user: and password-file:', 'err')

    def test_the_password_stands_on_no_command_line_and_is_told_nowhere(self):
        self.passwords()
        publisher = self.begin(broker=f'user: reader\npassword-file: {self.secret("secret-word")}')
        publisher.expect('it refuses the user', 'err')
        with open(f'/proc/{publisher.process.pid}/cmdline', encoding='ascii') as file:
            self.assertNotIn('secret-word', file.read())
        done = publisher.end()
        self.assertNotIn('secret-word', done.out + done.err)


class Secure(Case):
    def secure(self, **options):
        """Returns the path of the authority's certificate."""
        ca, certificate, key = mqtt.certificates(self.folder, **options)
        self.broker(f'certfile {certificate}', f'keyfile {key}')
        return ca

    def begin_secure(self, ca):
        return self.begin(broker=f'tls: {{ca-file: {ca}}}')

    def test_states_go_by_tls(self):
        ca = self.secure(name='127.0.0.1')
        self.begin_secure(ca)
        self.wait_for(self.subscribe(options=['--cafile', ca]), '/gate/state', count=3)

    def refused(self, ca, words):
        publisher = self.begin_secure(ca)
        publisher.expect(rf'broker .*: {self.path("site.yaml")}:\d+: tls: {words}.*; it is tried again and again\.$', 'err')
        publisher.has_ended(2)
        self.assertIsNone(publisher.done)
        self.assertEqual(publisher.said['err'].count(b'tried again'), 1, publisher.said['err'].decode())

    def test_an_expired_certificate(self):
        self.refused(self.secure(name='127.0.0.1', days='-1'),
                     r'its certificate is not accepted: certificate has expired: it is valid until [-0-9]+ [0-9:]+, and this '
                     r"machine's clock says [-0-9]+ [0-9:]+ \(UTC\)\. Set the clock; if it is right, the broker needs another")

    def test_a_clock_that_was_not_set_is_named_once_until_it_is(self):
        ca = self.secure(name='127.0.0.1')
        with open(self.path('unset'), 'wb'):
            pass
        publisher = self.begin(broker=f'tls: {{ca-file: {ca}}}', env=self.preload('clock_shim.c', UNSET_WHILE=self.path('unset')))
        day = time.strftime('%Y-%m-%d', time.gmtime())
        publisher.expect(rf'tls: its certificate is not accepted: certificate is not yet valid: it is valid from {day} [0-9:]+, and '
                         r"this machine's clock says 1970-01-01 00:00 \(UTC\)\. Set the clock; .* tried again and again\.$", 'err')
        publisher.has_ended(1)
        os.remove(self.path('unset'))
        self.wait_for(self.subscribe(options=['--cafile', ca]), '/gate/state', count=3)
        self.assertEqual(publisher.end().err.count('not yet valid'), 1)

    def test_a_broker_that_is_killed_is_not_a_matter_of_tls(self):
        ca, certificate, key = mqtt.certificates(self.folder, name='127.0.0.1')
        broker = self.broker(f'certfile {certificate}', f'keyfile {key}')
        publisher = self.begin_secure(ca)
        self.wait_for(self.subscribe(options=['--cafile', ca]), '/gate/state')
        broker.end(signal.SIGKILL)
        publisher.expect(r'port \d+: the connection is lost; ', 'err')

    def test_an_authority_that_is_not_trusted(self):
        self.secure(name='127.0.0.1')
        self.refused(mqtt.certificates(self.folder, ca='other')[0], 'its certificate is not accepted: ')

    def test_a_certificate_for_another_name(self):
        self.refused(self.secure(name='another.example'),
                     r'its certificate is not accepted: (IP address|hostname) mismatch; ')

    def test_a_broker_that_speaks_no_tls(self):
        self.broker()
        self.refused(mqtt.certificates(self.folder)[0], 'no secure connection: ')

    def test_a_client_certificate(self):
        ca, certificate, key = mqtt.certificates(self.folder, name='127.0.0.1')
        self.broker(f'certfile {certificate}', f'keyfile {key}', f'cafile {ca}', 'require_certificate true')
        self.begin(broker=f'tls: {{ca-file: {ca}, certificate-file: {certificate}, key-file: {key}}}')
        options = ['--cafile', ca, '--cert', certificate, '--key', key]
        self.wait_for(self.subscribe(options=options), '/gate/state', count=3)


if __name__ == '__main__':
    e2e.main()
