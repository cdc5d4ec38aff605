// What may be asked of a world. Every complaint names the object, the field, what was found and what was expected.
#pragma once

#include <span>
#include <string>

#include "engine/world/state/model.h"
#include "skerry/settings.h"
#include "skerry/world.h"

namespace skerry {

void validate(const Settings& settings);
void validate(const MaterialSettings& material);
/// `mesh_is_known`: it was found to be one that a body may have.
void validate(const Mesh& mesh, const BodySettings& body, bool mesh_is_known);
void validate(const Sphere& sphere, const BodySettings& body);
void validate(const Capsule& capsule, const BodySettings& body);
void validate(const Cylinder& cylinder, const BodySettings& body);
/// Of a body that has its rows: that its stable step is a number.
void validate_step(const Model& model, Index body, const std::string& name);
void validate(const Shape& shape, const ColliderSettings& collider);
void validate(const Motion& motion, const std::string& object);
void validate(const Motion& motion, const Vec3& pivot);
void validate(const SurfaceSettings& surface, const std::string& object);
/// Of `object`, three numbers each.
void require_finite(const std::string& object, const char* field, const Vec3& found);
/// Of `object`: numbers of a body's nodes, of which there are `count`.
void require_nodes(const std::string& object, std::span<const Index> nodes, Index count);
void validate(const Pose& pose, const std::string& object);

}  // namespace skerry
