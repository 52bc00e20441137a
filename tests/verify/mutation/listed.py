# SPDX-License-Identifier: MIT
"""Which mutants survivors.py lists. A row is found by the tokens of its identity; and if what is local to the function
has been renamed since, by the same tokens with other names."""
import re

import survivors
from mutants import TOKEN, tokens

NAME = re.compile(r'[A-Za-z_]\w*')


def is_renamed(row, mutant):
    """Do the tokens of a row become a mutant's when names that are local to its function take the place of others?"""
    before, after = TOKEN.findall(row), TOKEN.findall(mutant.identity)
    if len(before) != len(after):
        return False
    others = {}
    for number, (old, new) in enumerate(zip(before, after)):
        is_member = number > 0 and after[number - 1] in ('.', '->')
        is_local = new in mutant.names and not is_member
        if not is_local and old != new:
            return False
        if is_local and (not NAME.fullmatch(old) or others.setdefault(old, new) != new):
            return False
    gone = {old for old, new in others.items() if old != new}
    return not gone & mutant.names and len(set(others.values())) == len(others)


class Listed:
    def __init__(self, mutants):
        self.keys = set()
        self.gone = []  # rows of which no mutant is made any more
        by_key = {tokens(mutant.identity) for mutant in mutants}
        seen, missing = set(), []
        for _, *identities in survivors.ROWS:
            for identity in identities:
                key = tokens(identity)
                if key in seen:
                    raise SystemExit(f'survivors.py has this twice: {identity}')
                seen.add(key)
                if key in by_key:
                    self.keys.add(key)
                else:
                    missing.append(identity)
        for identity in missing:
            place = identity.split(' | ')[:2]
            found = [tokens(mutant.identity) for mutant in mutants if [mutant.file, mutant.function] == place and
                     tokens(mutant.identity) not in self.keys and is_renamed(identity, mutant)]
            if len(found) == 1:
                self.keys.add(found[0])
            else:
                self.gone.append(identity)

    def __contains__(self, mutant):
        return tokens(mutant.identity) in self.keys
