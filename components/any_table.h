// Type-erased tables and columns, for code that runs rarely. The compiler translates such code only once, not once for
// every column of every table.
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "components/column.h"
#include "components/column_role.h"
#include "components/row_type.h"

namespace skerry {

/// Refers to a column of any type, like a pointer: a const AnyColumn can change the rows of its column.
class AnyColumn {
public:
    template <class T>
    AnyColumn(Column<T>& column) : AnyColumn(&column.memory_, row_type<T>) {}
    AnyColumn(RowMemory* memory, const RowType& type) : memory_(memory), type_(&type) {}

    const RowType& type() const { return *type_; }
    std::size_t size() const { return seen().size(); }
    const std::byte* read() const { return static_cast<const std::byte*>(seen().rows()); }
    std::byte* write() const { return static_cast<std::byte*>(changed().rows()); }
    /// Sets the number of rows. New rows are value-initialised.
    void resize(std::size_t count) const;
    /// Removes ranges of rows. Preconditions: see Column::erase.
    void erase(std::span<const Range> erased) const { changed().erase(erased, type_->bytes); }
    bool is(const void* column) const { return memory_ == column; }

private:
    const RowMemory& seen() const {
        check_access(memory_, sizeof *memory_, false);
        return *memory_;
    }
    RowMemory& changed() const {
        check_access(memory_, sizeof *memory_, true);
        return *memory_;
    }

    RowMemory* memory_;
    const RowType* type_;
};

/// Name, role, offset and row type of a column of a table.
struct ColumnInfo {
    const char* name;
    ColumnRole role;
    // true: the column has one row per row of the table; false: each row of the table has a range of rows in the column
    bool has_row_each;
    std::size_t offset;  // offset of the column from the start of the table [bytes]
    const RowType* type;
};

/// Returns descriptions of the columns of a table, in the order in which Table::for_each_column visits them.
/// any_table.cpp instantiates this function for each table.
template <class Table>
std::span<const ColumnInfo> columns_of();

class AnyTable {
public:
    template <class Table>
    requires(!std::is_same_v<Table, AnyTable>) AnyTable(Table& table, const char* name = "")
        : name_(name), table_(reinterpret_cast<std::byte*>(&table)), columns_(columns_of<Table>()) {}

    const char* name() const { return name_; }
    std::span<const ColumnInfo> columns() const { return columns_; }
    AnyColumn column(const ColumnInfo& info) const {
        return {reinterpret_cast<RowMemory*>(table_ + info.offset), *info.type};
    }
    /// Resizes all columns that have one row per row of the table.
    void resize(std::size_t rows) const;
    void erase(std::span<const Range> erased) const;

private:
    const char* name_;
    std::byte* table_;
    std::span<const ColumnInfo> columns_;
};

}  // namespace skerry
