// Whether what a file says of a world fits together: every row that is named is there, every range lies in its table.
// Each check complains by the file, which knows its name, and by the data set.
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include "components/range.h"
#include "engine/hdf5/hdf5_file.h"
#include "engine/world/world_state.h"

namespace skerry {

/// Before anything is derived from the tables: sizes, links, ranges and handles of the model.
void check_model(const Hdf5File& file, Model& model);
/// Once surfaces have been built: pairs, warm start, what the search remembers.
void check_cache(const Hdf5File& file, const Model& model, ContactCache& cache);
void check_candidates(const Hdf5File& file, const Model& model, const PairTable& pairs);
/// Contacts of the last step.
void check_contacts(const Hdf5File& file, const Model& model, ContactTable& contacts);
void check_resting_contacts(const Hdf5File& file, const Model& model, RestingContactTable& resting);
/// `kick`: s, of the last step.
void check_clock(const Hdf5File& file, const Clock& clock, Real kick);

/// Columns of one table, all as long as it.
inline void expect_size(const Hdf5File& file, const std::string& path, std::size_t found, std::size_t expected) {
    if (found != expected)
        file.complain(path, std::to_string(found) + " rows", std::to_string(expected) + ", as its table has");
}

/// Every entry is a row of something that has `count` rows; `none`: or no row.
inline void expect_rows_of(const Hdf5File& file, const std::string& path, std::span<const Index> rows,
                           std::size_t count, bool none = false) {
    for (std::size_t i = 0; i < rows.size(); ++i)
        if ((rows[i] < 0 && !(none && rows[i] == no_index)) || rows[i] >= static_cast<Index>(count))
            file.complain(path, std::to_string(rows[i]) + " at row " + std::to_string(i),
                          "a row of " + std::to_string(count) + (none ? ", or -1" : ""));
}

inline void expect_between(const Hdf5File& file, const std::string& path, auto&& values, auto least, auto most) {
    std::size_t row = 0;
    for (const auto& value : values) {
        if (!(value >= least && value <= most))
            file.complain(path, std::to_string(value) + " at row " + std::to_string(row),
                          "a number from " + std::to_string(least) + " to " + std::to_string(most));
        ++row;
    }
}

/// Ranges that follow each other and leave out none of `count` rows.
inline void expect_partition(const Hdf5File& file, const std::string& path, std::span<const Range> ranges,
                             std::size_t count) {
    Index end = 0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        if (ranges[i].begin != end || ranges[i].end < end)
            file.complain(path,
                          std::to_string(ranges[i].begin) + " to " + std::to_string(ranges[i].end) + " at row " +
                              std::to_string(i),
                          "a range that begins at " + std::to_string(end) + ", where the one before ends");
        end = ranges[i].end;
    }
    if (end != static_cast<Index>(count))
        file.complain(path, "ranges that end at " + std::to_string(end),
                      std::to_string(count) + ", the rows there are");
}

inline std::span<const Index> part(std::span<const Index> rows, Range range) {
    return rows.subspan(static_cast<std::size_t>(range.begin), static_cast<std::size_t>(range.size()));
}

}  // namespace skerry
