#include "engine/output/page/page_data.h"

#include <cmath>

namespace skerry {

void PageData::add(const Frame& frame) {
    if (rows_.empty()) gravity_ = frame.gravity;
    frames_.add(stream_.pack(frame));
    for (const PageStream::BodyValues& body : stream_.values())
        for (std::size_t field = 0; field < page_field_count; ++field)
            for (const Real value : body.field[field]) fields_[field].add(value);
    for (const Contact& contact : frame.contacts) force_.add(contact.force().norm());
    for (const LineFrame& line : frame.lines)
        for (const Real force : line.force) line_force_.add(std::abs(force));
    rows_.push_back(row_of(frame));
}

}  // namespace skerry
