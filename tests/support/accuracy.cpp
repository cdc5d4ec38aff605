#include "tests/support/accuracy.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace skerry::test::accuracy {

namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

void record(const Quantity& q) {
    const char* const folder = std::getenv("SKERRY_ACCURACY_RECORD");
    if (folder == nullptr) return;
    // one file a process: test programs may run side by side
    std::ofstream out(std::filesystem::path(folder) / (std::to_string(getpid()) + ".jsonl"), std::ios::app);
    out.precision(17);
    out << "{\"item\": " << q.item << ", \"name\": " << quoted(q.name) << ", \"formula\": " << quoted(q.formula)
        << ", \"expected\": " << q.expected << ", \"found\": " << q.found << ", \"tolerance\": " << q.tolerance
        << ", \"kind\": " << (q.kind == Tolerance::relative ? "\"relative\"" : "\"absolute\"") << ", \"note\": " << quoted(q.note) << "}\n";
    REQUIRE(out.good());
}

}  // namespace

void check(const Quantity& q) {
    INFO("item " << q.item << ": " << q.name << " = " << q.formula);
    REQUIRE(std::isfinite(q.found));
    const Real scale = q.kind == Tolerance::relative ? std::abs(q.expected) : 1;
    INFO("expected " << q.expected << ", found " << q.found << ", error " << std::abs(q.found - q.expected) / scale << ", tolerance "
                     << q.tolerance);
    REQUIRE(std::abs(q.found - q.expected) <= q.tolerance * scale);
    record(q);
}

}  // namespace skerry::test::accuracy
