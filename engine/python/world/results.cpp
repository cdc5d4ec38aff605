// Python bindings for the contacts, the forces and the spatial queries (rays, nearest points) of a world.
#include <unordered_map>

#include "engine/python/world/parts.h"
#include "skerry/forces.h"
#include "skerry/query.h"

namespace skerry::python {

namespace {

/// Converts handles to indices in the list of all bodies or colliders; -1 for a handle that names no object.
template <class HandleType>
class Places {
public:
    explicit Places(const std::vector<HandleType>& all) {
        for (const HandleType& handle : all) place_.emplace(handle.slot, static_cast<Index>(place_.size()));
    }
    Index operator()(const HandleType& handle) const {
        const auto found = place_.find(handle.slot);
        return found == place_.end() ? no_index : found->second;
    }

private:
    // Key: slot of a handle. Its generation is not needed, because results contain no handles of removed objects.
    std::unordered_map<std::uint32_t, Index> place_;
};

using Triple = std::array<Real, 3>;
Triple triple_of(const Vec3& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

/// A contact in the memory layout of contact_dtype in skerry/_results.py.
struct ContactRow {
    Index first = no_index, second = no_index, collider = no_index;
    std::array<Index, 4> node{};
    std::array<Real, 4> weight{};
    Triple point{}, normal{}, slip{}, impulse{}, force{};
    Triple friction_direction{};
    Real static_friction = 0, dynamic_friction = 0, friction_across = 0;
    Real distance = 0, gap = 0, seconds = 0;
    std::uint8_t motion = 0;
    Index region = no_index;
};

/// A hit of a ray, or a nearest point of a surface, in the memory layout of hit_dtype in skerry/_results.py. Without a
/// hit the distance is infinite.
struct HitRow {
    Index body = no_index, collider = no_index, triangle = no_index;
    Triple barycentric{}, point{}, normal{};
    Real distance = infinity;
};

/// Returns the bytes of the rows as an array of uint8, which skerry/_results.py reinterprets as an array of the dtype
/// of the rows.
template <class Row>
nb::ndarray<nb::numpy, std::uint8_t> bytes_of(const std::vector<Row>& rows) {
    const std::span<const Row> all(rows);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(all.data());
    return array_of<std::uint8_t>(std::span<const std::uint8_t>(bytes, all.size_bytes()));
}

nb::ndarray<nb::numpy, std::uint8_t> contacts(World& world) {
    const Places<BodyHandle> body(world.bodies());
    const Places<ColliderHandle> collider(world.colliders());
    std::vector<ContactRow> rows;
    rows.reserve(world.contacts().size());
    for (const Contact& contact : world.contacts())
        rows.push_back({.first = body(contact.first),
                        .second = body(contact.second),
                        .collider = collider(contact.collider),
                        .node = contact.node,
                        .weight = contact.weight,
                        .point = triple_of(contact.point),
                        .normal = triple_of(contact.normal),
                        .slip = triple_of(contact.slip),
                        .impulse = triple_of(contact.impulse),
                        .force = triple_of(contact.force()),
                        .friction_direction = triple_of(contact.friction_direction),
                        .static_friction = contact.static_friction,
                        .dynamic_friction = contact.dynamic_friction,
                        .friction_across = contact.friction_across,
                        .distance = contact.distance,
                        .gap = contact.gap,
                        .seconds = contact.seconds,
                        .motion = static_cast<std::uint8_t>(contact.motion),
                        .region = contact.region});
    return bytes_of(rows);
}

nb::dict values_of(const ForceReport& report) {
    nb::dict values;
    values["impulse"] = array_of<Real>(std::span<const Real>(report.impulse.data(), 3));
    values["moment_impulse"] = array_of<Real>(std::span<const Real>(report.moment_impulse.data(), 3));
    values["friction_impulse"] = array_of<Real>(std::span<const Real>(report.friction_impulse.data(), 3));
    values["pressing_impulse"] = report.pressing_impulse;
    values["largest_force"] = report.largest_force;
    values["contact_count"] = report.contacts;
    values["most_contacts"] = report.most_contacts;
    values["seconds"] = report.seconds;
    values["moment_point"] = array_of<Real>(std::span<const Real>(report.moment_point.data(), 3));
    values["measured"] = report.measured;
    return values;
}

nb::list force_pairs(World& world) {
    nb::list pairs;
    for (const PairForces& pair : world.forces().pairs())
        pairs.append(
            nb::make_tuple(pair.first, object_of(pair.second), object_of(pair.collider), values_of(pair.on_first)));
    return pairs;
}

/// Filter of a query. `except`: handles of bodies and colliders that the query ignores.
QueryFilter filter_of(bool bodies, bool colliders, std::uint32_t groups, const nb::list& except) {
    QueryFilter filter{.bodies = bodies, .colliders = colliders, .groups = groups};
    for (const nb::handle handle : except) {
        if (nb::isinstance<BodyHandle>(handle))
            filter.except_bodies.push_back(nb::cast<BodyHandle>(handle));
        else
            filter.except_colliders.push_back(nb::cast<ColliderHandle>(handle));
    }
    return filter;
}

/// Calls find(number) without the GIL for the numbers 0 to count - 1, and returns a HitRow for each.
template <class Find>
nb::ndarray<nb::numpy, std::uint8_t> hits(const World& world, std::size_t count, Find&& find) {
    std::vector<HitRow> rows(count);
    without_gil([&] {
        const Places<BodyHandle> body(world.bodies());
        const Places<ColliderHandle> collider(world.colliders());
        for (std::size_t number = 0; number < count; ++number) {
            const std::optional<SurfaceHit> hit = find(number);
            if (!hit) continue;
            rows[number] = {.body = body(hit->body),
                            .collider = collider(hit->collider),
                            .triangle = hit->triangle,
                            .barycentric = hit->barycentric,
                            .point = triple_of(hit->point),
                            .normal = triple_of(hit->normal),
                            .distance = hit->distance};
        }
    });
    return bytes_of(rows);
}

nb::ndarray<nb::numpy, std::uint8_t> cast_rays(WorldObject& object, const Vectors& origins, const Vectors& directions,
                                               Real max_distance, bool bodies, bool colliders, std::uint32_t groups,
                                               const nb::list& except) {
    Use use(object);
    const QueryFilter filter = filter_of(bodies, colliders, groups, except);
    const auto origin = span_of(origins), direction = span_of(directions);
    if (origin.size() != direction.size()) {
        PyErr_Format(PyExc_TypeError, "directions: found %zu rows, expected %zu, one for each origin", direction.size(),
                     origin.size());
        throw nb::python_error();
    }
    return hits(object.world, origin.size(), [&](std::size_t number) {
        return object.world.cast_ray(origin[number], direction[number], max_distance, filter);
    });
}

nb::ndarray<nb::numpy, std::uint8_t> nearest_points(WorldObject& object, const Vectors& points, Real max_distance,
                                                    bool bodies, bool colliders, std::uint32_t groups,
                                                    const nb::list& except) {
    Use use(object);
    const QueryFilter filter = filter_of(bodies, colliders, groups, except);
    const auto point = span_of(points);
    return hits(object.world, point.size(),
                [&](std::size_t number) { return object.world.nearest_point(point[number], max_distance, filter); });
}

}  // namespace

void bind_results(WorldClass& type) {
    type.def("contacts", guarded([](World& world) { return contacts(world); }))
        .def("contact_count", guarded([](World& world) { return world.contacts().size(); }))
        .def("measure_forces",
             guarded([](World& world, bool on, const Vec3& point) { world.measure_forces(on, point); }))
        .def("measures_forces", guarded([](World& world) { return world.measures_forces(); }))
        .def("forces_on", guarded([](World& world, const BodyHandle& on) { return values_of(world.forces().on(on)); }))
        .def("forces_on",
             guarded([](World& world, const ColliderHandle& on) { return values_of(world.forces().on(on)); }))
        .def("forces_on", guarded([](World& world, const BodyHandle& on, const BodyHandle& by) {
                 return values_of(world.forces().on(on, by));
             }))
        .def("forces_on", guarded([](World& world, const BodyHandle& on, const ColliderHandle& by) {
                 return values_of(world.forces().on(on, by));
             }))
        .def("forces_on", guarded([](World& world, const ColliderHandle& on, const BodyHandle& by) {
                 return values_of(world.forces().on(on, by));
             }))
        .def("forces_by",
             guarded([](World& world, const AttachmentHandle& by) { return values_of(world.forces().by(by)); }))
        .def("force_pairs", guarded([](World& world) { return force_pairs(world); }))
        .def("cast_rays", &cast_rays)
        .def("nearest_points", &nearest_points);
}

}  // namespace skerry::python
