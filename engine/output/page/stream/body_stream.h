// Encodes the positions and values of one body, frame after frame, as changes from predictions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/stream/value_scale.h"

namespace skerry {

/// Number of fields that the page displays at a vertex. The fields are, in this order: speed [m/s], von Mises stress
/// [Pa], equivalent strain, and relative error of the stress due to the mesh (mesh_error()).
inline constexpr std::size_t page_field_count = 4;
inline constexpr std::size_t stress_field = 1, strain_field = 2, error_field = 3;

/// A lattice point: its three coordinates relative to the origin of the lattice, in lattice steps.
using Code3 = std::array<std::int64_t, 3>;

/// Lattice to which the positions of a body are rounded. Its origin is the lower corner of the bounding box of the
/// surface in the first frame of the body. A step is 2^-14 of the largest extent of this box, so rounding moves a
/// coordinate by at most 1/32768 of that extent.
struct Lattice {
    static constexpr int steps = 1 << 14;

    Vec3 origin = Vec3::Zero();  // [m]
    Real step = 1e-6;            // [m]

    static Lattice around(std::span<const Vec3> points);
    /// Returns the nearest lattice point. A coordinate that is not finite, or more than 2^45 steps from the origin, is
    /// taken from `code_prev` instead.
    Code3 code(const Vec3& point, const Code3& code_prev) const;
    Vec3 point(const Code3& code) const;
};

/// Encoder of one body. It stores the vertices that the page draws, and the codes of the last frames. The vertices are
/// the nodes of the surface, and the nodes on which the visual surface of the body depends.
class BodyStream {
public:
    explicit BodyStream(const BodyFrame& body);

    /// Writes, in this order:
    /// - numbers of vertices and triangles,
    /// - f64 origin[3] and step of the lattice [m],
    /// - for each vertex: the node number, as change from the previous vertex,
    /// - for each triangle corner: the vertex number, as change from the previous corner.
    void put_shape(std::string& out) const;
    /// Writes the positions of all vertices axis by axis. Each number is a residual (lattice coordinate minus
    /// prediction), written as change from the residual of the previous vertex. The predictions are
    /// - in the first frame: 0,
    /// - in the second frame: the coordinate in the first frame,
    /// - afterwards: a linear extrapolation from the last two frames.
    void put_positions(const BodyFrame& body, std::string& out);
    /// Writes the values of all vertices field by field. Each number is a residual (code minus prediction), written as
    /// change from the residual of the previous vertex. The predictions use the codes of the last frame, converted to
    /// the present scale:
    /// - speed, stress, mesh error: the last code,
    /// - strain: the last code plus r times the change of the stress code, rounded. The factor r is the ratio of strain
    ///   to stress: sum of all strain codes divided by the sum of all stress codes of the last frame, or 0 if the
    ///   latter is 0.
    void put_values(std::span<const std::vector<Real>> values, std::span<const ValueScale> scales, std::string& out);

    const std::vector<Index>& node() const { return node_; }
    const Lattice& lattice() const { return lattice_; }
    const Code3& first_code() const { return now_.front(); }

private:
    struct Values {
        int exponent = ValueScale::lowest;
        std::vector<int> code;  // by vertex
        std::int64_t sum = 0;   // sum of the codes of one field over all vertices
    };

    Lattice lattice_;
    std::vector<Index> node_;                      // node number within the body, by vertex
    std::vector<std::array<Index, 3>> triangles_;  // triangle corners as vertex numbers
    // Vertex positions as coordinates on lattice_ (integers): now_ in the last encoded frame, before_ in the frame
    // before that one. next_ is working memory.
    std::vector<Code3> now_, before_, next_;
    int frames_ = 0;
    std::array<Values, page_field_count> values_;
};

}  // namespace skerry
