#include "engine/output/page/stream/body_stream.h"

#include <algorithm>

#include "engine/output/page/stream/pack.h"
#include "engine/output/page/stream/visual_stream.h"

namespace skerry {

Lattice Lattice::around(std::span<const Vec3> points) {
    Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
    bool first = true;
    for (const Vec3& point : points) {
        if (!point.allFinite()) continue;
        lower = first ? point : Vec3(lower.cwiseMin(point));
        upper = first ? point : Vec3(upper.cwiseMax(point));
        first = false;
    }
    Lattice lattice{.origin = lower};
    const Real extent = (upper - lower).maxCoeff();
    if (extent > 0 && std::isfinite(extent)) lattice.step = extent / steps;
    return lattice;
}

Code3 Lattice::code(const Vec3& point, const Code3& code_prev) const {
    // Largest distance of a lattice point from the origin, in lattice steps. The JavaScript of the page computes with
    // doubles, in which sums of a few coordinates of this size are still exact.
    constexpr Real far = static_cast<Real>(std::int64_t{1} << 45);
    Code3 code = code_prev;
    for (int axis = 0; axis < 3; ++axis) {
        const Real steps_away = (point[axis] - origin[axis]) / step;
        if (std::abs(steps_away) <= far) code[static_cast<std::size_t>(axis)] = std::llround(steps_away);
    }
    return code;
}

Vec3 Lattice::point(const Code3& code) const {
    return origin + step * Vec3(static_cast<Real>(code[0]), static_cast<Real>(code[1]), static_cast<Real>(code[2]));
}

BodyStream::BodyStream(const BodyFrame& body) {
    std::vector<bool> used(body.position.size(), false);
    for (const auto& triangle : body.surface)
        for (const Index node : triangle) used[static_cast<std::size_t>(node)] = true;
    if (body.visual) mark_nodes(*body.visual, used);
    std::vector<Index> vertex(used.size(), no_index);
    std::vector<Vec3> points;
    for (std::size_t node = 0; node < vertex.size(); ++node)
        if (used[node]) {
            vertex[node] = static_cast<Index>(node_.size());
            node_.push_back(static_cast<Index>(node));
            points.push_back(body.position[node]);
        }
    const auto vertex_of = [&](Index node) { return vertex[static_cast<std::size_t>(node)]; };
    triangles_.reserve(body.surface.size());
    for (const auto& [a, b, c] : body.surface) triangles_.push_back({vertex_of(a), vertex_of(b), vertex_of(c)});
    lattice_ = Lattice::around(points);
    // A body without a surface also gets one entry, because first_code() reads the first entry (here 0).
    now_.resize(std::max<std::size_t>(node_.size(), 1));
    before_ = now_;
    for (Values& values : values_) values.code.resize(node_.size());
}

void BodyStream::put_shape(std::string& out) const {
    put_count(out, node_.size());
    put_count(out, triangles_.size());
    for (int axis = 0; axis < 3; ++axis) put(out, lattice_.origin[axis]);
    put(out, lattice_.step);
    Index last = 0;
    const auto put_next = [&](Index value) {
        put_change(out, value - last);
        last = value;
    };
    for (const Index node : node_) put_next(node);
    last = 0;
    for (const auto& triangle : triangles_)
        for (const Index corner : triangle) put_next(corner);
}

void BodyStream::put_positions(const BodyFrame& body, std::string& out) {
    next_.resize(now_.size());
    for (std::size_t vertex = 0; vertex < node_.size(); ++vertex)
        next_[vertex] = lattice_.code(body.position[static_cast<std::size_t>(node_[vertex])], now_[vertex]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::int64_t residual_prev = 0;
        for (std::size_t vertex = 0; vertex < node_.size(); ++vertex) {
            const std::int64_t last = now_[vertex][axis];
            const std::int64_t last_change = frames_ > 1 ? last - before_[vertex][axis] : 0;
            const std::int64_t residual = next_[vertex][axis] - last - last_change;
            put_change(out, residual - residual_prev);
            residual_prev = residual;
        }
    }
    before_.swap(now_);
    now_.swap(next_);
    ++frames_;
}

void BodyStream::put_values(std::span<const std::vector<Real>> values, std::span<const ValueScale> scales,
                            std::string& out) {
    // Changes of the stress codes since the last frame. The changes of the strain codes are predicted from these
    // changes.
    std::vector<int> stress_change(node_.size());
    const std::int64_t stress_sum_prev = values_[stress_field].sum;
    for (std::size_t field = 0; field < page_field_count; ++field) {
        const ValueScale& scale = scales[field];
        Values& last = values_[field];
        const bool follows = field == strain_field && stress_sum_prev > 0;
        const Real slope = follows ? static_cast<Real>(last.sum) / static_cast<Real>(stress_sum_prev) : 0;
        last.sum = 0;
        int residual_prev = 0;
        for (std::size_t vertex = 0; vertex < node_.size(); ++vertex) {
            const int code = scale.code(values[field][vertex]);
            const int change = code - shifted(last.code[vertex], last.exponent, scale.exponent());
            if (field == stress_field) stress_change[vertex] = change;
            const int residual =
                follows ? change - static_cast<int>(std::floor(stress_change[vertex] * slope + 0.5)) : change;
            put_change(out, residual - residual_prev);
            residual_prev = residual;
            last.code[vertex] = code;
            last.sum += code;
        }
        last.exponent = scale.exponent();
    }
}

}  // namespace skerry
