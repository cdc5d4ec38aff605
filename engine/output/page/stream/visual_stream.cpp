#include "engine/output/page/stream/visual_stream.h"

#include <algorithm>
#include <cmath>

#include "engine/output/page/stream/deflate.h"
#include "engine/output/page/stream/pack.h"

namespace skerry {
namespace {

constexpr Real weight_steps = 1 << 16;

/// Writes `count` integers, the first as it is, the others as changes from the previous integer.
void put_changes(std::string& out, std::size_t count, auto&& value) {
    std::int64_t last = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto now = static_cast<std::int64_t>(value(i));
        put_change(out, now - last);
        last = now;
    }
}

void put_corners(std::string& out, const std::vector<std::array<Index, 3>>& triangles) {
    put_changes(out, 3 * triangles.size(), [&](std::size_t i) { return triangles[i / 3][i % 3]; });
}

void put_binding(std::string& out, const BoundVisual& visual) {
    Real longest = 0;
    for (const Vec3& offset : visual.offset) longest = std::max(longest, offset.cwiseAbs().maxCoeff());
    const Real step = longest > 0 ? longest / (1 << 14) : 1;
    put(out, step);
    const std::size_t nodes = visual.point.size();
    for (std::size_t k = 0; k < 4; ++k) put_changes(out, nodes, [&](std::size_t i) { return visual.point[i].node[k]; });
    for (std::size_t k = 0; k < 3; ++k)
        put_changes(out, nodes, [&](std::size_t i) { return std::llround(visual.point[i].weight[k] * weight_steps); });
    for (int axis = 0; axis < 3; ++axis)
        put_changes(out, nodes, [&](std::size_t i) {
            return visual.offset.empty() ? 0 : std::llround(visual.offset[i][axis] / step);
        });
    std::vector<std::size_t> with_terms;
    for (std::size_t n = 0; n < visual.gradient.size(); ++n)
        if (!visual.gradient[n].empty()) with_terms.push_back(n);
    put_count(out, with_terms.size());
    std::int64_t last = 0;
    for (const std::size_t n : with_terms) {
        put_change(out, static_cast<std::int64_t>(n) - last);
        last = static_cast<std::int64_t>(n);
        put_count(out, visual.gradient[n].size());
        std::int64_t last_term = last;
        for (const GradientTerm& term : visual.gradient[n]) {
            put_change(out, term.node - last_term);
            last_term = term.node;
            put_floats(out, term.gradient);
        }
    }
}

std::string encode(const BoundVisual& visual) {
    const VisualSurface& surface = visual.surface;
    const std::size_t points = surface.texture_corners.empty() ? 0 : surface.texture_points.size();
    std::string out;
    put_count(out, visual.point.size());
    put_count(out, surface.triangles.size());
    put_count(out, points);
    put_count(out, surface.materials.size());
    put_binding(out, visual);
    put_corners(out, surface.triangles);
    if (points > 0) {
        for (std::size_t k = 0; k < 2; ++k)
            put_changes(out, points,
                        [&](std::size_t i) { return std::llround(surface.texture_points[i][k] * weight_steps); });
        put_corners(out, surface.texture_corners);
    }
    if (!surface.materials.empty())
        put_changes(out, surface.triangles.size(),
                    [&](std::size_t i) { return surface.material.empty() ? no_index : surface.material[i]; });
    return out;
}

}  // namespace

Index VisualStream::number_of(const BoundVisual& visual) {
    std::string encoded = encode(visual);
    for (std::size_t i = 0; i < encoded_.size(); ++i)
        if (encoded_[i] == encoded && materials_[i] == visual.surface.materials) return static_cast<Index>(i);
    encoded_.push_back(std::move(encoded));
    materials_.push_back(visual.surface.materials);
    return static_cast<Index>(encoded_.size() - 1);
}

std::string VisualStream::packed(std::size_t first) const {
    Deflater deflater;
    for (std::size_t i = first; i < encoded_.size(); ++i) deflater.add(encoded_[i]);
    return deflater.packed();
}

void mark_nodes(const BoundVisual& visual, std::vector<bool>& used) {
    const auto mark = [&](Index node) { used[static_cast<std::size_t>(node)] = true; };
    for (const MaterialPoint& point : visual.point) std::ranges::for_each(point.node, mark);
    for (const GradientTerm& term : visual.gradient.item) mark(term.node);
}

}  // namespace skerry
