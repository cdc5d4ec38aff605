// Declared accesses of a stage, and the Binder, which hands out columns and records the accesses.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "components/column.h"
#include "components/ragged.h"

namespace skerry {

/// value: read, and never written by any stage, so that it causes no dependency.
enum class Use : std::uint8_t { value, read, write };

/// Use of one object: a column, a table, a number. Objects are identified by the memory that they occupy. A table
/// therefore conflicts with the columns inside it, whichever columns it lists.
struct Access {
    std::uintptr_t begin;
    std::uintptr_t end;
    Use use;

    bool writes() const { return use == Use::write; }
    bool overlaps(const Access& other) const { return begin < other.end && other.begin < end; }
    /// Whether one stage has to wait for the other.
    bool conflicts_with(const Access& other) const {
        return use != Use::value && other.use != Use::value && (writes() || other.writes()) && overlaps(other);
    }
    bool operator==(const Access&) const = default;
};
using AccessList = std::vector<Access>;

/// Type of an object that can be declared and that stays in place. A span or a pointer does not qualify: it would
/// declare itself instead of the data it refers to.
template <class T>
inline constexpr bool shows_other_data = std::is_pointer_v<T>;
template <class T, std::size_t N>
inline constexpr bool shows_other_data<std::span<T, N>> = true;
template <class T>
inline constexpr bool shows_other_data<RaggedView<T>> = true;
template <class T>
concept Resource = std::is_object_v<T> && !shows_other_data<std::remove_cv_t<T>>;

/// Converts columns, which the tables own, to spans, which functions take. A struct of inputs defines its own binding:
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
/// bind runs with an access list when a stage is listed, which declares the accesses of the stage, and without one
/// whenever the stage starts. It must therefore request the same columns whatever they contain: use read_if and
/// write_if, never if. It must not allocate.
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
    /// Declares a table without one of its columns, which another stage may write at the same time.
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
    /// For stages that add rows, or write an object as a whole.
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

    /// Returns an empty span unless `wanted`; the access is declared in both cases.
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
    void read(const T&&) const = delete;  // a temporary would be gone when the stage runs
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
