// All material models that are registered: a new one meets every claim that is made for each of them.
#pragma once

#include <array>

#include "components/options.h"

namespace skerry::test {

inline constexpr auto material_models = [] {
    std::array<MaterialModel, EnumNames<MaterialModel>::table.size()> models{};
    for (std::size_t i = 0; i < models.size(); ++i) models[i] = EnumNames<MaterialModel>::table[i].first;
    return models;
}();

}  // namespace skerry::test
