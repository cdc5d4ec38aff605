// Refuses wrong values by a SceneError, and makes the parts of its message.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "components/types.h"
#include "jobs/function_ref.h"
#include "skerry/error.h"

namespace skerry {

/// Throws a SceneError with these parts of the message, each of which may be empty. refuse() names no file.
[[noreturn]] void refuse(std::string_view object, std::string_view field, std::string_view found,
                         std::string_view expected, std::string_view hint = {});
[[noreturn]] void refuse_in(std::string_view file, std::string_view object, std::string_view field,
                            std::string_view found, std::string_view expected, std::string_view hint = {});

/// Throws SceneError if `good` is false or the number is not finite.
void require(bool good, std::string_view object, std::string_view field, Real found, std::string_view expected);
/// Refuses a vector with a component that is not finite.
void require_finite(std::string_view object, std::string_view field, const Vec3& found);

/// Returns a copy of `inner` whose text begins with `context`, without an object or a field that `inner` names again.
/// If `inner` names no file, the copy also gets the file of `context`, its object unless that is empty, and its field
/// in front of the field of `inner`.
SceneError error_at(const Complaint& context, const SceneError& inner);

/// Formats a number with `digits` significant digits. Numbers from 0.0001 up to a million get no exponent.
std::string short_text(Real value, int digits = 3);
/// Formats a vector as (x, y, z).
std::string short_text(const Vec3& value, int digits = 3);
/// Text of a number or a vector in messages, with six digits.
std::string shown(Real value);
std::string shown(const Vec3& value);

/// Returns the name closest to `text`: the one with the fewest changed, missing, added or swapped letters. Empty if
/// there are no names.
std::string nearest_name(std::string_view text, std::span<const std::string> names);
/// Returns the hint `did you mean "NAME"?` with the nearest name. Empty if more than one letter and more than a third
/// of the letters differ.
std::string nearest_hint(std::string_view text, std::span<const std::string> names);

/// Checks that the offsets of a list of rows begin at 0, ascend and do not exceed the number of items. For the first
/// wrong offset it calls `complain`, which must throw.
void expect_offsets(std::span<const Index> offset, std::size_t items,
                    FunctionRef<void(const std::string& found, const std::string& expected)> complain);

}  // namespace skerry
