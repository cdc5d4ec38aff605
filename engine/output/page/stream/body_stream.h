// Encodes one body of the page, frame after frame, as changes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/stream/value_scale.h"

namespace skerry {

/// Fields that the page displays at a vertex, in this order: speed [m/s], von Mises stress [Pa], equivalent strain.
inline constexpr std::size_t page_field_count = 3;
inline constexpr std::size_t stress_field = 1, strain_field = 2;

/// A point on a lattice, in steps from its origin.
using Code3 = std::array<std::int64_t, 3>;

/// Lattice for the points of a body. Its origin is the lower corner of the surface when first seen. The largest extent
/// of the surface is divided into 2^14 steps. Points are accurate to half a step, 1/32768 of that extent.
struct Lattice {
    static constexpr int steps = 1 << 14;

    Vec3 origin = Vec3::Zero();  // [m]
    Real step = 1e-6;            // [m]

    static Lattice around(std::span<const Vec3> points);
    /// Returns the nearest lattice point. Coordinates that are not finite, or more than 2^45 steps away, are taken
    /// from `code_prev`.
    Code3 code(const Vec3& point, const Code3& code_prev) const;
    Vec3 point(const Code3& code) const;
};

/// Surface nodes of a body, which are the vertices on the page, and their encoded values in the last frame.
class BodyStream {
public:
    explicit BodyStream(const BodyFrame& body);

    /// Writes counts of vertices and triangles; f64 origin[3] and step of the lattice [m]; node numbers, each as
    /// change from the previous vertex; triangle corners, each as change from the previous corner.
    void put_shape(std::string& out) const;
    /// Writes positions by axis, then by vertex. Each number is the code minus its prediction, as a change from the
    /// previous vertex. The prediction extrapolates linearly from the last two frames; it is the last code in the
    /// second frame and 0 in the first.
    void put_positions(const BodyFrame& body, std::string& out);
    /// Writes values by field, then by vertex. Each number is the code minus its prediction, as a change from the
    /// previous vertex. The prediction is the code of the last frame. For strain the change of the stress code is
    /// added, times the ratio of the last frame's sums of strain and stress codes (if not 0), rounded: the two are
    /// nearly proportional.
    void put_values(std::span<const std::vector<Real>> values, std::span<const ValueScale> scales, std::string& out);

    const std::vector<Index>& node() const { return node_; }
    const Lattice& lattice() const { return lattice_; }
    const Code3& first_code() const { return now_.front(); }

private:
    struct Values {
        int exponent = ValueScale::lowest;
        std::vector<int> code;  // by vertex
        std::int64_t sum = 0;   // sum of the codes
    };

    Lattice lattice_;
    std::vector<Index> node_;                      // node of the body, by vertex
    std::vector<std::array<Index, 3>> triangles_;  // as vertices
    std::vector<Code3> now_, before_, next_;       // by vertex; next_ is scratch
    int frames_ = 0;
    std::array<Values, page_field_count> values_;
};

}  // namespace skerry
