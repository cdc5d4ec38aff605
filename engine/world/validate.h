// Checks of all inputs of a world. They throw SceneError, whose message names the object, the field, the found value
// and the expected value.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/base/complaint.h"
#include "engine/world/state/model.h"
#include "engine/world/tuning.h"
#include "skerry/settings.h"
#include "skerry/time_table.h"
#include "skerry/world.h"

namespace skerry {

void validate(const Settings& settings);
void validate(const Tuning& tuning);
void validate(const MaterialSettings& material);
/// Checks a body and its mesh. `mesh_is_known`: true if another body has this mesh, so that the mesh need not be
/// checked again.
void validate(const Mesh& mesh, const BodySettings& body, bool mesh_is_known);
void validate(const Sphere& sphere, const BodySettings& body);
void validate(const Capsule& capsule, const BodySettings& body);
void validate(const Cylinder& cylinder, const BodySettings& body);
/// Checks a body after its rows were appended. Its stable step must be above 0. It must also be finite, except for a
/// rigid or implicit body, whose elements need not limit the step.
void validate_step(const Model& model, Index body, const std::string& name);
void validate(const Shape& shape, const ColliderSettings& collider);
void validate(const Motion& motion, const std::string& object);
void validate(const Motion& motion, const Vec3& pivot);
void validate(const SurfaceSettings& surface, const std::string& object);
/// Checks the time table `field` of `object`. It must have at least one key and only finite numbers, and each time must
/// be later than the one before.
void require_table(const std::string& object, const std::string& field, const TimeTable& table);
/// Checks that the node numbers `nodes` exist in `object`, a body with `count` nodes.
void require_nodes(const std::string& object, std::span<const Index> nodes, Index count);
/// Checks as require_nodes does, and that no node occurs twice.
void require_different_nodes(const std::string& object, std::span<const Index> nodes, Index count);
void validate(const Pose& pose, const std::string& object);

}  // namespace skerry
