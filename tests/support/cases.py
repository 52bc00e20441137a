# SPDX-License-Identifier: MIT
"""The cases of a script: its functions test_..., run one after the other."""
import sys


def run(script):
    """script: its globals(). Does not come back."""
    failed = 0
    tests = [(name, test) for name, test in list(script.items()) if name.startswith('test_')]
    for name, test in tests:
        try:
            test()
            print('ok', name)
        except (AssertionError, SystemExit) as error:
            failed += 1
            print('FAILED', name, error)
    print(f'{len(tests) - failed} passed, {failed} failed')
    sys.exit(1 if failed else 0)
