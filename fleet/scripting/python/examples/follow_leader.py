"""The first vehicle leads along a square, each other one follows to where the one before it was: follow_leader.py [STEPS]

Wants fleet.assignment: in_order, so that points go to vehicles in the order of the experiment file.
"""

import sys

from roundabout import Fleet

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 8
STEP_M = 1.3
HEIGHT_M = 1.0


def square():
    """Way points along a square of two steps a side, for ever."""
    x, y = 0.0, 0.0
    while True:
        for dx, dy in ((1, 0), (1, 0), (0, 1), (0, 1), (-1, 0), (-1, 0), (0, -1), (0, -1)):
            x, y = x + dx * STEP_M, y + dy * STEP_M
            yield (x, y, HEIGHT_M)


with Fleet() as fleet:
    fleet.take_off()
    names = list(fleet.states())
    places = [(-i * STEP_M, 0.0, HEIGHT_M) for i in range(len(names))]
    fleet.formation(places, name="line")
    for _, point in zip(range(steps), square()):
        places = [point] + places[:-1]
        fleet.formation(places, name="follow")
        x, y, _ = fleet.states()[names[0]].position
        print(f"{names[0]} leads at ({x:.1f}, {y:.1f})", flush=True)
    fleet.land()
