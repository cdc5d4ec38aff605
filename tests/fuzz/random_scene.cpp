#include "random_scene.h"
#include "engine/world/tuning.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "components/options.h"
#include "random_mesh.h"
#include "random_numbers.h"
#include "skerry/settings.h"

namespace skerry::test {

namespace {

using Json = nlohmann::ordered_json;

Json list(const Vec3& v) {
    return Json::array({v.x(), v.y(), v.z()});
}

/// Builds one scene. Sizes and speeds are chosen so that something happens within a few hundred stable steps.
class SceneMaker {
public:
    explicit SceneMaker(std::uint64_t seed) : seed_(seed), random_(seed) {}

    RandomScene make() {
        scene_.advances = random_.count(10, 60);
        scene_.steps_per_advance = random_.within(0.3, 10);
        scene_.length = random_.by_decade(1e-3, 1e2);
        stiffness_ = random_.by_decade(1e3, 1e9);
        density_ = random_.by_decade(1, 1e4);
        wave_speed_ = std::sqrt(stiffness_ / density_);
        duration_ = scene_.advances * scene_.steps_per_advance * 0.05 * scene_.length / wave_speed_;
        // up to 100 m/s for any material, or slow enough for the material to survive the impact
        top_speed_ = random_.chance(0.2) ? random_.by_decade(0.1, 100)
                                         : std::min(100.0, wave_speed_ * random_.by_decade(1e-3, 0.5));
        scene_.speed = top_speed_;

        Json json;
        json["name"] = "random";
        json["seconds"] = duration_;
        json["settings"] = settings();
        json["materials"] = materials();
        json["bodies"] = Json::array();
        const int bodies = random_.chance(0.05) ? random_.count(7, 15) : random_.count(1, 6);
        for (int b = 0; b < bodies; ++b) json["bodies"].push_back(body(b));
        json["colliders"] = Json::array();
        for (int c = random_.count(0, 4); c > 0; --c) json["colliders"].push_back(collider());
        add_changes();
        scene_.json = json.dump(1);
        return std::move(scene_);
    }

private:
    template <class Enum>
    std::string any_name() {
        const auto& table = EnumNames<Enum>::table;
        return std::string(table[random_.next() % table.size()].second);
    }

    Json settings() {
        Json s;
        Tuning& tuning = scene_.tuning;
        // Most scenes ignore start overlaps: a run that goes on tests more than one that is moved apart or refused.
        constexpr std::uint64_t one_in = 16;
        s["start_overlaps"] = seed_ % one_in == 0 ? "resolve" : "ignore";
        // gravity of the Earth, none, or strong enough to matter within so short a run
        const Real strong = random_.by_decade(1e-4, 1e-1) * wave_speed_ * wave_speed_ / scene_.length;
        s["gravity"] = list(random_.one_of<Real>({0, 9.81, strong, strong}) * random_.direction());
        if (random_.chance(0.3)) tuning.step_safety = random_.within(0.05, 1);
        if (random_.chance(0.03)) {
            s["step_size"] = random_.by_decade(1e-3, 10) * duration_ / scene_.advances;
            scene_.oversized_step = true;
            scene_.passive = false;
        }
        if (random_.chance(0.3)) s["integrator"] = "leapfrog";
        if (random_.chance(0.2)) {
            tuning.sleep_speed = top_speed_ * random_.by_decade(1e-3, 1);
            s["sleep_time"] = duration_ * random_.one_of<Real>({0, random_.by_decade(1e-3, 1)});
        } else {
            draw_rest(s);
        }
        s["backend"] = any_name<Backend>();
        s["threads"] = random_.one_of<int>({1, 1, 1, 2, 3});
        s["contact_regions"] = random_.one_of<const char*>({"separate", "separate", "global"});
        s["method"] = random_.chance(0.4) ? "automatic" : any_name<SolverMethod>();
        s["friction"] = random_.chance(0.5) ? "cone" : any_name<Friction>();
        tuning.warm_start = *from_name<WarmStart>(any_name<WarmStart>());
        s["tolerance"] = random_.by_decade(1e-10, 0.5);
        s["max_iterations"] = random_.count(1, 300);
        if (random_.chance(0.1)) tuning.fixed_iterations = true;
        // Over-relaxed sweeps may add energy before they converge, and may be cut off there.
        if (random_.chance(0.1)) tuning.relaxation = random_.within(0.1, 1.9);
        if (random_.chance(0.2)) tuning.max_strain_step = random_.by_decade(0.01, 1);
        bool continuous = Settings{}.continuous_collision;
        for (bool* const option : {&tuning.contact_budgets, &continuous, &tuning.certify_warm_start,
                                   &tuning.skip_separating, &tuning.frictionless_rows, &tuning.small_regions_in_lanes})
            if (random_.chance(0.3)) *option = random_.chance(0.5);
        s["continuous_collision"] = continuous;
        if (!s.contains("integrator") && of_long_steps_.chance(0.3))
            s["implicit_step"] = duration_ * of_long_steps_.by_decade(1e-3, 1);
        return s;
    }

    /// Uses the engine's own sleep limits and a sleep time short enough to matter in the run. Its random numbers are
    /// separate, so that all other draws stay unchanged.
    void draw_rest(Json& s) const {
        RandomNumbers random(seed_ ^ 0x9e3779b97f4a7c15u);
        s["sleep"] = random.chance(0.8);
        if (random.chance(0.6)) s["sleep_time"] = duration_ * random.by_decade(1e-3, 1);
    }

    Json materials() {
        Json all;
        material_count_ = random_.count(1, 3);
        for (int m = 0; m < material_count_; ++m) {
            Json material;
            material["young_modulus"] = std::clamp(stiffness_ * (m == 0 ? 1 : random_.by_decade(0.01, 100)), 1e3, 1e9);
            material["poisson_ratio"] =
                random_.one_of<Real>({0, 0.499, random_.within(-0.3, 0.499), random_.within(0.2, 0.45)});
            material["density"] = std::clamp(density_ * (m == 0 ? 1 : random_.by_decade(0.01, 100)), 1.0, 1e4);
            const Real friction = random_.one_of<Real>({0, 0.5, 10, random_.within(0, 1), random_.within(0, 10)});
            if (random_.chance(0.3)) {
                material["static_friction"] = friction;
                material["dynamic_friction"] = friction * random_.within(0, 1);
            } else {
                material["friction"] = friction;
            }
            material["restitution"] = random_.one_of<Real>({0, 0, 1, random_.within(0, 1)});
            material["damping"] = random_.chance(0.5) ? 0 : random_.by_decade(1e-3, 1e2) / duration_;
            material["model"] = any_name<MaterialModel>();
            if (material["model"] == name_of(MaterialModel::orthotropic)) make_orthotropic(material, m);
            if (random_.chance(0.5)) {
                const Real loss_factor = random_.one_of<Real>({0, 0.3, random_.within(0, 0.3)});
                material["loss_factor"] = loss_factor;
                any_losses_ |= loss_factor > 0;
                material["bulk_viscosity"] = random_.one_of<Real>({0, 1, random_.within(0, 1)});
            }
            all["m" + std::to_string(m)] = material;
        }
        return all;
    }

    /// Replaces the elastic constants by those of an orthotropic law. Its random numbers are separate, so that all
    /// other draws stay unchanged.
    void make_orthotropic(Json& material, int index) const {
        RandomNumbers random(seed_ ^ (0xd1b54a32d192ed03u + static_cast<std::uint64_t>(index)));
        // These ranges keep every stiffness positive definite: |nu_ij| sqrt(E_j/E_i) stays below 1/2.
        constexpr Real most_poisson = 0.2, factor = 2;
        const Real isotropic = material["young_modulus"];
        const auto modulus = [&](Real mean) { return mean * random.by_decade(1 / factor, factor); };
        Json law;
        for (int axis = 0; axis < 3; ++axis) {
            law["young_modulus"].push_back(modulus(isotropic));
            law["poisson_ratio"].push_back(random.within(-most_poisson, most_poisson));
            law["shear_modulus"].push_back(modulus(isotropic / 2));
        }
        if (random.chance(0.5)) {
            law["first_axis"] = {0, 0, 1};
            law["second_axis"] = {1, 0, 0};
        }
        for (const char* key : {"model", "young_modulus", "poisson_ratio"}) material.erase(key);
        material["orthotropic"] = law;
    }

    Json mesh(Real size) {
        Json mesh;
        const int resolution = random_.count(1, 4);
        switch (random_.count(0, 5)) {
            case 0: {
                Vec3 edges = Vec3::Constant(size);
                if (random_.chance(0.6))
                    edges = size * Vec3(random_.by_decade(0.1, 1), random_.by_decade(0.1, 1), random_.within(0.2, 1));
                mesh["box"] = {{"size", list(edges)},
                               {"cells", {random_.count(1, 4), random_.count(1, 4), random_.count(1, 4)}}};
                break;
            }
            case 1:
                mesh["ball"] = {{"radius", size / 2}, {"resolution", resolution}};
                break;
            case 2:
                mesh["cylinder"] = {
                    {"radius", size * random_.within(0.1, 0.5)}, {"height", size}, {"resolution", resolution}};
                break;
            case 3: {
                Json profile = Json::array();
                Real z = -size / 2;
                for (int k = random_.count(2, 5); k > 0; --k, z += size * random_.within(0.1, 0.4))
                    profile.push_back({size * random_.within(0.1, 0.5), z});
                mesh["lathe"] = {{"profile", profile}, {"resolution", std::min(resolution, 3)}};
                break;
            }
            case 4:
                mesh["skittle"] = {{"height", size}, {"resolution", std::min(resolution, 2)}};
                break;
            default:
                mesh["table"] = {{"length", size},
                                 {"width", size * random_.within(0.4, 1)},
                                 {"height", size * random_.within(0.4, 1)},
                                 {"thickness", size * random_.within(0.05, 0.3)},
                                 {"leg", size * random_.within(0.05, 0.15)},
                                 {"cells_per_leg", 1}};
        }
        if (random_.chance(0.1)) mesh["scale"] = random_.by_decade(0.5, 2);
        return mesh;
    }

    Json mesh_file(Real size) {
        const std::string name = "mesh_" + std::to_string(seed_) + "_" + std::to_string(scene_.meshes.size()) + ".msh";
        scene_.meshes.emplace_back(name, make_poor_mesh(of_meshes_, size));
        return {{"file", name}};
    }

    Json rotation() {
        return {{"axis", list(random_.direction())}, {"radians", random_.one_of<Real>({0, random_.within(-4, 4)})}};
    }

    /// A position beside the last body: separated by a part of their sizes, exactly touching, or one inside the other.
    Vec3 next_to_last(Real size) {
        const Real reach = (last_size_ + size) / 2;
        const Real apart = random_.one_of<Real>(
            {1, 1, 1, 1.001, random_.within(1, 1.1), random_.within(0.9, 1), random_.within(0, 1)});
        // Nested bodies may be pushed apart later, when their surfaces meet.
        if (apart < 0.9) scene_.passive = false;
        const Vec3 position = last_position_ + apart * reach * random_.direction();
        last_size_ = size;
        return last_position_ = position;
    }

    Vec3 velocity(Real most) {
        return random_.chance(0.3) ? Vec3(Vec3::Zero()) : Vec3(random_.within(0, most) * random_.direction());
    }

    Json motion(const Vec3& start) {
        Json motion;
        scene_.passive = false;
        if (random_.chance(0.6)) {
            motion["velocity"] = list(velocity(top_speed_));
            motion["angular_velocity"] = list(velocity(top_speed_ / scene_.length));
            return motion;
        }
        Json keys = Json::array();
        Real time = random_.one_of<Real>({0, random_.within(0, duration_)});
        for (int k = random_.count(1, 4); k > 0; --k) {
            const Vec3 place = start + random_.within(0, 1) * top_speed_ * duration_ * random_.direction();
            keys.push_back({{"time", time}, {"position", list(place)}, {"rotation", rotation()}});
            time += duration_ * random_.by_decade(0.01, 1);
        }
        motion["keys"] = keys;
        return motion;
    }

    Json body(int number) {
        const Real size = scene_.length * random_.by_decade(0.3, 3);
        Json body;
        body["name"] = "b" + std::to_string(number);
        body["mesh"] = mesh(size);
        if (of_meshes_.chance(0.25)) body["mesh"] = mesh_file(size);
        body["material"] = "m" + std::to_string(random_.count(0, material_count_ - 1));
        const Vec3 place = number == 0 ? Vec3(Vec3::Zero()) : next_to_last(size);
        if (number == 0) last_size_ = size;
        // Far from the origin, positions have fewer digits after the decimal point.
        if (number == 0 && random_.chance(0.05)) last_position_ = 1e4 * scene_.length * random_.direction();
        body["position"] = list(number == 0 ? last_position_ : place);
        if (random_.chance(0.5)) body["rotation"] = rotation();
        body["velocity"] = list(velocity(top_speed_));
        if (random_.chance(0.4)) body["angular_velocity"] = list(velocity(top_speed_ / size));
        if (random_.chance(0.3))
            body["contact_distance"] = random_.chance(0.3) ? 0 : size * random_.by_decade(1e-4, 0.1);
        if (random_.chance(0.2)) body["self_contact"] = true;
        if (random_.chance(0.5)) body["element"] = any_name<ElementKind>();
        if (random_.chance(0.2)) {
            Json pin = {{"nodes", Json::array({random_.count(0, 3)})}};
            if (random_.chance(0.3))
                pin = {{"box", {{"lower", list(Vec3::Constant(-size * 2))}, {"upper", {size * 2, size * 2, 0.0}}}}};
            if (random_.chance(0.5)) {
                pin["motion"] = motion(last_position_);
                if (!pin["motion"].contains("keys")) pin["pivot"] = list(last_position_);
            }
            body["pin"] = pin;
        }
        if (!body.contains("pin") && !body.contains("self_contact") && of_frames_.chance(0.35))
            body["dynamics"] = name_of(of_frames_.chance(0.5) ? BodyDynamics::rigid
                                       : any_losses_          ? BodyDynamics::explicit_elastic
                                                              : BodyDynamics::implicit_elastic);
        if (!body.contains("dynamics") && of_meshes_.chance(0.1)) body["dynamics"] = name_of(BodyDynamics::automatic);
        if (!body.contains("pin") && !body.contains("self_contact") && of_spheres_.chance(0.25)) {
            body.erase("mesh");
            body.erase("element");
            body["shape"] =
                of_capsules_.chance(0.5)
                    ? Json{{"capsule", {{"radius", size * of_capsules_.within(0.1, 0.4)}, {"length", size / 2}}}}
                    : Json{{"sphere", {{"radius", size / 2}}}};
            if (of_cylinders_.chance(0.35))
                body["shape"] = Json{{"cylinder",
                                      {{"radius", size * of_cylinders_.within(0.1, 0.5)},
                                       {"height", size * of_cylinders_.by_decade(0.1, 1)}}}};
            body["dynamics"] = name_of(BodyDynamics::rigid);
        }
        return body;
    }

    Json shape(Real size) {
        switch (random_.count(0, 6)) {
            case 0:
                return {{"plane", {{"normal", list(random_.by_decade(0.01, 100) * random_.direction())}}}};
            case 1:
                return {{"sphere", {{"radius", size / 2}}}};
            case 2:
                return {
                    {"box", {{"size", list(size * Vec3(1, random_.by_decade(0.1, 1), random_.by_decade(0.1, 1)))}}}};
            case 3:
                return {{"capsule", {{"radius", size * random_.within(0.1, 0.4)}, {"length", size / 2}}}};
            case 4:
                return {{"cylinder", {{"radius", size * random_.within(0.1, 0.5)}, {"height", size}}}};
            case 5:
                return {
                    {"bucket", {{"radius", size}, {"height", size}, {"thickness", size * random_.within(0.01, 0.2)}}}};
            default:
                return {{"mesh", mesh(size)}};
        }
    }

    Json collider() {
        const Real size = scene_.length * random_.by_decade(0.2, 20);
        Json collider;
        collider["shape"] = shape(size);
        const Vec3 place = next_to_last(size);
        collider["position"] = list(place);
        if (random_.chance(0.5)) collider["rotation"] = rotation();
        if (random_.chance(0.4)) collider["motion"] = motion(place);
        // Keys give the normal of a plane.
        if (collider.contains("motion") && collider["motion"].contains("keys") && collider["shape"].contains("plane"))
            collider["shape"]["plane"].erase("normal");
        if (random_.chance(0.5)) collider["friction"] = random_.one_of<Real>({0, 1, random_.within(0, 10)});
        if (random_.chance(0.3)) collider["restitution"] = random_.within(0, 1);
        if (collider["shape"].contains("mesh") && random_.chance(0.5))
            collider["contact_distance"] = size * random_.by_decade(1e-4, 0.05);
        return collider;
    }

    void add_changes() {
        if (random_.chance(0.5)) return;
        for (int k = random_.count(1, 6); k > 0; --k)
            scene_.changes.push_back({random_.count(1, scene_.advances - 1),
                                      static_cast<Change>(random_.count(0, static_cast<int>(Change::set_gravity))),
                                      random_.next()});
        std::stable_sort(scene_.changes.begin(), scene_.changes.end(),
                         [](const SceneChange& a, const SceneChange& b) { return a.advance < b.advance; });
    }

    const std::uint64_t seed_;
    RandomNumbers random_;
    // Separate generators, so that the draws of random_ stay unchanged.
    RandomNumbers of_frames_{~seed_};
    RandomNumbers of_meshes_{~seed_ * 3};
    RandomNumbers of_spheres_{~seed_ * 5};
    RandomNumbers of_capsules_{~seed_ * 7};
    RandomNumbers of_cylinders_{~seed_ * 11};
    RandomNumbers of_long_steps_{~seed_ * 13};
    RandomScene scene_;
    Real stiffness_ = 0, density_ = 0;  // of the first material [Pa, kg/m^3]
    bool any_losses_ = false;           // a material sets a loss factor, which implicit bodies refuse
    Real wave_speed_ = 0;               // of the first material [m/s]
    Real duration_ = 0;                 // approximate length of the run [s]
    Real top_speed_ = 0;                // [m/s]
    int material_count_ = 0;
    Vec3 last_position_ = Vec3::Zero();
    Real last_size_ = 0;
};

}  // namespace

std::filesystem::path write_random_scene(const RandomScene& scene, const std::filesystem::path& folder,
                                         const std::string& name) {
    for (const auto& [mesh_name, content] : scene.meshes) mesh::write((folder / mesh_name).string(), content);
    const std::filesystem::path file = folder / name;
    std::ofstream(file) << scene.json;
    return file;
}

RandomScene make_random_scene(std::uint64_t seed) {
    return SceneMaker(seed).make();
}

}  // namespace skerry::test
