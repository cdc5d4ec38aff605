// host SCENE EVERY FRAMES: computes with Eigen itself, with Skerry in between. Prints the state hash.
#include <skerry/instruction_set.h>
#include <skerry/output.h>
#include <skerry/problem.h>
#include <skerry/scene.h>
#include <skerry/world.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

double solve_own_systems();

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    const double own_before = solve_own_systems();
    skerry::Scene scene = skerry::load_scene(argv[1]);
    // Uses everything in Skerry that allocates through Eigen: solvers, problems in files, fields, pages.
    std::vector<skerry::ContactProblem> problems;
    scene.world.watch_contact_problems([&](const skerry::StepProblem& step) { problems.push_back(step.problem); }, 100);
    const double every = std::atof(argv[2]);
    for (int frame = 0; frame < std::atoi(argv[3]); ++frame)
        if (const skerry::StepReport report = scene.world.advance(every); !report.ok()) {
            std::fprintf(stderr, "%s\n", report.message().c_str());
            return 3;
        }
    for (const skerry::ContactProblem& problem : problems) {
        skerry::write_problem(problem, "problem.hdf5");
        const skerry::ContactProblem again = skerry::read_problem("problem.hdf5");
        if (!solve_problem(again, {.tolerance = 1e-6}).converged) return 4;
    }
    if (problems.empty()) return 5;
    for (const skerry::BodyHandle body : scene.world.bodies())
        if (scene.world.node_stress(body).size() != scene.world.positions(body).size()) return 6;
    scene.world.save("host.skerry");
    if (skerry::World::load("host.skerry").state_hash() != scene.world.state_hash()) return 7;
    try {
        skerry::load_scene("no such file.json");
        return 8;
    } catch (const skerry::SceneError&) {  // the exception crosses from Skerry to the host
    }
    if (solve_own_systems() != own_before) return 9;
    std::printf("0x%016" PRIx64 "\n", scene.world.state_hash());
}
