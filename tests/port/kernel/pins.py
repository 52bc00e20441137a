# SPDX-License-Identifier: MIT
"""The lines of a GPIO chip in QEMU, seen and set from outside by qtest (QEMU, docs/devel/qtest.rst); and what an A16
plays on them. Times are the host's: a busy one makes pulses longer."""
import queue
import socket
import threading
import time


class Pins:
    def __init__(self, path):
        """QEMU connects to the path when it starts."""
        self.server = socket.socket(socket.AF_UNIX)
        self.server.bind(path)
        self.server.listen(1)
        self.device, self.link = None, None
        self.lock, self.answers = threading.Lock(), queue.Queue()
        self.trigger = None
        self.triggers = queue.Queue()
        self.play = None  # what follows a falling edge of the trigger

    def begin(self, device):
        self.server.settimeout(10)
        self.link = self.server.accept()[0]
        self.device = device
        for run in (self.listen, self.perform):
            threading.Thread(target=run, daemon=True).start()
        self.order(f'irq_intercept_out {device}')

    def listen(self):
        for line in self.link.makefile(encoding='ascii'):
            words = line.split()
            if words[0] != 'IRQ':
                self.answers.put(line)
                continue
            number, level = int(words[2]), int(words[1] == 'raise')
            if number == self.trigger and level == 0:
                self.triggers.put(None)

    def perform(self):
        while True:
            self.triggers.get()
            if self.play is not None:
                self.play()
            self.triggers.task_done()

    def order(self, text):
        with self.lock:
            self.link.sendall(text.encode() + b'\n')
            answer = self.answers.get(timeout=10)
        if not answer.startswith('OK'):
            raise RuntimeError(f'{text}: {answer}')

    def set(self, line, level):
        self.order(f'set_irq_in {self.device} unnamed-gpio-in {line} {level}')

    def pulse(self, line, width_s):
        self.set(line, 1)
        time.sleep(width_s)
        self.set(line, 0)

    def bounce(self, line, level):
        """To the level, and back and to it again, three times."""
        for _ in range(3):
            for one in (level, 1 - level):
                self.set(line, one)
                time.sleep(0.0002)

    def a16(self, line, kind, width_s):
        """What an A16 with PWM output sends after each trigger: a pulse; one whose edges bounce; a level that stays
        high; or nothing. Returns when no response of the former kind can follow: a late one would overwrite the level
        that the test sets next."""
        def play():
            time.sleep(0.005)  # the datasheet's 110 ms are no promise
            if kind == 'bounce':
                self.bounce(line, 1)
                self.pulse(line, width_s)
                self.bounce(line, 0)
                self.set(line, 0)
            elif kind == 'high':
                self.set(line, 1)
            elif kind == 'pulse':
                self.pulse(line, width_s)
        self.play = play if kind != 'nothing' else None
        self.triggers.join()
