#include "engine/study/report/wording.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/output/number_text.h"

namespace skerry {

namespace {

/// Factor and name of the SI prefix for a number of this size. Counts, and units with powers such as m^2, get no
/// prefix.
std::pair<Real, std::string> prefix_of(Real size, const std::string& unit) {
    static constexpr std::array<std::string_view, 7> with_prefix{"m", "m/s", "N", "N m", "N s", "J", "Pa"};
    static const std::pair<Real, std::string> prefixes[] = {{1e9, "G"},  {1e6, "M"},  {1e3, "k"}, {1, ""},
                                                            {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
    if (std::ranges::find(with_prefix, unit) == with_prefix.end()) return {1, ""};
    for (const auto& prefix : prefixes)
        if (size >= prefix.first) return prefix;
    return {1, ""};
}

/// Returns a value as text, rounded to the second significant digit of its error. To format an error, pass it for both
/// arguments.
std::string to_digit_of(Real value, Real error) {
    constexpr int most_digits = 6, most_decimals = 4;
    if (!(error > 0) || !std::isfinite(error)) return short_text(value, most_digits);
    const int decimals = 1 - static_cast<int>(std::floor(std::log10(error)));
    const int before = value == 0 ? 1 : 1 + static_cast<int>(std::floor(std::log10(std::abs(value))));
    if (decimals > most_decimals || before + decimals > most_digits || before > most_digits)
        return short_text(value, value == error ? 2 : most_digits);
    // A value that rounds to zero is written without a sign, not as -0.
    const bool is_zero = std::abs(value) < 0.5 * std::pow(10, -std::max(decimals, 0));
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", std::max(decimals, 0), is_zero ? 0 : value);
    return text;
}

std::string order_text(const char* name, Real order, Real expected) {
    if (!std::isfinite(order)) return {};
    // `expected` is the lowest order of the theory. If it is below 2, the theory also allows higher orders, up to 2.
    return std::string(name) + " " + short_text(order, 2) + " (" + (expected < 2 ? "at least " : "") +
           short_text(expected, 2) + " expected)";
}

}  // namespace

std::string variant_text(const StudyVariant& variant) {
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    const int levels = std::abs(variant.refine);
    if (levels > 0)
        add("mesh " + std::to_string(levels) + (levels > 1 ? " levels " : " level ") +
            (variant.refine > 0 ? "finer" : "coarser"));
    if (variant.step != 1) add("steps x " + short_text(variant.step));
    if (variant.tolerance != 1) add("tolerance x " + short_text(variant.tolerance));
    if (variant.element) add(std::string(name_of(*variant.element)) + " elements");
    if (variant.draw != 0) add("start moved by 1e-12 m (" + std::to_string(variant.draw) + ")");
    return text.empty() ? "the scene as it is" : text;
}

QuantityText quantity_text(const StudyQuantity& q) {
    const bool has_error = std::isfinite(q.error);
    constexpr Real rounding = 1e-9;  // smaller shares of the scale are shown as zero
    const Real least = rounding * (q.scale > 0 ? q.scale : 0);
    const Real size = std::max(std::abs(q.value), has_error ? q.error : 0);
    const auto [factor, prefix] = prefix_of(size > least ? size : q.scale, q.unit);
    const auto in_unit = [least, factor = factor](Real value) { return std::abs(value) > least ? value / factor : 0; };
    const auto part = [&](Real error) {
        return in_unit(error) > 0 && std::isfinite(error) ? to_digit_of(in_unit(error), in_unit(error)) : std::string();
    };
    QuantityText text;
    text.unit = q.unit == "1" ? "" : prefix + q.unit;
    if (q.verdict == StudyVerdict::zero) {
        text.value = "zero within " + part(q.error);
        return text;
    }
    text.value = std::isfinite(q.value) ? to_digit_of(in_unit(q.value), in_unit(q.error)) : "unknown";
    if (has_error) text.error = in_unit(q.error) > 0 ? part(q.error) : "0";
    constexpr Real shown_share = 0.01;  // smaller parts of an error bar are not shown
    for (const auto& [name, error] : {std::pair{"mesh ", q.mesh}, std::pair{"step ", q.step},
                                      std::pair{"contacts ", q.contact}, std::pair{"start ", q.noise}})
        if (error > shown_share * q.error && !part(error).empty())
            text.parts += (text.parts.empty() ? "" : ", ") + (name + part(error));
    if (std::isfinite(q.best) && std::isfinite(q.best_error)) {
        text.best = to_digit_of(in_unit(q.best), in_unit(q.best_error));
        text.best_error = in_unit(q.best_error) > 0 ? part(q.best_error) : "0";
    }
    if (has_error && in_unit(q.error) > 0 && q.scale > 0) {
        text.share = short_text(100 * q.error / q.scale, 2) + " %";
        // The share is relative to the scale. The text names the scale unless the scale is close to the value.
        constexpr Real near = 0.1;
        if (std::abs(std::abs(q.value) - q.scale) > near * q.scale) {
            const auto [scale_factor, scale_prefix] = prefix_of(q.scale, q.unit);
            text.share +=
                " of " + short_text(q.scale / scale_factor) + (q.unit == "1" ? "" : " " + scale_prefix + q.unit);
        }
    }
    constexpr Real least_share = 1e-4;  // below this share of the scale, errors are too small to show an order
    if (q.mesh > least_share * q.scale) text.orders = order_text("order", q.mesh_order, q.expected_mesh_order);
    // The order of the steps is shown only if the steps cause a large part of the error.
    constexpr Real share = 0.2;
    if (q.step > std::max(share * q.error, least_share * q.scale)) {
        const std::string step = order_text("order of steps", q.step_order, q.expected_step_order);
        text.orders += (text.orders.empty() || step.empty() ? "" : ", ") + step;
    }
    return text;
}

}  // namespace skerry
