// Keys of a scene file: settings, materials, bodies, pins, colliders and included files.
#include "engine/scene/scene_rules.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "skerry/materials.h"

namespace skerry {

namespace {

constexpr Real all_groups = 4294967295;
constexpr KeyDoc group_doc{.meaning = "bit mask of the collision groups that contain the object; default: 1",
                           .limits = within(0, all_groups)};
constexpr KeyDoc mask_doc{.meaning =
                              "bit mask of the collision groups that the object can touch; default: all groups. Two "
                              "objects can touch if the mask of each object includes a group of the other object",
                          .limits = within(0, all_groups)};

struct MaterialName {};
/// Moduli of the laws of Ogden and of Mooney and Rivlin, as papers give them. The functions ogden() and mooney_rivlin()
/// convert them to MaterialSettings.
struct OgdenEntry {
    std::vector<OgdenTerm> terms;
    Real bulk_modulus = 0;  // [Pa]
};
struct MooneyRivlinEntry {
    Real c10 = 0, c01 = 0, bulk_modulus = 0;  // [Pa]
};
MaterialSettings law_of(const OgdenEntry& entry, const MaterialSettings& base) {
    return ogden(entry.terms, entry.bulk_modulus, base);
}
MaterialSettings law_of(const MooneyRivlinEntry& entry, const MaterialSettings& base) {
    return mooney_rivlin(entry.c10, entry.c01, entry.bulk_modulus, base);
}
MaterialSettings law_of(const OrthotropicModuli& moduli, const MaterialSettings& base) {
    return orthotropic(moduli, base);
}
template <class Entry>
struct LawFromEntry {};
struct LawFromName {};  // a law given by its name, which is the value of the key "model"
std::string_view no_hint(std::string_view) {
    return {};
}

}  // namespace

template <>
struct Value<MaterialName> {
    static std::vector<std::string> names() {
        std::vector<std::string> names;
        for (const NamedMaterial& material : named_materials()) names.emplace_back(material.name);
        return names;
    }
    static void read(const Json& json, const Place& place, const KeyDoc&, MaterialSettings& out) {
        out = named_material(named_materials()[read_name(json, place, names(), no_hint)].name);
    }
    static Json schema(SchemaBook&, const KeyDoc&) { return enum_schema(names()); }
};

template <>
const Rule<OgdenTerm>& rule_of<OgdenTerm>() {
    static const auto rule =
        Rule<OgdenTerm>("ogden_term", "A term of the law of Ogden. Modulus and exponent have the same sign.")
            .key("modulus", &OgdenTerm::modulus, {.meaning = "modulus mu_p", .unit = "Pa", .required = true})
            .key("exponent", &OgdenTerm::exponent, {.meaning = "exponent alpha_p of the stretches", .required = true});
    return rule;
}

template <>
const Rule<OgdenEntry>& rule_of<OgdenEntry>() {
    static const auto rule = Rule<OgdenEntry>("ogden", "Moduli of the law of Ogden.")
                                 .key("terms", &OgdenEntry::terms, {.meaning = "one to three terms", .required = true})
                                 .key("bulk_modulus", &OgdenEntry::bulk_modulus,
                                      {.meaning = "bulk modulus", .unit = "Pa", .limits = above(0), .required = true});
    return rule;
}

template <>
const Rule<MooneyRivlinEntry>& rule_of<MooneyRivlinEntry>() {
    using Entry = MooneyRivlinEntry;
    static const auto rule =
        Rule<Entry>("mooney_rivlin", "Moduli of the law of Mooney and Rivlin.")
            .key("c10", &Entry::c10,
                 {.meaning = "modulus of the first invariant", .unit = "Pa", .limits = above(0), .required = true})
            .key("c01", &Entry::c01,
                 {.meaning = "modulus of the second invariant", .unit = "Pa", .limits = at_least(0), .required = true})
            .key("bulk_modulus", &Entry::bulk_modulus,
                 {.meaning = "bulk modulus", .unit = "Pa", .limits = above(0), .required = true});
    return rule;
}

template <>
const Rule<OrthotropicModuli>& rule_of<OrthotropicModuli>() {
    using M = OrthotropicModuli;
    static const auto rule =
        Rule<M>("orthotropic", "Elastic constants along the three axes of a material.")
            .key("young_modulus", &M::young_modulus, {.meaning = "E_1, E_2, E_3", .unit = "Pa", .required = true})
            .key("poisson_ratio", &M::poisson_ratio,
                 {.meaning = "nu_12, nu_23, nu_13: under a stress along axis i alone, the strain along axis j is "
                             "-nu_ij times that along axis i",
                  .required = true})
            .key("shear_modulus", &M::shear_modulus, {.meaning = "G_12, G_23, G_13", .unit = "Pa", .required = true})
            .key("first_axis", &M::first_axis, {.meaning = "direction of the first axis in the mesh"})
            .key("second_axis", &M::second_axis,
                 {.meaning = "direction of the second axis in the mesh, made orthogonal to the first"});
    return rule;
}

/// Reads an Entry, which sets the law and the elastic moduli of a material.
template <class Entry>
struct Value<LawFromEntry<Entry>> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, MaterialSettings& out) {
        Entry entry;
        Value<Entry>::read(json, place, doc, entry);
        called_at(place, [&] { out = law_of(entry, out); });
    }
    static Json schema(SchemaBook& book, const KeyDoc& doc) { return Value<Entry>::schema(book, doc); }
};

/// Reads the name of a law. Refuses "orthotropic": the key "orthotropic" gives this law, together with its elastic
/// constants.
template <>
struct Value<LawFromName> {
    static void read(const Json& json, const Place& place, const KeyDoc& doc, MaterialSettings& out) {
        Value<MaterialModel>::read(json, place, doc, out.model);
        if (out.model == MaterialModel::orthotropic)
            place.refuse(json.dump(), "another constitutive law",
                         "replace the key by \"orthotropic\": {...}, which sets the law and its elastic constants");
    }
    static Json schema(SchemaBook&, const KeyDoc&) {
        std::vector<std::string> names = Value<MaterialModel>::names();
        std::erase(names, name_of(MaterialModel::orthotropic));
        return enum_schema(names);
    }
};

template <>
const Rule<PinEntry>& rule_of<PinEntry>() {
    static const auto rule =
        Rule<PinEntry>("pin", "Nodes of a body that are fixed or follow a motion.")
            .key("set", &PinEntry::set, part_set_doc)
            .key("box", &PinEntry::box, part_box_doc)
            .key("nodes", &PinEntry::nodes, part_nodes_doc)
            .key("motion", &PinEntry::motion, {.meaning = "motion of the pinned nodes; default: none"})
            .key("pivot", &PinEntry::pivot,
                 {.meaning = "centre of rotation of an angular velocity, in the world; default: the origin",
                  .unit = "m"})
            .key("axes", &PinEntry::axes,
                 {.meaning = "world axes along which the nodes are held, as for a roller support; default: all. The "
                             "nodes of explicit bodies are free along the other axes"})
            .key("direction", &PinEntry::direction,
                 {.meaning = "the only direction in the world along which the nodes are held, of any nonzero length"})
            .exactly_one({"set", "box", "nodes"})
            .at_most_one({"axes", "direction"});
    return rule;
}

template <>
const Rule<RepeatEntry>& rule_of<RepeatEntry>() {
    static const auto rule =
        Rule<RepeatEntry>("repeat",
                          "Copies of a body in a grid that starts at the position of the body. The copies are called "
                          "NAME_0, NAME_1, ...; the index along x varies fastest.")
            .key("count", &RepeatEntry::count,
                 {.meaning = "numbers of copies along x, y and z", .limits = within(1, 1000), .required = true})
            .key("spacing", &RepeatEntry::spacing,
                 {.meaning = "distances between neighbouring copies along x, y and z", .unit = "m", .required = true})
            .key("jitter", &RepeatEntry::jitter,
                 {.meaning = "largest random displacement of a copy along each axis",
                  .unit = "m",
                  .limits = at_least(0)})
            .key("seed", &RepeatEntry::seed,
                 {.meaning = "seed of the random displacements; the same seed gives the same scene",
                  .limits = at_least(0)})
            .check([](const Place& place, const RepeatEntry& grid) {
                // A larger number of copies would not fit into memory and is probably a typing mistake.
                constexpr std::int64_t most_copies = 1000000;
                const std::int64_t copies = std::int64_t{1} * grid.count[0] * grid.count[1] * grid.count[2];
                if (copies > most_copies)
                    place.key("count").refuse(std::to_string(copies) + " copies",
                                              "at most " + std::to_string(most_copies) + " copies in total");
            });
    return rule;
}

template <>
const Rule<BodyEntry>& rule_of<BodyEntry>() {
    static const auto rule =
        Rule<BodyEntry>("body", "A body. The mesh is first rotated about its origin and then moved to the position.")
            .key("name", &BodyEntry::name, {.meaning = "name in messages, output and probes; default: body_NUMBER"})
            .key("mesh", &BodyEntry::mesh,
                 {.meaning = "mesh of the body: tetrahedra, or for a rigid body also a closed surface"})
            .key("shape", &BodyEntry::shape,
                 {.meaning = "shape of a rigid body without a mesh; \"dynamics\" may be left out or \"rigid\""})
            .key("material", &BodyEntry::material, {.meaning = "name of one of the materials", .required = true})
            .key("materials", &BodyEntry::materials,
                 {.meaning = "names of materials by label or by set of tetrahedra, {LABEL or SET: NAME}; sets take "
                             "precedence. All other tetrahedra have \"material\", which also sets the friction, "
                             "restitution and damping of the whole body"})
            .key("sets", &BodyEntry::sets,
                 {.meaning = "named sets of nodes, faces or tetrahedra, in addition to those of the mesh file"})
            .key("position", &BodyEntry::position, {.meaning = "position of the mesh's origin", .unit = "m"})
            .key("rotation", &BodyEntry::rotation, {.meaning = "rotation about the mesh's origin"})
            .key("positions", &BodyEntry::positions,
                 {.meaning = "positions of several copies of the body, called NAME_0, NAME_1, ...", .unit = "m"})
            .key("repeat", &BodyEntry::repeat, {.meaning = "copies of the body in a grid"})
            .key("velocity", &BodyEntry::velocity, {.meaning = "initial velocity", .unit = "m/s"})
            .key("angular_velocity", &BodyEntry::angular_velocity,
                 {.meaning = "initial angular velocity about the centre of mass", .unit = "rad/s"})
            .key("contact_distance", &BodyEntry::contact_distance,
                 {.meaning = "thickness of the contact shell; default: 2 % of the mean length of the surface edges",
                  .unit = "m",
                  .limits = at_least(0)})
            .key("self_contact", &BodyEntry::self_contact,
                 {.meaning = "whether the body can touch itself; default: false"})
            .key("dynamics", &BodyEntry::dynamics,
                 {.meaning =
                      "model of the motion. \"automatic\" (default): implicit if the body is stiff, has no "
                      "self-contact, no pins and no set loss_factor, and if implicit integration more than halves the "
                      "predicted cost; otherwise explicit; "
                      "\"explicit\": any deformation, short steps; \"implicit\": small deformation, any step size, for "
                      "stiff bodies; \"rigid\": no deformation, with the mass and inertia of the mesh"})
            .key("mass", &BodyEntry::mass,
                 {.meaning = "mass of a rigid body; default: by density. It scales the inertia of the mesh unless "
                             "\"center_of_mass\" and \"inertia\" are given, too",
                  .unit = "kg",
                  .limits = above(0)})
            .key("center_of_mass", &BodyEntry::center_of_mass,
                 {.meaning = "centre of mass of a rigid body in the frame of the mesh", .unit = "m"})
            .key("inertia", &BodyEntry::inertia,
                 {.meaning = "inertia tensor about the centre of mass in the frame of the mesh, by rows",
                  .unit = "kg m^2"})
            .key("collision_group", &BodyEntry::collision_group, group_doc)
            .key("collision_mask", &BodyEntry::collision_mask, mask_doc)
            .key("element", &BodyEntry::element, {.meaning = "type of the elements that carry the stress"})
            .key("pin", &BodyEntry::pin, {.meaning = "pinned nodes"})
            .key("surfaces", &BodyEntry::surfaces,
                 {.meaning = "parts with their own friction and restitution; where they overlap, the last one counts"})
            .key("visual", &BodyEntry::visual, {.meaning = "surface that is drawn in place of the body"})
            .exactly_one({"mesh", "shape"})
            .at_most_one({"position", "positions"})
            .at_most_one({"positions", "repeat"});
    return rule;
}

template <>
const Rule<ColliderEntry>& rule_of<ColliderEntry>() {
    using Entry = ColliderEntry;
    static const auto rule = [] {
        auto made = Rule<Entry>("collider", "A rigid shape that is fixed or follows a prescribed motion.");
        made.key("name", &Entry::name, {.meaning = "name in messages and output; default: collider_NUMBER"})
            .key("shape", &Entry::shape, {.meaning = "shape of the collider", .required = true})
            .key("position", &Entry::position, {.meaning = "position of the shape's origin", .unit = "m"})
            .key("rotation", &Entry::rotation, {.meaning = "rotation about the shape's origin"})
            .key("motion", &Entry::motion, {.meaning = "prescribed motion; default: none"})
            .key("material", &Entry::material,
                 {.meaning = "name of one of the materials, for friction, restitution and \"pairs\"; default: none"});
        add_surface_keys(
            made,
            {.meaning = "friction coefficient of the collider. A contact uses the geometric mean of this value "
                        "and the value of the touching body; default: the value of the material or of the body",
             .alias = "mu",
             .limits = at_least(0)},
            {.meaning = "coefficient of restitution of the collider. A contact uses the larger of this value and "
                        "the value of the touching body; default: the value of the material or of the body",
             .limits = within(0, 1)});
        made.key("contact_distance", &Entry::contact_distance,
                 {.meaning = "thickness of the contact shell of a mesh collider", .unit = "m", .limits = at_least(0)})
            .key("collision_group", &Entry::collision_group, group_doc)
            .key("collision_mask", &Entry::collision_mask, mask_doc);
        return made;
    }();
    return rule;
}

template <>
const Rule<Plasticity>& rule_of<Plasticity>() {
    static const auto rule =
        Rule<Plasticity>("plasticity", "Plasticity of von Mises with isotropic hardening.")
            .key("yield_stress", &Plasticity::yield_stress,
                 {.meaning = "von Mises stress at the first yield", .unit = "Pa", .limits = above(0), .required = true})
            .key("hardening", &Plasticity::hardening,
                 {.meaning = "slope of the yield stress by the equivalent plastic strain",
                  .unit = "Pa",
                  .limits = at_least(0)});
    return rule;
}

template <>
const Rule<MaterialSettings>& rule_of<MaterialSettings>() {
    using M = MaterialSettings;
    static const auto rule = [] {
        auto made = Rule<M>("material", "An elastic material and its surface.");
        made.preset<MaterialName>("like",
                                  {.meaning = "name of a material from the literature, whose values the other keys "
                                              "replace; `skerry materials` lists the materials with their sources"})
            .key("young_modulus", &M::young_modulus,
                 {.meaning = "Young's modulus", .unit = "Pa", .alias = "E", .limits = above(0)})
            .key("poisson_ratio", &M::poisson_ratio,
                 {.meaning = "Poisson's ratio",
                  .alias = "nu",
                  .limits = {.at_least = {}, .above = -1, .at_most = {}, .below = 0.5}})
            .key("density", &M::density, {.meaning = "density", .unit = "kg/m^3", .alias = "rho", .limits = above(0)});
        add_surface_keys(
            made, {.meaning = "Coulomb friction coefficient", .alias = "mu", .limits = at_least(0)},
            {.meaning = "coefficient of restitution of a surface point at an impact, not of the whole body",
             .limits = within(0, 1)});
        made.key("damping", &M::damping,
                 {.meaning = "decay rate of deformation velocities; momentum is conserved",
                  .unit = "1/s",
                  .limits = at_least(0)})
            .key("loss_factor", &M::loss_factor,
                 {.meaning = "tangent of the phase angle between stress and strain, the same at every natural "
                             "frequency of a body",
                  .limits = within(0, largest_loss_factor)})
            .key("bulk_viscosity", &M::bulk_viscosity,
                 {.meaning = "damping ratio of volume changes at the highest natural frequency of an element",
                  .limits = within(0, largest_bulk_viscosity)})
            .preset<LawFromName>("model", {.meaning = "constitutive law"})
            .key("plasticity", &M::plasticity, {.meaning = "yield of the law \"hencky\"; for explicit bodies"})
            .preset<LawFromEntry<OgdenEntry>>(
                "ogden", {.meaning = "law of Ogden for rubber; sets the model and the elastic moduli"})
            .preset<LawFromEntry<MooneyRivlinEntry>>(
                "mooney_rivlin", {.meaning = "law of Mooney and Rivlin: the law of Ogden with the exponents 2 and -2"})
            .preset<LawFromEntry<OrthotropicModuli>>(
                "orthotropic", {.meaning = "orthotropic elasticity; sets the model and the elastic constants"})
            .at_most_one({"ogden", "mooney_rivlin", "orthotropic", "model"})
            .at_most_one({"ogden", "mooney_rivlin", "orthotropic", "young_modulus"})
            .at_most_one({"ogden", "mooney_rivlin", "orthotropic", "E"})
            .at_most_one({"ogden", "mooney_rivlin", "orthotropic", "poisson_ratio"})
            .at_most_one({"ogden", "mooney_rivlin", "orthotropic", "nu"});
        return made;
    }();
    return rule;
}

template <>
const Rule<Settings>& rule_of<Settings>() {
    using S = Settings;
    constexpr std::string_view always_on = "delete the key; the feature is now always on";
    static const auto rule =
        Rule<S>("settings", "Settings of time steps and contacts. The defaults suit most scenes.")
            .key("gravity", &S::gravity,
                 {.meaning = "acceleration of gravity; default: [0, 0, -9.81]", .unit = "m/s^2"})
            .key("step_size", &S::step_size,
                 {.meaning = "largest step size; default and upper bound: the smallest stable step of all bodies",
                  .unit = "s",
                  .limits = above(0)})
            .key("integrator", &S::integrator, {.meaning = "time integration method"})
            .key("clusters", &S::clusters,
                 {.meaning = "whether the few elements that would make all steps several times shorter are integrated "
                             "implicitly, in clusters"})
            .withdrawn("multirate",
                       "delete the key; \"clusters\", which is on by default, prevents short steps because of a few "
                       "stiff elements; for a stiff body set \"dynamics\" to \"implicit\" or \"automatic\"")
            .key("backend", &S::backend, {.meaning = "thread library"})
            .key("threads", &S::threads,
                 {.meaning = "number of threads; 0: all available threads", .limits = within(0, 1024)})
            .key("contact_regions", &S::contact_regions,
                 {.meaning = "grouping of contacts into regions; the solver treats each region separately"})
            .key("method", &S::method, {.meaning = "contact solver"})
            .key("friction", &S::friction, {.meaning = "friction law"})
            .key("tolerance", &S::tolerance,
                 {.meaning = "relative error at which the solver of a region stops", .limits = above(0)})
            .key("max_iterations", &S::max_iterations,
                 {.meaning = "largest number of solver iterations for a contact region in a step; an iteration passes "
                             "over all its contacts once",
                  .limits = at_least(1)})
            .key("recovery_speed", &S::recovery_speed,
                 {.meaning = "largest speed at which surfaces within the contact distance are pushed apart",
                  .unit = "m/s",
                  .limits = above(0)})
            .key("start_overlaps", &S::start_overlaps,
                 {.meaning = "treatment of bodies that overlap each other or colliders at the start. resolve "
                             "(default): moves them apart if the way out is short, otherwise an error; refuse: always "
                             "an error; ignore: reports them and starts with the overlaps"})
            .key("theta", &S::theta,
                 {.meaning =
                      "parameter theta of the implicit time integration, from 0.5 to 1. The value 1 damps vibrations "
                      "most, 0.55 damps them a tenth as much; values below 1 need the integrator symplectic_euler",
                  .limits = at_least(0.5)})
            .key("implicit_step", &S::implicit_step,
                 {.meaning = "largest step of implicit bodies that are not pinned; one such step covers several steps "
                             "of the other bodies. 0 (default): all bodies take the same steps; other values need the "
                             "integrator symplectic_euler",
                  .unit = "s",
                  .limits = at_least(0)})
            .key("sleep", &S::sleep,
                 {.meaning = "whether bodies at rest are put to sleep, together with all bodies that they touch. A "
                             "body is at rest if, for sleep_time, it hardly moves and neither accelerates nor drifts "
                             "steadily; a new load wakes sleeping bodies"})
            .key("sleep_time", &S::sleep_time,
                 {.meaning = "time for which a body must be at rest before it is put to sleep",
                  .unit = "s",
                  .limits = at_least(0)})
            .key("continuous_collision", &S::continuous_collision,
                 {.meaning = "whether a step in which surfaces would pass through each other is repeated with "
                             "additional contacts between the crossing nodes, edges and triangles"})
            .withdrawn("freeze_contacts", "delete the key; every sweep now evaluates all contacts")
            .withdrawn("step_safety", "delete the key; for shorter steps set \"step_size\"")
            .withdrawn("max_strain_step", "delete the key; for shorter steps set \"step_size\"")
            .withdrawn("restitution_speed", "delete the key; set \"restitution\" of the materials")
            .withdrawn("sleep_speed", "delete the key; use \"sleep\" and \"sleep_time\"")
            .withdrawn("relaxation", "delete the key; use another \"method\" or a larger \"max_iterations\"")
            .withdrawn("fixed_iterations", "delete the key; limit the number of sweeps by \"max_iterations\"")
            .withdrawn("warm_start", always_on)
            .withdrawn("contact_budgets", always_on)
            .withdrawn("certify_warm_start", always_on)
            .withdrawn("skip_separating", always_on)
            .withdrawn("frictionless_rows", always_on)
            .withdrawn("small_regions_in_lanes", always_on);
    return rule;
}

template <>
const Rule<IncludeEntry>& rule_of<IncludeEntry>() {
    static const auto rule =
        Rule<IncludeEntry>("include", "A scene whose objects are added with other names and at another place.")
            .key("scene", &IncludeEntry::scene, {.meaning = "scene file", .required = true})
            .key("name", &IncludeEntry::name,
                 {.meaning = "prefix of the names of all objects and materials, as in NAME/OBJECT, and of probes, "
                             "as in NAME_PROBE",
                  .required = true})
            .key("position", &IncludeEntry::position, {.meaning = "position of the frame of the scene", .unit = "m"})
            .key("rotation", &IncludeEntry::rotation, {.meaning = "rotation of the frame of the scene"});
    return rule;
}

template <>
const Rule<SceneFile>& rule_of<SceneFile>() {
    static const auto rule =
        Rule<SceneFile>(
            "scene",
            "A scene: deformable and rigid bodies, colliders, and the settings of a run. All values are in SI units.")
            .key("$schema", &SceneFile::schema, {.meaning = "path or address of this schema, for editors"})
            .key("name", &SceneFile::name, {.meaning = "name of the scene; default: the name of the file"})
            .key("description", &SceneFile::description, {.meaning = "description of the scene"})
            .key(
                "include", &SceneFile::include,
                {.meaning =
                     "scene files to read before this file. Their materials and the entries of their lists, such as "
                     "bodies, springs or probes, are added to those of this file; where both files set the same single "
                     "value, this file takes precedence. Of a scene with a name, only the objects are added"})
            .key("seconds", &SceneFile::seconds,
                 {.meaning = "simulated time of a run; default: 2", .unit = "s", .limits = above(0)})
            .key("frame_step", &SceneFile::frame_step,
                 {.meaning = "time between frames of output; default: 1/60", .unit = "s", .limits = above(0)})
            .key("settings", &SceneFile::settings, {.meaning = "settings of time steps and contacts"})
            .key("materials", &SceneFile::materials, {.meaning = "materials by name"})
            .key("pairs", &SceneFile::pairs, {.meaning = "friction and restitution by pair of materials"})
            .key("bodies", &SceneFile::bodies, {.meaning = "deformable and rigid bodies"})
            .key("colliders", &SceneFile::colliders,
                 {.meaning = "rigid shapes that are fixed or follow a prescribed motion"})
            .key("no_collision", &SceneFile::no_collision, {.meaning = "pairs of objects that do not collide"})
            .key("joints", &SceneFile::joints, {.meaning = "joints of rigid bodies"})
            .key("ties", &SceneFile::ties, {.meaning = "ties of deformable bodies to other objects"})
            .key("cables", &SceneFile::cables, {.meaning = "cables that run through points of bodies"})
            .key("cavities", &SceneFile::cavities, {.meaning = "pressure on faces, and gas or liquid in cavities"})
            .key("pipes", &SceneFile::pipes, {.meaning = "pipes between cavities with gas"})
            .key("loads", &SceneFile::loads, {.meaning = "forces, tractions and force fields"})
            .key("fibres", &SceneFile::fibres, {.meaning = "fibres in bodies, which resist stretch and contract"})
            .key("springs", &SceneFile::springs,
                 {.meaning = "springs and dampers between points of bodies, colliders and the world"})
            .key("probes", &SceneFile::probes,
                 {.meaning = "recorded quantities: contacts for the report, and time series for --probes"})
            .key("probe_step", &SceneFile::probe_step,
                 {.meaning = "time between rows of the time series; default: frame_step",
                  .unit = "s",
                  .limits = above(0)})
            .key("sliders", &SceneFile::sliders, {.meaning = "values that a user changes while the scene runs"});
    return rule;
}

}  // namespace skerry
