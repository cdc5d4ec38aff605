#include "engine/output/page/page_data.h"

#include <algorithm>

#include "components/check.h"
#include "engine/output/page/pack.h"
#include "engine/output/shape_picture.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {
namespace {

/// In the order of the alternatives of Shape.
constexpr const char* kind_names[] = {"plane", "sphere", "box", "capsule", "cylinder", "bucket", "mesh"};
static_assert(std::size(kind_names) == std::variant_size_v<Shape>);

/// The nodes of a surface and its triangles between them, in the order of the nodes.
PageBody surface_of(const BodyFrame& body) {
    PageBody page{.name = body.name, .node = {}, .triangles = {}};
    std::vector<Index> vertex(body.position.size(), no_index);
    for (const auto& triangle : body.surface)
        for (const Index node : triangle) vertex[static_cast<std::size_t>(node)] = 0;
    for (std::size_t node = 0; node < vertex.size(); ++node)
        if (vertex[node] != no_index) {
            vertex[node] = static_cast<Index>(page.node.size());
            page.node.push_back(static_cast<Index>(node));
        }
    const auto vertex_of = [&](Index node) { return vertex[static_cast<std::size_t>(node)]; };
    page.triangles.reserve(body.surface.size());
    for (const auto& [a, b, c] : body.surface) page.triangles.push_back({vertex_of(a), vertex_of(b), vertex_of(c)});
    return page;
}

/// Values as fractions of the largest: the largest goes to `top`, the codes to `codes`.
void put_fractions(std::span<const Real> values, std::string& codes, float& top) {
    Real largest = 0;
    for (const Real value : values)
        if (std::isfinite(value)) largest = std::max(largest, value);
    top = static_cast<float>(largest);
    for (const Real value : values) put(codes, code_of<std::uint8_t>(value, largest));
    fill_up(codes);
}

}  // namespace

std::size_t PageData::body_number(const BodyFrame& body) {
    const auto [place, is_new] = body_numbers_.try_emplace(body.handle, bodies_.size());
    if (is_new) bodies_.push_back(surface_of(body));
    return place->second;
}

std::size_t PageData::collider_number(const ColliderFrame& collider) {
    const auto [place, is_new] = collider_numbers_.try_emplace(collider.handle, colliders_.size());
    if (is_new) {
        const bool is_plane = std::holds_alternative<Plane>(*collider.shape);
        colliders_.push_back({.name = collider.name,
                              .kind = kind_names[collider.shape->index()],
                              .picture = is_plane ? SurfaceMesh{} : shape_picture(*collider.shape, {})});
    }
    return place->second;
}

void PageData::add(const Frame& frame) {
    if (frames_.empty()) gravity_ = frame.gravity;
    std::string out;
    if (!frames_.empty()) out.reserve(frames_.back().size() + frames_.back().size() / 8);
    put(out, static_cast<std::uint32_t>(frame.bodies.size()));
    put(out, static_cast<std::uint32_t>(frame.colliders.size()));
    put(out, static_cast<std::uint32_t>(frame.contacts.size()));
    for (const BodyFrame& body : frame.bodies) pack_body(body, out);
    for (const ColliderFrame& collider : frame.colliders) {
        put(out, static_cast<std::uint32_t>(collider_number(collider)));
        put_floats(out, collider.pose.position);
        put_floats(out, collider.pose.rotation);
    }
    pack_contacts(frame, out);
    frames_.push_back(std::move(out));

    const auto count = [&](ContactMotion motion) {
        return static_cast<Index>(std::ranges::count(frame.contacts, motion, &Contact::motion));
    };
    rows_.push_back({.time = frame.time,
                     .energy = frame.energy,
                     .contacts = static_cast<Index>(frame.contacts.size()),
                     .stick = count(ContactMotion::stick),
                     .slide = count(ContactMotion::slide),
                     .regions = count_regions(frame.contacts)});
}

void PageData::pack_body(const BodyFrame& body, std::string& out) {
    SKERRY_CHECK(body.velocity.size() == body.position.size() && body.node_stress.size() == body.position.size());
    const std::size_t number = body_number(body);
    const std::vector<Index>& node = bodies_[number].node;

    std::string codes;
    float top_speed = 0, top_stress = 0;
    values_.clear();
    for (const Index n : node) speed_.add(values_.emplace_back(body.velocity[static_cast<std::size_t>(n)].norm()));
    put_fractions(values_, codes, top_speed);
    values_.clear();
    for (const Index n : node)
        stress_.add(values_.emplace_back(von_mises(body.node_stress[static_cast<std::size_t>(n)])));
    put_fractions(values_, codes, top_stress);
    points_.clear();
    for (const Index n : node) points_.push_back(body.position[static_cast<std::size_t>(n)]);

    put(out, static_cast<std::uint32_t>(number));
    put(out, top_speed);
    put(out, top_stress);
    put_points(out, points_);
    out += codes;
}

void PageData::pack_contacts(const Frame& frame, std::string& out) {
    points_.clear();
    Real largest = 0;  // N, of a component
    for (const Contact& contact : frame.contacts) {
        points_.push_back(contact.point);
        const Vec3 force = frame.force(contact);
        force_.add(force.norm());
        if (force.allFinite()) largest = std::max(largest, force.cwiseAbs().maxCoeff());
    }
    constexpr Real last = 32767;
    const Real unit = largest > 0 ? largest / last : 1;
    put(out, static_cast<float>(unit));
    put_points(out, points_);
    for (const Contact& contact : frame.contacts) {
        const Vec3 force = frame.force(contact);
        for (int axis = 0; axis < 3; ++axis)
            put(out, force.allFinite() ? static_cast<std::int16_t>(std::lround(force[axis] / unit)) : std::int16_t{0});
    }
    fill_up(out);
    for (const Contact& contact : frame.contacts) put(out, static_cast<std::uint16_t>(contact.region));
    fill_up(out);
    for (const Contact& contact : frame.contacts) put(out, static_cast<std::uint8_t>(contact.motion));
    fill_up(out);
}

}  // namespace skerry
