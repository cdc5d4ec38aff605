// Solution methods of the lab by name. They run on every operator of the library.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "components/options.h"
#include "profiling/lab/apgd.h"
#include "profiling/lab/mprgp.h"
#include "profiling/lab/nncg.h"

namespace skerry {

namespace lab {

enum class Method { nncg, apgd, mprgp };

/// True if the method ignores friction.
constexpr bool needs_frictionless(Method method) {
    return method == Method::mprgp;
}

template <ContactOperator Op>
SolveResult run(Method method, Op& op, const SolveLimits& limits) {
    switch (method) {
        case Method::nncg:
            return solve_nncg(op, limits);
        case Method::apgd:
            return solve_apgd(op, limits);
        case Method::mprgp:
            return solve_mprgp(op, limits);
    }
    return {};
}

}  // namespace lab

template <>
struct EnumNames<lab::Method> {
    static constexpr std::array<std::pair<lab::Method, std::string_view>, 3> table{{
        {lab::Method::nncg, "nncg"},
        {lab::Method::apgd, "apgd"},
        {lab::Method::mprgp, "mprgp"},
    }};
};

}  // namespace skerry
