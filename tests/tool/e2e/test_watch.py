#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom watch: what is on the screen of a terminal, how it is given back, and the lines that go into a
pipe."""
import os
import re
import signal
import termios

import e2e
import terminal

BUS = 'a16:1:modbus a05:2:modbus hps167s:7'


SEEN = 'a16:1:modbus,distance=1953 a05:2:modbus,distance=1000,no-target,1500,4500 hps167s:7,distance='
FULL = '█'  # an eighth to eight eighths: ▁▂▃▄▅▆▇█
GUTTER = 8


def has(screen, *patterns):
    """Each at the begin of a line."""
    return all(re.search(f'(?m)^{pattern}', screen.text()) for pattern in patterns)


class Case(e2e.Case):
    def watch(self, line, **options):
        it = terminal.Terminal([e2e.FATHOM, 'watch', *line.split()], **options)
        self.addCleanup(it.discard)
        return it

    def begin(self, options='', **more):
        """An HPS-167S that is watched, at 2.5 m; it and the terminal."""
        sim = self.sim('hps167s --distance 2500')
        return sim, self.watch(f'hps167s --port {sim} {options}', **more)

    @staticmethod
    def shows(it, *patterns):
        it.wait(lambda screen: has(screen, *patterns))

    def assert_given_back(self, it):
        """As it was before: the screen, the cursor, the wrapping, the echo."""
        screen = it.screen
        self.assertEqual((screen.is_other, screen.has_cursor, screen.wraps), (False, True, True))
        self.assertEqual(termios.tcgetattr(it.slave), it.before)
        self.assertIn(b'\x1b[?1049h', it.bytes)

    def ends(self, it, code=0):
        self.assertEqual(it.finish(), code)
        self.assert_given_back(it)


def rows_of(screen, name):
    """The rows of a lane: its words, and the plot below them. None while the first picture is drawn, of which the
    terminal may pass on a part alone."""
    lines = screen.text().split('\n')
    axis = next((n for n, line in enumerate(lines) if ' ago ' in line), 0)
    first = next((n for n, line in enumerate(lines[:axis]) if line.startswith(name + ' ')), axis)
    last = next((n for n in range(first + 1, axis) if lines[n][:1].strip()), axis)
    return lines[first:last]


def plot_of(screen, name):
    """Its columns, each from the bottom up."""
    rows = [line.ljust(screen.columns)[GUTTER:] for line in rows_of(screen, name)[1:]]
    return [''.join(column) for column in zip(*reversed(rows))]


def foot_of(screen, name):
    """The lowest row of its plot."""
    return ''.join(column[0] for column in plot_of(screen, name))


class Picture(Case):
    def test_three_models_fit_80x24_with_a_lane_for_each_probe(self):
        sim = self.sim(f'{SEEN}fault')
        it = self.watch(f'{BUS} a16:9 --port {sim} --timeout 800')
        it.wait(lambda screen: has(screen, 'no response from a16:9 at ') and 'x' in foot_of(screen, 'a16:9'))
        self.shows(it, f'fathom watch {sim}   00:00:', r'a16:1 +1\.953 m +\d+\.\d/s +lost 0 of \d+$',
                   r'a05:2 probe 1 +1\.000 m +\d+\.\d/s +lost 0 of \d+$', r'a05:2 probe 2 +no target ',
                   r'a05:2 probe 3 +1\.500 m ', r'a05:2 probe 4 +4\.500 m ', r'hps167s:7 +fault ',
                   r'a16:9 +no response +0\.0/s +lost (\d+) of \1', r'.*\d s ago',
                   '- no target ~ interference s stale x no response ! unusable F fault P port lost$',
                   'no response from a16:9 at ')  # the advice of fathom read
        screen = it.screen
        self.assertEqual((screen.is_other, screen.has_cursor), (True, False))
        # Each has a scale in metres that its distances fit in.
        for name, scale in (('a16:1', '   2.0 m'), ('a05:2 probe 1', '   1.0 m'), ('a05:2 probe 4', '   5.0 m')):
            self.assertTrue(rows_of(screen, name)[1].startswith(scale))
        # What is no distance is to be seen in the plot, over its whole height.
        for name, mark in (('a05:2 probe 2', '-'), ('hps167s:7', 'F'), ('a16:9', 'x'), ('a16:1', FULL),
                           ('a05:2 probe 1', FULL), ('a05:2 probe 3', FULL)):
            columns = [column for column in plot_of(screen, name) if column.strip()]
            self.assertTrue(columns, name)
            for column in columns:
                self.assertEqual(column[0], mark, name)
                self.assertTrue(mark == FULL or set(column) == {mark}, name)

    def test_a_name_moves_what_stands_behind_it(self):
        long = 'n' * 31
        sims = [self.sim('hps167s --distance 2500'), self.sim('a05::modbus --distance 1000')]
        it = self.watch(f'gate=hps167s@{sims[0]} {long}=a05:1@{sims[1]}')
        # The longest has 39 columns, and two blanks stand behind it.
        self.shows(it, fr'{long} probe 4  1\.000 m ', r'gate {37}2\.500 m ')

    def test_a_bar_is_as_high_as_the_distance_on_its_scale(self):
        _, it = self.begin()
        it.wait(lambda screen: FULL in screen.text())
        # 24 rows less title, axis, legend, two of messages and the words: 18; 2.5 m of 5 m are 9. The newest
        # one stands at the right edge.
        bar = FULL * 9 + ' ' * 9
        it.wait(lambda screen: set(plot_of(screen, 'hps167s:1')) == {' ' * 18, bar} and
                plot_of(screen, 'hps167s:1')[-4:] == [bar] * 4)
        self.assertTrue(rows_of(it.screen, 'hps167s:1')[1].startswith('   5.0 m'))
        self.assertTrue(rows_of(it.screen, 'hps167s:1')[-1].startswith('     0 m'))

    def test_lost_responses_are_gaps_and_marks_between_the_bars(self):
        """Every third request is let pass."""
        device = self.device()
        it = self.watch(f'a16:1 --port {device} --timeout 500 --interval 300')
        for n in range(9):
            device.asked(e2e.ASK_A16, e2e.registers(1, 1000) if n % 3 != 2 else b'')
            it.wait(lambda screen: f'of {n + 1} ' in screen.text().replace('\n', ' \n'))
        self.assertRegex(it.screen.text(), r'lost 3 of 9')
        it.wait(lambda screen: foot_of(screen, 'a16:1').count('x') == 3)
        self.assertRegex(foot_of(it.screen, 'a16:1'), f'{FULL} *x *{FULL}+ *x *{FULL}+ *x')

    def test_what_has_fallen_silent_does_not_live_on(self):
        device = self.device()
        it = self.watch(f'a16 --port {device} --timeout 1500')
        it.wait(lambda screen: 'waiting' in screen.text())
        for _ in range(8):
            device.write(e2e.frame(1000))
            it.changes()
        it.wait(lambda screen: '1.000 m' in screen.text())
        it.wait(lambda screen: re.search(r'(?m)^a16 +stale ', screen.text()))
        it.wait(lambda screen: re.search(f'{FULL} {{2,}}s', foot_of(screen, 'a16')))

    @e2e.each(
        a_value_without_a_meaning=(e2e.registers(1, 0), '~ interference ? unknown s stale', 'unknown', '?'),
        another_master_that_reads_register_0200=(
            e2e.adu(1, 3, 2, 0, 0, 1), 'x no response m other master ! unusable', 'other master', 'm'))
    def rare_mark_is_in_the_legend_after_its_first_use(self, received, legend, word, mark):
        device = self.device()
        it = self.watch(f'a16:1 --port {device} --interval 300 --timeout 500')
        device.asked(e2e.ASK_A16, e2e.registers(1, 1000))
        it.wait(lambda screen: '1.000 m' in screen.text())
        self.assertNotIn(f'{mark} {word}', it.screen.text())
        device.asked(e2e.ASK_A16, received)
        it.wait(lambda screen: has(screen, f'.*{re.escape(legend)}', f'a16:1 +{word} ') and
                mark in foot_of(screen, 'a16:1'))
        self.assertNotIn('line busy', it.screen.text())

    def test_a_frame_in_which_a_probe_turns_odd_is_lost_for_all(self):
        device = self.device()
        it = self.watch(f'a05 --port {device}')
        it.wait(lambda screen: 'waiting' in screen.text())
        for _ in range(4):
            device.write(e2e.frame(1000, 2000, 3000, 4000))
            it.changes()
        it.wait(lambda screen: '3.000 m' in screen.text())
        device.write(e2e.frame(1000, 2000, 40000, 4000))
        self.shows(it, *(rf'a05 probe {probe} +unusable .* lost 1 of \d$' for probe in (1, 2, 3, 4)))

    def test_a_refused_value_is_its_probes_alone(self):
        device = self.device()
        it = self.watch(f'a05:1 --port {device}')
        device.read(8)
        device.write(e2e.registers(1, 1000, 40000, 3000, 4000))
        self.shows(it, 'a05:1 probe 1 +1.000 m ', 'a05:1 probe 2 +unusable .* lost 1 of 1$',
                   'a05:1 probe 3 +3.000 m ', 'a05:1 probe 4 +4.000 m ')


class Window(Case):
    def test_the_picture_follows_the_window(self):
        it = self.watch(f'{BUS} --port {self.sim(BUS)}')
        it.wait(lambda screen: FULL in screen.text())
        for rows, columns in ((50, 132), (10, 60), (24, 80)):
            it.resize(rows, columns)
            it.wait(lambda screen: ' now' in screen.text() and FULL in screen.text())
            lines = it.screen.text().split('\n')
            self.assertEqual(len(next(line for line in lines if ' ago ' in line)), columns)
            for name in ('a16:1', 'a05:2 probe 1', 'a05:2 probe 4', 'hps167s:7'):
                self.assertEqual(len([line for line in lines if line.startswith(name + ' ')]), 1, name)

    def test_a_small_window_shows_what_fits(self):
        it = self.watch(f'{BUS} --port {self.sim(BUS)}', rows=5, columns=40)
        it.wait(lambda screen: re.search(r'(?m)^a05:2 probe 3 +\d', screen.text()))
        self.assertIn('2 more: enlarge', it.screen.line(0))
        it.resize(1, 10)
        it.wait(lambda screen: screen.line(0).startswith('fathom'))
        it.type(b'\x03')
        self.ends(it)

    @e2e.each(**{f'without_utf8_in_the_locale_all_is_ascii_{number}': environment for number,
                 environment in enumerate((
        {'LC_ALL': 'C'}, {'LC_ALL': None, 'LC_CTYPE': None, 'LANG': None},
        {'LC_ALL': None, 'LC_CTYPE': 'de_DE', 'LANG': 'C.UTF-8'}))})
    def ascii(self, environment):
        _, it = self.begin(environment=environment)
        it.wait(lambda screen: '#' in screen.text())
        it.wait(lambda screen: set(plot_of(screen, 'hps167s:1')) == {' ' * 18, '#' * 9 + ' ' * 9})
        self.assertTrue(it.bytes.isascii())

    @e2e.each(colours_are_for_those_who_want_them=(None, {0, 1, 31, 33, 36}),
              colours_are_for_those_who_do_not_say=('', {0, 1, 31, 33, 36}),
              colours_are_not_for_those_who_want_none=('1', {0}))
    def colours(self, value, expected):
        _, it = self.begin(environment={'NO_COLOR': value})
        it.wait(lambda screen: FULL in screen.text())
        self.assertEqual(it.screen.colours, expected)


class End(Case):
    """However it ends, the terminal is as it was."""

    def begin(self, *arguments, **options):
        sim, it = super().begin(*arguments, **options)
        it.wait(lambda screen: FULL in screen.text())
        self.assertNotEqual(termios.tcgetattr(it.slave), it.before)
        return sim, it

    @e2e.each(ctrl_c='some keys, of which nothing is seen, and then \x03', q='q',
              a_big_q_among_others='some keys and Q and more', ctrl_z_and_ctrl_backslash_do_nothing='\x1a\x1c\x03')
    def key(self, keys):
        _, it = self.begin()
        it.wait(lambda screen: 'q or Ctrl-C ends' in screen.line(0))
        it.type(b'wetyuiop')
        it.changes()
        it.type(keys.encode())
        self.ends(it)
        self.assertNotIn('keys', it.screen.main)
        self.assertRegex(it.screen.main, r'^fathom: attempts \d+, failed 0, readings \d+\r\n')

    @e2e.each(**{f'signals_{number.name}': number
                 for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)})
    def signals(self, number):
        _, it = self.begin()
        it.send(number)
        self.ends(it)

    def test_a_signal_ends_it_at_a_terminal_that_takes_nothing(self):
        """Ctrl-S: nothing can be written before Ctrl-Q, neither the rest of the picture nor a summary."""
        _, it = self.begin()
        it.type(b'\x13')
        while e2e.is_ready(it.master, 0.5):
            it.take()
        it.send(signal.SIGTERM)
        self.assertTrue(e2e.is_ready(it.pidfd, 5))
        self.assertEqual(termios.tcgetattr(it.slave), it.before)
        self.assertEqual(it.finish(), 1)

    def test_the_time_that_was_asked_for(self):
        self.ends(self.begin('--duration 2')[1])

    def test_a_lost_port(self):
        sim, it = self.begin()
        sim.end()
        self.ends(it, 1)
        self.assertIn('Connect it again and start again', it.screen.main)

    @e2e.each(that_is_not_there=('a16 --port /nowhere', 'fathom: /nowhere: no such device'),
              that_cannot_hold_its_tx=('a16 --value real-time --port {}', 'a16: this port cannot hold its TX low'))
    def port(self, line, said):
        it = self.watch(line.format(self.device()))
        self.ends(it, 1)
        self.assertIn(said, it.screen.main)


class Ports(Case):
    """Several ports in one picture."""

    def begin(self, options=''):
        self.link = self.path('lost')
        lost = self.sim(f'hps167s --distance 2500 --link {self.link}')
        fine = self.sim('hps167s --distance 2000')
        it = self.watch(f'lost=hps167s@{self.link} fine=hps167s@{fine} {options}')
        it.wait(lambda screen: FULL in screen.text() and FULL in foot_of(screen, 'lost') and
                FULL in foot_of(screen, 'fine'))
        self.shows(it, rf'fathom watch lost, {os.path.basename(str(fine))}   00:00:\d\d   q or Ctrl-C ends$')
        return lost, it

    def test_a_lost_port_marks_its_lanes_only(self):
        lost, it = self.begin('--reconnect')
        lost.end()
        it.wait(lambda screen: 'P' in foot_of(screen, 'lost') and has(screen, '.*Waiting until it is back'))
        for _ in range(8):
            it.changes()
        self.shows(it, 'lost +port lost ', r'fine +2\.000 m .* lost 0 of ', '.* now$')  # a whole picture
        self.assertNotIn('P', foot_of(it.screen, 'fine'))
        self.sim(f'hps167s --distance 1500 --link {self.link}')
        self.shows(it, r'lost +1\.500 m ', '.*it is back')
        it.type(b'q')
        self.ends(it, 1)

    def test_what_was_said_of_a_lost_port_stands_there_after_the_end(self):
        lost, it = self.begin()
        lost.end()
        self.shows(it, 'lost +port lost ')
        it.type(b'q')
        self.ends(it, 1)
        self.assertIn(f'fathom: {self.link}: ', it.screen.main)
        self.assertIn('Connect it again and start again', it.screen.main)


class Lines(Case):
    ends = e2e.Case.ends

    def test_into_a_pipe_go_plain_lines_one_a_second(self):
        sim = self.sim(f'{SEEN}2500')
        done = self.ends(f'watch {BUS} --port {sim} --duration 4', 0)
        self.assertNotIn('\x1b', done.out + done.err)
        lines = done.out.splitlines()
        self.assertIn(len(lines), (3, 4, 5))
        times = [float(line.split()[0]) for line in lines]
        self.assertTrue(all(0.5 < later - before < 2.5 for before, later in zip(times, times[1:])), times)
        told = ('a16:1 1.953 m', 'a05:2 probe 1 1.000 m', 'a05:2 probe 2 no target', 'a05:2 probe 3 1.500 m',
                'a05:2 probe 4 4.500 m', 'hps167s:7 2.500 m')
        lanes = ''.join(rf'  {re.escape(one)} \d\.\d/s' for one in told)
        self.assertRegex(lines[-1], rf'^ +\d\.\d s{lanes}$')

    def test_the_rate_is_that_of_the_readings(self):
        done = self.ends(f'watch a16 --port {self.sim("a16 --distance 1000")} --duration 6', 0)
        rate = re.search(r'a16 1\.000 m ([\d.]+)/s$', done.out.splitlines()[-1])
        # It sends every 100 ms; a machine under load makes it less.
        self.assertTrue(5 < float(rate[1]) <= 11, rate)

    def test_probes_that_are_left_out_have_no_lane_and_values_have_their_meaning(self):
        sim = self.sim('a05 --distance 0,1000,7000,no-target')
        done = self.ends(f'watch a05 --port {sim} --duration 3 --probes 1,2,4 --means fffd=too-near', 0)
        self.assertRegex(done.out.splitlines()[-1], r' s  a05 probe 1 unknown \d\.\d/s  a05 probe 2 1\.000 m '
                         r'\d\.\d/s  a05 probe 4 too near \d\.\d/s$')

    def test_losses_are_in_the_lines_and_advice_is_given_once(self):
        done = self.ends(f'watch a16:1 --port {self.device()} --timeout 200 --duration 3', 1)
        self.assertRegex(done.out.splitlines()[-1], r'  a16:1 no response 0\.0/s lost (\d+) of \1$')
        self.assertEqual(done.err.count('no response from a16:1 at '), 1, done.err)

    @e2e.each(a_terminal_that_can_do_nothing_gets_lines_too='dumb',
              a_terminal_that_is_not_told_gets_lines_too='')
    def dumb(self, kind):
        _, it = self.begin(environment={'TERM': kind})
        it.wait(lambda screen: 'hps167s:1 2.500 m' in screen.main)
        it.type(b'\x03')
        self.assertEqual(it.finish(), 0)
        self.assertNotIn(b'\x1b', it.bytes)

    def test_output_that_is_not_read_ends_it(self):
        sim = self.sim('hps167s --distance 2500')
        out, pipe = os.pipe()
        watch = self.fathom(f'watch hps167s --port {sim}', stdout=pipe)
        os.close(pipe)
        self.assertIn(b'hps167s:1', os.read(out, 4000))
        os.close(out)
        self.ends(watch, 1)

    def test_a_full_disk_is_said(self):
        sim = self.sim('hps167s --distance 2500')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'watch hps167s --port {sim}', 1,
                      'the picture cannot be written: No space left on device',
                      stdout=full)


if __name__ == '__main__':
    e2e.main()
