"""The library shows nothing but what its public headers declare: names of other packages that it showed would be mixed
with those of a host, which were compiled otherwise.

exported_names_test.py NM STATIC SHARED VERSION"""
import re
import subprocess
import sys

NM, STATIC, SHARED, VERSION = sys.argv[1:]


def names(*arguments):
    text = subprocess.run([NM, "--defined-only", "--extern-only", "-C", *arguments], text=True, check=True,
                          capture_output=True).stdout
    return [line.split(" ", 2)[2] for line in text.splitlines() if re.match(r"^[0-9a-f]+ \w ", line)]


def main():
    public = re.compile(r"^((typeinfo|typeinfo name|vtable) for )?skerry::")
    # Internal names of the library.
    internal = re.compile(r"^skerry::(World(State|Access)|Executor|TaskGraph|Model|\(anonymous)|nlohmann|"
                          r"Eigen::(?!Matrix<double, 3, [13], 0, 3, [13]>)")
    failures = []
    for what, found in (("static", names(STATIC)), ("shared", names("-D", SHARED))):
        print(f"{what}: {len(found)} names")
        if not any(name.startswith("skerry::World::advance(") for name in found):
            failures.append(f"{what}: World::advance is not there")
        failures += [f"{what}: {name}" for name in found if not public.match(name) or internal.search(name)]
    dynamic = subprocess.run(["readelf", "-d", SHARED], text=True, check=True, capture_output=True).stdout
    soname = f"libskerry.so.{'.'.join(VERSION.split('.')[:2])}"
    if f"[{soname}]" not in dynamic:
        failures.append(f"shared: no SONAME {soname}")
    print(*failures, sep="\n")
    return 1 if failures else 0


sys.exit(main())
