#include "engine/study/run_variant.h"

#include <algorithm>
#include <ctime>
#include <new>
#include <random>
#include <utility>
#include <variant>

#include "engine/scene/run_plan.h"
#include "engine/scene/scene_plan.h"
#include "engine/study/study_columns.h"
#include "jobs/executor.h"
#include "skerry/error.h"
#include "skerry/load.h"

namespace skerry {

namespace {

/// CPU time so far of this thread, or of the whole process if the world has several threads [s].
double cpu_clock(bool one_thread) {
    timespec now{};
    clock_gettime(one_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Returns the surface loads of a world, each with the area of its faces in the present shape.
std::vector<StudyLoad> loads_of(World& world) {
    std::vector<StudyLoad> found;
    const Loads loads(world);
    for (const LoadHandle handle : loads.all()) {
        const AnyLoad settings = loads.settings(handle);
        const auto* traction = std::get_if<TractionLoad>(&settings);
        if (!traction) continue;
        const std::span<const Vec3> position = world.positions(traction->body);
        StudyLoad load{.name = loads.name(handle)};
        for (const auto& face : traction->faces) {
            const auto corner = [&](std::size_t k) { return position[static_cast<std::size_t>(face[k])]; };
            load.area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
        }
        found.push_back(std::move(load));
    }
    return found;
}

class VariantRun {
public:
    VariantRun(const VariantJob& job, const std::atomic<bool>& stop, std::atomic<double>& progress, StudyRun& run)
        : scene_(load_scene(job.scene, job.overrides)),
          plan_(plan_run(scene_, job.scene, {})),
          recorder_(scene_),
          one_thread_(job.overrides.threads == 1),
          stop_(stop),
          progress_(progress),
          run_(run) {
        perturb_start(job.variant.draw, scene_.world);
    }

    bool run() {
        run_.loads = loads_of(scene_.world);
        recorder_.sample();
        bool goes_on = true;
        for (long frame = 0; frame < plan_.frames() && goes_on; ++frame) goes_on = advance_frame(frame);
        const WorldReport report = scene_.world.report();
        if (std::string distrust = report.distrust(); !distrust.empty()) run_.warnings.push_back(std::move(distrust));
        run_.steps = report.steps;
        run_.integrator = scene_.world.settings().integrator;
        run_.state_hash = scene_.world.state_hash();
        run_.max_contacts = static_cast<std::size_t>(report.max_contacts);
        for (const BodyHandle body : scene_.world.bodies()) run_.tetrahedra += scene_.world.tetrahedra(body).size();
        run_.time = recorder_.time();
        run_.columns = recorder_.columns();
        return goes_on || run_.status == StudyRunStatus::failed;
    }

private:
    /// Returns false if the run must end.
    bool advance_frame(long frame) {
        const std::vector<double> ends = plan_.ends_in(frame);
        const int calls = ends.empty() ? plan_.samples : static_cast<int>(ends.size());
        for (int call = 0; call < calls; ++call)
            if (!advance(ends.empty() ? plan_.length_of(frame) / calls
                                      : ends[static_cast<std::size_t>(call)] - scene_.world.time()))
                return false;
        return true;
    }

    bool advance(double duration) {
        const double before = cpu_clock(one_thread_);
        const StepReport report = scene_.world.advance(duration, [&](const StepReport&) { return !stop_; });
        run_.cpu_seconds += cpu_clock(one_thread_) - before;
        progress_ = std::min(1.0, scene_.world.time() / plan_.seconds);
        recorder_.sample();
        if (report.ok()) return true;
        if (report.status != StepStatus::stopped) {
            run_.status = StudyRunStatus::failed;
            run_.message = report.message();
        }
        return false;
    }

    Scene scene_;
    const RunPlan plan_;
    StudyRecorder recorder_;
    const bool one_thread_;
    const std::atomic<bool>& stop_;
    std::atomic<double>& progress_;
    StudyRun& run_;
};

}  // namespace

void perturb_start(int draw, World& world) {
    if (draw == 0) return;
    // Upper limit of a movement [m]. Each component is at most half of it, so the movement is at most sqrt(3)/2 of it.
    constexpr double largest = 1e-12;
    std::mt19937_64 engine(static_cast<std::uint64_t>(draw));
    // Random number between -1 and 1 with 53 bits. The distributions of the standard library are not used, because
    // their results differ between implementations.
    const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
    const auto movement = [&] {
        const Real x = number(), y = number(), z = number();
        return Vec3(largest / 2 * Vec3(x, y, z));
    };
    std::vector<std::vector<Index>> held;
    const std::vector<AttachmentHandle> attachments = world.attachments();
    for (const BodyHandle body : bodies_in_order(world)) {
        const std::span<const Vec3> start = world.positions(body);
        std::vector<Vec3> positions(start.begin(), start.end());
        const Vec3 whole = movement();
        const bool rigid = world.dynamics(body) == BodyDynamics::rigid;
        for (Vec3& position : positions) position += rigid ? whole : movement();
        bool attached = false;
        for (const AttachmentHandle attachment : attachments) {
            if (world.body(attachment) != body) continue;
            attached = true;
            for (const Index node : world.nodes(attachment))
                positions[static_cast<std::size_t>(node)] = start[static_cast<std::size_t>(node)];
        }
        if (!(rigid && attached)) world.set_positions(body, positions);
    }
}

bool run_variant(const VariantJob& job, const std::atomic<bool>& stop, std::atomic<double>& progress, StudyRun& run) {
    run.variant = job.variant;
    try {
        return VariantRun(job, stop, progress, run).run();
    } catch (const SceneError& error) {
        run.status = StudyRunStatus::refused;
        run.message = error.what();
    } catch (const std::bad_alloc&) {
        run.status = StudyRunStatus::refused;
        run.message = "there is not enough memory for it";
        run.time.clear();
        run.columns.clear();
    }
    return true;
}

}  // namespace skerry
