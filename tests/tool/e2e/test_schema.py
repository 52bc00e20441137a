#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/fathom/schema.json. Whatever the other tests of the tool print as JSON is compared with it: those that start
the tool do that themselves (e2e.py), and those in one process leave their lines in a file for this test."""
import os
import re

import e2e
import schema

STATE = ('{"utc":"2026-11-23T09:43:12.345678Z","status":"target","distance_mm":1500,"boot":"0123456789abcdef","seq":7,'
         '"age_ms":0,"dropped":0}')


class Schema(e2e.Case):
    def test_a_record_is_of_one_kind(self):
        self.assertEqual(schema.kinds(schema.json.loads(STATE)), ['state'])

    @e2e.each(a_key_is_missing=(',"seq":7', '', 'seq is missing'), a_key_is_unknown=('"seq"', '"n":1,"seq"', 'n is unknown'),
              a_value_has_another_type=('1500', '"1500"', 'distance_mm'), a_word_is_unknown=('target', 'Target', 'status'),
              a_number_is_out_of_range=('1500', '-1', 'distance_mm'), a_time_has_another_form=('T09', ' 09', 'utc'))
    def refused(self, before, after, problem):
        with self.assertRaisesRegex(AssertionError, f'nearest kind is state: .*{problem}'):
            schema.expect_record(STATE.replace(before, after))

    def test_the_tests_in_one_process_print_records(self):
        path = os.environ.get('FATHOM_JSON_LINES', '')
        if not os.path.exists(path):
            return  # they did not run
        is_old = os.path.getmtime(path) < os.path.getmtime(e2e.FATHOM)
        with open(path, encoding='utf-8') as file:
            lines = sorted(set(file))
        os.remove(path)
        for line in lines if not is_old else []:
            schema.expect_record(line)

    def test_the_help_lists_each_kind_and_each_field_of_read_and_scan(self):
        defined = schema.schema()['$defs']
        topic = self.ends('help json', 0).out
        for name in schema.names():
            for command in re.findall(r'fathom (\w+)', defined[name]['description']):
                self.assertRegex(topic, rf'(?m)^  (\w+, )?{command}\b')
        fields = topic.split("Fields of 'scan':\n\n")[1]
        self.assertEqual(set(re.findall(r'(?m)^  (\w+)', fields)), set(defined['finding']['properties']))
        fields, statuses = (re.findall(r'(?m)^  (\w+) ', part.split('\n\n')[1])
                            for part in self.ends('help output', 0).out.split('Fields of json')[1].split("Words of 'status'"))
        self.assertEqual(set(fields), {*defined['reading']['properties'], *defined['alarm_change']['properties']})
        self.assertEqual(sorted(statuses), sorted(defined['status']['enum']))
        self.assertEqual([name for name in statuses if name in e2e.FAILURES], e2e.FAILURES)


if __name__ == '__main__':
    e2e.main()
