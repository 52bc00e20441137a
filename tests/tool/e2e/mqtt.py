# SPDX-License-Identifier: MIT
"""A Mosquitto on the loopback interface, a subscriber that its makers wrote, and configuration files of fathom publish."""
import datetime
import json
import os
import re
import socket
import subprocess

import e2e
import schema


READY = 'ready'
KEY = ('-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes')


kept = []  # sockets


def free_port():
    """It stays free for who sets SO_REUSEADDR, as a broker does: a socket keeps it that does not listen."""
    one = socket.socket()
    one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    one.bind(('127.0.0.1', 0))
    kept.append(one)
    return one.getsockname()[1]


class Message:
    """One that a subscriber has got."""

    def __init__(self, line):
        retained, self.topic, self.payload = (line.split(' ', 2) + [''])[:3]
        self.is_retained = retained == '1'

    def __repr__(self):
        return f'{self.topic} {self.payload}'

    @property
    def json(self):
        schema.expect_records(self.payload + '\n')
        return json.loads(self.payload)


class Case(e2e.Case):
    def setUp(self):
        super().setUp()
        self.number = free_port()
        self.subscribers = 0

    # ---- the broker ----

    def broker(self, *lines, anonymous=True):
        """Begins one, again at the same number."""
        with open(self.path('broker.conf'), 'w', encoding='ascii') as file:
            print('log_dest stderr', 'user root', f'listener {self.number} 127.0.0.1',
                  f'allow_anonymous {"true" if anonymous else "false"}', *lines, sep='\n', file=file)
        program = self.start(['mosquitto', '-c', self.path('broker.conf')])
        program.expect('mosquitto version .* running', 'err')
        return program

    def subscribe(self, *topics, options=(), qos=1):
        """mosquitto_sub, when it has subscribed: it has got a message that is retained. What was published before is told
        as retained."""
        self.subscribers += 1
        name = f'sub{self.subscribers}'
        self.post(READY, 'x', *options)
        words = ['mosquitto_sub', '-h', '127.0.0.1', '-p', self.number, '-i', name, '-q', qos, '-F', '%r %t %p', *options]
        for topic in topics or ('fathom/#',):
            words += ['-t', topic]
        program = self.start([*words, '-t', READY])
        program.expect(f'^1 {READY} ')
        return program

    def post(self, topic, text, *options):
        """Another client's message, retained."""
        self.ends(self.start(['mosquitto_pub', '-h', '127.0.0.1', '-p', self.number, '-r', '-q', '1', '-t', topic, '-m', text,
                              *options]), 0)

    def messages(self, subscriber, topic=None):
        """What has come so far; of topics that end so."""
        all_of_them = [one for one in map(Message, subscriber.lines()) if one.topic != READY]
        return [one for one in all_of_them if topic is None or one.topic.endswith(topic)]

    def wait_for(self, subscriber, topic, until=lambda message: True, count=1):
        """The messages of a topic that ends so, up to that one of which this is so for the count-th time."""
        def found():
            return [i for i, one in enumerate(self.messages(subscriber, topic)) if until(one)]
        if not subscriber.hear(lambda: len(found()) >= count):
            subscriber.fail(f'{topic}: {count} such messages did not come')
        return self.messages(subscriber, topic)[:found()[count - 1] + 1]

    # ---- the site ----

    def config(self, *lines, broker='', top='', name='site.yaml'):
        """A file with these lines: of sensors."""
        path = self.path(name)
        with open(path, 'w', encoding='utf-8') as file:
            print(f'site: mill\n{top}\nbroker:\n  host: 127.0.0.1\n  port: {self.number}', file=file)
            for line in broker.splitlines():
                print(f'  {line}', file=file)
            print('lines:', *lines, sep='\n', file=file)
        return path

    def line(self, port, *sensors):
        """Of the configuration: a port and its sensors, each in YAML's braces, of which name and sensor come first."""
        rows = [f'  - port: {port}', '    sensors:']
        for sensor in sensors:
            name, kind, *more = sensor.split(' ', 2)
            rows.append(f'      - {{name: {name}, sensor: "{kind}"{", " if more else ""}{"".join(more)}}}')
        return '\n'.join(rows)

    def publish(self, path, **options):
        return self.fathom('publish', [path], **options)


def utc(text):
    """In seconds since 1970."""
    return datetime.datetime.fromisoformat(text.replace('Z', '+00:00')).timestamp()


def states(messages):
    return [one.json for one in messages]


def certificates(folder, *, days='365', name='localhost', ca='ca'):
    """An authority and a broker's certificate, by openssl: the paths of the authority's, the certificate and its key."""
    def openssl(*words):
        subprocess.run(['openssl', *words], check=True, cwd=folder, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    if not os.path.exists(os.path.join(folder, f'{ca}.crt')):
        openssl('req', '-x509', *KEY, '-days', '3650', '-subj', f'/CN=Fathom test {ca}',
                '-keyout', f'{ca}.key', '-out', f'{ca}.crt')
    own = f'{name}-{days.strip("-")}-{ca}'
    openssl('req', *KEY, '-subj', f'/CN={name}', '-keyout', f'{own}.key', '-out', f'{own}.csr')
    with open(os.path.join(folder, 'extension'), 'w', encoding='ascii') as file:
        kind = 'IP' if re.fullmatch(r'[\d.]+', name) else 'DNS'
        print(f'subjectAltName = {kind}:{name}', file=file)
    openssl('x509', '-req', '-in', f'{own}.csr', '-CA', f'{ca}.crt', '-CAkey', f'{ca}.key', '-CAcreateserial', '-days',
            days, '-extfile', 'extension', '-out', f'{own}.crt')
    return tuple(os.path.join(folder, name) for name in (f'{ca}.crt', f'{own}.crt', f'{own}.key'))
