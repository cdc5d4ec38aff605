// Python bindings of studies. A study estimates the errors of a scene's results.
#include "skerry/study.h"

#include <span>
#include <string>
#include <vector>

#include "engine/python/bind.h"

namespace skerry::python {

namespace {

/// Runs a study. `progress` is None or is called about every 20 ms with the completed share of the work, the number of
/// completed runs and the number of planned runs. If `progress` or a signal handler raises an exception, all runs stop.
StudyResult run_study(const std::string& scene, double error, const std::vector<std::string>& probes,
                      std::optional<Real> seconds, const std::vector<std::string>& assignments, int threads,
                      std::optional<double> budget, const std::string& folder, bool redo, const std::string& python,
                      const nb::object& progress) {
    const StudySettings settings{.error = error,
                                 .probes = probes,
                                 .seconds = seconds,
                                 .assignments = assignments,
                                 .threads = threads,
                                 .budget = budget,
                                 .folder = folder,
                                 .redo = redo,
                                 .fill_python = python,
                                 .go_on = [&](const StudyProgress& so_far) {
                                     CallScope::raise_at_exit();
                                     nb::gil_scoped_acquire held;
                                     if (PyErr_CheckSignals() != 0) throw nb::python_error();
                                     if (!progress.is_none()) progress(so_far.share, so_far.runs_done, so_far.runs);
                                     return true;
                                 }};
    return without_gil([&] { return study(scene, settings); });
}

/// Results of run `number`: a tuple of the array of times [s] and a dictionary of arrays of values by "PROBE.QUANTITY".
nb::tuple series_of(const StudyResult& result, std::size_t number) {
    const StudyRun& run = result.runs.at(number);
    nb::dict columns;
    for (const StudyColumn& column : run.columns)
        columns[nb::str((column.what.probe + "." + column.what.quantity).c_str())] =
            array_of<Real>(std::span<const Real>(column.values));
    return nb::make_tuple(array_of<Real>(std::span<const Real>(run.time)), columns);
}

}  // namespace

void bind_study(nb::module_& module) {
    nb::class_<StudyResult>(module, "StudyResult")
        .def("json", &study_json)
        .def("text", &study_text)
        .def("page", &study_page)
        .def("series", &series_of)
        .def("write_cheapest_scene", [](const StudyResult& result, const std::string& scene, const std::string& file) {
            write_cheapest_scene(scene, result, file);
        });
    module.def("study", &run_study, nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg(),
               nb::arg().none(), nb::arg(), nb::arg(), nb::arg(), nb::arg().none());
}

}  // namespace skerry::python
