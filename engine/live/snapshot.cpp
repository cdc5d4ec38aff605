#include "engine/live/snapshot.h"

#include <algorithm>

#include "engine/world/world_state.h"

namespace skerry {

void SnapshotTaker::take(const World& world, FrameContent content, Snapshot& snapshot) {
    const Model& model = WorldAccess::state_of(world).model;
    snapshot.frame = collect_frame(world, content);
    Frame& frame = snapshot.frame;
    const auto now = std::chrono::steady_clock::now();
    if (content >= FrameContent::mesh_error) {
        energy_ = frame.energy;
    } else if (now >= next_energy_) {
        constexpr int pause = 100;  // pause between two calculations, as a multiple of the duration of a calculation
        energy_ = world.energy();
        next_energy_ = now + pause * (std::chrono::steady_clock::now() - now);
    }
    frame.energy = energy_;
    snapshot.bodies.resize(frame.bodies.size());
    for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
        BodyFrame& body = frame.bodies[b];
        Snapshot::BodyCopy& copy = snapshot.bodies[b];
        copy.position.assign(body.position.begin(), body.position.end());
        copy.velocity.assign(body.velocity.begin(), body.velocity.end());
        KnownBody& known = bodies_[body.handle];
        if (!known.surface)
            known = {body.position.size(),
                     std::make_shared<Snapshot::Triangles>(body.surface.begin(), body.surface.end())};
        copy.surface = known.surface;
        copy.visual = model.body_records[static_cast<std::size_t>(model.row(body.handle, "live view"))].visual;
        body.position = copy.position;
        body.velocity = copy.velocity;
        body.surface = *copy.surface;
        body.tetrahedra = {};
        body.visual = copy.visual.get();
    }
    snapshot.shapes.resize(frame.colliders.size());
    for (std::size_t c = 0; c < frame.colliders.size(); ++c) {
        ColliderFrame& collider = frame.colliders[c];
        std::shared_ptr<const Shape>& shape = shapes_[collider.handle];
        if (!shape) shape = std::make_shared<Shape>(*collider.shape);
        snapshot.shapes[c] = shape;
        collider.shape = shape.get();
    }
    snapshot.contacts.assign(frame.contacts.begin(), frame.contacts.end());
    frame.contacts = snapshot.contacts;
    std::erase_if(bodies_, [&](const auto& entry) { return !world.alive(entry.first); });
    std::erase_if(shapes_, [&](const auto& entry) { return !world.alive(entry.first); });
    time_ = frame.time;
}

bool SnapshotTaker::is_other_run(const World& world) const {
    return world.time() < time_ || std::ranges::any_of(bodies_, [&](const auto& entry) {
               const auto& [body, known] = entry;
               return world.alive(body) && (world.positions(body).size() != known.nodes ||
                                            world.surface(body).size() != known.surface->size());
           });
}

void SnapshotTaker::clear() {
    *this = {};
}

}  // namespace skerry
