// Mutates scenes. About 70 % of the mutations of valid JSON keep it valid: broken text seldom passes the parser.
#include <algorithm>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "random_numbers.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using Json = nlohmann::ordered_json;
using skerry::test::RandomNumbers;

std::vector<Json*> all_values(Json& root) {
    std::vector<Json*> values{&root};
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i]->is_structured())
            for (Json& inner : *values[i]) values.push_back(&inner);
    return values;
}

Json telling_value(RandomNumbers& random) {
    const Json values[] = {0,
                           1,
                           -1,
                           2,
                           0.5,
                           1e-300,
                           1e300,
                           1e30,
                           -1e30,
                           1e-9,
                           2147483647,
                           4294967296.0,
                           "",
                           "x",
                           "body.vtk",
                           "other.json",
                           true,
                           nullptr,
                           Json::array(),
                           Json::object(),
                           Json::array({0, 0, 0}),
                           Json::array({0, 0, 1})};
    return random.one_of(values);
}

void change(Json& root, RandomNumbers& random) {
    const std::vector<Json*> values = all_values(root);
    Json& value = *values[random.next() % values.size()];
    const Json& other = *values[random.next() % values.size()];
    switch (random.count(0, 5)) {
        case 0:
            value = Json(other);
            return;
        case 1:
            value = telling_value(random);
            return;
        case 2:
            if (value.is_number())
                value = value.get<double>() * random.one_of<double>({-1, 0, 0.5, 2, 1e3, 1e-3, 1e12, 1e-12});
            return;
        case 3:
            if (value.is_array() && !value.empty()) value.erase(random.next() % value.size());
            if (value.is_object() && !value.empty())
                value.erase(std::next(value.begin(), static_cast<std::ptrdiff_t>(random.next() % value.size())).key());
            return;
        case 4:
            if (value.is_array()) value.push_back(Json(other));
            return;
        default:
            if (value.is_object() && other.is_object() && !other.empty()) {
                const auto item = std::next(other.begin(), static_cast<std::ptrdiff_t>(random.next() % other.size()));
                const std::string key = item.key();
                const Json copy = item.value();
                value[key] = copy;
            }
    }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
    RandomNumbers random(seed);
    Json json = Json::parse(data, data + size, nullptr, false);
    if (json.is_discarded() || random.chance(0.3)) return LLVMFuzzerMutate(data, size, most);
    for (int k = random.count(1, 3); k > 0; --k) change(json, random);
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > most) return LLVMFuzzerMutate(data, size, most);
    std::memcpy(data, text.data(), text.size());
    return text.size();
}
