// Numbers as people read them.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace skerry {

/// As printf's %.*g.
inline std::string short_number(double value, int digits = 3) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

/// 1,234,567
inline std::string grouped(std::uint64_t value) {
    std::string digits = std::to_string(value);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), ",");
    return digits;
}

/// With the prefix that leaves one to three digits before the point: 0.00031, "s" is 310 us.
inline std::string with_unit(double value, const char* unit) {
    struct Prefix {
        double factor;
        const char* name;
    };
    constexpr Prefix prefixes[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
    const double size = value < 0 ? -value : value;
    for (const Prefix& prefix : prefixes)
        if (size >= prefix.factor) return short_number(value / prefix.factor) + " " + prefix.name + unit;
    return short_number(value) + " " + unit;
}

}  // namespace skerry
