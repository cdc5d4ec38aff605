#include "output_sample.h"

#include <cmath>
#include <map>
#include <numbers>

namespace skerry {
namespace {

constexpr Real radius = 0.1, gravity = 9.81, drop = 0.45, frame_step = 1.0 / 60;

struct Icosphere {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 3>> triangles;

    explicit Icosphere(int level) {
        const Real g = std::numbers::phi;
        nodes = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
        triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
        for (int i = 0; i < level; ++i) refine();
        for (Vec3& node : nodes) node.normalize();
    }
    void refine() {
        std::map<std::pair<Index, Index>, Index> middle;
        const auto half = [&](Index a, Index b) {
            const auto [place, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(nodes.size()));
            if (is_new)
                nodes.push_back((nodes[static_cast<std::size_t>(a)].normalized() +
                                 nodes[static_cast<std::size_t>(b)].normalized()) /
                                2);
            return place->second;
        };
        std::vector<std::array<Index, 3>> finer;
        for (const auto& [a, b, c] : triangles) {
            const Index ab = half(a, b), bc = half(b, c), ca = half(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
};

/// Mean at each node over the tetrahedra around it.
std::vector<Mat3> means_of_nodes(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Mat3> value,
                                 std::size_t node_count) {
    std::vector<Mat3> mean(node_count, Mat3::Zero());
    std::vector<Real> count(node_count);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        for (const Index n : tetrahedra[t]) {
            mean[static_cast<std::size_t>(n)] += value[t];
            ++count[static_cast<std::size_t>(n)];
        }
    for (std::size_t n = 0; n < node_count; ++n)
        if (count[n] > 0) mean[n] /= count[n];
    return mean;
}

}  // namespace

OutputSample::OutputSample(int ball_count, int level, int frame_count) : frame_count_(frame_count) {
    const Icosphere sphere(level);
    direction_.push_back(Vec3::Zero());
    direction_.insert(direction_.end(), sphere.nodes.begin(), sphere.nodes.end());
    for (const auto& [a, b, c] : sphere.triangles) {
        surface_.push_back({a + 1, b + 1, c + 1});
        tetrahedra_.push_back({0, a + 1, b + 1, c + 1});
    }
    for (int ball = 0; ball < ball_count; ++ball) {
        const Real turn = 2.399963 * ball, out = ball == 0 ? 0 : 0.13 * std::sqrt(ball);
        balls_.push_back({.name = "ball " + std::to_string(ball),
                          .home = {out * std::cos(turn), out * std::sin(turn), 0},
                          .phase = 0.03 * ball,
                          .position = std::vector<Vec3>(direction_.size()),
                          .velocity = std::vector<Vec3>(direction_.size()),
                          .stress = std::vector<Mat3>(tetrahedra_.size()),
                          .strain = std::vector<Mat3>(tetrahedra_.size())});
    }
    // Unescaped, these names would end their script element, attribute or text.
    balls_[0].name = "</script><script>document.documentElement.dataset.error='escaped'</script>";
    if (ball_count > 1) balls_[1].name = "\"quotes\" & <b>, \xff no UTF-8";
    shapes_ = {Plane{}, Bucket{.radius = 0.48, .height = 0.25, .thickness = 0.02}, Box{.size = {0.12, 0.5, 0.1}},
               Capsule{.radius = 0.05, .length = 0.2},
               SurfaceMesh{.nodes = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.2}},
                           .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};
}

/// Position of a ball that keeps 55 % of its speed at each bounce. On the ground it is flattened and wobbles.
void OutputSample::place_ball(int number, Real time) {
    Ball& ball = balls_[static_cast<std::size_t>(number)];
    Real t = time + ball.phase, speed = 0, height = drop + 0.02 * number, length = std::sqrt(2 * height / gravity);
    if (t < length) {
        height -= gravity * t * t / 2;
        speed = -gravity * t;
    } else {
        Real up = gravity * length;
        t -= length;
        do {
            up *= 0.55;
            length = 2 * up / gravity;
            if (t > length)
                t -= length;
            else
                break;
        } while (up > 0.05);
        height = std::max(up * t - gravity * t * t / 2, 0.0);
        speed = up > 0.05 ? up - gravity * t : 0;
    }
    const Real squash =
        0.35 * std::exp(-height / 0.02) * std::cos(40 * t) * std::exp(-2 * time) + 0.08 * std::exp(-height / 0.02);
    const Vec3 stretch(1 + squash / 2, 1 + squash / 2, 1 - squash);
    for (std::size_t node = 0; node < direction_.size(); ++node) {
        ball.position[node] =
            ball.home + Vec3(0, 0, height + radius * stretch.z()) + radius * stretch.cwiseProduct(direction_[node]);
        ball.velocity[node] =
            Vec3(0, 0, speed) + 2 * squash * Vec3(direction_[node].x(), direction_[node].y(), -direction_[node].z());
    }
    for (std::size_t element = 0; element < tetrahedra_.size(); ++element) {
        const Vec3& side = direction_[static_cast<std::size_t>(tetrahedra_[element][1])];
        const Real along = 1e3 + 4e4 * std::abs(squash) * (1.2 - side.z());
        ball.stress[element] = -along * side * side.transpose();  // uniaxial: von Mises has the same size
        ball.strain[element] = 1e-5 * ball.stress[element];
    }
    if (height < 0.02) add_contacts(number, time);
}

void OutputSample::add_contacts(int number, Real time) {
    const Ball& ball = balls_[static_cast<std::size_t>(number)];
    for (std::size_t node = 1; node < direction_.size(); ++node) {
        if (direction_[node].z() > -0.85) continue;
        const bool slides = direction_[node].x() > 0.3, open = direction_[node].z() > -0.87;
        const Real press = open ? 0 : -direction_[node].z() * 1e-4;
        contacts_.push_back({.first = frame_.bodies.back().handle,
                             .second = {},
                             .collider = {0, 0},
                             .node = {static_cast<Index>(node), -1, -1, -1},
                             .weight = {1, 0, 0, 0},
                             .point = {ball.position[node].x(), ball.position[node].y(), 0},
                             .normal = {0, 0, 1},
                             .gap = open ? 1e-4 : 0,
                             .slip = slides ? Vec3(0.01 * std::cos(time), 0.02, 0) : Vec3::Zero(),
                             .impulse = {slides ? -0.5 * press : 0.1 * press, 0, press},
                             .seconds = frame_step / 20,
                             .motion = open     ? ContactMotion::open
                                       : slides ? ContactMotion::slide
                                                : ContactMotion::stick,
                             .region = number % 3 == 2 && open ? -1 : number});
    }
}

void OutputSample::add_lines(int number) {
    const Real time = frame_.time;
    LineFrame cable{.kind = LineKind::cable, .name = "cable <&>", .points = {{0, 0, 0.7}}, .force = {3.5}};
    for (const BodyFrame& body : frame_.bodies) {
        cable.points.push_back(body.position[0]);
        cable.force.push_back(3 + std::sin(9 * time));
    }
    LineFrame tie{.kind = LineKind::tie, .name = "tie"};
    for (auto node = static_cast<std::size_t>(1 + 6 * number / frame_count_); node < 7; ++node) {
        tie.points.push_back(frame_.bodies.back().position[node]);
        tie.force.push_back(0.01 * static_cast<Real>(node));
    }
    const LineFrame spring{.kind = LineKind::spring,
                           .name = "spring",
                           .points = {{0.3, 0, 0.7}, frame_.bodies.back().position[0]},
                           .force = {-std::cos(5 * time), -std::cos(5 * time)}};
    frame_.lines = {tie, cable, spring};
    if (2 * number >= frame_count_)
        frame_.lines.insert(
            frame_.lines.begin(),
            {.kind = LineKind::joint, .name = "joint", .points = {{0.1, 0, 0.3}}, .force = {20 * time}});
}

const Frame& OutputSample::frame(int number) {
    const Real time = number * frame_step;
    frame_ =
        Frame{.time = time, .gravity = {0, 0, -gravity}, .energy = {}, .bodies = {}, .colliders = {}, .contacts = {}};
    contacts_.clear();
    for (int ball = 0; ball < static_cast<int>(balls_.size()); ++ball) {
        if ((ball == 0 && 3 * number >= 2 * frame_count_) || (ball == 1 && 3 * number < frame_count_)) continue;
        const Ball& b = balls_[static_cast<std::size_t>(ball)];
        frame_.bodies.push_back({.handle = {static_cast<std::uint32_t>(ball), 3},
                                 .name = b.name,
                                 .position = b.position,
                                 .velocity = b.velocity,
                                 .surface = surface_,
                                 .tetrahedra = tetrahedra_,
                                 .stress = {},
                                 .strain = {},
                                 .plastic_strain = {},
                                 .node_stress = {},
                                 .node_strain = {},
                                 .material = std::vector<Index>(tetrahedra_.size(), ball % 2)});
        place_ball(ball, time);
        BodyFrame& body = frame_.bodies.back();
        body.stress = b.stress;
        body.strain = b.strain;
        body.node_stress = means_of_nodes(tetrahedra_, b.stress, b.position.size());
        body.node_strain = means_of_nodes(tetrahedra_, b.strain, b.position.size());
        for (const Mat3& strain : body.node_strain) body.node_mesh_error.push_back(std::sqrt(strain.norm()));
    }
    frame_.contacts = contacts_;
    add_lines(number);
    const std::array<MotionKey, 5> pose{{{},
                                         {time, {0, 0, 0.005}, Vec3::Zero()},
                                         {time, {-0.75, 0.1 * std::sin(3 * time), 0.05}, Vec3::Zero()},
                                         {time, {0.75, -0.2, 0.05}, {std::numbers::pi / 2, 0, 0}},
                                         {time, {0.6, 0.3, 0}, Vec3::Zero()}}};
    for (std::uint32_t i = 0; i < shapes_.size(); ++i)
        frame_.colliders.push_back(
            {.handle = {i, 0}, .name = "collider " + std::to_string(i), .shape = &shapes_[i], .pose = pose[i]});
    const Real lost = 10 * (1 - std::exp(-1.5 * time));
    frame_.energy = {.kinetic = (12 - lost) * std::pow(std::sin(3 * time), 2),
                     .elastic = 0.4 * std::abs(std::sin(9 * time)) * std::exp(-time),
                     .potential = 4 + (12 - lost) * std::pow(std::cos(3 * time), 2),
                     .dissipated = lost};
    return frame_;
}

PageSummary OutputSample::summary() const {
    PageSummary summary{
        .title = "Balls into a bucket </title> & \"quotes\"", .report = {}, .state_hash = 0x0123456789abcdefu};
    WorldReport& report = summary.report;
    report.time = frame_step * (frame_count_ - 1);
    report.steps = static_cast<std::uint64_t>(20 * (frame_count_ - 1));
    report.bodies = balls_.size() - 1;
    report.colliders = shapes_.size();
    report.nodes = direction_.size() * balls_.size();
    report.elements = tetrahedra_.size() * balls_.size();
    const Real steps = static_cast<Real>(report.steps);
    const auto stage = [&](const char* name, double ms, Real share) {
        report.stages.push_back({name, 1e-3 * ms * steps, static_cast<std::uint64_t>(share * steps),
                                 static_cast<std::uint64_t>((1 - share) * steps)});
    };
    stage("dynamics/compute_element_forces", 0.81, 1);
    stage("dynamics/predict_velocity", 0.18, 1);
    stage("collision/find_candidates", 0.11, 0.06);
    stage("collision/find_contacts", 0.32, 0.9);
    stage("contact/match_warm_start", 0.04, 0.9);
    stage("contact/separate_regions", 0.07, 0.9);
    stage("solver/solve_regions", 0.28, 0.9);
    stage("dynamics/advance_positions", 0.06, 1);
    stage("dynamics/check_state", 0.02, 1);
    report.mean_contacts = 143.7;
    report.max_contacts = 412;
    report.mean_regions = 6.3;
    report.max_regions = 9;
    report.largest_region = 61;
    report.mean_iterations = 4.2;
    report.solved = 15012;
    report.max_penetration = 2.1e-5;
    report.self_crossings = {{.name = "</dd> ring", .first_time = 0.4, .last_time = 1, .most_places = 3}};
    report.crossed = 2;
    return summary;
}

}  // namespace skerry
