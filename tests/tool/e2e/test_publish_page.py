#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the manual says of fathom publish: its keys are the command's, its topics and their members are those that come."""
import os
import re

import e2e
import mqtt

HELP_SECTION = r'^  (\w+):$'
HELP_KEY = r'^ +([a-z][\w-]*) +(\S.*)$'


def section_of_page():
    with open(os.path.join(e2e.ROOT, 'examples/fathom/README.md'), encoding='utf-8') as file:
        return re.search(r'(?sm)^## Publishing to MQTT$.*?(?=^## )', file.read())[0]


def rows(page, header):
    """Of the table that begins so: the cells."""
    table = page[page.index(header):].split('\n\n')[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in table]


def codes(text):
    return re.findall('`([^`]+)`', text)


def keys_of_help(text):
    """(section, key, what it takes)"""
    section, found = '', []
    for line in text[text.index('of these keys:'):text.index('The topics are')].splitlines()[1:]:
        begin, key = re.match(HELP_SECTION, line), re.match(HELP_KEY, line)
        if begin:
            section = begin[1]
        elif key:
            found.append((section, key[1], key[2]))
    return found


class Page(mqtt.Case):
    def test_the_keys_are_those_of_the_command(self):
        found = keys_of_help(self.run_fathom('publish --help').out)
        self.assertGreater(len(found), 40)
        shown = [(''.join(codes(where)).rstrip(':'), *codes(key), takes)
                 for where, key, takes in rows(section_of_page(), '| in | key | takes |')]
        self.assertEqual(shown, found)

    def test_the_topics_and_their_members_are_those_that_come(self):
        self.broker()
        subscriber = self.subscribe()
        self.sim(f'hps167s:7 --link {self.path("bus")}')
        level, alarm = 'level: {mounting: 9000, height: 9000, capacity: 1}', 'alarm: {when: near<99, unknown: on, no-response: on}'
        self.publish(self.config(self.line(self.path('bus'), f'gate hps167s:7 temperature: 1, {level}, {alarm}')))
        for topic in ('gate/state', 'gate/level', 'gate/alarm', 'gate/availability', 'mill/publisher'):
            self.wait_for(subscriber, topic)
        came = self.messages(subscriber)
        page = section_of_page()
        shown = [codes(row[0])[0] for row in rows(page, '| topic | | retained |')]
        self.assertEqual({topic.replace('SITE', 'mill').replace('NAME', 'gate') for topic in shown}, {one.topic for one in came})
        members = rows(page, '| member | in | |')
        for topic in ('state', 'level', 'alarm'):
            documented = [name for name, where, _ in members if where == 'all' or topic in codes(where) for name in codes(name)]
            state = next(one for one in came if one.topic.endswith(f'gate/{topic}')).json
            self.assertEqual(sorted(documented), sorted(state), topic)
        publisher = next(one for one in came if one.topic.endswith('/publisher')).json
        said = next(row[1] for row in rows(page, '| topic | | retained |') if 'publisher' in row[0])
        self.assertEqual(codes(said), list(publisher))
        late = self.subscribe()
        self.wait_for(late, 'gate/state')
        retained = {one.topic.rsplit('/', 1)[1] for one in self.messages(late) if one.is_retained}
        self.assertEqual(retained, {codes(row[0])[0].rsplit('/', 1)[1] for row in rows(page, '| topic | | retained |')
                                    if row[2] == 'yes'})


if __name__ == '__main__':
    e2e.main()
