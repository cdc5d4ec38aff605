// Keys of a scene file: settings, materials, bodies, colliders, probes.
#include "engine/scene/scene_rules.h"

#include <cstdint>
#include <string_view>

namespace skerry {

namespace {

constexpr Real all_groups = 4294967295;
const KeyDoc group_doc{.meaning = "its collision groups, a bit each; 1 by default", .limits = within(0, all_groups)};
const KeyDoc mask_doc{.meaning =
                          "the groups that it touches, a bit each; all by default. Two touch if each is in a group "
                          "that the mask of the other has",
                      .limits = within(0, all_groups)};

}  // namespace

template <>
const Rule<PinEntry>& rule_of<PinEntry>() {
    static const auto rule =
        Rule<PinEntry>("pin", "Nodes of a body that stand still or follow a motion.")
            .key("box", &PinEntry::box, {.meaning = "the nodes inside, in the mesh's own frame"})
            .key("nodes", &PinEntry::nodes, {.meaning = "node numbers, from 0", .limits = at_least(0)})
            .key("motion", &PinEntry::motion, {.meaning = "how they move; by default they do not"})
            .key("pivot", &PinEntry::pivot, {.meaning = "the point that the motion turns about", .unit = "m"})
            .exactly_one({"box", "nodes"});
    return rule;
}

template <>
const Rule<RepeatEntry>& rule_of<RepeatEntry>() {
    static const auto rule =
        Rule<RepeatEntry>(
            "repeat",
            "Copies in a grid that starts at the body's position; they are called NAME_0, NAME_1, ..., x first.")
            .key("count", &RepeatEntry::count,
                 {.meaning = "copies along x, y and z", .limits = within(1, 1000), .required = true})
            .key("spacing", &RepeatEntry::spacing, {.meaning = "between copies", .unit = "m", .required = true})
            .key("jitter", &RepeatEntry::jitter,
                 {.meaning = "largest random shift along each axis", .unit = "m", .limits = at_least(0)})
            .key("seed", &RepeatEntry::seed,
                 {.meaning = "of the shifts; the same seed gives the same scene", .limits = at_least(0)})
            .check([](const Place& place, const RepeatEntry& grid) {
                // A larger number of copies would not fit into memory and is probably a typing mistake.
                constexpr std::int64_t most_copies = 1000000;
                const std::int64_t copies = std::int64_t{1} * grid.count[0] * grid.count[1] * grid.count[2];
                if (copies > most_copies)
                    place.key("count").refuse(std::to_string(copies) + " copies",
                                              "at most " + std::to_string(most_copies) + " in all");
            });
    return rule;
}

template <>
const Rule<BodyEntry>& rule_of<BodyEntry>() {
    static const auto rule =
        Rule<BodyEntry>("body", "A body. The rotation is applied before the position.")
            .key("name", &BodyEntry::name, {.meaning = "for messages, output and probes; body_NUMBER by default"})
            .key("mesh", &BodyEntry::mesh, {.meaning = "its tetrahedra"})
            .key("shape", &BodyEntry::shape,
                 {.meaning = "in place of a mesh: it is round, and moves as a whole (\"dynamics\": \"rigid\")"})
            .key("material", &BodyEntry::material, {.meaning = "the name of one of the materials", .required = true})
            .key("materials", &BodyEntry::materials,
                 {.meaning = "materials of tetrahedra by the label that the mesh file gives them; the others have "
                             "\"material\", whose friction, restitution and damping the whole body has"})
            .key("position", &BodyEntry::position, {.meaning = "of the mesh's origin", .unit = "m"})
            .key("rotation", &BodyEntry::rotation, {.meaning = "about the mesh's origin"})
            .key("positions", &BodyEntry::positions,
                 {.meaning = "several positions: one copy at each, called NAME_0, NAME_1, ...", .unit = "m"})
            .key("repeat", &BodyEntry::repeat, {.meaning = "copies in a grid"})
            .key("velocity", &BodyEntry::velocity, {.meaning = "at the start", .unit = "m/s"})
            .key("angular_velocity", &BodyEntry::angular_velocity,
                 {.meaning = "at the start, about the centre of mass", .unit = "rad/s"})
            .key("contact_distance", &BodyEntry::contact_distance,
                 {.meaning = "thickness of the contact shell; by default 2 % of the mean surface edge",
                  .unit = "m",
                  .limits = at_least(0)})
            .key("self_contact", &BodyEntry::self_contact, {.meaning = "whether it touches itself; false by default"})
            .key(
                "dynamics", &BodyEntry::dynamics,
                {.meaning = "how it moves: \"rigid\" as a whole, with the mass and inertia of its mesh; \"implicit\" "
                            "deforming by little, in any step, for what is stiff; \"automatic\" is one of \"explicit\" "
                            "(the default) and \"implicit\", by predicted cost"})
            .key("collision_group", &BodyEntry::collision_group, group_doc)
            .key("collision_mask", &BodyEntry::collision_mask, mask_doc)
            .key("element", &BodyEntry::element, {.meaning = "what carries its stress"})
            .key("pin", &BodyEntry::pin, {.meaning = "nodes that are held"})
            .exactly_one({"mesh", "shape"})
            .at_most_one({"position", "positions"})
            .at_most_one({"positions", "repeat"});
    return rule;
}

template <>
const Rule<ColliderEntry>& rule_of<ColliderEntry>() {
    using Entry = ColliderEntry;
    static const auto rule =
        Rule<Entry>("collider", "A rigid shape that stands still or moves by a script.")
            .key("name", &Entry::name, {.meaning = "for messages and output; collider_NUMBER by default"})
            .key("shape", &Entry::shape, {.meaning = "its shape", .required = true})
            .key("position", &Entry::position, {.meaning = "of the shape's origin", .unit = "m"})
            .key("rotation", &Entry::rotation, {.meaning = "about the shape's origin"})
            .key("motion", &Entry::motion, {.meaning = "how it moves; by default it does not"})
            .key("friction", &Entry::friction,
                 {.meaning = "by default the body's own; else the geometric mean of both counts",
                  .alias = "mu",
                  .limits = at_least(0)})
            .key("static_friction", &Entry::static_friction,
                 {.meaning = "friction of sticking contacts", .limits = at_least(0)})
            .key("dynamic_friction", &Entry::dynamic_friction,
                 {.meaning = "friction of sliding contacts", .limits = at_least(0)})
            .key("restitution", &Entry::restitution,
                 {.meaning = "by default the body's own; else the larger of both counts", .limits = within(0, 1)})
            .key("contact_distance", &Entry::contact_distance,
                 {.meaning = "thickness of the contact shell of a mesh", .unit = "m", .limits = at_least(0)})
            .key("collision_group", &Entry::collision_group, group_doc)
            .key("collision_mask", &Entry::collision_mask, mask_doc)
            .together({"static_friction", "dynamic_friction"})
            .at_most_one({"friction", "static_friction"})
            .at_most_one({"mu", "static_friction"})
            .check([](const Place& place, const Entry& c) {
                if (c.static_friction && *c.dynamic_friction > *c.static_friction)
                    place.key("dynamic_friction")
                        .refuse(Json(*c.dynamic_friction).dump(),
                                "at most static_friction, " + Json(*c.static_friction).dump());
            });
    return rule;
}

template <>
const Rule<MaterialSettings>& rule_of<MaterialSettings>() {
    using M = MaterialSettings;
    static const auto rule =
        Rule<M>("material", "An elastic material and its surface.")
            .key("young_modulus", &M::young_modulus,
                 {.meaning = "Young's modulus", .unit = "Pa", .alias = "E", .limits = above(0)})
            .key("poisson_ratio", &M::poisson_ratio,
                 {.meaning = "Poisson's ratio",
                  .alias = "nu",
                  .limits = {.at_least = {}, .above = -1, .at_most = {}, .below = 0.5}})
            .key("density", &M::density, {.meaning = "density", .unit = "kg/m^3", .alias = "rho", .limits = above(0)})
            .key("friction", &M::friction, {.meaning = "Coulomb's coefficient", .alias = "mu", .limits = at_least(0)})
            .key("static_friction", &M::static_friction,
                 {.meaning = "friction of sticking contacts", .limits = at_least(0)})
            .key("dynamic_friction", &M::dynamic_friction,
                 {.meaning = "friction of sliding contacts", .limits = at_least(0)})
            .key("restitution", &M::restitution,
                 {.meaning = "of a surface point at an impact, not of the body as a whole", .limits = within(0, 1)})
            .key("damping", &M::damping,
                 {.meaning = "decay rate of deformation velocities; momentum is kept",
                  .unit = "1/s",
                  .limits = at_least(0)})
            .key("loss_factor", &M::loss_factor,
                 {.meaning = "tangent of the angle by which strain is behind stress, at every frequency of a body",
                  .limits = within(0, largest_loss_factor)})
            .key("bulk_viscosity", &M::bulk_viscosity,
                 {.meaning = "damping ratio of an element's own highest frequency, by its change of volume",
                  .limits = within(0, largest_bulk_viscosity)})
            .key("model", &M::model, {.meaning = "the constitutive law"})
            .together({"static_friction", "dynamic_friction"})
            .at_most_one({"friction", "static_friction"})
            .at_most_one({"mu", "static_friction"})
            .check([](const Place& place, const M& m) {
                if (m.static_friction && *m.dynamic_friction > *m.static_friction)
                    place.key("dynamic_friction")
                        .refuse(Json(*m.dynamic_friction).dump(),
                                "at most static_friction, " + Json(*m.static_friction).dump());
            });
    return rule;
}

template <>
const Rule<Settings>& rule_of<Settings>() {
    using S = Settings;
    constexpr std::string_view always_on = "delete the key, which is internal now and always on";
    static const auto rule =
        Rule<S>("settings", "How the world is stepped. Defaults work.")
            .key("gravity", &S::gravity, {.meaning = "gravity; [0, 0, -9.81] by default", .unit = "m/s^2"})
            .key("step_size", &S::step_size,
                 {.meaning = "at most; by default the stable step of the stiffest body, which is never exceeded",
                  .unit = "s",
                  .limits = above(0)})
            .key("integrator", &S::integrator, {.meaning = "how velocities and positions are integrated in time"})
            .key("clusters", &S::clusters,
                 {.meaning = "the few elements that would make all steps several times shorter move as clusters"})
            .withdrawn(
                "multirate",
                "delete the key: clusters, which are on by default, keep steps long where few elements are stiff; "
                "for a stiff body set \"dynamics\" to \"implicit\" or \"automatic\"")
            .key("backend", &S::backend, {.meaning = "what runs the threads"})
            .key("threads", &S::threads, {.meaning = "0: as many as there are", .limits = within(0, 1024)})
            .key("contact_regions", &S::contact_regions, {.meaning = "how contacts are grouped"})
            .key("method", &S::method, {.meaning = "the contact solver"})
            .key("friction", &S::friction, {.meaning = "the friction law"})
            .key("tolerance", &S::tolerance, {.meaning = "relative error of a region", .limits = above(0)})
            .key("max_iterations", &S::max_iterations, {.meaning = "sweeps of a region", .limits = at_least(1)})
            .key("recovery_speed", &S::recovery_speed,
                 {.meaning = "what overlaps, or lies within the contact distance, is pushed apart no faster",
                  .unit = "m/s",
                  .limits = above(0)})
            .key("start_overlaps", &S::start_overlaps,
                 {.meaning = "what is done about bodies that overlap each other or colliders at the start: resolve "
                             "(default) moves them apart where the way out is short and refuses them where it is not, "
                             "refuse refuses them, ignore reports them and begins as it is"})
            .key("theta", &S::theta,
                 {.meaning = "of the steps of implicit bodies, from 0.5 to 1: 1 damps what vibrates, 0.55 a tenth as "
                             "much; less than 1 with symplectic_euler only",
                  .limits = at_least(0.5)})
            .key(
                "implicit_step", &S::implicit_step,
                {.meaning = "of implicit bodies that nothing holds, at most: they take one such step while others take "
                            "several; 0 (default): all take the same; with symplectic_euler only",
                 .unit = "s",
                 .limits = at_least(0)})
            .key("sleep", &S::sleep,
                 {.meaning = "bodies that hardly move for sleep_time, and neither more and more nor on and on, rest "
                             "with all that they touch, until something presses on them; false: they go on moving"})
            .key("sleep_time", &S::sleep_time,
                 {.meaning = "how long a body has to be still to be put to rest", .unit = "s", .limits = at_least(0)})
            .key("continuous_collision", &S::continuous_collision,
                 {.meaning = "a step in which surfaces would go through each other is tried again with what crossed as "
                             "contacts"})
            .withdrawn("freeze_contacts", "delete the key: every sweep evaluates all contacts")
            .withdrawn("step_safety", "delete the key, which is internal now; for shorter steps set \"step_size\"")
            .withdrawn("max_strain_step", "delete the key, which is internal now; for shorter steps set \"step_size\"")
            .withdrawn("restitution_speed",
                       "delete the key, which is internal now; set \"restitution\" of the materials")
            .withdrawn("sleep_speed", "delete the key, which is internal now; use \"sleep\" and \"sleep_time\"")
            .withdrawn("relaxation",
                       "delete the key, which is internal now; use another \"method\" or more \"max_iterations\"")
            .withdrawn("fixed_iterations",
                       "delete the key, which is internal now; bound the sweeps by \"max_iterations\"")
            .withdrawn("warm_start", always_on)
            .withdrawn("contact_budgets", always_on)
            .withdrawn("certify_warm_start", always_on)
            .withdrawn("skip_separating", always_on)
            .withdrawn("frictionless_rows", always_on)
            .withdrawn("small_regions_in_lanes", always_on);
    return rule;
}

template <>
const Rule<SceneFile>& rule_of<SceneFile>() {
    static const auto rule =
        Rule<SceneFile>("scene", "A world of deformable bodies and colliders, and a run. SI units.")
            .key("$schema", &SceneFile::schema, {.meaning = "where editors find this schema"})
            .key("name", &SceneFile::name, {.meaning = "of the scene; by default that of the file"})
            .key("description", &SceneFile::description, {.meaning = "what it shows"})
            .key("include", &SceneFile::include,
                 {.meaning =
                      "scene files that come first; their bodies, colliders, joints and materials are added, single "
                      "values are replaced by those here"})
            .key("seconds", &SceneFile::seconds,
                 {.meaning = "length of a run; 2 by default", .unit = "s", .limits = above(0)})
            .key("frame_step", &SceneFile::frame_step,
                 {.meaning = "between frames of output; 1/60 by default", .unit = "s", .limits = above(0)})
            .key("settings", &SceneFile::settings, {.meaning = "of the step"})
            .key("materials", &SceneFile::materials, {.meaning = "materials by name"})
            .key("bodies", &SceneFile::bodies, {.meaning = "deformable bodies"})
            .key("colliders", &SceneFile::colliders, {.meaning = "rigid shapes"})
            .key("joints", &SceneFile::joints, {.meaning = "what joins rigid bodies"})
            .key("probes", &SceneFile::probes,
                 {.meaning = "what is recorded: contacts for the report, series of numbers for --probes"})
            .key("probe_step", &SceneFile::probe_step,
                 {.meaning = "between two looks at the probes, or rows of their series; frame_step by default",
                  .unit = "s",
                  .limits = above(0)});
    return rule;
}

}  // namespace skerry
