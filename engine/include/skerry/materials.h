// Materials with values from the literature. The command `skerry materials` prints them.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "skerry/settings.h"

#pragma GCC visibility push(default)
namespace skerry {

struct SourcedValue {
    Real value;
    std::string_view source;  // citation, and the way in which the value was derived from it
};

struct NamedMaterial {
    std::string_view name;         // for named_material() and for the key "like" of scene files
    std::string_view title;        // description for people
    SourcedValue young_modulus;    // at small strain [Pa]
    SourcedValue poisson_ratio;    // rubber, gels and tissue have 0.49 in place of almost 0.5
    SourcedValue density;          // [kg/m^3]
    std::optional<SourcedValue> loss_factor;
};

/// Friction coefficients of two clean, dry surfaces.
struct KnownFriction {
    std::string_view first, second;  // names of materials
    Real static_friction, dynamic_friction;
    std::string_view source;
};

/// All materials, in groups from soft to stiff.
std::span<const NamedMaterial> named_materials();
std::span<const KnownFriction> known_frictions();

/// Settings of the material called `name`. `friction` is the dynamic friction of two surfaces of this material if
/// known_frictions() lists the pair, else the default. Loss factors below 0.01 are not set: implicit bodies, to which
/// such materials belong, accept none. Throws SceneError if no material has this name.
MaterialSettings named_material(std::string_view name);

}  // namespace skerry
#pragma GCC visibility pop
