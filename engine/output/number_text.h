// Formats numbers, and lines of a summary, for people to read.
#pragma once

#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <string>

#include "engine/base/complaint.h"

namespace skerry {

inline std::string percent(double fraction) {
    return short_text(100 * fraction) + " %";
}

/// Formats a count with its digits in groups of three, for example 1,234,567.
inline std::string grouped(std::uint64_t value) {
    std::string digits = std::to_string(value);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), ",");
    return digits;
}

/// Formats an estimated count that is given as a double.
inline std::string count_text(double count) {
    constexpr double most_written_out = 1e15;  // counts of at least this size are written with a power of ten
    return count < most_written_out ? grouped(static_cast<std::uint64_t>(count)) : short_text(count);
}

/// Formats a value with an SI prefix from nano to giga, so that one to three digits precede the decimal point:
/// (0.00031, "s") gives "310 us". Values below 1e-9 get no prefix; values from 1e12 on get more digits before the
/// point.
inline std::string with_unit(double value, const char* unit) {
    struct Prefix {
        double factor;
        const char* name;
    };
    constexpr Prefix prefixes[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
    constexpr double rounds_up = 0.9995;  // rounded to three digits, 0.9995 is 1
    const double size = value < 0 ? -value : value;
    for (const Prefix& prefix : prefixes)
        if (size >= rounds_up * prefix.factor) return short_text(value / prefix.factor) + " " + prefix.name + unit;
    return short_text(value) + " " + unit;
}

/// Formats a duration, for example "40 s", "12 min", "3.5 h" or "20 days".
inline std::string duration_text(double seconds) {
    struct Unit {
        double seconds;
        const char* name;
    };
    constexpr Unit units[] = {{86400, " days"}, {3600, " h"}, {60, " min"}};
    // A duration is written in days, hours or minutes only if it is at least this number of them. A shorter one is
    // written in the next smaller unit.
    constexpr double enough = 2;
    for (const Unit& unit : units)
        if (seconds >= enough * unit.seconds) return short_text(seconds / unit.seconds) + unit.name;
    return seconds >= 1 ? short_text(seconds) + " s" : with_unit(seconds, "s");
}

/// Formats a hash as 0x and 16 hexadecimal digits.
inline std::string hash_text(std::uint64_t hash) {
    char text[24];
    std::snprintf(text, sizeof text, "0x%016" PRIx64, hash);
    return text;
}

/// Returns a line of a summary: the label in the first column, the text in the second. With an empty label the line
/// continues the line above.
inline std::string summary_line(const std::string& label, const std::string& text) {
    constexpr std::size_t width = 14;
    return "  " + label + std::string(label.size() < width ? width - label.size() : 1, ' ') + text + "\n";
}

}  // namespace skerry
