// State of worlds, bodies, colliders and attachments.
#include "engine/python/read_settings.h"
#include "engine/python/world/parts.h"
#include "skerry/estimate.h"

namespace skerry::python {

namespace {

using Tensors = nb::ndarray<nb::numpy, Real>;

/// A NumPy array (k, 3, 3). Matrices are transposed first, because Eigen stores a matrix by columns and NumPy by rows.
Tensors array_of(std::vector<Mat3>&& matrices) {
    for (Mat3& matrix : matrices) matrix.transposeInPlace();
    return python::array_of<Real>(std::span<const Mat3>(matrices), {3, 3});
}

Tensors array_of(const std::vector<Real>& values) {
    return python::array_of<Real>(std::span<const Real>(values));
}

/// Converts a function of World that computes a field of a body to a method of WorldObject, which calls it without the
/// GIL.
template <class Result>
auto field_of(std::vector<Result> (World::*compute)(BodyHandle) const) {
    return [compute](WorldObject& object, const BodyHandle& body) {
        Use use(object);
        auto values = without_gil([&] { return (object.world.*compute)(body); });
        if constexpr (std::is_same_v<Result, Vec3>)
            return python::array_of(std::span<const Vec3>(values));
        else
            return array_of(std::move(values));
    };
}

Tensors stress_at(WorldObject& object, const BodyHandle& body, const Indices& nodes) {
    Use use(object);
    return array_of(object.world.node_stress(body, span_of(nodes)));
}

nb::object pose_object(const MotionKey& pose) {
    return object_of(Pose{.position = pose.position, .rotation = pose.rotation});
}

nb::ndarray<nb::numpy, Real> vector_array(const Vec3& vector) {
    return python::array_of<Real>(std::span<const Real>(vector.data(), 3));
}

/// Handles in `all` of the bodies or colliders that have this name, in the order of `all`.
template <class HandleType>
std::vector<HandleType> named(const World& world, const std::vector<HandleType>& all, const std::string& name) {
    std::vector<HandleType> found;
    for (const HandleType& handle : all)
        if (world.name(handle) == name) found.push_back(handle);
    return found;
}

void bind_world_state(WorldClass& type) {
    type.def("time", guarded([](World& world) { return world.time(); }))
        .def("settings", guarded([](World& world) { return values_of(world.settings()); }))
        .def("stable_step", guarded([](World& world) { return world.stable_step(); }))
        .def("energy", guarded([](World& world) { return values_of(world.energy()); }))
        .def("report",
             [](WorldObject& object) {
                 Use use(object);
                 return values_of(without_gil([&] { return object.world.report(); }));
             })
        .def("state_hash",
             [](WorldObject& object) {
                 Use use(object);
                 return without_gil([&] { return object.world.state_hash(); });
             })
        .def("bodies", guarded([](World& world) { return world.bodies(); }))
        .def("bodies_named",
             guarded([](World& world, const std::string& name) { return named(world, world.bodies(), name); }))
        .def("colliders", guarded([](World& world) { return world.colliders(); }))
        .def("colliders_named",
             guarded([](World& world, const std::string& name) { return named(world, world.colliders(), name); }))
        .def("name", guarded([](World& world, const BodyHandle& body) { return world.name(body); }))
        .def("name", guarded([](World& world, const ColliderHandle& collider) { return world.name(collider); }))
        .def("pose", guarded([](World& world, const BodyHandle& body) { return pose_object(world.pose(body)); }))
        .def("pose",
             guarded([](World& world, const ColliderHandle& collider) { return pose_object(world.pose(collider)); }))
        .def("pose", guarded([](World& world, const AttachmentHandle& attachment) {
                 return pose_object(world.pose(attachment));
             }))
        .def("shape",
             guarded([](World& world, const ColliderHandle& collider) { return object_of(world.shape(collider)); }));
}

void bind_body_state(WorldClass& type) {
    type.def("positions",
             guarded([](World& world, const BodyHandle& body) { return python::array_of(world.positions(body)); }))
        .def("velocities",
             guarded([](World& world, const BodyHandle& body) { return python::array_of(world.velocities(body)); }))
        .def("node_count", guarded([](World& world, const BodyHandle& body) { return world.positions(body).size(); }))
        .def("surface", guarded([](World& world, const BodyHandle& body) {
                 return python::array_of<Index>(world.surface(body), {3});
             }))
        .def("tetrahedra", guarded([](World& world, const BodyHandle& body) {
                 return python::array_of<Index>(world.tetrahedra(body), {4});
             }))
        .def("element",
             guarded([](World& world, const BodyHandle& body) { return std::string(name_of(world.element(body))); }))
        .def("dynamics",
             guarded([](World& world, const BodyHandle& body) { return std::string(name_of(world.dynamics(body))); }))
        .def("dynamics_choice",
             guarded([](World& world, const BodyHandle& body) { return values_of(world.dynamics_choice(body)); }))
        .def("mass", guarded([](World& world, const BodyHandle& body) { return world.mass(body); }))
        .def("center_of_mass",
             guarded([](World& world, const BodyHandle& body) { return vector_array(world.center_of_mass(body)); }))
        .def("contact_distance",
             guarded([](World& world, const BodyHandle& body) { return world.contact_distance(body); }))
        .def("asleep", guarded([](World& world, const BodyHandle& body) { return world.asleep(body); }))
        .def("mean_edge", guarded([](World& world, const BodyHandle& body) { return world.mean_edge(body); }));
}

nb::tuple tuple_of(const Twist& twist) {
    return nb::make_tuple(vector_array(twist.velocity), vector_array(twist.angular_velocity));
}

/// Binds the getters of velocities and, for bodies and colliders, of surface properties and collision groups.
template <class HandleType>
void bind_given_values(WorldClass& type) {
    type.def("velocity",
             guarded([](World& world, const HandleType& object) { return tuple_of(world.velocity(object)); }));
    if constexpr (!std::is_same_v<HandleType, AttachmentHandle>)
        type.def("surface_properties", guarded([](World& world, const HandleType& object) {
                     return object_of(world.surface_properties(object));
                 }))
            .def("collision_groups", guarded([](World& world, const HandleType& object) {
                     const CollisionGroups groups = world.collision_groups(object);
                     return nb::make_tuple(groups.group, groups.mask);
                 }));
}

void bind_links(WorldClass& type) {
    type.def("attachments", guarded([](World& world) { return world.attachments(); }))
        .def("body_of",
             guarded([](World& world, const AttachmentHandle& attachment) { return world.body(attachment); }))
        .def("nodes_of", guarded([](World& world, const AttachmentHandle& attachment) {
                 const std::vector<Index> nodes = world.nodes(attachment);
                 return python::array_of<Index>(std::span<const Index>(nodes));
             }))
        .def("directions", guarded([](World& world, const AttachmentHandle& attachment) {
                 return python::array_of(world.directions(attachment));
             }))
        .def("materials", guarded([](World& world) { return world.materials(); }))
        .def("material_of", guarded([](World& world, const BodyHandle& body) { return world.material(body); }))
        .def("loads",
             guarded([](World& world, const BodyHandle& body) { return python::array_of(world.loads(body)); }));
}

void bind_fields(WorldClass& type) {
    type.def("stress", field_of<Mat3>(&World::stress))
        .def("strain", field_of<Mat3>(&World::strain))
        .def("node_stress", field_of<Mat3>(&World::node_stress))
        .def("node_stress_at", &stress_at)
        .def("node_strain", field_of<Mat3>(&World::node_strain))
        .def("plastic_strain", field_of<Real>(&World::plastic_strain))
        .def("mesh_error",
             guarded([](World& world, const BodyHandle& body) { return array_of(mesh_error(world, body)); }))
        .def("von_mises_stress", field_of<Real>(&World::von_mises_stress))
        .def("node_von_mises_stress", field_of<Real>(&World::node_von_mises_stress))
        .def("node_principal_stresses", field_of<Vec3>(&World::node_principal_stresses))
        .def("tetrahedron_steps", field_of<Real>(&World::tetrahedron_steps));
}

}  // namespace

void bind_state(WorldClass& type) {
    bind_world_state(type);
    bind_body_state(type);
    bind_fields(type);
    bind_links(type);
    bind_given_values<BodyHandle>(type);
    bind_given_values<ColliderHandle>(type);
    bind_given_values<AttachmentHandle>(type);
}

}  // namespace skerry::python
