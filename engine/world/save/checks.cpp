#include "engine/world/save/checks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/base/complaint.h"

namespace skerry {

namespace {

/// True for columns that may contain infinity. Infinity means that a limit does not apply, or that a lane of an element
/// block is unused.
bool may_be_infinite(std::string_view path) {
    constexpr std::array<std::string_view, 21> paths{"watch/step",
                                                     "watch/look/in_frame",
                                                     "watch/look/highest",
                                                     "tetrahedra/altitude",
                                                     "tetrahedra/uninverted_until",
                                                     "bodies/uninverted_until",
                                                     "bodies/rest_step",
                                                     "bodies/stable_step",
                                                     "bodies/cluster_step",
                                                     "bodies/travel",
                                                     "colliders/travel",
                                                     "pairs/valid_until",
                                                     "pairs/candidates/asleep_until",
                                                     "search/body_valid_until",
                                                     "search/collider_valid_until",
                                                     "joints/lower",
                                                     "joints/upper",
                                                     "joints/motor",
                                                     "ties/break_force",
                                                     "ties/broken",
                                                     "springs/strength"};
    return std::find(paths.begin(), paths.end(), path) != paths.end();
}

template <class Number>
std::optional<WrongReal> find_wrong(bool infinite, std::size_t width, const std::byte* rows, std::size_t stride,
                                    std::size_t count) {
    for (std::size_t row = 0; row < count; ++row)
        for (std::size_t i = 0; i < width; ++i) {
            Number number;
            std::memcpy(&number, rows + row * stride + i * sizeof number, sizeof number);
            if (std::isnan(number) || (std::isinf(number) && !infinite))
                return WrongReal{.found = std::to_string(number), .row = row};
        }
    return {};
}

std::string text_of(Real value) {
    return short_text(value);
}
std::string text_of(Index value) {
    return std::to_string(value);
}

template <class T>
void expect_numbers(const SavedFile& file, std::string_view path, std::span<const T> values, T least, T most) {
    for (std::size_t row = 0; row < values.size(); ++row)
        if (!(values[row] >= least && values[row] <= most))
            file.complain(std::string(path), at_row(text_of(values[row]), row),
                          "a number from " + text_of(least) + " to " + text_of(most));
}

}  // namespace

std::optional<WrongReal> find_wrong_real(std::string_view path, const RowType& type, const std::byte* rows,
                                         std::size_t stride, std::size_t count) {
    if (!is_real(type.number)) return {};
    const bool infinite = may_be_infinite(path);
    return type.number == NumberType::real ? find_wrong<Real>(infinite, type.width, rows, stride, count)
                                           : find_wrong<float>(infinite, type.width, rows, stride, count);
}

std::string at_row(const std::string& found, std::size_t row) {
    return found + " at row " + std::to_string(row);
}

std::string at_row(Index found, std::size_t row) {
    return at_row(std::to_string(found), row);
}

void expect_size(const SavedFile& file, std::string_view path, std::size_t found, std::size_t expected) {
    if (found != expected)
        file.complain(std::string(path), std::to_string(found) + " rows",
                      std::to_string(expected) + ", the size of the table or list to which this data set belongs");
}

void expect_one_size(const SavedFile& file, const char* name, AnyTable table, std::size_t rows) {
    for (const ColumnInfo& info : table.columns()) {
        if (!info.has_row_each) continue;
        const AnyColumn column = table.column(info);
        if (is_saved(info.role))
            expect_size(file, std::string(name) + "/" + info.name, column.size(), rows);
        else
            column.resize(rows);
    }
}

void expect_rows_of(const SavedFile& file, std::string_view path, std::span<const Index> rows, std::size_t count,
                    bool none) {
    for (std::size_t i = 0; i < rows.size(); ++i)
        if ((rows[i] < 0 && !(none && rows[i] == no_index)) || rows[i] >= static_cast<Index>(count))
            file.complain(std::string(path), at_row(rows[i], i),
                          "a row index below " + std::to_string(count) + (none ? ", or -1 for none" : ""));
}

void expect_between(const SavedFile& file, std::string_view path, std::span<const Real> values, Real least, Real most) {
    expect_numbers(file, path, values, least, most);
}
void expect_between(const SavedFile& file, std::string_view path, std::span<const Index> values, Index least,
                    Index most) {
    expect_numbers(file, path, values, least, most);
}
void expect_between(const SavedFile& file, std::string_view path, std::span<const std::uint8_t> values,
                    std::uint8_t least, std::uint8_t most) {
    expect_numbers(file, path, values, least, most);
}

void expect_partition(const SavedFile& file, std::string_view path, std::span<const Range> ranges, std::size_t count) {
    Index end = 0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        if (ranges[i].begin != end || ranges[i].end < end)
            file.complain(std::string(path),
                          at_row(std::to_string(ranges[i].begin) + " to " + std::to_string(ranges[i].end), i),
                          "a range that begins at " + std::to_string(end) +
                              (i > 0 ? ", the end of the previous range," : "") + " and ends there or later");
        end = ranges[i].end;
    }
    if (end != static_cast<Index>(count))
        file.complain(std::string(path), "ranges that end at " + std::to_string(end),
                      "ranges that end at " + std::to_string(count) + ", the number of rows");
}

void expect_all_offsets(const SavedFile& file, const std::string& path, std::span<const Index> offset,
                        std::size_t items, const std::string& suffix) {
    expect_offsets(offset, items, [&](const std::string& found, const std::string& expected) {
        file.complain(path, found + suffix, expected);
    });
    if (offset.empty() || offset.back() != static_cast<Index>(items))
        file.complain(path,
                      (offset.empty() ? "no offset" : std::to_string(offset.back()) + " as the last offset") + suffix,
                      std::to_string(items) + ", the number of items");
}

bool is_rotation(const Mat3& matrix) {
    constexpr Real rounding = 1e-9;
    return (matrix.transpose() * matrix - Mat3::Identity()).norm() < rounding && matrix.determinant() > 0;
}

}  // namespace skerry
