#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom publish where a library was not there when the tool was built: fathom_without_publish and fathom_without_openssl are
the tool with without.c."""
import os

import e2e
import mqtt


def built(name):
    return os.path.join(os.environ.get('FATHOM_BUILD', ''), 'tests', 'tool', name)


class Publish(e2e.Case):
    def test_it_says_what_is_missing_with_exit_status_2(self):
        with open(self.path('site.yaml'), 'w', encoding='ascii') as file:
            file.write('site: mill\n')
        for words in (['--check', self.path('site.yaml')], [self.path('site.yaml')], []):
            done = self.start([built('fathom_without_publish'), 'publish', *words]).finish()
            self.ends(done, 2, 'fathom publish: this fathom was built without libmosquitto and libyaml. Install ', out='')

    def test_the_help_says_so_too(self):
        done = self.start([built('fathom_without_publish'), 'publish', '--help']).finish()
        self.ends(done, 0)
        self.assertIn('built without libmosquitto and libyaml', done.out)
        done = self.start([built('fathom_without_publish'), '--help']).finish()
        self.assertRegex(done.out, r'(?m)^  publish .*\(not in this build\)$')

    def test_the_other_commands_are_there(self):
        self.ends(self.start([built('fathom_without_publish'), 'decode', '01 03 02 02 F2 38 A1']), 0)


class Tls(mqtt.Case):
    def begin(self, ca):
        self.sim(f'hps167s:7 --link {self.path("bus")}')
        path = self.config(self.line(self.path('bus'), 'gate hps167s:7'), broker=f'tls: {{ca-file: {ca}}}')
        return self.start([built('fathom_without_openssl'), 'publish', path])

    def test_without_openssl_it_is_encrypted_all_the_same(self):
        ca, certificate, key = mqtt.certificates(self.folder, name='127.0.0.1')
        self.broker(f'certfile {certificate}', f'keyfile {key}')
        self.begin(ca)
        self.wait_for(self.subscribe(options=['--cafile', ca]), '/gate/state', count=2)

    def test_without_openssl_a_certificate_of_another_authority_is_refused(self):
        _, certificate, key = mqtt.certificates(self.folder, name='127.0.0.1')
        other = mqtt.certificates(self.folder, ca='other')[0]
        self.broker(f'certfile {certificate}', f'keyfile {key}')
        publisher = self.begin(other)
        publisher.expect(rf'broker .*: {self.path("site.yaml")}:\d+: tls: no secure connection: .*; it is tried again', 'err')


if __name__ == '__main__':
    e2e.main()
