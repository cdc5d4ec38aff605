// Contact problems: their files, their solution, and the problems of the steps of a world.
#include "skerry/problem.h"

#include <filesystem>
#include <string>
#include <utility>

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using Blocks = nb::ndarray<const Real, nb::shape<-1, 3, 3>, nb::c_contig, nb::device::cpu>;

// Eigen stores matrices by columns, NumPy by rows.
using RowMajor = Eigen::Matrix<Real, 3, 3, Eigen::RowMajor>;

nb::ndarray<nb::numpy, Real> array_of_blocks(const std::vector<Mat3>& blocks) {
    const std::vector<RowMajor> rows(blocks.begin(), blocks.end());
    return array_of<Real>(std::span<const RowMajor>(rows), {3, 3});
}

template <class Number>
auto flat_array(const std::vector<Number>& values) {
    return array_of<Number>(std::span<const Number>(values));
}

ContactProblem new_problem(const std::string& name, const std::string& description, const Indices& row_offset,
                           const Indices& column, const Blocks& block, const Vectors& q, const Reals& mu) {
    ContactProblem problem;
    problem.name = name;
    problem.description = description;
    problem.row_offset.assign(span_of(row_offset).begin(), span_of(row_offset).end());
    problem.column.assign(span_of(column).begin(), span_of(column).end());
    const auto* matrices = reinterpret_cast<const RowMajor*>(block.data());
    problem.block.assign(matrices, matrices + block.shape(0));
    problem.q.assign(span_of(q).begin(), span_of(q).end());
    problem.mu.assign(mu.data(), mu.data() + mu.shape(0));
    part_of(problem, {});  // called only for its check: throws SceneError if the arrays do not fit together
    return problem;
}

nb::dict solve(const ContactProblem& problem, nb::handle settings_object) {
    ProblemSettings settings;
    read(settings_object, settings);
    const ProblemSolution solution = without_gil([&] { return solve_problem(problem, settings); });
    nb::dict values;
    values["reaction"] = array_of(solution.reaction);
    values["regions"] = solution.regions;
    values["iterations"] = solution.iterations;
    values["seconds"] = solution.seconds;
    values["error"] = solution.error;
    values["error_absolute"] = solution.error_absolute;
    values["error_over_q"] = solution.error_over_q;
    values["energy_gap"] = solution.energy_gap;
    values["largest_region"] = solution.largest_region;
    values["unconverged"] = solution.unconverged;
    values["converged"] = solution.converged;
    return values;
}

nb::dict error_of(const ContactProblem& problem, const Vectors& reaction) {
    const ProblemError error = problem_error(problem, span_of(reaction));
    nb::dict values;
    values["absolute"] = error.absolute;
    values["relative"] = error.relative;
    values["over_q"] = error.over_q;
    values["energy_gap"] = error.energy_gap;
    return values;
}

}  // namespace

nb::dict values_of(const StepProblem& step) {
    nb::dict values;
    values["step"] = step.step;
    values["time"] = step.time;
    values["step_size"] = step.step_size;
    values["problem"] = step.problem;
    values["impulse"] = array_of(step.impulse);
    values["contact"] = flat_array(step.contact);
    values["region"] = flat_array(step.region);
    return values;
}

void bind_problem(nb::module_& module) {
    nb::class_<ContactProblem>(module, "Problem")
        .def_ro("name", &ContactProblem::name)
        .def_ro("description", &ContactProblem::description)
        .def_ro("freedoms", &ContactProblem::freedoms)
        .def("row_offset", [](const ContactProblem& problem) { return flat_array(problem.row_offset); })
        .def("column", [](const ContactProblem& problem) { return flat_array(problem.column); })
        .def("block", [](const ContactProblem& problem) { return array_of_blocks(problem.block); })
        .def("q", [](const ContactProblem& problem) { return array_of(problem.q); })
        .def("mu", [](const ContactProblem& problem) { return flat_array(problem.mu); });
    module.attr("has_hdf5") = SKERRY_HAS_HDF5 != 0;
    module.def("new_problem", &new_problem);
    // read_problem and write_problem keep the GIL, because HDF5 is not built for several threads.
    module.def("read_problem", [](const std::string& file) { return read_problem(file); });
    module.def(
        "write_problem",
        [](const ContactProblem& problem, const std::string& file, const std::optional<Vectors>& reaction) {
            write_problem(problem, file, reaction ? span_of(*reaction) : std::span<const Vec3>());
        },
        nb::arg(), nb::arg(), nb::arg().none());
    module.def("part_of", [](const ContactProblem& problem, const Indices& contacts) {
        return part_of(problem, span_of(contacts));
    });
    module.def("solve", &solve);
    module.def("problem_error", &error_of);
}

}  // namespace skerry::python
