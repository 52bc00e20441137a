#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`fathom help publishing`: its topics and their members are those that a subscriber receives."""
import re

import e2e
import mqtt

TOPIC = r'^  ([a-zA-Z/]+)  +(\S.*(?:\n {21}\S.*)*)'
MEMBER = r'^  (\w+)  +((?:all|state|level|alarm)(?:, \w+)*)  +\S'


class Topic(mqtt.Case):
    def test_the_topics_and_their_members_are_those_that_arrive(self):
        page = self.run_fathom('help publishing').out
        topics = {name: ' '.join(text.split()) for name, text in re.findall(TOPIC, page[:page.index('An a05')], re.M)}
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
