// What a stage is given and what it touches: read(...), write(...), value(...), make(...), reads(...), writes(...), bundle(...), only_if(...).
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "components/column.h"
#include "components/ragged.h"

namespace skerry {

/// A read or write of one object: a column, a table, a number. Objects are told apart by the memory that they occupy, so that a table
/// and its columns, which lie inside it, are known to be the same data, whatever the table lists.
struct Access {
    std::uintptr_t begin;
    std::uintptr_t end;
    bool writes;

    bool conflicts_with(const Access& other) const { return (writes || other.writes) && begin < other.end && other.begin < end; }
};
using AccessList = std::vector<Access>;

/// Something that can be declared: an object that stays where it is. A span or a pointer would declare itself instead of what it shows.
template <class T>
inline constexpr bool shows_other_data = std::is_pointer_v<T>;
template <class T, std::size_t N>
inline constexpr bool shows_other_data<std::span<T, N>> = true;
template <class T>
inline constexpr bool shows_other_data<RaggedView<T>> = true;
template <class T>
concept Resource = std::is_object_v<T> && !shows_other_data<std::remove_cv_t<T>>;

namespace access_detail {

template <class T>
Access access_to(const T& object, bool writes) {
    const auto begin = reinterpret_cast<std::uintptr_t>(std::addressof(object));
    return {begin, begin + sizeof(T), writes};
}

// An argument of a stage: pass() makes a tuple of what the function gets, when the stage starts; declare() adds what is touched; allows()
// says whether the stage is to run.
struct Always {
    bool allows() const { return true; }
};
struct PassesNothing {
    std::tuple<> pass() const { return {}; }
};

template <class T>
struct ReadColumn : Always {
    const Column<T>* column;
    std::tuple<std::span<const T>> pass() const { return {column->span()}; }
    void declare(AccessList& list) const { list.push_back(access_to(*column, false)); }
};

template <class T>
struct WriteColumn : Always {
    Column<T>* column;
    std::tuple<std::span<T>> pass() const { return {column->span()}; }
    void declare(AccessList& list) const { list.push_back(access_to(*column, true)); }
};

template <class T>
struct ReadRagged : Always {
    const Ragged<T>* ragged;
    std::tuple<RaggedView<T>> pass() const { return {ragged->view()}; }
    void declare(AccessList& list) const { list.push_back(access_to(*ragged, false)); }
};

template <class T>
struct ReadObject : Always {
    const T* object;
    std::tuple<const T&> pass() const { return {*object}; }
    void declare(AccessList& list) const { list.push_back(access_to(*object, false)); }
};

template <class T>
struct MakeObject : Always {
    T* object;
    std::tuple<T&> pass() const { return {*object}; }
    void declare(AccessList& list) const { list.push_back(access_to(*object, true)); }
};

template <class T>
struct Value : Always {
    const T* object;
    std::tuple<const T&> pass() const { return {*object}; }
    void declare(AccessList&) const {}
};

struct Declared : Always, PassesNothing {
    AccessList accesses;
    void declare(AccessList& list) const { list.insert(list.end(), accesses.begin(), accesses.end()); }
};

template <class Make>
struct Bundle : Always {
    Make make;
    AccessList accesses;
    std::tuple<std::invoke_result_t<const Make&>> pass() const { return {make()}; }
    void declare(AccessList& list) const { list.insert(list.end(), accesses.begin(), accesses.end()); }
};

template <class Guard>
struct OnlyIf : PassesNothing {
    Guard guard;
    AccessList accesses;
    bool allows() const { return guard(); }
    void declare(AccessList& list) const { list.insert(list.end(), accesses.begin(), accesses.end()); }
};

AccessList joined(const auto&... declared) {
    AccessList list;
    (declared.declare(list), ...);
    return list;
}

}  // namespace access_detail

/// Passes span<const T> of a column, RaggedView<T> of a ragged, const T& of anything else.
template <class T>
auto read(const Column<T>& column) {
    return access_detail::ReadColumn<T>{{}, &column};
}
template <class T>
auto read(const Ragged<T>& ragged) {
    return access_detail::ReadRagged<T>{{}, &ragged};
}
template <Resource T>
auto read(const T& object) {
    return access_detail::ReadObject<T>{{}, &object};
}
template <Resource T>
void read(const T&&) = delete;  // nothing to come back to when the stage runs

/// Passes span<T> of a column.
template <class T>
auto write(Column<T>& column) {
    return access_detail::WriteColumn<T>{{}, &column};
}

/// Passes T&: for stages that make rows, or write an object as a whole.
template <Resource T>
requires(!std::is_const_v<T>) auto make(T& object) {
    return access_detail::MakeObject<T>{{}, &object};
}

/// Passes const T& and declares nothing: for what no stage writes.
template <Resource T>
auto value(const T& object) {
    return access_detail::Value<T>{{}, &object};
}
template <Resource T>
void value(const T&&) = delete;

/// Declare accesses and pass nothing.
template <Resource... T>
access_detail::Declared reads(const T&... objects) {
    return {{}, {}, {access_detail::access_to(objects, false)...}};
}
template <Resource... T>
requires(!std::is_const_v<T> && ...) access_detail::Declared writes(T&... objects) {
    return {{}, {}, {access_detail::access_to(objects, true)...}};
}

/// Passes what make() returns when the stage starts: a struct of spans, usually. `declared`: reads(...) and writes(...) of what is in it.
template <class Make>
auto bundle(Make make, const std::same_as<access_detail::Declared> auto&... declared) {
    return access_detail::Bundle<Make>{{}, std::move(make), access_detail::joined(declared...)};
}

/// The stage is skipped if guard() is false when its turn comes. `declared`: what the guard reads.
template <class Guard>
auto only_if(Guard guard, const std::same_as<access_detail::Declared> auto&... declared) {
    static_assert(sizeof...(declared) > 0, "only_if: declare what the guard reads, else it may look too early");
    return access_detail::OnlyIf<Guard>{{}, std::move(guard), access_detail::joined(declared...)};
}

}  // namespace skerry
