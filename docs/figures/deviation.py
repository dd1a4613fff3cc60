"""How far a trace strays from its meridian of a torus around the z axis over one full turn.

deviation.py TRACE.csv RADIUS: RADIUS is that of the torus' centre circle.
"""
import csv
import sys
from math import atan2, degrees, hypot

turn = worst = 0.0
start = before = None
with open(sys.argv[1]) as file:
    for row in csv.DictReader(file):
        x, y, z = (float(row[axis]) for axis in "xyz")
        # The meridian is a place around the axis; the way along it an angle around the tube.
        meridian = degrees(atan2(y, x))
        tube = degrees(atan2(z, hypot(x, y) - float(sys.argv[2])))
        if start is None:
            start = meridian
        else:
            turn += (tube - before + 180) % 360 - 180
        before = tube
        worst = max(worst, abs((meridian - start + 180) % 360 - 180))
        if abs(turn) >= 360:
            break
if abs(turn) < 360:
    sys.exit(f"the trace ends after {abs(turn):.1f} degrees of a turn")
print(f"{row['step']} steps, {abs(turn):.1f} degrees around the tube: "
      f"at most {worst:.2f} degrees off the meridian")
