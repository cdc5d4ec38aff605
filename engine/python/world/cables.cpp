// Cables that run through points of bodies.
#include "skerry/cable.h"

#include <array>
#include <optional>
#include <vector>

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using GivenTable = std::optional<std::vector<std::array<Real, 2>>>;

CableDrive drive_of(const GivenTable& tension, const GivenTable& length, const GivenTable& rate) {
    CableDrive drive;
    if (tension) drive.tension = table_of(*tension);
    if (length) drive.length = table_of(*length);
    if (rate) drive.rate = table_of(*rate);
    return drive;
}

nb::dict values_of(const CableState& state) {
    nb::dict values;
    values["points"] = nb::tuple(nb::cast(state.points));
    values["tension"] = nb::tuple(nb::cast(state.tension));
    values["length"] = state.length;
    values["rate"] = state.rate;
    values["released"] = state.released;
    values["work"] = state.work;
    values["dissipated"] = state.dissipated;
    return values;
}

nb::dict settings_of_cable(World& world, const CableHandle& cable) {
    const CableSettings settings = Cables(world).settings(cable);
    nb::dict values = python::values_of(settings);
    values["points"] = nb::list(nb::cast(settings.points));
    return values;
}

}  // namespace

void bind_cables(WorldClass& type) {
    bind_view<CableHandle>(type, "cables");
    type.def("add_cable",
             guarded([](World& world, const std::vector<Anchor>& points, const GivenTable& tension,
                        const GivenTable& length, const GivenTable& rate, Real friction) {
                 return Cables(world).add(
                     {.points = points, .drive = drive_of(tension, length, rate), .friction = friction});
             }),
             nb::arg("points"), nb::arg("tension").none(), nb::arg("length").none(), nb::arg("rate").none(),
             nb::arg("friction"))
        .def("cable_state",
             guarded([](World& world, const CableHandle& cable) { return values_of(Cables(world).state(cable)); }))
        .def("cable_settings", guarded(settings_of_cable))
        .def("set_cable_drive",
             guarded([](World& world, const CableHandle& cable, const GivenTable& tension, const GivenTable& length,
                        const GivenTable& rate) { Cables(world).set_drive(cable, drive_of(tension, length, rate)); }),
             nb::arg("cable"), nb::arg("tension").none(), nb::arg("length").none(), nb::arg("rate").none());
}

}  // namespace skerry::python
