// Binds the functions that make, copy and save worlds, and that add and remove their objects.
#include <nanobind/stl/map.h>
#include <filesystem>
#include <map>

#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

WorldObject* object_with(World&& world) {
    return new WorldObject(std::move(world));
}

BodySettings body_settings(const MaterialHandle& material, nb::handle settings_object) {
    BodySettings settings;
    read(settings_object, settings);
    settings.material = material;
    return settings;
}

BodyHandle add_body(WorldObject& object, const Mesh& mesh, const MaterialHandle& material,
                    const std::map<int, MaterialHandle>& materials,
                    const std::map<std::string, MaterialHandle>& materials_of_sets, nb::handle settings_object) {
    Use use(object);
    require_no_views(object, "add_body");
    BodySettings settings = body_settings(material, settings_object);
    settings.materials = materials;
    settings.materials_of_sets = materials_of_sets;
    return without_gil([&] { return object.world.add_body(mesh, settings); });
}

/// Adds a rigid body: a sphere, a capsule, a cylinder or the inside of a closed surface.
BodyHandle add_rigid_body(WorldObject& object, nb::handle shape, const MaterialHandle& material,
                          nb::handle settings_object) {
    Use use(object);
    require_no_views(object, "add_body");
    const BodySettings settings = body_settings(material, settings_object);
    return std::visit(
        [&]<class Given>(const Given& body) -> BodyHandle {
            if constexpr (std::is_same_v<Given, Sphere> || std::is_same_v<Given, Capsule> ||
                          std::is_same_v<Given, Cylinder> || std::is_same_v<Given, SurfaceMesh>)
                return object.world.add_body(body, settings);
            else
                throw nb::type_error("add_body: expected a Mesh, SurfaceMesh, Sphere, Capsule or Cylinder");
        },
        read_shape(shape));
}

ColliderHandle add_collider(WorldObject& object, nb::handle shape, nb::handle settings_object) {
    Use use(object);
    require_no_views(object, "add_collider");
    ColliderSettings settings;
    read(settings_object, settings);
    return object.world.add_collider(read_shape(shape), settings);
}

AttachmentHandle attach(WorldObject& object, const BodyHandle& body, const Indices& nodes, nb::handle motion,
                        const Vec3& pivot, const std::vector<Vec3>& directions) {
    Use use(object);
    require_no_views(object, "attach");
    Motion motion_settings;
    read(motion, motion_settings);
    return object.world.attach(body, span_of(nodes), motion_settings, pivot, directions);
}

template <class HandleType>
void remove(WorldObject& object, const HandleType& handle) {
    Use use(object);
    require_no_views(object, "remove");
    object.world.remove(handle);
}

LoadSettings load_settings(nb::handle settings_object) {
    LoadSettings settings;
    read(settings_object, settings);
    return settings;
}

}  // namespace

void bind_building(WorldClass& type) {
    type.def("__init__",
             [](WorldObject* self, nb::handle settings_object) {
                 Use::require_threads();
                 Settings settings;
                 read(settings_object, settings);
                 new (self) WorldObject(World(settings));
             })
        .def("clone",
             [](WorldObject& object, nb::handle settings_object) {
                 Use use(object);
                 const LoadSettings settings = load_settings(settings_object);
                 return object_with(without_gil([&] { return object.world.clone(settings); }));
             })
        .def("to_bytes",
             [](WorldObject& object) {
                 Use use(object);
                 const auto bytes = without_gil([&] { return object.world.to_bytes(); });
                 return nb::bytes(bytes.data(), bytes.size());
             })
        .def_static("from_bytes",
                    [](const nb::bytes& bytes, nb::handle settings_object) {
                        Use::require_threads();
                        const LoadSettings settings = load_settings(settings_object);
                        const std::span<const std::byte> data(static_cast<const std::byte*>(bytes.data()),
                                                              bytes.size());
                        return object_with(without_gil([&] { return World::from_bytes(data, settings); }));
                    })
        .def("save",
             [](WorldObject& object, const std::string& file) {
                 Use use(object);
                 without_gil([&] { object.world.save(file); });
             })
        .def_static("load",
                    [](const std::string& file, nb::handle settings_object) {
                        Use::require_threads();
                        const LoadSettings settings = load_settings(settings_object);
                        return object_with(without_gil([&] { return World::load(file, settings); }));
                    })
        .def("add_material",
             [](WorldObject& object, nb::handle settings_object) {
                 Use use(object);
                 MaterialSettings settings;
                 read(settings_object, settings);
                 return object.world.add_material(settings);
             })
        .def("add_body", &add_body)
        .def("add_rigid_body", &add_rigid_body)
        .def("add_collider", &add_collider)
        .def("attach", &attach)
        .def("remove", &remove<BodyHandle>)
        .def("remove", &remove<ColliderHandle>)
        .def("remove", &remove<AttachmentHandle>)
        .def("alive", guarded([](World& world, const BodyHandle& body) { return world.alive(body); }))
        .def("alive", guarded([](World& world, const ColliderHandle& collider) { return world.alive(collider); }))
        .def("alive", guarded([](World& world, const AttachmentHandle& attachment) { return world.alive(attachment); }))
        .def("settle_start", [](WorldObject& object) {
            Use use(object);
            without_gil([&] { object.world.settle_start(); });
        });
}

}  // namespace skerry::python
