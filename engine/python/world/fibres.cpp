// Fibres in bodies.
#include "skerry/fibre.h"

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using TensionPairs = std::vector<std::array<Real, 2>>;

FibreHandle add_fibres(World& world, const BodyHandle& body, const Indices& tetrahedra, const Vectors& direction,
                       const std::array<Real, 2>& moduli, const TensionPairs& tension) {
    const std::span<const Index> numbers = span_of(tetrahedra);
    const std::span<const Vec3> directions = span_of(direction);
    return Fibres(world).add({.body = body,
                              .tetrahedra = {numbers.begin(), numbers.end()},
                              .direction = {directions.begin(), directions.end()},
                              .stiffness = moduli[0],
                              .exponent = moduli[1],
                              .tension = table_of(tension)});
}

nb::dict values_of(const FibreState& state) {
    nb::dict values;
    values["body"] = object_of(state.body);
    values["tension"] = state.tension;
    values["energy"] = state.energy;
    values["tetrahedra"] = array_of<Index>(std::span<const Index>(state.tetrahedra));
    values["stretch"] = array_of<Real>(std::span<const Real>(state.stretch));
    values["stress"] = array_of<Real>(std::span<const Real>(state.stress));
    return values;
}

nb::dict settings_of_fibres(World& world, const FibreHandle& fibres) {
    const FibreSettings settings = Fibres(world).settings(fibres);
    nb::dict values;
    values["body"] = object_of(settings.body);
    values["direction"] = array_of(settings.direction);
    values["tetrahedra"] = array_of<Index>(std::span<const Index>(settings.tetrahedra));
    values["stiffness"] = settings.stiffness;
    values["exponent"] = settings.exponent;
    values["tension"] = object_of(settings.tension);
    return values;
}

}  // namespace

void bind_fibres(WorldClass& type) {
    bind_view<FibreHandle>(type, "fibres_of_world");
    type.def("add_fibres", guarded(&add_fibres))
        .def("fibre_settings", guarded(settings_of_fibres))
        .def("fibre_body",
             guarded([](World& world, const FibreHandle& fibres) { return object_of(Fibres(world).body(fibres)); }))
        .def("fibre_state",
             guarded([](World& world, const FibreHandle& fibres) { return values_of(Fibres(world).state(fibres)); }))
        .def("set_tension", guarded([](World& world, const FibreHandle& fibres, const TensionPairs& tension) {
                 Fibres(world).set_tension(fibres, table_of(tension));
             }));
}

}  // namespace skerry::python
