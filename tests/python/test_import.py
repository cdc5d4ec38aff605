"""Importing the package, and leaving Python with worlds that still live."""

import dataclasses
import inspect
import pathlib
import re
import subprocess
import sys


def run(program: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Runs a program in a new Python."""
    return subprocess.run([sys.executable, *options, "-c", program], capture_output=True, text=True, timeout=120)


def test_the_package_imports_without_a_warning() -> None:
    done = run("import skerry", "-X", "dev", "-W", "error")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_the_import_loads_no_optional_package() -> None:
    optional = {"h5py", "meshio", "pyvista", "IPython", "gmsh", "gymnasium", "mujoco", "matplotlib", "pandas", "scipy"}
    done = run("import sys, skerry; print(*{name.partition('.')[0] for name in sys.modules})")
    assert done.returncode == 0
    assert not optional & set(done.stdout.split())


def test_every_public_class_and_function_is_documented() -> None:
    import skerry

    public = [getattr(skerry, name) for name in skerry.__all__]
    assert sum(map(inspect.isclass, public)) > 20
    assert [found for found in public if inspect.isroutine(found) or inspect.isclass(found) if not found.__doc__] == []


def test_the_docstring_of_a_record_names_its_fields() -> None:
    import skerry

    records = [kind for name in skerry.__all__ if dataclasses.is_dataclass(kind := getattr(skerry, name))]
    assert len(records) > 30
    for record in records:
        for field in dataclasses.fields(record):
            assert re.search(rf"^ *{field.name}: \S", inspect.getdoc(record) or "", re.MULTILINE), (record, field.name)
    for record in (skerry.Material, skerry.Settings, skerry.Motor, skerry.JointState, skerry.StepReport, skerry.Sphere):
        assert "[" in (record.__doc__ or ""), record


def test_the_docstring_of_a_new_world_names_the_settings() -> None:
    import skerry

    for field in dataclasses.fields(skerry.Settings):
        assert re.search(rf"^ *{field.name}: ", skerry.World.__init__.__doc__ or "", re.MULTILINE), field.name


def test_the_version_is_that_of_the_source() -> None:
    import skerry

    source = pathlib.Path(__file__).resolve().parents[2] / "CMakeLists.txt"
    found = re.search(r"project\(skerry VERSION ([0-9.]+)", source.read_text())
    assert found and skerry.__version__ == found[1]


def test_python_ends_silently_with_a_living_world() -> None:
    # nanobind reports objects that outlive the module, and references that were lost.
    done = run("import skerry\nworld = skerry.World()\nworld.add_body(skerry.Mesh.ball(0.1, 4), skerry.Material())\n")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
