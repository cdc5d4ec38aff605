// Scenes of profile_work_precision: one description from which the worlds of Skerry and of the peers are built.
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
    Mesh mesh;                   // in the world frame [m]
    std::vector<Vec3> velocity;  // by node [m/s]
    std::vector<Index> fixed;    // nodes held in place
    std::vector<Real> mass;      // by node: a quarter of each tetrahedron [kg]
    Real sphere = 0;             // radius of a rigid sphere, whose mesh has its centre as first node; 0: deformable [m]
};

struct PrecisionPlane {
    Vec3 normal = {0, 0, 1};    // unit vector
    Vec3 point = Vec3::Zero();  // [m]
};

/// Key of the gravity, which is linear between keys.
struct GravityKey {
    Real time = 0;  // [s]
    Vec3 gravity = {0, 0, -9.81};
};

struct PrecisionScene {
    std::string name;
    int level = 1;                              // mesh level: the number of elements along an edge grows in proportion
    ElementKind element = ElementKind::linear;  // like the elements of the peers
    MaterialSettings material{};
    Real stiffness_damping = 0;    // damping of Bullet and MuJoCo; ours is a rate in the material [s]
    Real contact_distance = 1e-3;  // between a surface and the object that it touches [m]
    std::vector<GravityKey> gravity{{}};
    std::vector<PrecisionBody> bodies;
    std::vector<PrecisionPlane> planes;
    Real seconds = 1;  // [s]
    int samples = 20;  // equally spaced, the last at the end
    Real length = 1;   // length that errors are relative to [m]

    bool has_contacts() const { return !planes.empty() || bodies.size() > 1; }
    std::size_t nodes() const;
    std::size_t tetrahedra() const;
};

/// Names of the scenes whose trajectories are compared.
const std::vector<std::string>& trajectory_scenes();

/// Names of the scenes whose meshes are compared: trajectory_scenes() and one with a body that mainly bends.
const std::vector<std::string>& mesh_scenes();

/// Makes a scene of mesh_scenes(), or "pile". Throws std::invalid_argument for other names.
PrecisionScene make_scene(std::string_view name, int level);

/// Mesh level at which the steps of the scene are compared.
int usual_level(std::string_view name);

/// Makes a block on a floor. Gravity pulls it along the floor with `fraction` of the force that friction can hold. The
/// block settles for creep_settling before its creep is measured.
PrecisionScene make_creep_scene(Real fraction);
// Settling time [s]. After one second, 1e-9 m of the transient of the pull would still remain.
inline constexpr Real creep_settling = 2.0;
inline constexpr Real creep_measured = 1.0;  // time over which creep is measured [s]

/// Gives a quarter of the mass of each tetrahedron to each of its nodes.
void set_masses(PrecisionScene& scene);

/// Moves every body by a random vector, never downwards, of up to `amplitude` per component [m]. Equal seeds give equal
/// vectors.
void perturb(PrecisionScene& scene, std::uint32_t seed, Real amplitude);

/// Writes the scene for the programs of the peers (JSON).
void write_scene(const PrecisionScene& scene, const std::filesystem::path& file);

}  // namespace skerry::profiling
