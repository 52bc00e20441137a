# SPDX-License-Identifier: MIT
"""Tries mutants: which test sees each of them."""
import collections
import concurrent.futures
import dataclasses
import json
import os
import queue
import tempfile
import time

from bench import IN_REAL_TIME, ROOT

QUICK_S = 0.3  # tests that take longer run last, on optimised code, if that is not the same as without the mutant
NOT_C, SAME_CODE, KILLED, SURVIVED = 'not C', 'same code', 'killed', 'survived'


@dataclasses.dataclass
class Result:
    mutant: object
    status: str
    killer: str = ''
    how: str = ''
    tests: int = 0
    seconds: float = 0


class Trial:
    def __init__(self, bench, is_brief=lambda mutant: False):
        self.bench = bench
        self.is_brief = is_brief  # without the slow tests
        self.texts = {}
        self.kills = collections.Counter()  # by test, (test, file) and (test, file, function)
        self.path = os.path.join(bench.folder, 'killers.json')  # of the runs before, by identity
        self.known = {}
        if os.path.exists(self.path):
            with open(self.path, encoding='utf-8') as file:
                self.known = json.load(file)

    def keep(self):
        with open(self.path, 'w', encoding='utf-8') as file:
            json.dump(self.known, file)

    def text_of(self, path):
        if path not in self.texts:
            with open(os.path.join(ROOT, path), encoding='ascii') as file:
                self.texts[path] = file.read()
        return self.texts[path]

    def order(self, mutant, tests):
        """The likeliest first, for the time that they take."""
        stem = os.path.basename(mutant.file)[:-2]
        known = self.known.get(mutant.identity)

        def worth(test):
            likely = (0.02 + 4 * self.kills[test, mutant.file, mutant.function] + self.kills[test, mutant.file]
                      + 0.01 * self.kills[test] + 2 * (stem in str(test)) + 1000 * (known == str(test)))
            return likely / (self.bench.seconds[test] + 0.01)
        return sorted(tests, key=lambda test: (-worth(test), test))

    def same_code(self, mutant, scratch):
        """(Is the optimised object the same as without the mutant?, what to run if not)"""
        before = self.bench.originals.get(mutant.file)
        if before is None:
            before = self.bench.contents(self.bench.compile(mutant, self.text_of(mutant.file), scratch, ['-O2']))
            self.bench.originals[mutant.file] = before
        objects = self.bench.compile(mutant, mutant.applied(self.text_of(mutant.file)), scratch, ['-O2'])
        if self.bench.contents(objects) == before:
            return True, None
        return False, self.bench.plant(objects, scratch)

    def kill(self, test, planted):
        how = self.bench.run(test, planted, *self.bench.limits_s(test))[0]
        if how and test.kind in IN_REAL_TIME:
            how = self.bench.run(test, planted, *self.bench.limits_s(test))[0]
        return how

    def attempt(self, mutant, scratch):
        began = time.monotonic()
        objects = self.bench.compile(mutant, mutant.applied(self.text_of(mutant.file)), scratch, ['-O0'])
        if objects is None:
            return Result(mutant, NOT_C)
        planted = self.bench.plant(objects, scratch)
        tests = self.order(mutant, self.bench.reached_by(mutant))
        first = tests[:1] + [test for test in tests[1:] if self.is_quick(test)]
        rest = [] if self.is_brief(mutant) else [test for test in tests if test not in first]
        count = 0
        for optimised in (False, True):
            if optimised:
                same, planted = self.same_code(mutant, scratch)
                if same:
                    return Result(mutant, SAME_CODE)
            for test in rest if optimised else first:
                count += 1
                how = self.kill(test, planted)
                if how:
                    for key in (test, (test, mutant.file), (test, mutant.file, mutant.function)):
                        self.kills[key] += 1
                    self.known[mutant.identity] = str(test)
                    return Result(mutant, KILLED, str(test), how, count, time.monotonic() - began)
        return Result(mutant, SURVIVED, tests=count, seconds=time.monotonic() - began)

    def is_quick(self, test):
        return self.bench.seconds[test] < QUICK_S and test.kind not in IN_REAL_TIME

    def attempt_all(self, mutants):
        """The results, as they come."""
        done = queue.SimpleQueue()
        rest = queue.SimpleQueue()
        for mutant in mutants:
            rest.put(mutant)

        def work():
            with tempfile.TemporaryDirectory(prefix='fathom-mutants.') as scratch:
                while True:
                    try:
                        mutant = rest.get_nowait()
                    except queue.Empty:
                        return
                    try:
                        done.put(self.attempt(mutant, scratch))
                    except Exception as error:  # of this program: raised where the result is waited for
                        done.put(error)
                        return
        with concurrent.futures.ThreadPoolExecutor(self.bench.jobs) as pool:
            for _ in range(self.bench.jobs):
                pool.submit(work)
            try:
                for _ in mutants:
                    result = done.get()
                    if isinstance(result, Exception):
                        raise result
                    yield result
            finally:
                while not rest.empty():
                    rest.get_nowait()
                self.keep()
