"""Checks an installed wheel of the Python package, and prints its size and how long it takes to import.

check_wheel.py WHEEL    run by the Python that the wheel was installed for"""
import pathlib
import re
import subprocess
import sys
import zipfile

WHEEL = pathlib.Path(sys.argv[1])
# CivetWeb, which the wheel contains, and libraries of every system with glibc. The policies of manylinux include zlib.
EXPECTED = re.compile(r"libcivetweb-[0-9a-f]+\.so\.[0-9.]+|"
                      r"(linux-vdso|libc|libm|libpthread|libstdc\+\+|libgcc_s|libz|.*/ld-linux-x86-64)\.so\.\d+")


def needed(library):
    text = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout
    return [line.split()[0] for line in text.splitlines()]


def import_times():
    """Milliseconds to import skerry, and NumPy within it: the fastest of five runs."""
    def once():
        text = subprocess.run([sys.executable, "-I", "-X", "importtime", "-c", "import skerry"], capture_output=True,
                              text=True, check=True).stderr
        times = {name: int(total) / 1000 for total, name in re.findall(r"\|\s*(\d+) \| +(skerry|numpy)\n", text)}
        return times["skerry"], times.get("numpy", 0)
    return min(once() for _ in range(5))


def main():
    import skerry

    folder = pathlib.Path(skerry.__file__).parent
    if "site-packages" not in folder.parts:
        sys.exit(f"skerry: found {folder}, expected the installed wheel")
    libraries = [path for folder in folder.parent.glob("skerry*") for path in folder.rglob("*.so*")]
    foreign = [f"{path.name}: found {name}" for path in libraries for name in needed(path)
               if not EXPECTED.fullmatch(name)]
    if foreign or not libraries:
        sys.exit("\n".join(foreign) + "\nexpected libraries of the system, and CivetWeb")
    with zipfile.ZipFile(WHEEL) as archive:
        unpacked = sum(entry.file_size for entry in archive.infolist())
    total, numpy = import_times()
    print(f"{WHEEL.name}: {WHEEL.stat().st_size / 1e6:.1f} MB, {unpacked / 1e6:.1f} MB unpacked; "
          f"import {total:.0f} ms, of these NumPy {numpy:.0f} ms")


if __name__ == "__main__":
    main()
