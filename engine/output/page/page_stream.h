// Encoder of the frames of a run for the HTML page that plays them in a browser, recorded or live.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/stream/body_stream.h"
#include "engine/output/page/stream/contact_stream.h"
#include "engine/output/page/stream/line_stream.h"
#include "engine/output/page/stream/visual_stream.h"

namespace skerry {

/// A collider with the shape that it had in its first frame. `picture`: triangle mesh for display; empty for a plane,
/// because the page draws planes itself.
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
PageRow row_of(const Frame& frame);

/// Packs frames one after the other. The stream stores the last frame, and the objects that were in any frame, so its
/// memory does not grow with the number of frames. Counts and changes are encoded as in pack.h, all other numbers are
/// little-endian. A frame consists of
///   numbers of bodies, colliders and contacts, as counts
///   exponents e of the upper ends 4^e of the scales of speed, stress, strain, mesh error and force (ValueScale), as
///     changes from zero
///   for each body: its number as a count; its shape in its first frame only; positions; values of each field
///     (BodyStream)
///   for each collider: its number as a count; f32 position[3] [m], rotation[3] (axis times angle) [rad]
///   contacts (ContactStream)
///   lines (LineStream)
class PageStream {
public:
    /// Returns the bytes of the frame, which are valid until the next call. Missing stresses, strains and mesh errors
    /// of a body are written as 0.
    std::string_view pack(const Frame& frame);

    // Objects of all frames so far. The index in a list is the number of the object in the stream.
    std::span<const std::string> body_names() const { return body_names_; }
    std::span<const BodyHandle> body_handles() const { return body_handles_; }
    /// Number of the visual surface of each body, or no_index. A body keeps the visual surface of its first frame.
    std::span<const Index> visual_numbers() const { return visual_numbers_; }
    const VisualStream& visuals() const { return visuals_; }
    std::span<const BodyStream> bodies() const { return bodies_; }
    std::span<const PageCollider> colliders() const { return colliders_; }
    std::span<const PageLine> lines() const { return lines_.lines(); }

    /// Values of one body in the last frame, by field and vertex. The list that values() returns has the order of the
    /// bodies in the frame.
    struct BodyValues {
        Index number = 0;     // number of the body in the stream
        bool is_new = false;  // true in the first frame of the body
        std::array<std::vector<Real>, page_field_count> field{};
    };
    std::span<const BodyValues> values() const { return values_; }

private:
    std::size_t collider_number(const ColliderFrame& collider);
    void measure_body(const BodyFrame& body, BodyValues& values);
    void pack_body(const BodyFrame& body, const BodyValues& values);
    void pack_contacts(const Frame& frame);

    std::map<BodyHandle, Index> body_numbers_;
    std::map<ColliderHandle, Index> collider_numbers_;
    std::vector<std::string> body_names_;
    std::vector<BodyHandle> body_handles_;
    std::vector<Index> visual_numbers_;
    VisualStream visuals_;
    std::vector<BodyStream> bodies_;
    std::vector<PageCollider> colliders_;
    ContactStream contacts_;
    LineStream lines_;
    std::array<ValueScale, page_field_count> field_scale_;
    ValueScale force_scale_;
    // Memory that is reused for each frame. `values_` and `bytes_` hold the results of the last frame.
    std::vector<BodyValues> values_;
    std::vector<ContactSides> sides_;
    std::string bytes_;
};

}  // namespace skerry
