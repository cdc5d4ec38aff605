// Messages between ranks that contain single values, lists or records of bodies.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/world/ranks/regions/rank_mail.h"
#include "engine/world/state/model.h"

namespace skerry {

/// True for a list of plain data: std::vector, Column or std::string.
template <class List>
concept RowList = requires(List& list) {
    list.clear();
    list.resize(0);
    list.data();
};

/// Appends a value of plain data, or a list: first its number of rows, then the rows.
template <class T>
void put_value(const T& value, RankMessage& message) {
    if constexpr (RowList<T>) {
        put_value(static_cast<std::uint64_t>(value.size()), message);
        put_rows(std::span<const typename T::value_type>(value.data(), value.size()), message);
    } else {
        put_rows(std::span<const T>(&value, 1), message);
    }
}

/// Reads a value or a list that put_value has written.
template <class T>
void take_value(MailReader& message, T& value) {
    if constexpr (RowList<T>) {
        value.resize(message.take<std::uint64_t>());
        message.take_rows(std::span<typename T::value_type>(value.data(), value.size()));
    } else {
        message.take_rows(std::span<T>(&value, 1));
    }
}

/// Appends a record to a message, without the surface that is drawn in place of the body, because only rank 0 draws
/// bodies.
void put_record(const BodyRecord& record, RankMessage& message);
/// Reads a record that put_record has written.
BodyRecord take_record(MailReader& message);
/// Returns a record with only a name, for a body that this rank does not hold.
BodyRecord record_of_name(std::string name);

}  // namespace skerry
