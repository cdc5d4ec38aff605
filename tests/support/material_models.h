// All registered material models. A new model has to pass every test that runs over all of them.
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
