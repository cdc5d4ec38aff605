#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "engine/base/complaint.h"
#include "engine/mesh/shapes/add_tetrahedron.h"
#include "engine/mesh/shapes/stack_discs.h"

namespace skerry::mesh {
namespace {

using ProfilePoint = std::array<Real, 2>;  // radius and z [m]

// Height of a layer of prisms between two discs, divided by the spacing of the rings. This ratio maximises the smallest
// altitude of the tetrahedra.
constexpr Real layer_height = 1.0;
// A kink of the outline becomes a layer boundary if the direction changes by more than this angle [rad].
constexpr Real sharp_turn = 0.25;
// Smallest distance between two layer boundaries, divided by the spacing of the rings. A kink that is closer to a layer
// boundary does not become one itself, and the mesh cuts it off.
constexpr Real least_layer = 0.6;
constexpr Real point_radius = 0.3;  // an end narrower than this closes to a point (radius divided by ring spacing)

void check_profile(std::span<const ProfilePoint> profile) {
    if (profile.size() < 2) refuse("lathe", "profile", std::to_string(profile.size()) + " points", "at least 2");
    for (std::size_t i = 0; i < profile.size(); ++i) {
        require_size("lathe profile", "radius", profile[i][0]);
        if (!std::isfinite(profile[i][1]) || (i > 0 && !(profile[i][1] > profile[i - 1][1])))
            refuse("lathe", "profile", "z = " + short_text(profile[i][1], 6) + " at point " + std::to_string(i),
                   "finite z in ascending order (m)");
    }
}

Real radius_at(std::span<const ProfilePoint> profile, Real z) {
    std::size_t i = 1;
    while (i + 1 < profile.size() && profile[i][1] < z) ++i;
    const Real t = std::clamp((z - profile[i - 1][1]) / (profile[i][1] - profile[i - 1][1]), Real{0}, Real{1});
    return (1 - t) * profile[i - 1][0] + t * profile[i][0];
}

/// Returns the z coordinates of the ends of the outline and of its sharp kinks, in ascending order. If kinks are closer
/// together than least_layer * spacing, only the sharpest is used; a kink as close to an end is not used.
std::vector<Real> find_breaks(std::span<const ProfilePoint> profile, Real spacing) {
    std::vector<Real> turn(profile.size(), 0);
    std::vector<std::size_t> order;
    for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
        const auto slope = [&](std::size_t j) {
            return std::atan2(profile[j + 1][0] - profile[j][0], profile[j + 1][1] - profile[j][1]);
        };
        turn[i] = std::abs(slope(i) - slope(i - 1));
        if (turn[i] > sharp_turn) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return turn[a] > turn[b]; });
    std::vector<Real> breaks{profile.front()[1], profile.back()[1]};
    for (const std::size_t i : order) {
        const Real z = profile[i][1];
        if (std::all_of(breaks.begin(), breaks.end(),
                        [&](Real other) { return std::abs(z - other) >= least_layer * spacing; }))
            breaks.push_back(z);
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
}

std::vector<Real> find_planes(std::span<const ProfilePoint> profile, Real spacing) {
    const std::vector<Real> breaks = find_breaks(profile, spacing);
    const auto pointed = [&](const ProfilePoint& end) { return end[0] < point_radius * spacing; };
    std::vector<Real> planes{breaks.front()};
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
        Real layers = std::max(Real{1}, std::round((breaks[b + 1] - breaks[b]) / (layer_height * spacing)));
        // Between two pointed ends at least one disc is needed, because two points span no volume.
        if (breaks.size() == 2 && pointed(profile.front()) && pointed(profile.back()))
            layers = std::max(layers, Real{2});
        require_fits("lathe", "layers", layers);
        const auto count = static_cast<int>(layers);
        for (int i = 1; i < count; ++i) planes.push_back(breaks[b] + (breaks[b + 1] - breaks[b]) * i / count);
        planes.push_back(breaks[b + 1]);
    }
    return planes;
}

std::vector<Disc> plan_discs(std::span<const ProfilePoint> profile, Real spacing, int most_rings) {
    const Real narrow = point_radius * spacing;
    std::vector<Real> planes = find_planes(profile, spacing);
    // A pointed end becomes a single point. If the outline is narrower than `narrow` also at the neighbouring plane,
    // this plane would only produce tiny elements, so it is removed.
    while (planes.size() > 3 && profile.back()[0] < narrow && radius_at(profile, planes[planes.size() - 2]) < narrow)
        planes.erase(planes.end() - 2);
    while (planes.size() > 3 && profile.front()[0] < narrow && radius_at(profile, planes[1]) < narrow)
        planes.erase(planes.begin() + 1);
    std::vector<Disc> discs;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const Real radius = radius_at(profile, planes[i]);
        const bool end = i == 0 || i + 1 == planes.size();
        const int least = end && radius < narrow ? 0 : 1;
        discs.push_back(
            {planes[i], radius, std::clamp(static_cast<int>(std::lround(radius / spacing)), least, most_rings)});
    }
    // Neighbouring discs may differ by at most one ring, as stack_discs requires. Where they differ by more, the wider
    // disc gets fewer rings. Elements may thus become longer, but not shorter.
    for (std::size_t i = 1; i < discs.size(); ++i) discs[i].rings = std::min(discs[i].rings, discs[i - 1].rings + 1);
    for (std::size_t i = discs.size() - 1; i-- > 0;) discs[i].rings = std::min(discs[i].rings, discs[i + 1].rings + 1);
    return discs;
}

}  // namespace

Mesh lathe(std::span<const ProfilePoint> profile, int resolution) {
    check_profile(profile);
    require_count("lathe", "resolution", resolution);
    const Real widest = (*std::max_element(profile.begin(), profile.end()))[0];
    const int rings = resolution / 2 + resolution % 2;
    const Real spacing = widest / rings;
    require_fits("lathe", "resolution",
                 18.0 * rings * rings * ((profile.back()[1] - profile.front()[1]) / spacing + 2));
    return stack_discs(plan_discs(profile, spacing, rings));
}

Mesh cylinder(Real radius, Real height, int resolution) {
    require_size("cylinder", "radius", radius);
    require_size("cylinder", "height", height);
    return lathe(std::array<ProfilePoint, 2>{{{radius, -height / 2}, {radius, height / 2}}}, resolution);
}

Mesh skittle(Real height, int resolution) {
    require_size("skittle", "height", height);
    // Outline of a ninepin: foot, belly at 0.3 of the height, neck at 0.7, head. Radius and z are relative to the
    // height.
    std::array<ProfilePoint, 12> profile{{{0.110, 0.00},
                                          {0.134, 0.10},
                                          {0.147, 0.20},
                                          {0.150, 0.30},
                                          {0.143, 0.40},
                                          {0.122, 0.50},
                                          {0.094, 0.60},
                                          {0.076, 0.70},
                                          {0.076, 0.76},
                                          {0.090, 0.84},
                                          {0.088, 0.92},
                                          {0.060, 1.00}}};
    for (ProfilePoint& point : profile) point = {point[0] * height, point[1] * height};
    return lathe(profile, resolution);
}

}  // namespace skerry::mesh
