// Checks the consistency of a saved world: every row number refers to an existing row, and every range lies within its
// table. Errors name the file and the data set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "components/any_table.h"
#include "components/range.h"
#include "engine/world/save/saved_file.h"
#include "engine/world/world_state.h"

namespace skerry {

/// Checks sizes, links, ranges and handles of the model. Must be called before any data are derived from the tables.
void check_model(const SavedFile& file, Model& model);
/// Checks node masses, and the surfaces of rigid bodies without tetrahedra. Must be called after put_records, which
/// restores the meshes.
void check_masses(const SavedFile& file, const Model& model);
/// Checks the tables whose rows join bodies or act on them, such as joints. Bodies must have been checked.
void check_joining_tables(const SavedFile& file, Model& model);
/// Checks material pairs, surface sets and the materials of colliders.
void check_surface_rules(const SavedFile& file, const Model& model);
/// Checks the pairs of close objects, the warm-start impulses and the data of the contact search. Surfaces must have
/// been built.
void check_cache(const SavedFile& file, const Model& model, ContactCache& cache);
void check_candidates(const SavedFile& file, const Model& model, const PairTable& pairs);
/// Checks the contacts of the last step.
void check_contacts(const SavedFile& file, const Model& model, ContactTable& contacts);
void check_resting_contacts(const SavedFile& file, const Model& model, RestingContactTable& resting);
/// Checks the clock. `kick_time`: time for which forces acted in the last step [s].
void check_clock(const SavedFile& file, const Clock& clock, Real kick_time);

/// Returns text for messages, such as "5 at row 7".
std::string at_row(const std::string& found, std::size_t row);
std::string at_row(Index found, std::size_t row);

inline bool is_real(NumberType number) {
    return number == NumberType::real || number == NumberType::single;
}

struct WrongReal {
    std::string found;
    std::size_t row;
};
/// Finds the first real number that a saved world must not have: NaN, or infinity in a column where it has no meaning.
/// `stride`: distance between two rows [bytes].
std::optional<WrongReal> find_wrong_real(std::string_view path, const RowType& type, const std::byte* rows,
                                         std::size_t stride, std::size_t count);

/// Throws SceneError unless `found`, the number of rows of a column, is `expected`.
void expect_size(const SavedFile& file, std::string_view path, std::size_t found, std::size_t expected);

/// Checks that all saved columns of a table have `rows` rows, and resizes the unsaved columns to this size. Columns
/// that contain lists may have any size.
void expect_one_size(const SavedFile& file, const char* name, AnyTable table, std::size_t rows);

/// Checks the offsets of a list of lists: there is at least one, and they ascend from 0 to `items`. `suffix`: text
/// after the found value in the message.
void expect_all_offsets(const SavedFile& file, const std::string& path, std::span<const Index> offset,
                        std::size_t items, const std::string& suffix = {});

/// Checks that every entry of `rows` is a row number of a table with `count` rows. If `none` is true, no_index is
/// accepted too.
void expect_rows_of(const SavedFile& file, std::string_view path, std::span<const Index> rows, std::size_t count,
                    bool none = false);

void expect_between(const SavedFile& file, std::string_view path, std::span<const Real> values, Real least, Real most);
void expect_between(const SavedFile& file, std::string_view path, std::span<const Index> values, Index least,
                    Index most);
void expect_between(const SavedFile& file, std::string_view path, std::span<const std::uint8_t> values,
                    std::uint8_t least, std::uint8_t most);

/// Checks that each range begins where the previous range ends, and that the ranges together cover `count` rows.
void expect_partition(const SavedFile& file, std::string_view path, std::span<const Range> ranges, std::size_t count);

bool is_rotation(const Mat3& matrix);

inline std::span<const Index> part(std::span<const Index> rows, Range range) {
    return rows.subspan(static_cast<std::size_t>(range.begin), static_cast<std::size_t>(range.size()));
}

}  // namespace skerry
