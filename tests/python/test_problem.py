"""Contact problems: their arrays, files and solutions."""

import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from skerry import _core, _problem
from worlds import ball_world

W = np.array(
    [
        [2.0, 0.1, 0, 0, 0, 0, 0.3, 0, 0],
        [0.1, 2.0, 0, 0, 0, 0, 0, 0.2, 0],
        [0, 0, 2.0, 0, 0, 0, 0, 0, 0.1],
        [0, 0, 0, 1.0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 1.0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 1.0, 0, 0, 0],
        [0.3, 0, 0, 0, 0, 0, 3.0, 0, 0],
        [0, 0.2, 0, 0, 0, 0, 0, 3.0, 0],
        [0, 0, 0.1, 0, 0, 0, 0, 0, 3.0],
    ]
)
Q = np.array([[-1, 0.2, 0], [-2, 5, 0], [-1, 0, 0.1]])
MU = [0.5, 0.2, 0.8]
"""Three contacts, of which the first and the last are coupled. The second slides."""


def test_a_dense_matrix_becomes_blocks_without_zeros() -> None:
    problem = sk.Problem.from_dense(W, Q, MU, name="three")
    assert problem.row_offset.tolist() == [0, 2, 3, 5]
    assert problem.column.tolist() == [0, 2, 1, 0, 2]
    assert problem.block[0].tolist() == W[:3, :3].tolist() and problem.block[3].tolist() == W[6:, :3].tolist()
    assert problem.q.tolist() == Q.tolist() and problem.mu.tolist() == MU
    assert len(problem) == 3 and repr(problem) == "<skerry.Problem 'three', 3 contacts, 5 blocks>"
    again = sk.Problem(problem.row_offset, problem.column, problem.block, Q, MU, name="three")
    assert again == problem and pickle.loads(pickle.dumps(problem)) == problem
    assert sk.Problem.from_dense(W, Q.ravel(), 0.5).mu.tolist() == [0.5, 0.5, 0.5]


def test_the_arrays_of_a_problem_cannot_be_changed() -> None:
    problem = sk.Problem.from_dense(W, Q, MU)
    with pytest.raises(ValueError, match="read-only"):
        problem.block[0] = 0


def test_the_solution_obeys_coulombs_law() -> None:
    problem = sk.Problem.from_dense(W, Q, MU)
    solution = sk.solve(problem, tolerance=1e-10)
    assert solution.converged and solution.regions == 2 and solution.largest_region == 2 and solution.unconverged == 0
    u, r = problem.velocity(solution.reaction), solution.reaction
    np.testing.assert_allclose(u.ravel(), W @ r.ravel() + Q.ravel(), atol=1e-14)
    assert np.all(np.linalg.norm(r[:, 1:], axis=1) <= problem.mu * r[:, 0] * (1 + 1e-9))
    assert r[1] == pytest.approx([2, -0.4, 0], abs=1e-9)  # it slides: friction against the sliding direction
    assert u[0] == pytest.approx([0, 0, 0], abs=1e-8)  # it sticks
    error = sk.problem_error(problem, r)
    assert error.relative == solution.error <= 1e-10
    assert sk.problem_error(problem, 2 * r).relative > 0.1
    assert repr(solution).startswith("<skerry.Solution converged, error ")


def test_rows_and_columns_of_a_block_keep_their_meaning() -> None:
    matrix = np.eye(6)
    # The normal impulse of the second contact moves the first one along its first tangent.
    matrix[1, 3] = matrix[3, 1] = 0.5
    q, impulses = [[-1, 0, 0], [-1, 0, 0]], [[1, 0, 0], [1, 0, 0]]
    problem = sk.Problem.from_dense(matrix, q, 0.0)
    assert problem.velocity(impulses).tolist() == [[0, 0.5, 0], [0, 0, 0]]
    assert sk.problem_error(problem, impulses).absolute == pytest.approx(0)
    rough = sk.Problem.from_dense(matrix, q, 1.0)
    assert sk.problem_error(rough, impulses).absolute > 0.1


@pytest.mark.parametrize("method", ["ags", "pgs", "newton"])
def test_all_methods_agree(method: sk.SolverMethod) -> None:
    problem = sk.Problem.from_dense(W, Q, MU)
    expected = sk.solve(problem, tolerance=1e-10).reaction
    np.testing.assert_allclose(sk.solve(problem, method=method, tolerance=1e-10).reaction, expected, atol=1e-8)


def test_the_pyramid_bounds_each_tangent() -> None:
    solution = sk.solve(sk.Problem.from_dense(np.eye(3), [[-2, 8, 8]], 0.5), friction="pyramid", tolerance=1e-12)
    assert solution.reaction[0] == pytest.approx([2, -1, -1])


def test_too_few_iterations_are_reported() -> None:
    rng = np.random.default_rng(3)
    half = rng.normal(size=(60, 60))
    problem = sk.Problem.from_dense(half @ half.T + 0.1 * np.eye(60), rng.normal(size=(20, 3)) - [1, 0, 0], 0.5)
    solution = sk.solve(problem, method="pgs", tolerance=1e-12, max_iterations=2)
    assert not solution.converged and solution.unconverged == 1 and solution.iterations == 2
    assert repr(solution).startswith("<skerry.Solution not converged")


def test_a_sparse_matrix_gives_the_same_problem() -> None:
    sparse = pytest.importorskip("scipy.sparse")
    dense = sk.Problem.from_dense(W, Q, MU)
    for matrix in (sparse.bsr_array(W, blocksize=(3, 3)), sparse.csr_array(W), sparse.coo_array(W)):
        assert sk.Problem.from_bsr(matrix, Q, MU) == dense
    np.testing.assert_array_equal(dense.to_bsr().toarray(), W)


def test_blocks_of_one_place_are_added_and_a_missing_diagonal_is_zero() -> None:
    sparse = pytest.importorskip("scipy.sparse")
    data = np.array([np.eye(3), 2 * np.eye(3), 3 * np.eye(3)])
    matrix = sparse.bsr_array((data, [1, 1, 0], [0, 2, 3]), shape=(6, 6))
    problem = sk.Problem.from_bsr(matrix, np.zeros((2, 3)), 0.5)
    assert problem.column.tolist() == [0, 1, 0, 1]
    assert [block[0, 0] for block in problem.block] == [0, 3, 3, 0]


def test_a_part_leaves_out_the_other_contacts() -> None:
    problem = sk.Problem.from_dense(W, Q, MU)
    part = problem.part_of([0, 2])
    keep = [0, 1, 2, 6, 7, 8]
    assert part == sk.Problem.from_dense(W[np.ix_(keep, keep)], Q[[0, 2]], [0.5, 0.8])
    with pytest.raises(sk.SceneError, match="ascending order"):
        problem.part_of([2, 0])


def test_arrays_that_do_not_fit_are_refused() -> None:
    with pytest.raises(TypeError, match=r"mu: found an array of the shape \(2,\), expected \(3,\)"):
        sk.Problem.from_dense(W, Q, [0.5, 0.5])
    with pytest.raises(sk.SceneError, match=r"problem: W: found the shape \(9, 8\), expected a square matrix"):
        sk.Problem.from_dense(W[:, :8], Q, MU)
    with pytest.raises(sk.SceneError, match="row_offset: found 4 values, expected 2, one more than contacts"):
        sk.Problem([0, 1, 2, 3], [0, 1, 2], np.zeros((3, 3, 3)), Q[:1], [0.5])
    with pytest.raises(sk.SceneError, match="column: found 3, expected the index of a contact, 0 to 2"):
        sk.Problem([0, 1, 2, 3], [0, 1, 3], np.zeros((3, 3, 3)), Q, MU)
    with pytest.raises(sk.SceneError, match="column: found no diagonal block in row 1, expected a diagonal block"):
        sk.Problem([0, 1, 1], [0], np.zeros((1, 3, 3)), Q[:2], 0.5)
    with pytest.raises(sk.SceneError, match="column: found columns that do not ascend in row 0"):
        sk.Problem([0, 2, 3], [1, 0, 1], np.zeros((3, 3, 3)), Q[:2], 0.5)
    with pytest.raises(sk.SceneError, match="q: found a value that is not finite at entry 0"):
        sk.Problem.from_dense(np.eye(3), [[np.nan, 0, 0]], 0.5)
    with pytest.raises(sk.SceneError, match="block: found a value that is not finite at entry 0"):
        sk.Problem.from_dense(np.full((3, 3), np.inf), [[-1, 0, 0]], 0.5)
    with pytest.raises(sk.SceneError, match="mu: found -0.5.* at entry 0, expected friction coefficients >= 0"):
        sk.Problem.from_dense(np.eye(3), [[-1, 0, 0]], -0.5)
    with pytest.raises(TypeError, match="problem: found 7, expected a Problem"):
        sk.solve(7)  # type: ignore[arg-type]
    problem = sk.Problem.from_dense(W, Q, MU)
    with pytest.raises(TypeError, match=r"reaction: found an array of the shape \(2, 3\), expected \(3, 3\)"):
        sk.problem_error(problem, np.zeros((2, 3)))
    with pytest.raises(sk.SceneError, match="relaxation"):
        sk.solve(problem, relaxation=3.0)
    with pytest.raises(sk.SceneError, match="ProblemSettings: method: found 'guess', expected one of 'automatic', "):
        sk.solve(problem, method="guess")  # type: ignore[arg-type]


def test_a_written_problem_is_read_back_equal(tmp_path: Path) -> None:
    if not _core.has_hdf5:
        pytest.importorskip("h5py")
    problem = sk.Problem.from_dense(W, Q, MU, name="three", description="a test")
    problem.write(tmp_path / "three.hdf5", sk.solve(problem).reaction)
    again = sk.Problem.read(tmp_path / "three.hdf5")
    assert again == problem and again.name == "three" and again.description == "a test"


@pytest.mark.skipif(not _core.has_hdf5, reason="this build has no HDF5 to compare with")
def test_files_through_h5py_equal_those_of_the_engine(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    uneven = W + np.triu(np.full((9, 9), 0.005), 1)
    problem = sk.Problem.from_dense(uneven, Q, MU, name="three", description="a test")
    reaction = sk.solve(problem).reaction
    problem.write(tmp_path / "engine.hdf5", reaction)
    _problem._write_with_h5py(problem, str(tmp_path / "h5py.hdf5"), reaction)
    names: list[str] = []
    with h5py.File(tmp_path / "engine.hdf5") as engine, h5py.File(tmp_path / "h5py.hdf5") as python:
        python.visititems(lambda name, item: names.append(name) if hasattr(item, "dtype") else None)
        assert len(names) > 10
        for name in names:
            both = np.asarray(engine[name]).ravel(), np.asarray(python[name]).ravel()
            if name == "solution/u":  # the two add up W r in another order
                np.testing.assert_allclose(*both, atol=1e-15)
            else:
                np.testing.assert_array_equal(*both, name)
    for name in ("engine.hdf5", "h5py.hdf5"):
        assert _problem._read_with_h5py(str(tmp_path / name)) == sk.Problem.read(tmp_path / name) == problem


def test_without_h5py_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_core, "has_hdf5", False)
    monkeypatch.setitem(__import__("sys").modules, "h5py", None)
    with pytest.raises(ImportError, match="found no package h5py, expected one; run: pip install h5py"):
        sk.Problem.read("a.hdf5")


def test_a_file_that_is_no_problem_is_refused_by_name(tmp_path: Path) -> None:
    if not _core.has_hdf5:
        pytest.importorskip("h5py")
    (tmp_path / "a.hdf5").write_text("none")
    with pytest.raises((sk.SceneError, OSError), match=r"a\.hdf5|signature"):
        sk.Problem.read(tmp_path / "a.hdf5")


DATA = os.environ.get("SKERRY_TEST_DATA")


@pytest.mark.skipif(not DATA, reason="SKERRY_TEST_DATA names no folder with problems in it")
@pytest.mark.parametrize("name", ["Box_Stacks-i0122-82-5", "Capsules-i101-404", "FC3D_Example1", "KaplasTower-i1061-4"])
def test_problems_of_the_fclib_collection_are_solved(name: str) -> None:
    path = Path(DATA or "") / "friction_problems" / f"{name}.hdf5"
    problem = sk.Problem.read(path)
    solution = sk.solve(problem)
    assert solution.converged
    assert sk.problem_error(problem, solution.reaction).relative <= 1e-6
    pytest.importorskip("h5py")
    assert _problem._read_with_h5py(str(path)) == problem


@pytest.mark.parametrize(
    ("row", "column", "value"), [(0, 1, 1e14), (0, 6, 0.4), (1, 3, 0.1)], ids=["diagonal block", "pair", "single block"]
)
def test_a_matrix_that_is_not_symmetric_is_refused(row: int, column: int, value: float) -> None:
    wrong, rounded = W.copy(), W.copy()
    wrong[row, column], rounded[row, column] = value, W[row, column] + 1e-3
    sk.Problem.from_dense(rounded, Q, MU)
    with pytest.raises(sk.SceneError, match="block: found a matrix W that is not symmetric in the rows of contact 0"):
        sk.Problem.from_dense(wrong, Q, MU)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"W": np.full((9, 9), np.nan)}, "block: found a value that is not finite"),
        ({"q": np.full((3, 3), np.inf)}, "q: found a value that is not finite"),
        ({"mu": -0.5}, "mu: found -0.5"),
        ({"mu": np.nan}, "mu: found nan"),
    ],
)
def test_values_out_of_range_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(sk.SceneError, match=f"^problem: {message}"):
        sk.Problem.from_dense(**{"W": W, "q": Q, "mu": MU, **change})


def test_an_argument_of_a_wrong_type_is_named() -> None:
    with pytest.raises(TypeError, match="^problem: found 'x', expected a Problem"):
        sk.solve("x")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="^problem: found 'x', expected a Problem"):
        sk.problem_error("x", [])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="^W: found 'x', expected a sparse matrix of SciPy"):
        sk.Problem.from_bsr("x", Q, MU)
    with pytest.raises(TypeError, match="^path: found 3, expected a path"):
        sk.Problem.read(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="^name: found 3, expected a str"):
        sk.Problem.from_dense(W, Q, MU, name=3)  # type: ignore[arg-type]


def test_a_second_block_of_contact_problems_is_refused() -> None:
    world, _, _ = ball_world()
    world.advance(0.045)

    def look(report: sk.StepReport) -> None:
        with pytest.raises(sk.SceneError), world.contact_problems():
            pass

    with world.contact_problems() as problems:
        with pytest.raises(sk.SceneError, match="found a block that is already active"), world.contact_problems():
            pass
        world.watch_steps(look)
        world.advance(0.01)
        world.watch_steps(None)
        first = len(problems)
        world.advance(0.01)
    assert 0 < first < len(problems)

    def look_outside(report: sk.StepReport) -> None:
        with pytest.raises(sk.SceneError, match="callback"), world.contact_problems():
            pass

    world.watch_steps(look_outside)
    world.advance(0.001)
