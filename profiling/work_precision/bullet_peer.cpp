// work_precision_bullet: runs a scene of profile_work_precision with Bullet's deformable bodies. This is the only file
// that uses Bullet. It is a separate program for two reasons. Bullet comes in single and in double precision, which no
// one program can hold. Some of its runs end the process.
//
// The bodies are tetrahedra of corotational material with the masses of the scene, without Bullet's own damping. Moving
// objects touch fixed ones through nodes (SDF_RDN) and each other through nodes and faces (VF_DD): the contacts that
// Bullet has for this.
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletCollisionCommon.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <ctime>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

using Json = nlohmann::json;

namespace {

struct Options {
    std::string scene, result;
    double step = 1.0 / 240;      // [s]
    bool implicit = false;        // elastic forces at the end of the step, by Newton's method; else at its start
    int newton_steps = 1;         // number of Newton steps of an implicit step; Bullet's default
    bool line_search = false;     // line search of Newton's method
    bool projection = false;      // contacts as projections in the linear solver instead of multipliers
    int contact_iterations = 10;  // sweeps over the contacts; Bullet's default
    double contact_residual = 0;  // residual at which the sweeps end early
    double erp = 0.06;            // part of an overlap that is corrected in a step; Bullet's default
    double cfm = 0.01;            // softness of contacts; Bullet's default
    double repulsion = 0;  // stiffness of springs between bodies nearer than their margins; 0: Bullet's default [N/m]
    int repeat = 1;
    double cap = 60;  // CPU time limit of a run [s]
};

/// Sets the parameters of Newton's method, which only derived classes can access.
struct BodySolver : btDeformableBodySolver {
    BodySolver(int steps, btScalar tolerance) {
        m_maxNewtonIterations = steps;
        m_newtonTolerance = tolerance;
    }
};

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

btVector3 vector_of(const Json& json, std::size_t first = 0) {
    return {json[first].get<btScalar>(), json[first + 1].get<btScalar>(), json[first + 2].get<btScalar>()};
}

/// Gravity at a time, linear between its keys (time, x, y, z).
btVector3 gravity_at(const Json& keys, double time) {
    if (time <= keys.front()[0].get<double>()) return vector_of(keys.front(), 1);
    for (std::size_t k = 1; k < keys.size(); ++k) {
        const double from = keys[k - 1][0].get<double>(), to = keys[k][0].get<double>();
        if (time < to)
            return vector_of(keys[k - 1], 1)
                .lerp(vector_of(keys[k], 1), static_cast<btScalar>((time - from) / (to - from)));
    }
    return vector_of(keys.back(), 1);
}

/// A world built like those of Bullet's own examples, and the objects that must outlive it.
class Simulation {
public:
    Simulation(const Json& scene, const Options& options)
        : scene_(scene), options_(options), solver_(options.newton_steps, options.implicit ? 1e-9 : 1e-4) {
        constraint_solver_.setDeformableSolver(&solver_);
        world_ = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&dispatcher_, &broadphase_, &constraint_solver_,
                                                                      &configuration_, &solver_);
        const btVector3 gravity = gravity_at(scene["gravity"], 0);
        world_->setGravity(gravity);
        world_->getWorldInfo().m_gravity = gravity;
        world_->getWorldInfo().air_density = 0;
        world_->getWorldInfo().m_sparsesdf.setDefaultVoxelsz(0.25);
        world_->getWorldInfo().m_sparsesdf.Reset();
        world_->setImplicit(options.implicit);
        world_->setLineSearch(options.line_search);
        world_->setUseProjection(options.projection);
        btContactSolverInfo& info = world_->getSolverInfo();
        info.m_numIterations = options.contact_iterations;
        info.m_leastSquaresResidualThreshold = static_cast<btScalar>(options.contact_residual);
        info.m_deformable_erp = static_cast<btScalar>(options.erp);
        info.m_deformable_cfm = static_cast<btScalar>(options.cfm);
        info.m_deformable_maxErrorReduction = btScalar(10);
        info.m_splitImpulse = true;
        for (const Json& plane : scene["planes"]) add_plane(plane);
        for (const Json& body : scene["bodies"]) add_body(body);
    }
    ~Simulation() {
        for (btSoftBody* body : bodies_) world_->removeSoftBody(body);
        for (const auto& rigid : rigid_) world_->removeCollisionObject(rigid.get());
    }

    void step(double time, double h) {
        const Json& keys = scene_["gravity"];
        if (keys.size() > 1)
            for (const auto& force : gravity_) force->m_gravity = gravity_at(keys, time);
        world_->stepSimulation(static_cast<btScalar>(h), 0, static_cast<btScalar>(h));
    }

    /// Appends x, y, z of all nodes of all bodies. Returns false if a position is not finite.
    bool sample(Json& positions, Json& velocities) const {
        bool finite = true;
        Json x = Json::array(), v = Json::array();
        for (const btSoftBody* body : bodies_)
            for (int n = 0; n < body->m_nodes.size(); ++n)
                for (int c = 0; c < 3; ++c) {
                    x.push_back(static_cast<double>(body->m_nodes[n].m_x[c]));
                    v.push_back(static_cast<double>(body->m_nodes[n].m_v[c]));
                    finite = finite && std::isfinite(body->m_nodes[n].m_x[c]);
                }
        positions.push_back(std::move(x));
        velocities.push_back(std::move(v));
        return finite;
    }

private:
    /// Adds a half space as a large box, since deformable bodies need the distances of convex shapes.
    void add_plane(const Json& plane) {
        constexpr btScalar half_size = 5;
        auto shape = std::make_unique<btBoxShape>(btVector3(half_size, half_size, half_size));
        const btVector3 normal = vector_of(plane["normal"]);
        // The other half of the contact distance is the margin of the bodies.
        const btScalar shift = scene_["contact_distance"].get<btScalar>() / 2 - half_size;
        btTransform pose(shortestArcQuat(btVector3(0, 0, 1), normal), vector_of(plane["point"]) + normal * shift);
        auto rigid = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shape.get()));
        rigid->setWorldTransform(pose);
        rigid->setFriction(factor_of_friction());
        world_->addRigidBody(rigid.get());
        shapes_.push_back(std::move(shape));
        rigid_.push_back(std::move(rigid));
    }

    /// Friction factor of one side. Bullet multiplies the factors of both sides.
    btScalar factor_of_friction() const { return std::sqrt(scene_["material"]["friction"].get<btScalar>()); }

    void add_body(const Json& body) {
        std::vector<btVector3> nodes;
        for (const Json& node : body["nodes"]) nodes.push_back(vector_of(node));
        const auto count = static_cast<int>(nodes.size());
        auto* soft = new btSoftBody(&world_->getWorldInfo(), count, nodes.data(), nullptr);
        for (const Json& t : body["tetrahedra"]) {
            soft->appendTetra(t[0], t[1], t[2], t[3]);
            // Bullet builds its trees of nodes along links, and never ends at a node without links. The links carry no
            // force here.
            for (int a = 0; a < 4; ++a)
                for (int b = a + 1; b < 4; ++b) soft->appendLink(t[a].get<int>(), t[b].get<int>(), nullptr, true);
        }
        btSoftBodyHelpers::generateBoundaryFaces(soft);
        soft->initializeDmInverse();
        soft->m_tetraScratches.resize(soft->m_tetras.size());
        soft->m_tetraScratchesTn.resize(soft->m_tetras.size());
        for (int n = 0; n < count; ++n) {
            const auto index = static_cast<std::size_t>(n);
            soft->setMass(n, body["mass"][index].get<btScalar>());
            soft->m_nodes[n].m_v = soft->m_nodes[n].m_vn = vector_of(body["velocity"][index]);
        }
        for (const Json& fixed : body["fixed"]) soft->setMass(fixed.get<int>(), 0);
        const Json& material = scene_["material"];
        // Two bodies keep the sum of their margins.
        soft->getCollisionShape()->setMargin(scene_["contact_distance"].get<btScalar>() / 2);
        if (options_.repulsion > 0) soft->setSpringStiffness(static_cast<btScalar>(options_.repulsion));
        soft->m_cfg.kDF = factor_of_friction();
        soft->m_cfg.kKHR = soft->m_cfg.kCHR = 1;
        soft->m_cfg.collisions =
            btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN | btSoftBody::fCollision::VF_DD;
        soft->m_sleepingThreshold = 0;
        soft->setActivationState(DISABLE_DEACTIVATION);
        soft->setSelfCollision(false);
        world_->addSoftBody(soft);
        bodies_.push_back(soft);
        owned_bodies_.emplace_back(soft);
        add_forces(soft, material);
    }

    void add_forces(btSoftBody* soft, const Json& material) {
        const auto young = material["young_modulus"].get<btScalar>(),
                   poisson = material["poisson_ratio"].get<btScalar>();
        const btScalar mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
        elastic_.push_back(std::make_unique<btDeformableLinearElasticityForce>(
            mu, lambda, btScalar(0), material["stiffness_damping"].get<btScalar>()));
        world_->addForce(soft, elastic_.back().get());
        gravity_.push_back(std::make_unique<btDeformableGravityForce>(gravity_at(scene_["gravity"], 0)));
        world_->addForce(soft, gravity_.back().get());
    }

    const Json& scene_;
    const Options& options_;
    btSoftBodyRigidBodyCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    BodySolver solver_;
    btDeformableMultiBodyConstraintSolver constraint_solver_;
    std::vector<std::unique_ptr<btDeformableLinearElasticityForce>> elastic_;
    std::vector<std::unique_ptr<btDeformableGravityForce>> gravity_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> rigid_;
    std::vector<std::unique_ptr<btSoftBody>> owned_bodies_;
    std::vector<btSoftBody*> bodies_;
    std::unique_ptr<btDeformableMultiBodyDynamicsWorld> world_;
};

/// Runs the scene once from the start. Only the steps are timed.
Json run_once(const Json& scene, const Options& options) {
    Simulation simulation(scene, options);
    const int samples = scene["samples"];
    const double interval = scene["seconds"].get<double>() / samples;
    const int steps = std::max(1, static_cast<int>(std::ceil(interval / options.step - 1e-9)));
    const double h = interval / steps;
    Json result{
        {"finished", true}, {"step", h}, {"steps", 0}, {"positions", Json::array()}, {"velocities", Json::array()}};
    double seconds = 0;
    for (int s = 0; s < samples; ++s) {
        const double start = cpu_seconds();
        for (int i = 0; i < steps; ++i) {
            simulation.step(s * interval + i * h, h);
            if (seconds + cpu_seconds() - start > options.cap) break;
        }
        seconds += cpu_seconds() - start;
        result["steps"] = (s + 1) * steps;
        const bool finite = simulation.sample(result["positions"], result["velocities"]);
        if (finite && seconds <= options.cap) continue;
        result["finished"] = false;
        break;
    }
    result["seconds"] = seconds;
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Runs a scene of profile_work_precision with Bullet's deformable bodies."};
    Options options;
    app.add_option("scene", options.scene, "Scene, as profile_work_precision writes it")->required();
    app.add_option("result", options.result, "Where the samples go")->required();
    app.add_option("--step", options.step, "s")->check(CLI::PositiveNumber);
    app.add_flag("--implicit", options.implicit, "Implicit elastic forces");
    app.add_option("--newton-steps", options.newton_steps);
    app.add_flag("--line-search", options.line_search);
    app.add_flag("--projection", options.projection);
    app.add_option("--contact-iterations", options.contact_iterations);
    app.add_option("--contact-residual", options.contact_residual);
    app.add_option("--erp", options.erp);
    app.add_option("--cfm", options.cfm);
    app.add_option("--repulsion", options.repulsion);
    app.add_option("--repeat", options.repeat);
    app.add_option("--cap", options.cap);
    CLI11_PARSE(app, argc, argv);
    const Json scene = Json::parse(std::ifstream(options.scene));
    Json result = run_once(scene, options);
    std::vector<double> seconds{result["seconds"].get<double>()};
    for (int r = 1; r < options.repeat && result["finished"].get<bool>(); ++r)
        seconds.push_back(run_once(scene, options)["seconds"].get<double>());
    std::ranges::sort(seconds);
    result["seconds"] = seconds[seconds.size() / 2];
    std::ofstream(options.result) << result;
    return 0;
}
