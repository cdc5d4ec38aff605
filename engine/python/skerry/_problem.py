"""Frictional contact problems without a world."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import checked, index_array, path_text, read_only, real_array, require_attributes
from ._errors import import_package, scene_error
from ._settings import Friction, ProblemSettings, SolverMethod

Path: TypeAlias = str | os.PathLike[str]
Reals: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.int32]


class Problem:
    """A local contact problem u = W r + q with relative velocities u and impulses r, which have the components (normal,
    tangent 1, tangent 2) for each of the c contacts. W is symmetric and stored in compressed rows of z blocks. A
    problem cannot be changed.

    row_offset: index of the first block of each block row, then z, shape (c + 1,).
    column: block column of each block, shape (z,), ascending in each row; each row must have its diagonal block.
    block: blocks of W, shape (z, 3, 3) [1/kg].
    q: relative velocities without impulses, shape (c, 3) [m/s].
    mu: friction coefficient of each contact, shape (c,), or one for all.

    TypeError: an array has the wrong shape or type.
    SceneError: the arrays do not fit together, or a value is out of range."""

    __slots__ = ("_arrays", "_core")

    def __init__(
        self,
        row_offset: ArrayLike,
        column: ArrayLike,
        block: ArrayLike,
        q: ArrayLike,
        mu: ArrayLike,
        *,
        name: str = "",
        description: str = "",
    ) -> None:
        offsets = index_array(row_offset, "row_offset", ("c + 1",))
        velocities = real_array(q, "q", ("c", 3))
        friction = real_array(np.full(len(velocities), mu) if np.ndim(mu) == 0 else mu, "mu", (len(velocities),))
        columns, blocks = index_array(column, "column", ("z",)), real_array(block, "block", ("z", 3, 3))
        checked(name, "name", str), checked(description, "description", str)
        self._hold(_core.new_problem(name, description, offsets, columns, blocks, velocities, friction))

    def _hold(self, core: Any) -> None:
        self._core = core
        self._arrays: dict[str, Any] = {}

    @classmethod
    def _of(cls, core: Any) -> Problem:
        problem = cls.__new__(cls)
        problem._hold(core)
        return problem

    @staticmethod
    def from_bsr(
        W: Any,  # noqa: N803
        q: ArrayLike,
        mu: ArrayLike,
        *,
        name: str = "",
        description: str = "",
    ) -> Problem:
        """Makes a problem from a sparse matrix W of SciPy, such as scipy.sparse.bsr_array, of the shape (3 c, 3 c). q:
        shape (c, 3) or (3 c,) [m/s]. mu: shape (c,), or one value for all contacts."""
        require_attributes(W, "W", "a sparse matrix of SciPy", "tobsr")
        blocks = W.tobsr(blocksize=(3, 3))
        rows = np.repeat(np.arange(len(blocks.indptr) - 1), np.diff(blocks.indptr))
        return _problem_of_blocks(blocks.shape, rows, blocks.indices, blocks.data, q, mu, name, description)

    @staticmethod
    def from_dense(
        W: ArrayLike,  # noqa: N803
        q: ArrayLike,
        mu: ArrayLike,
        *,
        name: str = "",
        description: str = "",
    ) -> Problem:
        """Makes a problem from a dense matrix W of the shape (3 c, 3 c). Blocks of zeros are left out. The other
        arguments are those of from_bsr()."""
        matrix = real_array(W, "W", ("3 c", "3 c"))
        _require_square(matrix.shape)
        count = len(matrix) // 3
        blocks = matrix.reshape(count, 3, count, 3).transpose(0, 2, 1, 3)
        rows, columns = np.nonzero(np.any(blocks != 0, axis=(2, 3)))
        return _problem_of_blocks(matrix.shape, rows, columns, blocks[rows, columns], q, mu, name, description)

    # Files.

    @staticmethod
    def read(path: Path) -> Problem:
        """Reads a problem from an FCLIB file (HDF5). A global problem is condensed to its contacts. If Skerry was built
        without HDF5, the package h5py reads local problems."""
        file = path_text(path, "path")
        return Problem._of(_core.read_problem(file)) if _core.has_hdf5 else _read_with_h5py(file)

    def write(self, path: Path, reaction: ArrayLike | None = None) -> None:
        """Writes the problem as an FCLIB file, with a solution if `reaction` (c, 3) [N s] is given. If Skerry was built
        without HDF5, the package h5py writes the file."""
        given = None if reaction is None else self._reaction(reaction)
        file = path_text(path, "path")
        if _core.has_hdf5:
            _core.write_problem(self._core, file, given)
        else:
            _write_with_h5py(self, file, given)

    # Contents.

    @property
    def name(self) -> str:
        """Name of the problem. For a problem from a file: name of the file without the extension."""
        return str(self._core.name)

    @property
    def description(self) -> str:
        """Description given to Problem() or read from the file."""
        return str(self._core.description)

    @property
    def row_offset(self) -> Indices:
        """Index of the first block of each block row, then the number of all blocks, shape (c + 1,), read-only."""
        array: Indices = self._array("row_offset")
        return array

    @property
    def column(self) -> Indices:
        """Block column of each block, shape (z,), read-only."""
        array: Indices = self._array("column")
        return array

    @property
    def block(self) -> Reals:
        """Blocks of W, shape (z, 3, 3), read-only [1/kg]."""
        array: Reals = self._array("block")
        return array

    @property
    def q(self) -> Reals:
        """Relative velocities without impulses, shape (c, 3), read-only [m/s]."""
        array: Reals = self._array("q")
        return array

    @property
    def mu(self) -> Reals:
        """Friction coefficients, shape (c,), read-only."""
        array: Reals = self._array("mu")
        return array

    def to_bsr(self) -> Any:
        """W as a scipy.sparse.bsr_array of the shape (3 c, 3 c). Needs the package scipy."""
        sparse = import_package("scipy.sparse")
        return sparse.bsr_array((self.block, self.column, self.row_offset), shape=(3 * len(self), 3 * len(self)))

    def part_of(self, contacts: ArrayLike) -> Problem:
        """Problem of the given contacts only, as if the impulses of all others were zero. contacts: ascending indices,
        shape (j,)."""
        return Problem._of(_core.part_of(self._core, index_array(contacts, "contacts", ("j",))))

    def velocity(self, reaction: ArrayLike) -> Reals:
        """Relative velocities u = W r + q that result from the impulses r (c, 3) [N s], shape (c, 3) [m/s]."""
        impulse = self._reaction(reaction)
        result = self.q.copy()
        rows = np.repeat(np.arange(len(self)), np.diff(self.row_offset))
        np.add.at(result, rows, np.einsum("zij,zj->zi", self.block, impulse[self.column]))
        return result

    def _reaction(self, reaction: ArrayLike) -> Reals:
        return real_array(reaction, "reaction", (len(self), 3))

    def _array(self, name: str) -> Any:
        if name not in self._arrays:
            self._arrays[name] = read_only(getattr(self._core, name)())
        return self._arrays[name]

    def __len__(self) -> int:
        return len(self.q)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Problem):
            return NotImplemented
        return all(np.array_equal(a, b) for a, b in zip(self._contents(), other._contents(), strict=True))

    def __hash__(self) -> int:
        return hash((self.q.tobytes(), self.block.tobytes()))

    def _contents(self) -> tuple[Any, ...]:
        return (self.row_offset, self.column, self.block, self.q, self.mu)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_same_problem, (*self._contents(), self.name, self.description))

    def __repr__(self) -> str:
        return f"<skerry.Problem {self.name!r}, {len(self):,} contacts, {len(self.column):,} blocks>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """Solution of a contact problem.

    reaction: impulses of the contacts, shape (c, 3) [N s].
    converged: True if `error` is at most the tolerance.
    iterations: largest number of iterations of a region.
    error: relative error as in FCLIB and Siconos: |e| / max(|q|, |r|, |u|) with the natural map residual e.
    error_absolute: norm |e| of the natural map residual.
    error_over_q: relative error |e| / |q|.
    energy_gap: violation of Coulomb's law, summed over all contacts; 0 for an exact solution [J].
    regions: number of independent regions.
    largest_region: number of contacts of the largest region.
    unconverged: number of regions that reached the iteration limit; 0 if `converged` is True.
    seconds: computing time of the solve; for a short solve, the median of several solves [s].
    """

    reaction: Reals
    converged: bool
    iterations: int
    error: float
    error_absolute: float
    error_over_q: float
    energy_gap: float
    regions: int
    largest_region: int
    unconverged: int
    seconds: float

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        return f"<skerry.Solution {state}, error {self.error:.3g}, {self.iterations:,} iterations>"


@dataclass(frozen=True, slots=True, kw_only=True)
class ProblemError:
    """Errors of given impulses as solutions of a contact problem.

    absolute: norm |e| of the natural map residual e.
    relative: relative error |e| / max(|q|, |r|, |u|).
    over_q: relative error |e| / |q|.
    energy_gap: violation of Coulomb's law, summed over all contacts [J].
    """

    absolute: float
    relative: float
    over_q: float
    energy_gap: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepProblem:
    """The contact problem of one step of a world, as the solver received it.

    step: number of the step, counted from 1.
    time: time at the start of the step [s].
    step_size: length of the step [s].
    problem: the problem, without contacts that no impulse can move. Joints, ties and nodes on rollers are eliminated:
        W and q include their effect. Slides, motors, limits, passive forces, and cables with friction or a prescribed
        length are replaced by the impulses that they exert in the step, whose effect is part of q.
    impulse: impulses that the solver found, in the contact frames of `problem`, shape (c, 3) [N s].
    contact: index of each contact in World.contacts, shape (c,).
    region: number of the region of each contact, shape (c,).
    """

    step: int
    time: float
    step_size: float
    problem: Problem
    impulse: Reals
    contact: Indices
    region: Indices


def solve(
    problem: Problem,
    *,
    method: SolverMethod = "automatic",
    friction: Friction = "cone",
    tolerance: float = 1e-6,
    max_iterations: int = 100_000,
    relaxation: float = 1.0,
) -> Solution:
    """Separates a problem into independent regions and solves each region, starting from zero impulses.

    method: "automatic", "ags", "pgs", "pcg_pgs", "newton", "pcg_fr" or "pcg_pr".
    friction: Coulomb's "cone", or its four-sided approximation "pyramid", to which the errors then refer.
    tolerance: upper bound on Solution.error.
    max_iterations: limit of the number of iterations for each region.
    relaxation: factor of the change of an impulse, for methods that sweep over the contacts, > 0 and < 2.

    SceneError: a setting is out of its range. A region that reaches max_iterations is no error, see
    Solution.converged."""
    settings = ProblemSettings(
        method=method, friction=friction, tolerance=tolerance, max_iterations=max_iterations, relaxation=relaxation
    )
    return Solution(**_core.solve(checked(problem, "problem", Problem)._core, settings))


def problem_error(problem: Problem, reaction: ArrayLike) -> ProblemError:
    """Errors of given impulses (c, 3) [N s], defined as in FCLIB and Siconos."""
    core = checked(problem, "problem", Problem)._core
    return ProblemError(**_core.problem_error(core, problem._reaction(reaction)))


@contextmanager
def contact_problems(world: Any, every: int) -> Iterator[list[StepProblem]]:
    """Collects the contact problems of steps whose number is a multiple of `every`, until the `with` block ends."""
    world._core.require_between_steps()
    if every == 0:
        raise scene_error("contact_problems", "every", "0", "a number of steps >= 1")
    if world._take is not None:
        raise scene_error("contact_problems", "", "a block that is already active", "one block at a time")
    problems: list[StepProblem] = []

    def take(values: dict[str, Any]) -> None:
        problems.append(StepProblem(**{**values, "problem": Problem._of(values["problem"])}))

    world._take, world._take_every = take, every
    try:
        yield problems
    finally:
        world._take = None


def _same_problem(row_offset: Any, column: Any, block: Any, q: Any, mu: Any, name: str, description: str) -> Problem:
    return Problem(row_offset, column, block, q, mu, name=name, description=description)


def _require_square(shape: tuple[int, ...]) -> None:
    if shape[0] != shape[1] or shape[0] % 3:
        raise scene_error("problem", "W", f"the shape {shape}", "a square matrix with three rows a contact")


def _problem_of_blocks(
    shape: tuple[int, ...],
    rows: NDArray[Any],
    columns: NDArray[Any],
    blocks: NDArray[Any],
    q: ArrayLike,
    mu: ArrayLike,
    name: str,
    description: str,
) -> Problem:
    """Problem from blocks in any order. Blocks with equal row and column are added; missing diagonal blocks become
    zero."""
    _require_square(shape)
    count = shape[0] // 3
    place = np.concatenate([rows.astype(np.int64) * count + columns, np.arange(count) * (count + 1)])
    places, number = np.unique(place, return_inverse=True)
    total = np.zeros((len(places), 3, 3))
    np.add.at(total, number[: len(blocks)], blocks)
    offsets = np.searchsorted(places, np.arange(count + 1) * count)
    velocities = real_array(q, "q", ("c", 3) if np.ndim(q) != 1 else ("3 c",)).reshape(-1, 3)
    return Problem(offsets, places % max(count, 1), total, velocities, mu, name=name, description=description)


# The next functions read and write FCLIB files if the engine was built without HDF5.


def _read_with_h5py(path: str) -> Problem:
    h5py = import_package("h5py")
    with h5py.File(path, "r") as file:
        if "fclib_local" not in file:
            raise scene_error(
                "", "", "no group fclib_local", "a local problem", "a build with HDF5 reads global problems", file=path
            )
        local = file["fclib_local"]
        matrix = {field: np.asarray(local["W"][field]) for field in ("m", "n", "nz", "p", "i", "x")}
        kind, shape = int(matrix["nz"].item()), (int(matrix["m"].item()), int(matrix["n"].item()))
        _require_square(shape)
        inner, outer, value = matrix["i"], matrix["p"], matrix["x"]
        if kind >= 0:
            inner, outer, value = inner[:kind], outer[:kind], value[:kind]
        else:
            outer = np.repeat(np.arange(len(outer) - 1), np.diff(outer))
        rows, columns = (outer, inner) if kind == -2 else (inner, outer)
        if len(rows) != len(columns) or len(rows) != len(value):
            raise scene_error("W", "p", f"{len(outer)} entries", f"{len(inner)} (values of i)", file=path)
        blocks = np.zeros((len(value), 3, 3))
        blocks[np.arange(len(value)), rows % 3, columns % 3] = value
        about = local.get("info/description")
        return _problem_of_blocks(
            shape,
            rows // 3,
            columns // 3,
            blocks,
            np.asarray(local["vectors/q"]).ravel(),
            np.asarray(local["vectors/mu"]).ravel(),
            os.path.splitext(os.path.basename(path))[0],
            "" if about is None else np.asarray(about).reshape(-1)[0].decode(),
        )


def _write_with_h5py(problem: Problem, path: str, reaction: Reals | None) -> None:
    h5py = import_package("h5py")
    size = 3 * len(problem)
    rows = np.repeat(np.arange(len(problem)), np.diff(problem.row_offset))
    block_row = (3 * rows[:, None, None] + np.arange(3)[:, None] + np.zeros(3, dtype=np.int64)).ravel()
    block_column = (3 * problem.column[:, None, None] + np.zeros((3, 1), dtype=np.int64) + np.arange(3)).ravel()
    value = problem.block.ravel()
    order = np.lexsort((block_row, block_column))
    order = order[value[order] != 0]
    begin = np.searchsorted(block_column[order], np.arange(size + 1))
    part = path + ".part"
    with h5py.File(part, "w") as file:
        local = file.create_group("fclib_local")
        local["spacedim"] = np.array([3], dtype=np.int32)
        for field, number in (("nzmax", len(order)), ("m", size), ("n", size), ("nz", -1)):
            local[f"W/{field}"] = np.array([number], dtype=np.int32)
        local["W/p"] = begin.astype(np.int32)
        local["W/i"] = block_row[order].astype(np.int32)
        local["W/x"] = value[order]
        local["vectors/q"] = problem.q.ravel()
        local["vectors/mu"] = problem.mu
        local["info/title"] = np.bytes_(problem.name)
        local["info/description"] = np.bytes_(problem.description)
        if reaction is not None:
            file["solution/u"] = problem.velocity(reaction).ravel()
            file["solution/r"] = reaction.ravel()
    os.replace(part, path)
