// Encodes joints, ties, cables and springs of each frame as changes from the previous frame.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/stream/body_stream.h"
#include "engine/output/page/stream/value_scale.h"

namespace skerry {

/// A line of the page. Lines are numbered in the order of their first appearance.
struct PageLine {
    std::string name;
    LineKind kind;
};

/// Encoder of all lines. It stores the points and forces of the previous frame, from which changes are computed.
class LineStream {
public:
    /// Writes the number of lines as a count. If it is not zero, writes further:
    /// 1. the exponent e of the scale of the forces, whose largest value is 4^e (ValueScale), encoded like a change;
    /// 2. in the first frame with lines: f64 origin[3] and step of the lattice on which points are encoded [m];
    /// 3. for each line: its number and its number of points, as counts; then x of all points, y of all points, z of
    ///    all points, and the forces at all points.
    ///
    /// Each value of 3. is written as change from a reference. If the line had the same number of points in the
    /// previous frame, this is the value of the point in that frame. Otherwise it is the value of the preceding point
    /// of the line, and zero for the first point.
    void put_frame(const Frame& frame, std::string& out);

    std::span<const PageLine> lines() const { return lines_; }

private:
    // encoded x, y, z (Lattice) and encoded force (ValueScale) of a point
    using Row = std::array<std::int64_t, 4>;

    std::map<decltype(LineFrame().key()), Index> numbers_;
    std::vector<PageLine> lines_;
    std::map<Index, std::vector<Row>> rows_prev_;  // rows of the previous frame by number of the line
    Lattice lattice_;
    bool has_lattice_ = false;
    ValueScale scale_;
};

}  // namespace skerry
