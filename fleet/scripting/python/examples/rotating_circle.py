"""Everybody on a circle that turns: rotating_circle.py [STEPS]. Wants fleet.assignment: in_order."""

import math
import sys

from roundabout import Fleet

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 12
RADIUS_M = 1.6
STEP_RAD = math.radians(30.0)


def circle(count, turned_rad):
    angles = [turned_rad + 2.0 * math.pi * i / count for i in range(count)]
    return [(RADIUS_M * math.cos(a), RADIUS_M * math.sin(a), 1.0) for a in angles]


with Fleet() as fleet:
    fleet.take_off()
    count = len(fleet.states())
    for step in range(steps):
        fleet.formation(circle(count, step * STEP_RAD), name="circle")
        print(f"turned by {math.degrees(step * STEP_RAD):.0f} degrees", flush=True)
    fleet.land()
