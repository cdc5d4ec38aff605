#include "engine/program/sweep/cases/draw.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "engine/base/complaint.h"

namespace skerry {

namespace {

/// Rounds to 12 significant digits. This gives 0.3 instead of 0.30000000000000004, and hides rounding errors in the
/// last bits.
double rounded(double value) {
    return std::strtod(short_text(value, 12).c_str(), nullptr);
}

}  // namespace

double natural_log(double x) {
    int exponent = 0;
    double mantissa = std::frexp(x, &exponent);  // in [0.5, 1)
    if (mantissa < std::numbers::sqrt2 / 2) {
        mantissa *= 2;
        --exponent;
    }
    // The mantissa m and exponent e of x = m 2^e give log x = e log 2 + log m. With s = (m - 1) / (m + 1), the series
    // is log m = 2 artanh s = 2 s (1 + s^2/3 + s^4/5 + ...). For m between sqrt(1/2) and sqrt(2), s^2 is at most
    // 0.0295, and the last term of the sum is below 1e-19.
    const double s = (mantissa - 1) / (mantissa + 1), square = s * s;
    double sum = 0;
    for (int k = 25; k >= 1; k -= 2) sum = sum * square + 1.0 / k;
    return exponent * std::numbers::ln2 + 2 * s * sum;
}

double exponential(double x) {
    const double turns = std::floor(x / std::numbers::ln2 + 0.5);
    // exp x = 2^turns exp(rest). The remainder `rest` is between -0.35 and 0.35, so that the Taylor series of exp(rest)
    // up to rest^18 has an error below 1e-25.
    const double rest = x - turns * std::numbers::ln2;
    double sum = 1;
    for (int k = 18; k >= 1; --k) sum = 1 + sum * rest / k;
    return std::ldexp(sum, static_cast<int>(turns));
}

double Draws::uniform() {
    constexpr double unit = 1.0 / 9007199254740992.0;  // 2^-53
    return static_cast<double>(engine_() >> 11) * unit;
}

double Draws::normal() {
    for (;;) {
        const double u = 2 * uniform() - 1, v = 2 * uniform() - 1;
        const double square = u * u + v * v;
        if (square > 0 && square < 1) return u * std::sqrt(-2 * natural_log(square) / square);
    }
}

double Draws::draw(const DrawnEntry& entry) {
    switch (entry.distribution) {
        case Distribution::uniform:
            return rounded(*entry.from + uniform() * (*entry.to - *entry.from));
        case Distribution::log_uniform: {
            const double low = natural_log(*entry.from), high = natural_log(*entry.to);
            return rounded(exponential(low + uniform() * (high - low)));
        }
        case Distribution::integer:
            return *entry.from + std::floor(uniform() * (*entry.to - *entry.from + 1));
        case Distribution::normal:
            break;
    }
    return rounded(*entry.mean + *entry.deviation * normal());
}

double spaced(double from, double to, int count, int index, Spacing spacing) {
    if (index == 0) return from;
    if (index == count - 1) return to;
    const double share = static_cast<double>(index) / (count - 1);
    if (spacing == Spacing::linear) return rounded(from + share * (to - from));
    const double low = natural_log(from);
    return rounded(exponential(low + share * (natural_log(to) - low)));
}

}  // namespace skerry
