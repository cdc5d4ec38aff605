#include "tests/support/record.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace skerry::test {

namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

}  // namespace

std::string& RecordLine::next(const char* key) {
    text_ += (text_.empty() ? "" : ", ") + quoted(key) + ": ";
    return text_;
}

RecordLine& RecordLine::add(const char* key, const std::string& text) {
    next(key) += quoted(text);
    return *this;
}

RecordLine& RecordLine::add(const char* key, Real number) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", number);
    next(key) += digits;
    return *this;
}

RecordLine& RecordLine::add(const char* key, int number) {
    next(key) += std::to_string(number);
    return *this;
}

void RecordLine::write() const {
    const char* const folder = std::getenv("SKERRY_RECORD");
    if (folder == nullptr) return;
    std::ofstream out(std::filesystem::path(folder) / (std::to_string(getpid()) + ".jsonl"), std::ios::app);
    out << '{' << text_ << "}\n";
    REQUIRE(out.good());
}

}  // namespace skerry::test
