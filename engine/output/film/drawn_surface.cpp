#include "engine/output/film/drawn_surface.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/complaint.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {

namespace {

// Colours as 0xRRGGBB (sRGB). `ramp` extends from the value 0 of a quantity to its top value. `body_colors` are given
// to the bodies in turn. Both lists equal those of web pages (player/data/page_colors.js).
constexpr std::uint32_t ramp[] = {0x8f8ad6, 0xb27cd0, 0xcf72b8, 0xe56d92, 0xf27f67, 0xf9a64a, 0xf7dd53};
constexpr std::uint32_t body_colors[] = {0x6fa8dc, 0xe6a15c, 0x7fbf7b, 0xd98cb3, 0xb8a6e0,
                                         0xd8c25f, 0x6cc5c1, 0xe07f72, 0xa9b665, 0x8f9fb8};
constexpr std::uint32_t collider_color = 0x9fb0c0;

/// Converts a colour channel in [0, 1] from sRGB to linear intensity.
float linear_channel(float value) {
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

/// Converts a colour from 0xRRGGBB (sRGB) to linear intensities.
Color linear(std::uint32_t srgb) {
    const auto channel = [srgb](int shift) { return linear_channel(static_cast<float>(srgb >> shift & 255) / 255); };
    return {channel(16), channel(8), channel(0)};
}

template <class T>
std::vector<T> gathered(std::span<const Index> nodes, std::span<const T> of_nodes) {
    std::vector<T> values;
    values.reserve(nodes.size());
    for (const Index node : nodes) values.push_back(of_nodes[static_cast<std::size_t>(node)]);
    return values;
}

/// Area of the surface that belongs to each node: a third of each adjacent triangle [m^2].
std::vector<Real> areas_of_nodes(const BodyFrame& body) {
    std::vector<Real> area(body.position.size(), 0);
    for (const auto& triangle : body.surface) {
        const auto corner = [&](std::size_t k) { return body.position[static_cast<std::size_t>(triangle[k])]; };
        const Real third = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 6;
        for (const Index node : triangle) area[static_cast<std::size_t>(node)] += third;
    }
    return area;
}

/// Returns the node nearest to a point among those on the drawn surface (area > 0), or `node` if there is none.
std::size_t nearest_drawn(const BodyFrame& body, std::span<const Real> area, const Vec3& point, std::size_t node) {
    Real least = infinity;
    for (std::size_t n = 0; n < area.size(); ++n) {
        const Real distance = (body.position[n] - point).squaredNorm();
        if (area[n] == 0 || !(distance < least)) continue;
        least = distance;
        node = n;
    }
    return node;
}

/// Contact pressure by body and node: sum of the normal forces of the contacts at the node, divided by the surface area
/// that belongs to the node [Pa].
std::vector<std::vector<Real>> contact_pressures(const Frame& frame) {
    std::vector<std::vector<Real>> pressure, area;
    std::map<BodyHandle, std::size_t> number;
    for (const BodyFrame& body : frame.bodies) {
        number.emplace(body.handle, pressure.size());
        pressure.emplace_back(body.position.size(), 0);
        area.push_back(areas_of_nodes(body));
    }
    for (const Contact& contact : frame.contacts)
        for (std::size_t a = 0; a < contact.node.size(); ++a) {
            const auto found = number.find(contact.weight[a] > 0 ? contact.first : contact.second);
            if (contact.weight[a] == 0 || found == number.end()) continue;
            const std::size_t b = found->second;
            auto node = static_cast<std::size_t>(contact.node[a]);
            // Contacts of round bodies act on core nodes, which lie inside the drawn surface.
            if (area[b][node] == 0) node = nearest_drawn(frame.bodies[b], area[b], contact.point, node);
            pressure[b][node] += std::abs(contact.weight[a] * contact.force().dot(contact.normal));
        }
    for (std::size_t b = 0; b < pressure.size(); ++b)
        for (std::size_t n = 0; n < pressure[b].size(); ++n)
            if (area[b][n] > 0) pressure[b][n] /= area[b][n];
    return pressure;
}

}  // namespace

DrawnSurface::DrawnSurface(const BodyFrame& body) : visual_(body.visual) {
    if (visual_ != nullptr) {
        triangles_ = visual_->surface.triangles;
        return;
    }
    std::vector<Index> vertex(body.position.size(), no_index);
    for (const auto& triangle : body.surface)
        for (const Index node : triangle) vertex[static_cast<std::size_t>(node)] = 0;
    for (std::size_t node = 0; node < vertex.size(); ++node) {
        if (vertex[node] == no_index) continue;
        vertex[node] = static_cast<Index>(node_.size());
        node_.push_back(static_cast<Index>(node));
    }
    const auto vertex_of = [&](Index node) { return vertex[static_cast<std::size_t>(node)]; };
    for (const auto& [a, b, c] : body.surface) triangles_.push_back({vertex_of(a), vertex_of(b), vertex_of(c)});
}

bool DrawnSurface::is_drawn(const BodyFrame& body) const {
    return body.visual == visual_ && (visual_ == nullptr || body.visual->surface.triangles == triangles_);
}

std::vector<Vec3> DrawnSurface::vectors(const BodyFrame& body, std::span<const Vec3> of_nodes) const {
    return visual_ != nullptr ? visual_positions(*body.visual, of_nodes) : gathered(node_, of_nodes);
}

std::vector<Real> DrawnSurface::values(const BodyFrame& body, std::span<const Real> of_nodes, FilmColor color) const {
    if (visual_ == nullptr) return gathered(node_, of_nodes);
    if (color != FilmColor::speed) return visual_values(*body.visual, of_nodes);
    std::vector<Real> speeds;
    for (const Vec3& velocity : visual_positions(*body.visual, body.velocity)) speeds.push_back(velocity.norm());
    return speeds;
}

void require_positive(const std::filesystem::path& file, const char* setting, Real value) {
    if (value > 0 && std::isfinite(value)) return;
    refuse_in(file.string(), "output", setting, std::to_string(value), "a number above 0");
}

std::vector<Vec3f> relative_to(const Vec3& origin, std::span<const Vec3> points) {
    std::vector<Vec3f> relative;
    relative.reserve(points.size());
    for (const Vec3& point : points) {
        const Eigen::Vector3f from_origin = (point - origin).cast<float>();
        relative.push_back({from_origin.x(), from_origin.y(), from_origin.z()});
    }
    return relative;
}

Vec3 mean_of(std::span<const Vec3> points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : points) sum += point;
    return sum / static_cast<Real>(std::max<std::size_t>(points.size(), 1));
}

Quantity quantity_of(FilmColor color) {
    if (color == FilmColor::stress) return {"von_mises", "Pa"};
    if (color == FilmColor::speed) return {"speed", "m/s"};
    return {"contact_pressure", "Pa"};
}

std::vector<std::vector<Real>> quantity_of_nodes(const Frame& frame, FilmColor color) {
    if (color == FilmColor::contact) return contact_pressures(frame);
    std::vector<std::vector<Real>> values;
    for (const BodyFrame& body : frame.bodies) {
        std::vector<Real>& of_body = values.emplace_back();
        if (color == FilmColor::stress)
            for (const Mat3& stress : body.node_stress) of_body.push_back(von_mises(stress));
        else
            for (const Vec3& velocity : body.velocity) of_body.push_back(velocity.norm());
    }
    return values;
}

Color color_of_value(Real value, Real top) {
    constexpr std::size_t pieces = std::size(ramp) - 1;
    const Real share = top > 0 && std::isfinite(value) ? std::clamp<Real>(value / top, 0, 1) : 0;
    const std::size_t piece = std::min(static_cast<std::size_t>(share * pieces), pieces - 1);
    const Color low = linear(ramp[piece]), high = linear(ramp[piece + 1]);
    Color mixed;
    for (std::size_t k = 0; k < mixed.size(); ++k)
        mixed[k] = std::lerp(low[k], high[k], static_cast<float>(share * pieces - static_cast<Real>(piece)));
    return mixed;
}

Color color_of_body(std::size_t number) {
    return linear(body_colors[number % std::size(body_colors)]);
}

Color color_of_colliders() {
    return linear(collider_color);
}

Color color_of_material(const VisualMaterial& material) {
    Color color;
    for (std::size_t k = 0; k < color.size(); ++k) color[k] = linear_channel(static_cast<float>(material.color[k]));
    return color;
}

}  // namespace skerry
