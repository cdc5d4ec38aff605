// Descriptions of the types of rows that columns store: numbers of one type, or a struct with its members. Code that
// saves, loads, hashes, resizes or erases rows uses these descriptions, so it works for rows of any type. The
// specialisation of NumbersOf or MembersOf for a struct follows the definition of the struct.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>

#include "components/lanes.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

enum class NumberType : std::uint8_t { real, single, int32, uint8, uint16, uint32, uint64 };

inline constexpr std::size_t bytes_of(NumberType type) {
    constexpr std::array<std::size_t, 7> bytes{8, 4, 4, 1, 2, 4, 8};
    return bytes[static_cast<std::size_t>(type)];
}

/// Returns the integer at an address. Throws std::logic_error for reals of either precision.
std::int64_t number_at(const std::byte* address, NumberType type);

struct Member;

struct RowType {
    std::size_t bytes;                            // size of a row [bytes]
    void (*make)(void* rows, std::size_t count);  // value-initialises `count` rows; vectors and matrices become zero
    // Number of numbers in a row if all of them have one type and the row has no padding; 0 for all other rows.
    std::size_t width = 0;
    NumberType number = NumberType::uint8;  // type of the numbers in a row
    std::uint64_t values = 0;               // the numbers must be below this limit (value_count); 0: no limit
    // Returns the members of the row type; null: the type is not a struct with listed members.
    std::span<const Member> (*members)() = nullptr;

    /// True if the description is complete enough to save the rows.
    bool is_known() const { return width > 0 || members != nullptr; }
};

/// Describes a row of `n` numbers of the same type.
template <NumberType type, std::size_t n>
struct SameNumbers {
    static constexpr NumberType number = type;
    static constexpr std::size_t count = n;
};
template <std::size_t n>
using Reals = SameNumbers<NumberType::real, n>;

template <class T>
struct NumbersOf;
template <>
struct NumbersOf<Real> : Reals<1> {};
template <>
struct NumbersOf<float> : SameNumbers<NumberType::single, 1> {};
template <class T>
requires(std::is_integral_v<T> && (std::is_unsigned_v<T> || sizeof(T) == sizeof(std::int32_t))) struct NumbersOf<T>
    : SameNumbers<std::is_signed_v<T> ? NumberType::int32
                  : sizeof(T) == 1    ? NumberType::uint8
                  : sizeof(T) == 2    ? NumberType::uint16
                  : sizeof(T) == 4    ? NumberType::uint32
                                      : NumberType::uint64,
                  1> {
};
template <class E>
requires std::is_enum_v<E>
struct NumbersOf<E> : NumbersOf<std::underlying_type_t<E>> {
};
template <int rows, int columns>
struct NumbersOf<Eigen::Matrix<Real, rows, columns>> : Reals<std::size_t{rows * columns}> {};
template <class T>
concept HasNumbers = requires {
    NumbersOf<T>::count;
};
template <HasNumbers T, std::size_t n>
struct NumbersOf<std::array<T, n>> : SameNumbers<NumbersOf<T>::number, n * NumbersOf<T>::count> {};
template <HasNumbers T, int n>
struct NumbersOf<Lanes<T, n>> : SameNumbers<NumbersOf<T>::number, std::size_t{n} * NumbersOf<T>::count> {};
template <>
struct NumbersOf<Range> : SameNumbers<NumberType::int32, 2> {};

/// Describes a struct that contains numbers of several types: list() returns an array or a span of Member, one entry
/// per member.
template <class S>
struct MembersOf;

template <class Enum>
struct EnumNames;

/// Number of values that an object of type T can have: 2 for bool, n for an enum with the values 0 to n - 1. A value
/// loaded from a file must be smaller. 0 (all other types, and some enums): loaded values are not checked.
template <class T>
inline constexpr std::uint64_t value_count = 0;
template <class E>
requires requires {
    EnumNames<E>::table;
}
inline constexpr std::uint64_t value_count<E> = EnumNames<E>::table.size();
template <>
inline constexpr std::uint64_t value_count<bool> = 2;

namespace row_type_detail {

template <class T>
void make(void* rows, std::size_t count) {
    T* const first = static_cast<T*>(rows);
    for (std::size_t row = 0; row < count; ++row) {
        if constexpr (requires { T::Zero(); })
            ::new (static_cast<void*>(first + row)) T(T::Zero());
        else
            ::new (static_cast<void*>(first + row)) T();
    }
}
template <class S>
std::span<const Member> members();

template <class T>
constexpr RowType describe() {
    RowType type{.bytes = sizeof(T), .make = make<T>};
    if constexpr (requires { MembersOf<T>::list(); }) {
        type.members = members<T>;
    } else if constexpr (HasNumbers<T>) {
        type.width = NumbersOf<T>::count;
        type.number = NumbersOf<T>::number;
        type.values = value_count<T>;
        static_assert(sizeof(T) == NumbersOf<T>::count * bytes_of(NumbersOf<T>::number),
                      "a saved row must not contain padding");
    }
    return type;
}

}  // namespace row_type_detail

template <class T>
inline constexpr RowType row_type = row_type_detail::describe<T>();

/// Offset of a member from the start of a struct S [bytes]. offsetof() cannot be used, because it does not accept a
/// pointer to member. No object of type S is made: zeroed memory takes its place.
template <class S, class T>
std::size_t member_offset(T S::*member) {
    alignas(S) static const std::byte memory[sizeof(S)]{};
    const auto* const address = &(reinterpret_cast<const S*>(memory)->*member);
    return static_cast<std::size_t>(reinterpret_cast<const std::byte*>(address) - memory);
}

/// A member of a struct, as an entry of MembersOf<S>::list().
struct Member {
    template <class S, class T>
    Member(const char* member_name, T S::*address)
        : name(member_name), offset(member_offset(address)), type(&row_type<T>) {}

    const char* name;
    std::size_t offset;  // offset of the member from the start of the struct [bytes]
    const RowType* type;
};

namespace row_type_detail {

template <class S>
std::span<const Member> members() {
    static const auto list = MembersOf<S>::list();
    return list;
}

}  // namespace row_type_detail

}  // namespace skerry
