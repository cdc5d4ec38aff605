// What a stage touches: accesses, and the Binder that hands out columns and notes what it hands out.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "components/column.h"
#include "components/ragged.h"

namespace skerry {

/// value: is read, and no stage may write it; so nothing waits for it.
enum class Use : std::uint8_t { value, read, write };

/// The use of one object: a column, a table, a number. Objects are told apart by the memory that they occupy, so that a
/// table and its columns, which lie inside it, are known to be the same data, whatever the table lists.
struct Access {
    std::uintptr_t begin;
    std::uintptr_t end;
    Use use;

    bool writes() const { return use == Use::write; }
    bool overlaps(const Access& other) const { return begin < other.end && other.begin < end; }
    /// One has to wait for the other.
    bool conflicts_with(const Access& other) const {
        return use != Use::value && other.use != Use::value && (writes() || other.writes()) && overlaps(other);
    }
    bool operator==(const Access&) const = default;
};
using AccessList = std::vector<Access>;

/// Something that can be declared: an object that stays where it is. A span or a pointer would declare itself instead
/// of what it shows.
template <class T>
inline constexpr bool shows_other_data = std::is_pointer_v<T>;
template <class T, std::size_t N>
inline constexpr bool shows_other_data<std::span<T, N>> = true;
template <class T>
inline constexpr bool shows_other_data<RaggedView<T>> = true;
template <class T>
concept Resource = std::is_object_v<T> && !shows_other_data<std::remove_cv_t<T>>;

/// Makes what a function takes, spans, of what the tables own, columns. A struct of inputs is bound where it is
/// defined:
///
///     struct RestInputs {
///         std::span<const Range> nodes;
///         std::span<const Real> mass;  // kg, by node
///
///         static RestInputs bind(const Binder& binder, const BodyTable& body, const NodeTable& node) {
///             return {.nodes = binder.read(body.nodes), .mass = binder.read(node.mass)};
///         }
///     };
///
/// The same bind runs with a list when a stage is listed, which declares what the stage takes, and without one whenever
/// it starts. So it must ask for the same columns whatever these hold: read_if and write_if, never if. Must not
/// allocate.
class Binder {
public:
    Binder() = default;
    explicit Binder(AccessList& list) : list_(&list) {}

    template <class T>
    std::span<const T> read(const Column<T>& column) const {
        note(column, Use::read);
        return column.span();
    }
    template <class T>
    RaggedView<T> read(const Ragged<T>& ragged) const {
        note(ragged, Use::read);
        return ragged.view();
    }
    template <Resource T>
    const T& read(const T& object) const {
        note(object, Use::read);
        return object;
    }
    /// A table without one of its columns, which another stage may write meanwhile.
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
        note(column, Use::write);
        return column.span();
    }
    /// For those that make rows, or write an object as a whole.
    template <Resource T>
    requires(!std::is_const_v<T>) T& make(T& object) const {
        note(object, Use::write);
        return object;
    }
    template <Resource T>
    const T& value(const T& object) const {
        note(object, Use::value);
        return object;
    }

    /// Nothing where not wanted; declared all the same.
    template <class T>
    std::span<const T> read_if(bool wanted, const Column<T>& column) const {
        const std::span<const T> rows = read(column);
        return wanted ? rows : std::span<const T>();
    }
    template <class T>
    std::span<T> write_if(bool wanted, Column<T>& column) const {
        const std::span<T> rows = write(column);
        return wanted ? rows : std::span<T>();
    }

    template <Resource T>
    void read(const T&&) const = delete;  // nothing to come back to when the stage runs
    template <Resource T>
    void value(const T&&) const = delete;

private:
    template <class T>
    void note(const T& object, Use use) const {
        if (!list_) return;
        const auto begin = reinterpret_cast<std::uintptr_t>(std::addressof(object));
        list_->push_back({begin, begin + sizeof(T), use});
    }

    AccessList* list_ = nullptr;
};

}  // namespace skerry
