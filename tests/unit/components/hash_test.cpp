#include "components/hash.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <vector>

namespace skerry::test::hash_test {

namespace {

std::uint64_t hash_of(const std::vector<unsigned char>& bytes) {
    Hash hash;
    hash.add(bytes.data(), bytes.size());
    return hash.value();
}

std::vector<unsigned char> some_bytes(std::size_t count) {
    std::mt19937 random(1);
    std::vector<unsigned char> bytes(count);
    for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random());
    return bytes;
}

}  // namespace

TEST_CASE("the hash is the published XXH3", "[unit]") {
    CHECK(Hash().value() == 0x2d06800538d394c2ull);  // empty input, seed 0
    CHECK(hash_of({'a'}) == 0xe6c632b61e964e1full);
}

TEST_CASE("the hash does not depend on the division of the data, and can be read in between", "[unit]") {
    const std::vector<unsigned char> bytes = some_bytes(5000);
    for (const std::size_t piece : {1, 7, 8, 64, 255, 256, 1000}) {
        INFO("pieces of " << piece);
        Hash hash;
        for (std::size_t begin = 0; begin < bytes.size(); begin += piece) {
            hash.add(bytes.data() + begin, std::min(piece, bytes.size() - begin));
            (void)hash.value();
        }
        CHECK(hash.value() == hash_of(bytes));
    }
}

TEST_CASE("a copy of a hash goes on by itself", "[unit]") {
    const std::vector<unsigned char> bytes = some_bytes(1000);
    Hash hash;
    hash.add(bytes.data(), 500);
    Hash copy = hash;
    hash.add(std::uint64_t{1});
    copy.add(bytes.data() + 500, 500);
    CHECK(copy.value() == hash_of(bytes));
}

TEST_CASE("any bit of the data changes the hash", "[unit]") {
    std::vector<unsigned char> bytes = some_bytes(600);
    const std::uint64_t before = hash_of(bytes);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (int bit = 0; bit < 8; ++bit) {
            bytes[i] = static_cast<unsigned char>(bytes[i] ^ (1 << bit));
            REQUIRE(hash_of(bytes) != before);
            bytes[i] = static_cast<unsigned char>(bytes[i] ^ (1 << bit));
        }
}

TEST_CASE("a column is hashed with its length: rows that move to the next column change the hash", "[unit]") {
    Column<double> one, two;
    one.push_back(1);
    one.push_back(2);
    Hash first;
    first.add(one);
    first.add(two);
    one.erase(1, 1);
    two.push_back(2);
    Hash second;
    second.add(one);
    second.add(two);
    CHECK(first.value() != second.value());
}

}  // namespace skerry::test::hash_test
