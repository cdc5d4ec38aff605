// Estimated errors of a world.
#include "skerry/estimate.h"

#include <array>

#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

/// Returns the estimates as columns by name. Each column has one value for each body.
nb::dict table_of(const ErrorEstimator& estimator) {
    using Column = std::pair<const char*, Real ErrorEstimate::*>;
    constexpr std::array<Column, 12> columns{{{"mesh", &ErrorEstimate::mesh},
                                              {"deflection", &ErrorEstimate::deflection},
                                              {"interpolation", &ErrorEstimate::interpolation},
                                              {"stress", &ErrorEstimate::stress},
                                              {"step", &ErrorEstimate::step},
                                              {"deformation", &ErrorEstimate::deformation},
                                              {"contact", &ErrorEstimate::contact},
                                              {"overlap", &ErrorEstimate::overlap},
                                              {"gap", &ErrorEstimate::gap},
                                              {"contact_radius", &ErrorEstimate::contact_radius},
                                              {"contact_edge", &ErrorEstimate::contact_edge},
                                              {"time", &ErrorEstimate::time}}};
    const std::vector<ErrorEstimate> bodies = estimator.bodies();
    nb::dict table;
    nb::list names;
    std::vector<Index> worst;
    for (const ErrorEstimate& body : bodies) {
        names.append(body.name);
        worst.push_back(body.worst_tetrahedron);
    }
    table["body"] = names;
    for (const auto& [name, member] : columns) {
        std::vector<Real> values;
        for (const ErrorEstimate& body : bodies) values.push_back(body.*member);
        table[name] = array_of<Real>(std::span<const Real>(values));
    }
    table["worst_tetrahedron"] = array_of<Index>(std::span<const Index>(worst));
    return table;
}

/// Calls a member function of an estimator with the world of a Python object.
template <auto function>
void with_world(ErrorEstimator& estimator, WorldObject& object) {
    Use use(object);
    (estimator.*function)(object.world);
}

}  // namespace

void bind_estimate(nb::module_& module) {
    nb::class_<ErrorEstimator>(module, "ErrorEstimator")
        .def("__init__",
             [](ErrorEstimator* self, WorldObject& object) {
                 Use use(object);
                 new (self) ErrorEstimator(object.world);
             })
        .def("sample", &with_world<&ErrorEstimator::sample>)
        .def("finish", &with_world<&ErrorEstimator::finish>)
        .def("table", &table_of);
}

}  // namespace skerry::python
