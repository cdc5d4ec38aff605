#!/usr/bin/env python3
"""Writes docs/stress.md from the records of the stress tests: stress_table.py FOLDER OUTPUT. The page lists the
criterion of each item, FOLDER/stress.csv has all checks."""
import pathlib
import sys

from records import rows_of, write_csv

HEADER = """# Stress

This page lists extreme inputs that the engine withstands. `scripts/stress` runs the tests tagged `[stress]`, writes
this page, and lists all {checks} checks in `build/stress/stress.csv`. {failed} failed.

In all tests the engine takes each step or refuses it with a message, the state stays finite, no scene gains more than
a hundredth of its energy, and the report counts unsolved contact regions. Bold numbers are the items of that file;
item 0 has problems reported by users of other engines.

"""
COLUMNS = ["item", "scene", "criterion", "found", "passed", "file", "test"]

CRITERIA = """- **1**: A block of 1 t on a block of 1 g comes to rest without penetration.
- **2**: Of bodies with Young's moduli from 1e3 to 1e9 Pa, the report names that with the shortest stable step.
- **3**: For Poisson's ratios up to 0.4999 a body's volume changes by at most 1 %.
- **4**: In a mesh with slivers (altitude 1e-4 of an edge length) the engine's step is 0.5 to 1 times the exact
  stability limit.
- **5**: A body recovers from inversion of a fifth of its elements.
- **6**: A body collapsed to a point, line or plane recovers its shape, or at least stays finite.
- **7**: A `step_size` of 2 or 10 times the stability limit is shortened, and the report says so.
- **8**: A sheet with one layer of elements stops a ball that flies at 100 m/s.
- **9**: A body that starts half inside another body leaves it with at most twice the
  [push-out](glossary.md) speed.
- **10**: If every contact occurs a hundred times, the motion stays the same.
- **11**: Contact search ignores triangles without area and edges without length.
- **12**: Without friction, solving for normal and tangential impulses gives the same result as for normal ones only.
- **13**: A block with the friction coefficient 1000 does not slide on a slope of 50 degrees.
- **14**: Stacks with restitution 0, 0.5 or 1 gain at most 1 % energy.
- **16, 17**: The contact solver converges for one region of 100,000 contacts, and for 100,000 regions of one contact.
- **18**: Values that are NaN or out of range are refused; the message names object and field.
- **19**: A stack of twenty bodies stands.
- **20**: Bodies that rest for a long time neither drift nor gain energy.
- **21**: A sheet pinched between two plates stays still and flat.
- **22**: Regions of jammed contacts with friction coefficient 3 are solved or flagged.
- **23**: The contact solver converges for contacts of 10,000 points with one triangle.
- **24**: Worlds that are empty, at rest, or of one tetrahedron advance.
- **25**: A body is pressed to a tenth of its height. The report counts inverted elements.
- **26**: A box rests 1e6 m from the origin. At 1e9 m steps are refused, because coordinates are too coarse
  ([time_stepping](methods/time_stepping.md) 4.3).
- **27**: Denormal floating-point velocities become zero and do not slow down computation.
- **28**: With fixed `step_size`, adding or removing bodies leaves bodies without contact bitwise unchanged.
- **29**: A cube is crushed to a fifth of its height, then released.
- **30**: A ball shot at a wall at 30 m/s flies back.
- **31**: A ball is pressed through a hole of half its diameter and falls out.

In items 29 to 31 no step is refused. At the end no element is inverted, and nodes are within a hundredth of an edge
length of the undeformed shape.

Item 20 uses `tolerance` 1e-8 or `sleep`. Without `sleep` a heap can creep in each step by `tolerance` times the
distance that it would fall without contacts.
"""


def main(folder, output):
    rows = rows_of(folder)
    write_csv(pathlib.Path(folder) / "stress.csv", COLUMNS,
              ([row["item"], row["what"], row["criterion"], row["found"], row["held"], row["file"], row["test"]]
               for row in rows))
    failed = sum(not row["held"] for row in rows)
    pathlib.Path(output).write_text(HEADER.format(checks=len(rows), failed=failed) + CRITERIA)
    print(f"{len(rows)} checks in {output}, {failed} failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
