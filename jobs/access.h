// Declared accesses of a stage, and the Binder, which passes columns to stage functions and records the accesses.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "components/column.h"
#include "components/ragged.h"

namespace skerry {

/// Kinds of access of a stage to an object. `value`: the stage reads an object that no stage ever writes, so that the
/// access causes no dependency between stages.
enum class Use : std::uint8_t { value, read, write };

/// Access to one object, such as a column, a table or a number. An object is identified by its address range. An access
/// to a table therefore conflicts with an access to any column inside the table.
struct Access {
    std::uintptr_t begin;
    std::uintptr_t end;
    Use use;

    bool writes() const { return use == Use::write; }
    bool overlaps(const Access& other) const { return begin < other.end && other.begin < end; }
    /// True if a stage with this access and a stage with the other access must run one after the other.
    bool conflicts_with(const Access& other) const {
        return use != Use::value && other.use != Use::value && (writes() || other.writes()) && overlaps(other);
    }
    bool operator==(const Access&) const = default;
};
using AccessList = std::vector<Access>;

/// True for spans, views and pointers. They are not accepted as a Resource (below): the declared access would cover the
/// address range of the span itself, not the data to which it refers.
template <class T>
inline constexpr bool shows_other_data = std::is_pointer_v<T>;
template <class T, std::size_t N>
inline constexpr bool shows_other_data<std::span<T, N>> = true;
template <class T>
inline constexpr bool shows_other_data<RaggedView<T>> = true;
template <class T>
concept Resource = std::is_object_v<T> && !shows_other_data<std::remove_cv_t<T>>;

/// Converts columns, which the tables own, to spans, which functions take. A struct of inputs defines a static function
/// `bind`:
///
///     struct RestInputs {
///         std::span<const Range> nodes;
///         std::span<const Real> mass;  // by node [kg]
///
///         static RestInputs bind(const Binder& binder, const BodyTable& body, const NodeTable& node) {
///             return {.nodes = binder.read(body.nodes), .mass = binder.read(node.mass)};
///         }
///     };
///
/// When a stage is added to the graph, bind runs with an access list, in which it declares the accesses of the stage.
/// When the stage starts, bind runs without a list. Both calls must request the same columns, whatever these contain,
/// so bind uses read_if and write_if instead of `if`. It must not allocate memory.
class Binder {
public:
    Binder() = default;
    explicit Binder(AccessList& list) : list_(&list) {}

    template <class T>
    std::span<const T> read(const Column<T>& column) const {
        record(column, Use::read);
        return column.span();
    }
    template <class T>
    RaggedView<T> read(const Ragged<T>& ragged) const {
        record(ragged, Use::read);
        return ragged.view();
    }
    template <Resource T>
    const T& read(const T& object) const {
        record(object, Use::read);
        return object;
    }
    /// Declares a read of a table except for one of its columns, which another stage may write at the same time.
    /// `column` must be a member of `table`.
    template <Resource T, class Row>
    const T& read_but(const T& table, const Column<Row>& column) const {
        if (!list_) return table;
        const auto begin = reinterpret_cast<std::uintptr_t>(std::addressof(table)), end = begin + sizeof(T);
        const auto without = reinterpret_cast<std::uintptr_t>(std::addressof(column));
        list_->push_back({begin, without, Use::read});
        list_->push_back({without + sizeof column, end, Use::read});
        return table;
    }
    template <class T>
    std::span<T> write(Column<T>& column) const {
        record(column, Use::write);
        return column.span();
    }
    /// Declares a write of an entire object, for stages that add rows to the object or replace it.
    template <Resource T>
    requires(!std::is_const_v<T>) T& make(T& object) const {
        record(object, Use::write);
        return object;
    }
    template <Resource T>
    const T& value(const T& object) const {
        record(object, Use::value);
        return object;
    }

    /// Returns an empty span unless `condition` is true. The access is declared in both cases.
    template <class T>
    std::span<const T> read_if(bool condition, const Column<T>& column) const {
        const std::span<const T> rows = read(column);
        return condition ? rows : std::span<const T>();
    }
    template <class T>
    std::span<T> write_if(bool condition, Column<T>& column) const {
        const std::span<T> rows = write(column);
        return condition ? rows : std::span<T>();
    }

    template <Resource T>
    void read(const T&&) const = delete;  // deleted, because a temporary object no longer exists when the stage runs
    template <Resource T>
    void value(const T&&) const = delete;

private:
    template <class T>
    void record(const T& object, Use use) const {
        if (!list_) return;
        const auto begin = reinterpret_cast<std::uintptr_t>(std::addressof(object));
        list_->push_back({begin, begin + sizeof(T), use});
    }

    AccessList* list_ = nullptr;
};

}  // namespace skerry
