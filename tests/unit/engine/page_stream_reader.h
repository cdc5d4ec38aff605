// Reads frames of a page like the page's own player (engine/output/page/player/data/page_decode.js). This reader shares
// no code with the writer.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/types.h"

namespace skerry {

/// Decompresses a zlib stream. Throws std::runtime_error if the stream is invalid or incomplete.
std::string inflate_all(const std::string& packed);

inline constexpr std::size_t read_field_count = 4;  // number of fields of values at vertices

struct ReadBody {
    std::size_t number;
    std::vector<Vec3> position;                             // by vertex [m]
    std::array<std::vector<Real>, read_field_count> value;  // speed, stress, strain, mesh error by vertex
};

struct ReadContact {
    Index first, second, collider, region;
    Vec3 point, force;
    Real normal_force;
    int state, row_prev;  // row_prev: row in the previous frame, -1 if new
};

struct ReadLine {
    std::size_t number;
    std::vector<Vec3> points{};
    std::vector<Real> force{};
};

struct ReadFrame {
    std::array<Real, read_field_count + 1> top;  // maxima of the fields and of force
    std::vector<ReadBody> bodies;
    std::vector<std::size_t> colliders;
    std::vector<ReadContact> contacts;
    std::vector<ReadLine> lines;
    Real top_of_lines = 0;  // maximum of the forces of lines
};

struct ReadShape {
    std::vector<Index> node;
    std::vector<std::array<Index, 3>> triangles;
    Vec3 origin;
    Real step;  // [m]
};

struct ReadRun {
    std::vector<ReadShape> shapes;  // by body number
    std::vector<ReadFrame> frames;
    Vec3 origin_of_lines;
    Real step_of_lines = 0;  // [m]
};

/// A visual surface and its binding.
struct ReadVisual {
    std::vector<std::array<Index, 4>> node;  // nodes of the body, by node of the surface
    std::vector<std::array<Real, 4>> weight;
    std::vector<Vec3> offset;  // [m]
    std::vector<std::array<Index, 3>> triangles;
    std::vector<std::array<Real, 2>> texture_points;
    std::vector<std::array<Index, 3>> texture_corners;
    std::vector<Index> material;
    std::map<Index, std::vector<std::pair<Index, Vec3>>> gradient;  // terms, by node of the body

    /// Positions of the nodes, given those of the body [m].
    std::vector<Vec3> positions(std::span<const Vec3> of_body) const;
};

/// All visual surfaces of VisualStream::packed(). Throws std::runtime_error if bytes are missing.
std::vector<ReadVisual> read_visuals(const std::string& packed);

/// All frames of packed_frames(). Throws std::runtime_error if bytes are missing.
ReadRun read_run(const std::string& packed);
/// All frames of uncompressed bytes. Throws std::runtime_error if bytes are missing.
ReadRun read_frames(const std::string& bytes);

}  // namespace skerry
