"""Spells a word: spell.py [WORD]"""

import sys

from roundabout import Fleet

word = sys.argv[1] if len(sys.argv) > 1 else "HI"
with Fleet() as fleet:
    fleet.take_off()
    for letter in word:
        fleet.spell(letter, seconds=1.0)
        print(f"{letter} is formed", flush=True)
    fleet.land()
