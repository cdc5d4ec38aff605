#include "engine/output/page/stream/line_stream.h"

#include <cmath>
#include <utility>

#include "engine/output/page/stream/pack.h"

namespace skerry {
namespace {

/// Lattice around the bodies and lines of a frame.
Lattice lattice_around(const Frame& frame) {
    std::vector<Vec3> points;
    for (const BodyFrame& body : frame.bodies) points.insert(points.end(), body.position.begin(), body.position.end());
    for (const LineFrame& line : frame.lines) points.insert(points.end(), line.points.begin(), line.points.end());
    return Lattice::around(points);
}

}  // namespace

void LineStream::put_frame(const Frame& frame, std::string& out) {
    std::map<Index, std::vector<Row>> rows_now;
    put_count(out, frame.lines.size());
    const int exponent_prev = scale_.exponent();
    for (const LineFrame& line : frame.lines)
        for (const Real force : line.force) scale_.widen(std::abs(force));
    if (!frame.lines.empty()) put_change(out, scale_.exponent());
    if (!frame.lines.empty() && !std::exchange(has_lattice_, true)) {
        lattice_ = lattice_around(frame);
        for (int axis = 0; axis < 3; ++axis) put(out, lattice_.origin[axis]);
        put(out, lattice_.step);
    }
    for (const LineFrame& line : frame.lines) {
        const auto [place, is_new] = numbers_.try_emplace(line.key(), static_cast<Index>(lines_.size()));
        if (is_new) lines_.push_back({line.name, line.kind});
        const Index number = place->second;
        const auto prev = rows_prev_.find(number);
        const bool continues = prev != rows_prev_.end() && prev->second.size() == line.points.size();
        std::vector<Row>& rows = rows_now[number];
        std::vector<Row> changes(line.points.size());
        for (std::size_t p = 0; p < line.points.size(); ++p) {
            Row base = p > 0 ? rows[p - 1] : Row{};
            if (continues) {
                base = prev->second[p];
                base[3] = shifted(static_cast<int>(base[3]), exponent_prev, scale_.exponent());
            }
            const Code3 point = lattice_.code(line.points[p], {base[0], base[1], base[2]});
            rows.push_back({point[0], point[1], point[2], scale_.code(line.force[p])});
            for (std::size_t k = 0; k < base.size(); ++k) changes[p][k] = rows[p][k] - base[k];
        }
        put_count(out, static_cast<std::uint64_t>(number));
        put_count(out, line.points.size());
        for (std::size_t k = 0; k < Row{}.size(); ++k)
            for (const Row& change : changes) put_change(out, change[k]);
    }
    rows_prev_ = std::move(rows_now);
}

}  // namespace skerry
