// One body of the page, frame after frame, as changes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/stream/value_scale.h"

namespace skerry {

/// What the page shows at a vertex besides its place, in this order: speed (m/s), von Mises stress (Pa), equivalent
/// strain.
inline constexpr std::size_t page_field_count = 3;
inline constexpr std::size_t stress_field = 1, strain_field = 2;

/// A point on a lattice.
using Code3 = std::array<std::int64_t, 3>;

/// Where the points of a body can be: lower corner and largest extent of its surface when it was first seen, cut into
/// 2^14 steps. A point is right to half a step, which is 1/32768 of that extent.
struct Lattice {
    static constexpr int steps = 1 << 14;

    Vec3 origin = Vec3::Zero();  // m
    Real step = 1e-6;            // m

    static Lattice around(std::span<const Vec3> points);
    /// Coordinates that are not finite, or farther than 2^45 steps away, stay where `code_prev` has them.
    Code3 code(const Vec3& point, const Code3& code_prev) const;
    Vec3 point(const Code3& code) const;
};

/// The nodes of the surface of a body, which are the vertices of the page, and what they were in the last frame.
class BodyStream {
public:
    explicit BodyStream(const BodyFrame& body);

    /// Counts of vertices, triangles; f64 origin[3], step of the lattice (m); changes from one vertex to the next of
    /// its node; changes from one corner to the next of triangles.
    void put_shape(std::string& out) const;
    /// By axis, vertex after vertex: what the code is beside the prediction, as a change from the vertex before. The
    /// prediction goes on as from the frame before last to the last; 0 in the first frame.
    void put_positions(const BodyFrame& body, std::string& out);
    /// By field, by vertex: what the code is beside the prediction, as a change from the vertex before. The prediction
    /// is the code of the last frame; that of strain goes with the change of stress, times the sum of all codes of
    /// strain over that of stress in the last frame (if not 0), rounded: they are nearly proportional.
    void put_values(std::span<const std::vector<Real>> values, std::span<const ValueScale> scales, std::string& out);

    const std::vector<Index>& node() const { return node_; }
    const Lattice& lattice() const { return lattice_; }
    const Code3& first_code() const { return now_.front(); }

private:
    struct Values {
        int exponent = ValueScale::lowest;
        std::vector<int> code;  // by vertex
        std::int64_t sum = 0;   // of the codes
    };

    Lattice lattice_;
    std::vector<Index> node_;                      // of the body, by vertex
    std::vector<std::array<Index, 3>> triangles_;  // vertices
    std::vector<Code3> now_, before_, next_;       // by vertex; next_ is scratch
    int frames_ = 0;
    std::array<Values, page_field_count> values_;
};

}  // namespace skerry
