#!/usr/bin/env python3
"""Reams a cup with reamers of 47, 48, 49 and 50 mm, and prints force and volume of each; the surface goes to a file.

    python3 four_reamers.py bone.stl
"""

import sys

import osteon  # before numpy: it says how to get numpy where there is none

import numpy as np

bone = osteon.Bone("acetabulum")
session = None
for diameter_mm in (47, 48, 49, 50):
    tool = osteon.Tool("reamer", 1e-3 * diameter_mm)
    free = bone.approach(0.0)  # the apex at the site's centre: free of bone
    if session is None:
        session = osteon.Session(bone, tool, lockstep=True)
        session.step(free)
    else:
        session.mark()
        session.change_tool(tool, free)
    before = session.figures["removed_volume_m3"]
    largest_N = 0.0
    for height_m in np.arange(-0.016, -0.0255, -4e-6):  # the hand feeds 4 mm/s
        X_GT = bone.approach(height_m)
        session.step(X_GT, tool.spindle_rad_per_s, 0.001)
        largest_N = max(largest_N, float(np.linalg.norm(session.evaluate(X_GT)[:3])))
    removed_mm3 = 1e9 * (session.figures["removed_volume_m3"] - before)
    print(f"{diameter_mm} mm: up to {largest_N:5.1f} N, {removed_mm3:7.1f} mm3")
    for height_m in np.arange(-0.0255, 0.0, 1e-4):  # back out
        session.step(bone.approach(height_m), 0.0, 0.001)
if len(sys.argv) > 1:
    print(session.export_surface(sys.argv[1]))
