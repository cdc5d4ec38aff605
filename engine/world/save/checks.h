// Whether what a file says of a world fits together: every row that is named is there, every range lies in its table.
// Each check complains by the file, which knows its name, and by the data set.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "components/any_table.h"
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

/// "5 at row 7"
std::string at_row(const std::string& found, std::size_t row);
std::string at_row(Index found, std::size_t row);

/// Columns of one table, all as long as it.
void expect_size(const Hdf5File& file, std::string_view path, std::size_t found, std::size_t expected);

/// All saved columns of a table have as many rows; those that are not saved get them. Lists that rows have ranges of
/// may have any length.
void expect_one_size(const Hdf5File& file, const char* name, AnyTable table, std::size_t rows);

/// Every entry is a row of something that has `count` rows; `none`: or no row.
void expect_rows_of(const Hdf5File& file, std::string_view path, std::span<const Index> rows, std::size_t count,
                    bool none = false);

void expect_between(const Hdf5File& file, std::string_view path, std::span<const Real> values, Real least, Real most);
void expect_between(const Hdf5File& file, std::string_view path, std::span<const Index> values, Index least,
                    Index most);
void expect_between(const Hdf5File& file, std::string_view path, std::span<const std::uint8_t> values,
                    std::uint8_t least, std::uint8_t most);

/// Ranges that follow each other and leave out none of `count` rows.
void expect_partition(const Hdf5File& file, std::string_view path, std::span<const Range> ranges, std::size_t count);

inline std::span<const Index> part(std::span<const Index> rows, Range range) {
    return rows.subspan(static_cast<std::size_t>(range.begin), static_cast<std::size_t>(range.size()));
}

}  // namespace skerry
