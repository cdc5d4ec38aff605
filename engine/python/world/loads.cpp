// Loads and force fields.
#include "skerry/load.h"

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using Pairs = std::vector<std::array<Real, 2>>;

std::vector<Index> nodes_in(const Indices& nodes) {
    const std::span<const Index> indices = span_of(nodes);
    return {indices.begin(), indices.end()};
}

std::vector<std::array<Index, 3>> faces_in(const IndexRows<3>& faces) {
    const std::span<const std::array<Index, 3>> indices = span_of(faces);
    return {indices.begin(), indices.end()};
}

nb::dict values_of(const LoadState& state) {
    nb::dict values;
    values["kind"] = std::string(name_of(state.kind));
    values["body"] = state.body ? object_of(*state.body) : nb::none();
    values["vector"] = tuple_of(state.vector);
    values["rate"] = state.rate;
    values["scale"] = state.scale;
    values["force"] = tuple_of(state.force);
    return values;
}

nb::dict settings_of_load(World& world, const LoadHandle& load) {
    const AnyLoad settings = Loads(world).settings(load);
    nb::dict values = python::values_of(settings);
    const std::optional<BodyHandle> body =
        std::visit([](const auto& any) { return std::optional<BodyHandle>(any.body); }, settings);
    values["body"] = body ? object_of(*body) : nb::none();
    if (const auto* const force = std::get_if<ForceLoad>(&settings))
        values["nodes"] = array_of<Index>(std::span<const Index>(force->nodes));
    if (const auto* const traction = std::get_if<TractionLoad>(&settings))
        values["present_area"] = traction->area == LoadArea::present;
    return values;
}

}  // namespace

void bind_loads(WorldClass& type) {
    bind_view<LoadHandle>(type, "loads_of_world");
    type.def("add_force", guarded([](World& world, const BodyHandle& body, const Indices& nodes, const Vec3& force,
                                     const Pairs& scale) {
                 return Loads(world).add(ForceLoad{body, nodes_in(nodes), force, table_of(scale)});
             }))
        .def("add_traction", guarded([](World& world, const BodyHandle& body, const IndexRows<3>& faces,
                                        const Vec3& traction, const Pairs& scale, bool present_area) {
                 return Loads(world).add(TractionLoad{body, faces_in(faces), traction, table_of(scale),
                                                      present_area ? LoadArea::present : LoadArea::reference});
             }))
        .def("add_acceleration",
             guarded([](World& world, std::optional<BodyHandle> body, const Vec3& acceleration, const Pairs& scale) {
                 return Loads(world).add(AccelerationField{body, acceleration, table_of(scale)});
             }),
             nb::arg("body").none(), nb::arg("acceleration"), nb::arg("scale"))
        .def("add_gravity_scale", guarded([](World& world, std::optional<BodyHandle> body, const Pairs& scale) {
                 return Loads(world).add(GravityScale{body, table_of(scale)});
             }),
             nb::arg("body").none(), nb::arg("scale"))
        .def("add_drag",
             guarded([](World& world, std::optional<BodyHandle> body, Real rate, const Vec3& wind, const Pairs& scale) {
                 return Loads(world).add(DragField{body, rate, wind, table_of(scale)});
             }),
             nb::arg("body").none(), nb::arg("rate"), nb::arg("wind"), nb::arg("scale"))
        .def("load_state",
             guarded([](World& world, const LoadHandle& load) { return values_of(Loads(world).state(load)); }))
        .def("load_settings", guarded(settings_of_load))
        .def("set_load_scale", guarded([](World& world, const LoadHandle& load, const Pairs& scale) {
                 Loads(world).set_scale(load, table_of(scale));
             }))
        .def("set_load_vector", guarded([](World& world, const LoadHandle& load, const Vec3& vector) {
                 Loads(world).set_vector(load, vector);
             }));
}

}  // namespace skerry::python
