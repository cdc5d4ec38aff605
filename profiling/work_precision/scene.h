// The scenes of profile_work_precision: one description from which our world and those of the peers are built.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "skerry/mesh.h"
#include "skerry/settings.h"

namespace skerry::profiling {

struct PrecisionBody {
    Mesh mesh;                   // m, world frame
    std::vector<Vec3> velocity;  // m/s, by node
    std::vector<Index> fixed;    // nodes held where they are
    std::vector<Real> mass;      // kg, by node: a quarter of each tetrahedron
    Real sphere = 0;             // m, radius of a rigid sphere, which the mesh draws (its first node is the middle)
};

struct PrecisionPlane {
    Vec3 normal = {0, 0, 1};    // unit
    Vec3 point = Vec3::Zero();  // m
};

/// Linear between its keys.
struct GravityKey {
    Real time = 0;  // s
    Vec3 gravity = {0, 0, -9.81};
};

struct PrecisionScene {
    std::string name;
    int level = 1;                              // of the mesh: elements along an edge grow in proportion
    ElementKind element = ElementKind::linear;  // what the peers have
    MaterialSettings material{};
    Real stiffness_damping = 0;    // s: what Bullet and MuJoCo have for damping; ours is in the material (1/s)
    Real contact_distance = 1e-3;  // m, between a surface and what it touches
    std::vector<GravityKey> gravity{{}};
    std::vector<PrecisionBody> bodies;
    std::vector<PrecisionPlane> planes;
    Real seconds = 1;  // s
    int samples = 20;  // equally spaced, the last at the end
    Real length = 1;   // m, to which errors relate

    bool has_contacts() const { return !planes.empty() || bodies.size() > 1; }
    std::size_t nodes() const;
    std::size_t tetrahedra() const;
};

/// The names of scenes whose trajectories are compared.
const std::vector<std::string>& trajectory_scenes();

/// Those whose meshes are compared, too: with a body that mainly bends.
const std::vector<std::string>& mesh_scenes();

/// A scene of mesh_scenes(), or "pile". Throws std::invalid_argument for other names.
PrecisionScene make_scene(std::string_view name, int level);

/// The mesh on which the scene's steps are compared.
int usual_level(std::string_view name);

/// A block on a floor on which gravity pulls along with `fraction` of what friction can hold. It settles for the first
/// part of the samples.
PrecisionScene make_creep_scene(Real fraction);
inline constexpr Real creep_settling = 2.0;  // s: in one second what the pull has strained has died away to 1e-9 m only
inline constexpr Real creep_measured = 1.0;  // s

/// A quarter of each tetrahedron to each of its nodes.
void set_masses(PrecisionScene& scene);

/// Moves every body by a random vector of up to `amplitude` (m) a component; the same seed gives the same vectors.
void perturb(PrecisionScene& scene, std::uint32_t seed, Real amplitude);

/// Writes the scene for the programs of the peers (JSON).
void write_scene(const PrecisionScene& scene, const std::filesystem::path& file);

}  // namespace skerry::profiling
