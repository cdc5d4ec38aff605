// A world with a single explicit body, from which the stable step of a mesh is computed.
#pragma once

#include <map>

#include "skerry/world.h"

namespace skerry {

/// All data on which the stable step of a single body depends, apart from the mesh. By default the body has the default
/// material and elements. The body is explicit; `body.dynamics` is ignored.
struct BodyCase {
    Settings settings{};
    MaterialSettings material{};
    BodySettings body{};
    std::map<int, MaterialSettings> labelled{};  // material of the tetrahedra with each label
};

struct ExplicitBody {
    World world;
    BodyHandle handle;
};

/// Adds a body to a new world without clusters, in which all elements are integrated explicitly. The stable step of the
/// world is therefore that of the elements of the mesh alone. Throws SceneError if the mesh cannot be a body.
ExplicitBody explicit_body(const Mesh& mesh, const BodyCase& body_case);

}  // namespace skerry
