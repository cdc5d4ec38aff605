#!/usr/bin/env python3
"""Prints how long the last build of a folder took to compile and to link, and its three slowest sources: reads the log
of ninja, whose times are by the clock.

    build_times.py BUILD_FOLDER SINCE    SINCE: when the build began, in seconds since the epoch
"""
import pathlib
import re
import sys

COMPILED = re.compile(r"\.o$|\.gch$")
LINKED = re.compile(r"kernels_[^/]*\.o$|/?skerry\.o$|\.a$|\.so[.0-9]*$|^[^.]*$")


def main():
    folder, since = pathlib.Path(sys.argv[1]), float(sys.argv[2])
    edges = {}
    for line in (folder / ".ninja_log").read_text().splitlines()[1:]:
        start, end, changed, output, key = line.split("\t")
        if int(changed) / 1e9 >= since:
            edges[key, start, end] = (int(end) - int(start)) / 1000, output
    linked = [seconds for seconds, output in edges.values() if LINKED.search(output)]
    compiled = sorted(((seconds, output) for seconds, output in edges.values()
                       if COMPILED.search(output) and not LINKED.search(output)), reverse=True)
    print(f"    {len(compiled)} sources compiled in {sum(s for s, _ in compiled):.0f} s, "
          f"{len(linked)} files linked in {sum(linked):.0f} s, added up by the clock of each")
    slowest = (f"{output.replace('CMakeFiles/', '').replace('.dir', '')} {seconds:.0f} s"
               for seconds, output in compiled[:3])
    if compiled:
        print(f"    slowest: {', '.join(slowest)}")


if __name__ == "__main__":
    main()
