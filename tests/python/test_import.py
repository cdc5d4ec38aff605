"""Importing the package, and leaving Python with worlds that still live."""

import inspect
import subprocess
import sys


def run(program: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Runs a program in a new Python."""
    return subprocess.run([sys.executable, *options, "-c", program], capture_output=True, text=True, timeout=120)


def test_the_package_imports_without_a_warning() -> None:
    done = run("import skerry", "-X", "dev", "-W", "error")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_the_import_loads_no_optional_package() -> None:
    optional = {"h5py", "meshio", "pyvista", "IPython", "gmsh", "gymnasium", "matplotlib", "pandas", "scipy"}
    done = run("import sys, skerry; print(*{name.partition('.')[0] for name in sys.modules})")
    assert done.returncode == 0
    assert not optional & set(done.stdout.split())


def test_every_public_class_and_function_is_documented() -> None:
    import skerry

    public = [getattr(skerry, name) for name in skerry.__all__]
    assert sum(map(inspect.isclass, public)) > 20
    assert [found for found in public if inspect.isroutine(found) or inspect.isclass(found) if not found.__doc__] == []


def test_python_ends_silently_with_a_living_world() -> None:
    # nanobind reports objects that outlive the module, and references that were lost.
    done = run("import skerry\nworld = skerry.World()\nworld.add_body(skerry.Mesh.ball(0.1, 4), skerry.Material())\n")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
