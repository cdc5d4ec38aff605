// The build compiles this file once per instruction set. SKERRY_LOOPS is the name of the table of loops,
// SKERRY_LOOPS_FOR the name of the instruction set. Nothing here may leave the file except the table, because an inline
// function of one instruction set could replace that of another.
#include "profiling/roofline/peak_loops.h"

#include <utility>

namespace {

#if defined(__AVX512F__)
constexpr std::size_t register_bytes = 64, register_count = 32;
#elif defined(__AVX__)
constexpr std::size_t register_bytes = 32, register_count = 16;
#elif defined(__aarch64__)
constexpr std::size_t register_bytes = 16, register_count = 32;
#else
constexpr std::size_t register_bytes = 16, register_count = 16;
#endif
// clang does not know the attribute of fused_rounds.
#if !defined(__clang__) && (defined(__FMA__) || defined(__aarch64__))
constexpr bool has_fused = true;
#else
constexpr bool has_fused = false;
#endif

template <class Number>
struct Register {
    typedef Number type __attribute__((vector_size(register_bytes), may_alias));
};
template <class Number>
constexpr double lanes = register_bytes / sizeof(Number);

// A chain is a register in which each operation waits for the one before. A multiplication and an addition take 6 to 8
// cycles together, and processors start one to two such pairs in a cycle, so 8 to 12 chains keep all units busy. Two
// registers are left for factor and summand. With more chains, registers would go through memory.
constexpr std::size_t chains = register_count == 32 ? 24 : 14;

// The rounds of both loops. The source is the same; only the option of the function that contains it differs. Factor
// and summand are arguments, because the compiler shortens a loop whose numbers it knows.
#define SKERRY_ROUNDS                                                                                     \
    using Vector = typename Register<Number>::type;                                                       \
    const Vector a = Vector{} + static_cast<Number>(factor), b = Vector{} + static_cast<Number>(summand); \
    Vector x[] = {Vector{} + static_cast<Number>(i)...};                                                  \
    for (std::size_t round = 0; round < rounds; ++round) ((x[i] = x[i] * a + b), ...);                    \
    Vector sum{};                                                                                         \
    ((sum += x[i]), ...);                                                                                 \
    return sum[0] < 0 ? 0 : 2 * lanes<Number> * static_cast<double>(sizeof...(i) * rounds)

template <class Number, std::size_t... i>
[[gnu::noinline]] double separate_rounds(std::size_t rounds, double factor, double summand, std::index_sequence<i...>) {
    SKERRY_ROUNDS;
}
/// The only function of the project that allows contraction.
template <class Number, std::size_t... i>
[[gnu::noinline, gnu::optimize("fp-contract=fast")]] double fused_rounds(std::size_t rounds, double factor,
                                                                         double summand, std::index_sequence<i...>) {
    SKERRY_ROUNDS;
}
#undef SKERRY_ROUNDS

template <class Number>
double separate(std::size_t rounds, double factor, double summand) {
    return separate_rounds<Number>(rounds, factor, summand, std::make_index_sequence<chains>{});
}
template <class Number>
double fused(std::size_t rounds, double factor, double summand) {
    return fused_rounds<Number>(rounds, factor, summand, std::make_index_sequence<chains>{});
}

/// Combines all numbers by exclusive or. It takes one cycle and runs on more units than an addition, so loads decide
/// the time.
double read(const double* from, std::size_t count) {
    using Bits = Register<unsigned long long>::type;
    constexpr std::size_t width = register_bytes / sizeof(double), at_once = 8;
    static_assert(skerry::profiling::reals_per_round % (width * at_once) == 0);
    Bits x[at_once] = {};
    for (std::size_t k = 0; k < count; k += width * at_once) {
        const Bits* const line = reinterpret_cast<const Bits*>(from + k);
        x[0] ^= line[0], x[1] ^= line[1], x[2] ^= line[2], x[3] ^= line[3];
        x[4] ^= line[4], x[5] ^= line[5], x[6] ^= line[6], x[7] ^= line[7];
    }
    const Bits all = x[0] ^ x[1] ^ x[2] ^ x[3] ^ x[4] ^ x[5] ^ x[6] ^ x[7];
    return static_cast<double>(all[0]);
}

void triad(double* to, const double* x, const double* y, double s, std::size_t count) {
    using Vector = Register<double>::type;
    constexpr std::size_t width = register_bytes / sizeof(double);
    const Vector factor = Vector{} + s;
    Vector* const __restrict target = reinterpret_cast<Vector*>(to);
    const Vector *const summand = reinterpret_cast<const Vector*>(x), *const scaled =
                                                                          reinterpret_cast<const Vector*>(y);
    for (std::size_t k = 0; k < count / width; k += 4) {
        target[k] = summand[k] + factor * scaled[k];
        target[k + 1] = summand[k + 1] + factor * scaled[k + 1];
        target[k + 2] = summand[k + 2] + factor * scaled[k + 2];
        target[k + 3] = summand[k + 3] + factor * scaled[k + 3];
    }
}

}  // namespace

// The table has a name without C++ mangling, which the build lists in peak_loops.inc.
extern "C" {
extern const skerry::profiling::PeakLoops SKERRY_LOOPS;

const skerry::profiling::PeakLoops SKERRY_LOOPS = {
    .instruction_set = SKERRY_LOOPS_FOR,
    .register_bytes = register_bytes,
    .separate_double = &separate<double>,
    .fused_double = has_fused ? &fused<double> : nullptr,
    .separate_single = &separate<float>,
    .fused_single = has_fused ? &fused<float> : nullptr,
    .read = &read,
    .triad = &triad,
};
}
