#include "engine/output/page/page_stream.h"

#include <algorithm>

#include "components/check.h"
#include "engine/output/page/stream/pack.h"
#include "engine/output/shape_picture.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {
namespace {

/// Names of the kinds of shapes, in the order of the alternatives of Shape.
constexpr const char* kind_names[] = {"plane", "sphere", "box", "capsule", "cylinder", "bucket", "mesh"};
static_assert(std::size(kind_names) == std::variant_size_v<Shape>);

/// Value of a displayed field at a node. `field` is the number of the field, from 0 to page_field_count - 1.
Real value_at(const BodyFrame& body, std::size_t field, std::size_t node) {
    if (field == 0) return body.velocity[node].norm();
    if (field == error_field) return body.node_mesh_error.empty() ? 0 : body.node_mesh_error[node];
    if (body.node_stress.empty()) return 0;
    if (field == stress_field) return von_mises(body.node_stress[node]);
    // An incompressible bar in tension has the strain diag(e, -e/2, -e/2), whose von Mises value is 3 e / 2. The factor
    // 2/3 converts this value to e.
    return von_mises(body.node_strain[node]) * 2 / 3;
}

}  // namespace

PageRow row_of(const Frame& frame) {
    const auto count = [&](ContactMotion motion) {
        return static_cast<Index>(std::ranges::count(frame.contacts, motion, &Contact::motion));
    };
    return {.time = frame.time,
            .energy = frame.energy,
            .contacts = static_cast<Index>(frame.contacts.size()),
            .stick = count(ContactMotion::stick),
            .slide = count(ContactMotion::slide),
            .regions = count_regions(frame.contacts)};
}

std::size_t PageStream::collider_number(const ColliderFrame& collider) {
    const auto [place, is_new] = collider_numbers_.try_emplace(collider.handle, static_cast<Index>(colliders_.size()));
    if (is_new) {
        const bool is_plane = std::holds_alternative<Plane>(*collider.shape);
        colliders_.push_back({.name = collider.name,
                              .kind = kind_names[collider.shape->index()],
                              .picture = is_plane ? SurfaceMesh{} : shape_picture(*collider.shape, {})});
    }
    return static_cast<std::size_t>(place->second);
}

std::string_view PageStream::pack(const Frame& frame) {
    values_.resize(frame.bodies.size());
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) measure_body(frame.bodies[i], values_[i]);
    for (const Contact& contact : frame.contacts) force_scale_.widen(contact.force().norm());

    bytes_.clear();
    put_count(bytes_, frame.bodies.size());
    put_count(bytes_, frame.colliders.size());
    put_count(bytes_, frame.contacts.size());
    for (const ValueScale& scale : field_scale_) put_change(bytes_, scale.exponent());
    put_change(bytes_, force_scale_.exponent());
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) pack_body(frame.bodies[i], values_[i]);
    for (const ColliderFrame& collider : frame.colliders) {
        put_count(bytes_, collider_number(collider));
        put_floats(bytes_, collider.pose.position);
        put_floats(bytes_, collider.pose.rotation);
    }
    pack_contacts(frame);
    lines_.put_frame(frame, bytes_);
    return bytes_;
}

/// Collects the values of a body at the vertices that the page draws, and widens the value scales to include them. Must
/// be called for all bodies of a frame before the first one is packed, because a scale applies to the whole frame.
void PageStream::measure_body(const BodyFrame& body, BodyValues& values) {
    SKERRY_CHECK(body.velocity.size() == body.position.size() && body.node_stress.size() == body.node_strain.size() &&
                 (body.node_mesh_error.empty() || body.node_mesh_error.size() == body.node_stress.size()) &&
                 (body.node_stress.empty() || body.node_stress.size() == body.position.size()));
    const auto [known, is_new] = body_numbers_.try_emplace(body.handle, static_cast<Index>(bodies_.size()));
    values.number = known->second;
    values.is_new = is_new;
    if (is_new) {
        bodies_.emplace_back(body);
        body_names_.push_back(body.name);
        body_handles_.push_back(body.handle);
        visual_numbers_.push_back(body.visual ? visuals_.number_of(*body.visual) : no_index);
    }
    for (std::size_t field = 0; field < page_field_count; ++field) {
        values.field[field].clear();
        for (const Index node : bodies_[static_cast<std::size_t>(values.number)].node()) {
            const Real value = value_at(body, field, static_cast<std::size_t>(node));
            values.field[field].push_back(value);
            field_scale_[field].widen(value);
        }
    }
}

void PageStream::pack_body(const BodyFrame& body, const BodyValues& values) {
    BodyStream& stream = bodies_[static_cast<std::size_t>(values.number)];
    put_count(bytes_, static_cast<std::uint64_t>(values.number));
    if (values.is_new) stream.put_shape(bytes_);
    stream.put_positions(body, bytes_);
    stream.put_values(values.field, field_scale_, bytes_);
}

void PageStream::pack_contacts(const Frame& frame) {
    const auto number_in = [](const auto& numbers, auto handle) {
        const auto found = numbers.find(handle);
        return found == numbers.end() ? no_index : found->second;
    };
    sides_.clear();
    for (const Contact& contact : frame.contacts)
        sides_.push_back({.first = number_in(body_numbers_, contact.first),
                          .second = number_in(body_numbers_, contact.second),
                          .collider = number_in(collider_numbers_, contact.collider)});
    contacts_.put_frame(frame, sides_, bodies_, force_scale_, bytes_);
}

}  // namespace skerry
