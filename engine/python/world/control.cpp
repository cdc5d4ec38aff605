// Changes of a running world between two calls of advance.
#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

template <class Struct>
Struct settings_of(nb::handle settings_object) {
    Struct settings;
    read(settings_object, settings);
    return settings;
}

BodyDynamics dynamics_named(const std::string& name) {
    if (const auto known = from_name<BodyDynamics>(name)) return *known;
    Complaint{.file = {},
              .object = "set_dynamics",
              .field = "dynamics",
              .found = "'" + name + "'",
              .expected = "'explicit', 'implicit' or 'rigid'",
              .hint = {}}
        .raise();
}

void set_dynamics(WorldObject& object, const BodyHandle& body, const std::string& dynamics) {
    Use use(object);
    require_no_views(object, "set_dynamics");
    object.world.set_dynamics(body, dynamics_named(dynamics));
}

void reset_to(WorldObject& object, WorldObject& saved) {
    Use use(object);
    Use use_saved(saved);
    require_no_views(object, "reset");
    object.world.reset(saved.world);
}

/// Binds the methods that move an object of the given kind.
template <class HandleType>
void bind_motion(WorldClass& type) {
    type.def("set_velocity",
             guarded([](World& world, const HandleType& object, const Vec3& velocity, const Vec3& angular_velocity) {
                 world.set_velocity(object, velocity, angular_velocity);
             }))
        .def("set_pose", guarded([](World& world, const HandleType& object, nb::handle pose) {
                 world.set_pose(object, settings_of<Pose>(pose));
             }));
    if constexpr (!std::is_same_v<HandleType, BodyHandle>)
        type.def("move_to", guarded([](World& world, const HandleType& object, nb::handle pose, Real duration) {
                     world.move_to(object, settings_of<Pose>(pose), duration);
                 }));
}

/// Binds the methods that select how an object of the given kind touches others.
template <class HandleType>
void bind_contact(WorldClass& type) {
    type.def("set_surface_properties", guarded([](World& world, const HandleType& object, nb::handle surface) {
                 world.set_surface_properties(object, settings_of<SurfaceSettings>(surface));
             }))
        .def("set_collision_groups",
             guarded([](World& world, const HandleType& object, std::uint32_t group, std::uint32_t mask) {
                 world.set_collision_groups(object, group, mask);
             }))
        .def("set_collision", guarded([](World& world, const BodyHandle& body, const HandleType& other, bool on) {
                 world.set_collision(body, other, on);
             }))
        .def("may_collide", guarded([](World& world, const BodyHandle& body, const HandleType& other) {
                 return world.may_collide(body, other);
             }));
}

}  // namespace

void bind_control(WorldClass& type) {
    bind_motion<BodyHandle>(type);
    bind_motion<ColliderHandle>(type);
    bind_motion<AttachmentHandle>(type);
    bind_contact<BodyHandle>(type);
    bind_contact<ColliderHandle>(type);
    type.def("set_gravity", guarded([](World& world, const Vec3& gravity) { world.set_gravity(gravity); }))
        .def("set_positions", guarded([](World& world, const BodyHandle& body, const Vectors& positions) {
                 world.set_positions(body, span_of(positions));
             }))
        .def("set_velocities", guarded([](World& world, const BodyHandle& body, const Vectors& velocities) {
                 world.set_velocities(body, span_of(velocities));
             }))
        .def("set_loads", guarded([](World& world, const BodyHandle& body, const Vectors& loads) {
                 world.set_loads(body, span_of(loads));
             }))
        .def("set_dynamics", &set_dynamics)
        .def("wake", guarded([](World& world, const BodyHandle& body) { world.wake(body); }))
        .def("reset", guarded([](World& world) { world.reset(); }))
        .def("reset", guarded([](World& world, const BodyHandle& body) { world.reset(body); }))
        .def("reset", guarded([](World& world, const BodyHandle& body, nb::handle pose) {
                 world.reset(body, settings_of<Pose>(pose));
             }))
        .def("reset_to", &reset_to)
        .def("material",
             guarded([](World& world, const MaterialHandle& material) { return values_of(world.material(material)); }))
        .def("set_material", guarded([](World& world, const MaterialHandle& material, nb::handle settings_object) {
                 world.set_material(material, settings_of<MaterialSettings>(settings_object));
             }));
}

}  // namespace skerry::python
