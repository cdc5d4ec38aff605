// Data that the page plays: all frames of the run in a compact encoding.
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
#include "engine/output/page/stream/line_stream.h"
#include "engine/output/page/stream/visual_stream.h"

namespace skerry {

/// A collider with the shape that it had in its first frame. Planes have no triangles, because the page draws them
/// itself.
struct PageCollider {
    std::string name;
    std::string kind;  // kind of shape: plane, sphere, box, capsule, cylinder, bucket or mesh
    SurfaceMesh picture;
};

/// Values of one frame for the plots on the page.
struct PageRow {
    Real time;  // [s]
    Energy energy;
    Index contacts, stick, slide, regions;
};

/// Packs frames into one stream as they arrive. The stream is compressed as a whole
/// (docs/decisions/0016-page-stream.md). Counts and changes are encoded as in pack.h, all other numbers are
/// little-endian. A frame consists of
///   numbers of bodies, colliders and contacts, as counts
///   exponents e of the largest values 4^e of speed, stress, strain and force (ValueScale), as changes from zero
///   for each body: its number as a count; its shape in its first frame only; positions; values of each field
///   (BodyStream)
///   for each collider: its number as a count; f32 position[3] [m], rotation[3] (axis times angle) [rad]
///   contacts (ContactStream)
///   lines (LineStream)
class PageData {
public:
    void add(const Frame& frame);

    std::span<const std::string> body_names() const { return body_names_; }
    /// Number of the visual surface of each body, or no_index. A body has that of its first frame.
    std::span<const Index> visual_numbers() const { return visual_numbers_; }
    const VisualStream& visuals() const { return visuals_; }
    std::span<const BodyStream> bodies() const { return bodies_; }
    std::span<const PageCollider> colliders() const { return colliders_; }
    std::span<const PageRow> rows() const { return rows_; }
    /// All frames, compressed.
    std::string packed_frames() const { return frames_.packed(); }
    /// Distribution of the values of each displayed field. The number of fields is page_field_count.
    std::span<const Quantile> fields() const { return fields_; }
    const Quantile& force() const { return force_; }
    const LineStream& lines() const { return lines_; }
    const Vec3& gravity() const { return gravity_; }

private:
    std::size_t collider_number(const ColliderFrame& collider);
    void measure_body(const BodyFrame& body, std::size_t place);
    void pack_body(const BodyFrame& body, std::size_t place, std::string& out);
    void pack_contacts(const Frame& frame, std::string& out);

    std::map<BodyHandle, Index> body_numbers_;
    std::map<ColliderHandle, Index> collider_numbers_;
    std::vector<std::string> body_names_;
    std::vector<Index> visual_numbers_;
    VisualStream visuals_;
    std::vector<BodyStream> bodies_;
    std::vector<PageCollider> colliders_;
    ContactStream contacts_;
    LineStream lines_;
    std::vector<PageRow> rows_;
    Deflater frames_;
    std::array<Quantile, page_field_count> fields_;
    Quantile force_;
    std::array<ValueScale, page_field_count> field_scale_;
    ValueScale force_scale_;
    Vec3 gravity_ = Vec3::Zero();  // gravity in the first frame [m/s^2]
    // Working memory that is reused for each frame. It contains for each body of the frame: its number, a flag if the
    // body is new, and its values by field and vertex.
    struct BodyValues {
        Index number = 0;
        bool is_new = false;
        std::array<std::vector<Real>, page_field_count> field;
    };
    std::vector<BodyValues> values_;
    std::vector<ContactSides> sides_;
};

}  // namespace skerry
