// Labels and named sets of bodies, in the form in which files contain them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "components/ragged.h"
#include "engine/world/save/checks.h"
#include "engine/world/save/saved_file.h"
#include "engine/world/state/model.h"

namespace skerry {

/// Appends a list to a list of lists.
template <class T>
void append(std::span<const T> row, Ragged<T>& rows) {
    if (rows.offset.empty()) rows.offset.push_back(0);
    for (const T& item : row) rows.item.push_back(item);
    rows.offset.push_back(static_cast<Index>(rows.item.size()));
}
inline void append_text(const std::string& text, Ragged<std::uint8_t>& rows) {
    append(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), rows);
}

inline std::string text_of_row(std::span<const std::uint8_t> row) {
    return {row.begin(), row.end()};
}

/// Checks that a column has one row for each of the `expected` objects. `object_kind`: name of the objects in the
/// message.
void expect_rows(const SavedFile& file, const std::string& path, std::size_t found, std::size_t expected,
                 const char* object_kind);
/// Checks the offsets of a list of lists, and the number of its rows. Without rows, offsets may be missing.
template <class T>
void expect_ragged(const SavedFile& file, const std::string& path, const Ragged<T>& rows, std::size_t count,
                   const char* object_kind) {
    expect_rows(file, path, rows.size(), count, object_kind);
    if (!rows.offset.empty())
        expect_all_offsets(file, path + "/offset", rows.offset, rows.item.size());
    else if (!rows.item.empty())
        file.complain(path + "/offset", "no offsets for " + std::to_string(rows.item.size()) + " items",
                      "offsets from 0 to the number of items");
}

struct SavedSets {
    Ragged<Index> label;        // BodyRecord::label
    Column<Index> body;         // by set: row of BodyTable, ascending
    Ragged<std::uint8_t> name;  // UTF-8
    Ragged<Index> nodes, tetrahedra;
    Ragged<std::array<Index, 3>> faces;
};

SavedSets sets_to_save(const Model& model);
/// Restores the labels and sets of all bodies. Throws SceneError that names the file if they are inconsistent with the
/// bodies. Must be called after the tetrahedra of the bodies were restored.
void put_sets(const SavedSets& saved, const SavedFile& file, Model& model);

}  // namespace skerry
