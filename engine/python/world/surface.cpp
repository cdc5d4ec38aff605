// Friction and restitution of pairs of materials and of parts of the surface of a body.
#include "skerry/surface.h"

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

SurfaceSettings surface_of(nb::handle settings_object) {
    SurfaceSettings surface;
    read(settings_object, surface);
    return surface;
}

void set_pair(WorldObject& object, const MaterialHandle& first, const MaterialHandle& second, nb::handle surface) {
    Use use(object);
    SurfacePairs(object.world).set(first, second, surface_of(surface));
}

nb::object pair(WorldObject& object, const MaterialHandle& first, const MaterialHandle& second) {
    Use use(object);
    const std::optional<SurfaceSettings> found = SurfacePairs(object.world).surface(first, second);
    return found ? object_of(*found) : nb::none();
}

nb::list pairs(WorldObject& object) {
    Use use(object);
    nb::list all;
    for (const MaterialPair& pair : SurfacePairs(object.world).all())
        all.append(nb::make_tuple(pair.first, pair.second, object_of(pair.surface)));
    return all;
}

nb::object material_of_collider(WorldObject& object, const ColliderHandle& collider) {
    Use use(object);
    const std::optional<MaterialHandle> material = SurfacePairs(object.world).material(collider);
    return material ? nb::cast(*material) : nb::none();
}

SurfaceSetHandle add_surface_set(WorldObject& object, const BodyHandle& body, const std::vector<Index>& nodes,
                                 const std::vector<std::array<Index, 3>>& faces, nb::handle surface,
                                 std::optional<Real> friction_across, std::optional<std::array<Real, 3>> direction) {
    Use use(object);
    SurfaceSetSettings settings{.body = body,
                                .nodes = nodes,
                                .faces = faces,
                                .surface = surface_of(surface),
                                .friction_across = friction_across};
    if (direction) settings.direction = Vec3((*direction)[0], (*direction)[1], (*direction)[2]);
    return SurfaceSets(object.world).add(settings);
}

void set_set_surface(WorldObject& object, const SurfaceSetHandle& set, nb::handle surface,
                     std::optional<Real> friction_across) {
    Use use(object);
    SurfaceSets(object.world).set_surface(set, surface_of(surface), friction_across);
}

nb::dict surface_set(WorldObject& object, const SurfaceSetHandle& set) {
    Use use(object);
    const SurfaceSetSettings settings = SurfaceSets(object.world).settings(set);
    nb::dict values;
    values["body"] = nb::cast(settings.body);
    values["nodes"] = array_of<Index>(std::span<const Index>(settings.nodes));
    values["faces"] = array_of<Index>(std::span<const std::array<Index, 3>>(settings.faces), {3});
    values["surface"] = object_of(settings.surface);
    values["friction_across"] = settings.friction_across;
    values["direction"] = settings.direction ? nb::object(tuple_of(*settings.direction)) : nb::none();
    return values;
}

}  // namespace

void bind_surface(WorldClass& type) {
    bind_view<SurfaceSetHandle>(type, "surface_sets");
    type.def("set_pair", &set_pair)
        .def("pair", &pair)
        .def("pairs", &pairs)
        .def("remove_pair", guarded([](World& world, const MaterialHandle& first, const MaterialHandle& second) {
                 SurfacePairs(world).remove(first, second);
             }))
        .def("material_of_collider", &material_of_collider)
        .def("set_material_of_collider",
             guarded([](World& world, const ColliderHandle& collider, std::optional<MaterialHandle> material) {
                 SurfacePairs(world).set_material(collider, material);
             }),
             nb::arg("collider"), nb::arg("material").none())
        .def("add_surface_set", &add_surface_set, nb::arg("body"), nb::arg("nodes"), nb::arg("faces"),
             nb::arg("surface"), nb::arg("friction_across").none(), nb::arg("direction").none())
        .def("set_set_surface", &set_set_surface, nb::arg("set"), nb::arg("surface"), nb::arg("friction_across").none())
        .def("surface_set", &surface_set);
}

}  // namespace skerry::python
