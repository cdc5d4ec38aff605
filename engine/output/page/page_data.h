// What the page plays: frames packed small.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/quantile.h"

namespace skerry {

/// The surface of a body, the same in all frames.
struct PageBody {
    std::string name;
    std::vector<Index> node;                      // of the body, by vertex of its surface
    std::vector<std::array<Index, 3>> triangles;  // rows of node
};

/// A collider as first seen. Planes have no triangles: the page draws them as far as it sees.
struct PageCollider {
    std::string name;
    std::string kind;  // plane, sphere, box, capsule, cylinder, bucket, mesh
    SurfaceMesh picture;
};

/// What the plots show of a frame.
struct PageRow {
    Real time;  // s
    Energy energy;
    Index contacts, stick, slide, regions;
};

/// Packs frames as they come. A packed frame is little-endian, each block filled up to 4 bytes:
///   u32 bodies, colliders, contacts
///   per body: u32 number; f32 top speed (m/s), top stress (Pa); f32 lower[3], extent[3] (m); u16 position[3 n] within
///   that box; u8 speed[n];
///     u8 stress[n], as fractions of the tops. Boxes and tops by body and frame, so a body far away or one peak costs
///     the others nothing.
///   per collider: u32 number; f32 position[3] (m), rotation[3] (axis times angle)
///   contacts: f32 unit of force (N), lower[3], extent[3] (m); u16 point[3 m]; i16 force[3 m]; u16 region[m] (modulo
///   65536, for
///     colours; 65535 none); u8 state[m] (0 open, 1 stick, 2 slide)
class PageData {
public:
    void add(const Frame& frame);

    std::span<const PageBody> bodies() const { return bodies_; }
    std::span<const PageCollider> colliders() const { return colliders_; }
    std::span<const PageRow> rows() const { return rows_; }
    std::span<const std::string> frames() const { return frames_; }
    const Quantile& speed() const { return speed_; }
    const Quantile& stress() const { return stress_; }
    const Quantile& force() const { return force_; }
    const Vec3& gravity() const { return gravity_; }

private:
    std::size_t body_number(const BodyFrame& body);
    std::size_t collider_number(const ColliderFrame& collider);
    void pack_body(const BodyFrame& body, std::string& out);
    void pack_contacts(const Frame& frame, std::string& out);

    std::map<BodyHandle, std::size_t> body_numbers_;
    std::map<ColliderHandle, std::size_t> collider_numbers_;
    std::vector<PageBody> bodies_;
    std::vector<PageCollider> colliders_;
    std::vector<PageRow> rows_;
    std::vector<std::string> frames_;
    Quantile speed_, stress_, force_;
    Vec3 gravity_ = Vec3::Zero();  // m/s^2, of the first frame
    // Scratch, kept for its memory.
    std::vector<Vec3> points_;
    std::vector<Real> values_;
};

}  // namespace skerry
