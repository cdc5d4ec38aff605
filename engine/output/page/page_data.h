// Data of the page that plays a recorded run: all frames of the run in a compact encoding.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/output/page/page_stream.h"
#include "engine/output/page/quantile.h"
#include "engine/output/page/stream/deflate.h"

namespace skerry {

/// Packs frames as they arrive, and compresses the stream as a whole (docs/decisions/0016-page-stream.md).
class PageData {
public:
    void add(const Frame& frame);

    const PageStream& stream() const { return stream_; }
    std::span<const PageRow> rows() const { return rows_; }
    /// All frames, compressed.
    std::string packed_frames() const { return frames_.packed(); }
    /// Distribution of the values of each displayed field. The number of fields is page_field_count.
    std::span<const Quantile> fields() const { return fields_; }
    /// force(): distribution of the norms of the contact forces [N]. line_force(): distribution of the absolute values
    /// of the forces of lines [N].
    const Quantile& force() const { return force_; }
    const Quantile& line_force() const { return line_force_; }
    const Vec3& gravity() const { return gravity_; }

private:
    PageStream stream_;
    std::vector<PageRow> rows_;
    Deflater frames_;
    std::array<Quantile, page_field_count> fields_;
    Quantile force_, line_force_;
    Vec3 gravity_ = Vec3::Zero();  // gravity in the first frame [m/s^2]
};

}  // namespace skerry
