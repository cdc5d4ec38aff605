// Cavities and pipes.
#include "skerry/cavity.h"

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using Pairs = std::vector<std::array<Real, 2>>;
using Face = std::array<Index, 3>;

CavityHandle add_cavity(WorldObject& object, const BodyHandle& body, const std::optional<IndexRows<3>>& faces,
                        const std::optional<Pairs>& pressure, nb::handle gas, nb::handle liquid,
                        std::optional<Real> volume) {
    Use use(object);
    CavitySettings settings{.body = body, .volume = volume};
    if (faces) settings.faces.emplace(span_of(*faces).begin(), span_of(*faces).end());
    if (pressure)
        settings.filling = table_of(*pressure);
    else if (!gas.is_none())
        read(gas, settings.filling.emplace<GasFilling>());
    else
        read(liquid, settings.filling.emplace<LiquidFilling>());
    return Cavities(object.world).add(settings);
}

nb::dict values_of(const CavityState& state) {
    nb::dict values;
    values["body"] = state.body;
    values["law"] = std::string(name_of(state.law));
    values["faces"] = state.faces;
    values["closed"] = state.closed;
    values["pressure"] = state.pressure;
    values["volume"] = state.volume;
    values["mass"] = state.mass;
    values["energy"] = state.energy;
    values["force"] = tuple_of(state.force);
    return values;
}

nb::dict values_of(const PipeState& state) {
    nb::dict values;
    values["first"] = state.first;
    values["second"] = state.second ? nb::cast(*state.second) : nb::none();
    values["conductance"] = state.conductance;
    values["flow"] = state.flow;
    return values;
}

nb::dict settings_of_cavity(World& world, const CavityHandle& cavity) {
    const CavitySettings settings = Cavities(world).settings(cavity);
    nb::dict values;
    values["body"] = settings.body;
    values["faces"] = array_of<Index>(std::span<const Face>(*settings.faces), {3});
    const char* const names[] = {"pressure", "gas", "liquid"};  // in the order of the alternatives of `filling`
    values[names[settings.filling.index()]] =
        std::visit([](const auto& filling) { return object_of(filling); }, settings.filling);
    values["volume"] = settings.volume;
    return values;
}

nb::dict settings_of_pipe(World& world, const PipeHandle& pipe) {
    const PipeSettings settings = Cavities(world).settings(pipe);
    nb::dict values = python::values_of(settings);
    values["first"] = settings.first;
    values["second"] = settings.second ? nb::cast(*settings.second) : nb::none();
    return values;
}

template <auto set>
auto setter() {
    return guarded([](World& world, const CavityHandle& cavity, const Pairs& table) {
        (Cavities(world).*set)(cavity, table_of(table));
    });
}

}  // namespace

void bind_cavities(WorldClass& type) {
    bind_view<CavityHandle>(type, "cavities");
    bind_view<PipeHandle>(type, "pipes");
    type.def("add_cavity", &add_cavity, nb::arg("body"), nb::arg("faces").none(), nb::arg("pressure").none(),
             nb::arg("gas").none(), nb::arg("liquid").none(), nb::arg("volume").none())
        .def("add_pipe",
             guarded([](World& world, const CavityHandle& first, std::optional<CavityHandle> second, Real conductance,
                        const Pairs& pressure) {
                 return Cavities(world).add(PipeSettings{first, second, conductance, table_of(pressure)});
             }),
             nb::arg("first"), nb::arg("second").none(), nb::arg("conductance"), nb::arg("pressure"))
        .def("cavity_state",
             guarded([](World& world, const CavityHandle& cavity) { return values_of(Cavities(world).state(cavity)); }))
        .def("pipe_state",
             guarded([](World& world, const PipeHandle& pipe) { return values_of(Cavities(world).state(pipe)); }))
        .def("cavity_settings", guarded(settings_of_cavity))
        .def("pipe_settings", guarded(settings_of_pipe))
        .def("set_pressure", setter<&Cavities::set_pressure>())
        .def("set_inflow", setter<&Cavities::set_inflow>())
        .def("set_liquid_volume", setter<&Cavities::set_liquid_volume>())
        .def("set_conductance", guarded([](World& world, const PipeHandle& pipe, Real conductance) {
                 Cavities(world).set_conductance(pipe, conductance);
             }))
        .def("set_reservoir", guarded([](World& world, const PipeHandle& pipe, const Pairs& pressure) {
                 Cavities(world).set_reservoir(pipe, table_of(pressure));
             }));
}

}  // namespace skerry::python
