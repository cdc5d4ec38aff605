// Access to corresponding columns of several contact tables.
#pragma once

#include <array>
#include <type_traits>

#include "components/contact_table.h"

namespace skerry {

/// Calls `visit` with each column of table a and the corresponding columns of tables b and c. Only columns of table a
/// may be written.
inline void for_each_column_of(ContactTable& a, const ContactTable& b, const ContactTable& c, auto&& visit) {
    constexpr std::size_t most = 32;
    using Places = std::array<const void*, most>;
    const auto places_of = [](const ContactTable& table) {
        Places places{};
        std::size_t count = 0;
        // for_each_column needs a mutable table, but this code only takes the addresses of the columns
        const_cast<ContactTable&>(table).for_each_column(
            [&](const char*, auto& column, ColumnRole) { places.at(count++) = &column; });
        return places;
    };
    const Places second = places_of(b), third = places_of(c);
    std::size_t at = 0;
    a.for_each_column([&](const char*, auto& column, ColumnRole) {
        using Same = std::remove_reference_t<decltype(column)>;
        visit(column, *static_cast<const Same*>(second[at]), *static_cast<const Same*>(third[at]));
        ++at;
    });
}

}  // namespace skerry
