#include "engine/program/nearest_text.h"

#include <vector>

#include "engine/output/number_text.h"

namespace skerry {

std::string nearest_text(const World& world) {
    Real least = infinity;
    std::string text;
    const std::vector<BodyHandle> bodies = world.bodies();
    std::size_t nodes = 0;
    for (const BodyHandle body : bodies) nodes += world.positions(body).size();
    // Largest product of the numbers of nodes and objects for which distances are computed; this takes about a second.
    // Larger scenes get an empty text.
    constexpr std::size_t most_tests = 10'000'000;
    if (nodes * (bodies.size() + world.colliders().size()) > most_tests) return {};
    for (const BodyHandle body : bodies) {
        QueryFilter others;
        others.except_bodies.push_back(body);
        for (const BodyHandle other : bodies)
            if (other != body && !world.may_collide(body, other)) others.except_bodies.push_back(other);
        for (const ColliderHandle collider : world.colliders())
            if (!world.may_collide(body, collider)) others.except_colliders.push_back(collider);
        // Each query is limited to the shortest distance so far, so that most of them end early.
        for (const Vec3& node : world.positions(body)) {
            const std::optional<SurfaceHit> hit = world.nearest_point(node, least, others);
            if (!hit || !(hit->distance < least)) continue;
            least = hit->distance;
            const std::string other = world.alive(hit->body) ? "body \"" + world.name(hit->body) + "\""
                                                             : "collider \"" + world.name(hit->collider) + "\"";
            text = with_unit(least, "m") + " between body \"" + world.name(body) + "\" and " + other;
        }
    }
    return text;
}

}  // namespace skerry
