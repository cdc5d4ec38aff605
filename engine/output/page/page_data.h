// What the page plays: frames packed small.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/quantile.h"
#include "engine/output/page/stream/body_stream.h"
#include "engine/output/page/stream/contact_stream.h"
#include "engine/output/page/stream/deflate.h"

namespace skerry {

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

/// Packs frames as they come into one stream, compressed as a whole (docs/decisions/0016-page-stream.md). Counts and
/// changes as in pack.h, the rest little-endian. A frame is
///   counts of bodies, colliders, contacts
///   changes: exponents of four of the tops of speed, stress, strain and force (ValueScale), each from zero
///   per body: count: its number; if it is new its shape, then positions, then values of each field (BodyStream)
///   per collider: count: its number; f32 position[3] (m), rotation[3] (axis times angle)
///   contacts (ContactStream)
class PageData {
public:
    void add(const Frame& frame);

    std::span<const std::string> body_names() const { return body_names_; }
    std::span<const BodyStream> bodies() const { return bodies_; }
    std::span<const PageCollider> colliders() const { return colliders_; }
    std::span<const PageRow> rows() const { return rows_; }
    /// All frames, compressed.
    std::string packed_frames() const { return frames_.packed(); }
    /// By field, in the order of page_field_count.
    std::span<const Quantile> fields() const { return fields_; }
    const Quantile& force() const { return force_; }
    const Vec3& gravity() const { return gravity_; }

private:
    std::size_t collider_number(const ColliderFrame& collider);
    void measure_body(const BodyFrame& body, std::size_t place);
    void pack_body(const BodyFrame& body, std::size_t place, std::string& out);
    void pack_contacts(const Frame& frame, std::string& out);

    std::map<BodyHandle, Index> body_numbers_;
    std::map<ColliderHandle, Index> collider_numbers_;
    std::vector<std::string> body_names_;
    std::vector<BodyStream> bodies_;
    std::vector<PageCollider> colliders_;
    ContactStream contacts_;
    std::vector<PageRow> rows_;
    Deflater frames_;
    std::array<Quantile, page_field_count> fields_;
    Quantile force_;
    std::array<ValueScale, page_field_count> field_scale_;
    ValueScale force_scale_;
    Vec3 gravity_ = Vec3::Zero();  // m/s^2, of the first frame
    // Scratch, kept for its memory: what the bodies of the frame have at their vertices, by body and field; which of
    // them are new.
    struct BodyValues {
        Index number = 0;
        bool is_new = false;
        std::array<std::vector<Real>, page_field_count> field;
    };
    std::vector<BodyValues> values_;
    std::vector<ContactSides> sides_;
};

}  // namespace skerry
