// Table of named materials. Every value has a source; materials with a value of unknown source are left out.
#include <algorithm>
#include <array>
#include <string>

#include "engine/world/validate.h"
#include "skerry/error.h"
#include "skerry/materials.h"
#include "systems/material/material_law.h"
#include "systems/material/orthotropic.h"

namespace skerry {

namespace {

// Books, papers and data sheets
constexpr std::string_view smooth_on =
    "Smooth-On, technical bulletins of Ecoflex and Dragon Skin (E = 12/7 of the 100 % modulus, neo-Hookean)";
constexpr std::string_view johnston =
    "Johnston et al., J. Micromech. Microeng. 24 (2014) 035017 (cured at 25 degrees Celsius)";
constexpr std::string_view dow = "Dow, technical data sheet of Sylgard 184";
constexpr std::string_view matweb_rubber = "MatWeb, vulcanized natural rubber (E = 3 G, without fillers)";
constexpr std::string_view subramani = "Subramani et al., Front. Mater. 7 (2020) 212 (stiff gel, E = 3 G)";
constexpr std::string_view water = "density of water, of which the gel mostly consists";
constexpr std::string_view tissue_density = "tissue densities in Mech. Mater. 44 (2012) 174, table 3";
constexpr std::string_view liver_shear = "Phys. Med. Biol. 64 (2019) 225001, table 1 (E = 3 G)";
constexpr std::string_view arda =
    "Arda et al., Am. J. Roentgenol. 197 (2011) 532 (shear-wave elastography of healthy adults)";
constexpr std::string_view briot = "Briot et al., Clin. Biomech. 99 (2022) 105743 (suction on the breast in vivo)";
constexpr std::string_view budday = "Budday et al., J. Mech. Behav. Biomed. Mater. 46 (2015) 318 (white matter)";
constexpr std::string_view incompressible = "taken as nearly incompressible";
constexpr std::string_view ninjaflex = "NinjaTek, technical data sheet of NinjaFlex";
constexpr std::string_view poisson_table = "Altair Radioss 2022 user guide, table of Poisson's ratios";
constexpr std::string_view poisson_middle =
    "Altair Radioss 2022 user guide, table of Poisson's ratios (middle of the range)";
constexpr std::string_view poisson_least =
    "Altair Radioss 2022 user guide, table of Poisson's ratios (lower end of the range)";
constexpr std::string_view geofoam = "ASTM D6817, EPS22 (E from the stress at a strain of 1 %)";
constexpr std::string_view granta = "Granta Design, CES EduPack, cork (middle of the range)";
constexpr std::string_view handbook = "The Mechanical Engineering Handbook, mechanical properties of non-metals";
constexpr std::string_view halliday = "Halliday, Resnick, Walker, Fundamentals of Physics, 5th ed., table 13-1";
constexpr std::string_view wood_handbook =
    "Wood Handbook, USDA FPL-GTR-190, Douglas-fir Interior South, 12 % moisture, along the grain";
constexpr std::string_view gammon =
    "Gammon et al., J. Glaciol. 25 (1980) 159, at -16 degrees Celsius (Voigt-Reuss-Hill mean of the crystals)";
constexpr std::string_view ice_density = "CRC Handbook of Chemistry and Physics, ice at 0 degrees Celsius";
constexpr std::string_view cremer = "Cremer, Heckl, Structure-Borne Sound, Springer 1988 (longitudinal and bending)";
constexpr std::string_view adams = "Adams, Askenazi, Building Better Products with Finite Element Analysis (2 zeta)";
constexpr std::string_view serway = "Serway, Jewett, Physics for Scientists and Engineers, table 5.1";
constexpr std::string_view openstax = "OpenStax, College Physics, table 5.1";

constexpr Real psi = 6894.757;  // pound-force per square inch [Pa]

/// Young's modulus E of an incompressible neo-Hookean rubber with the given engineering stress at the stretch s = 2
/// (100 % strain) [Pa]. The stress is E/3 (s - 1/s^2).
constexpr SourcedValue from_100_percent_modulus(Real pounds_per_square_inch) {
    return {12.0 / 7 * pounds_per_square_inch * psi, smooth_on};
}

constexpr SourcedValue soft{0.49, incompressible};

// Each row: name, title, Young's modulus [Pa], Poisson's ratio, density [kg/m^3]; loss factor and yield stress [Pa] if
// known.
constexpr std::array materials = {
    // soft tissue
    NamedMaterial{"brain", "brain, white matter", {1895, budday}, soft, {1040, tissue_density}, {}},
    NamedMaterial{"spleen", "spleen", {2900, arda}, soft, {1054, tissue_density}, {}},
    NamedMaterial{"fat", "fat and glandular tissue of the breast", {3040, briot}, soft, {950, tissue_density}, {}},
    NamedMaterial{"kidney", "kidney, cortex", {5000, arda}, soft, {1050, tissue_density}, {}},
    NamedMaterial{"liver", "liver, healthy", {5400, liver_shear}, soft, {1060, tissue_density}, {}},
    NamedMaterial{"muscle", "muscle at rest, gastrocnemius", {11100, arda}, soft, {1050, tissue_density}, {}},
    NamedMaterial{"skin", "skin of the breast", {56300, briot}, soft, {1090, tissue_density}, {}},
    // gels, silicones, rubbers
    NamedMaterial{"gel_polyacrylamide", "polyacrylamide gel, stiff", {13590, subramani}, soft, {1000, water}, {}},
    NamedMaterial{
        "silicone_ecoflex_10", "silicone Ecoflex 00-10", from_100_percent_modulus(8), soft, {1040, smooth_on}, {}},
    NamedMaterial{
        "silicone_ecoflex_30", "silicone Ecoflex 00-30", from_100_percent_modulus(10), soft, {1070, smooth_on}, {}},
    NamedMaterial{
        "silicone_ecoflex_50", "silicone Ecoflex 00-50", from_100_percent_modulus(12), soft, {1070, smooth_on}, {}},
    NamedMaterial{"silicone_dragon_skin_10",
                  "silicone Dragon Skin 10",
                  from_100_percent_modulus(22),
                  soft,
                  {1070, smooth_on},
                  {}},
    NamedMaterial{"silicone_dragon_skin_20",
                  "silicone Dragon Skin 20",
                  from_100_percent_modulus(49),
                  soft,
                  {1080, smooth_on},
                  {}},
    NamedMaterial{"silicone_dragon_skin_30",
                  "silicone Dragon Skin 30",
                  from_100_percent_modulus(86),
                  soft,
                  {1080, smooth_on},
                  {}},
    NamedMaterial{"silicone_sylgard_184", "silicone Sylgard 184 (PDMS)", {1.32e6, johnston}, soft, {1030, dow}, {}},
    NamedMaterial{"rubber_natural",
                  "natural rubber, vulcanized",
                  {1.5e6, matweb_rubber},
                  soft,
                  {950, matweb_rubber},
                  SourcedValue{0.1, adams}},
    NamedMaterial{"tpu_85a",
                  "thermoplastic polyurethane, Shore 85A",
                  {1.2e7, ninjaflex},
                  {0.48, poisson_least},
                  {1190, ninjaflex},
                  {}},
    // foams and cork
    NamedMaterial{
        "foam_polystyrene", "expanded polystyrene", {5e6, geofoam}, {0.1, poisson_least}, {21.6, geofoam}, {}},
    NamedMaterial{"cork", "cork", {3.75e7, granta}, {0, poisson_table}, {198, granta}, SourcedValue{0.2, granta}},
    // plastics
    NamedMaterial{
        "polyethylene", "polyethylene of high density", {1.2e9, handbook}, {0.42, handbook}, {950, handbook}, {}},
    NamedMaterial{"nylon", "nylon 101", {1e9, handbook}, {0.3, handbook}, {1150, handbook}, {}},
    NamedMaterial{"polypropylene", "polypropylene", {1.5e9, handbook}, {0.4, handbook}, {900, handbook}, {}},
    NamedMaterial{"abs", "ABS", {2e9, handbook}, {0.394, handbook}, {1020, handbook}, {}},
    NamedMaterial{"polycarbonate", "polycarbonate", {2.4e9, handbook}, {0.37, handbook}, {1200, handbook}, {}},
    NamedMaterial{"acrylic", "acrylic glass", {3e9, handbook}, {0.35, handbook}, {1200, handbook}, {}},
    NamedMaterial{"polystyrene", "polystyrene", {3.3e9, handbook}, {0.35, handbook}, {1050, handbook}, {}},
    // wood, ice, stone, metals
    NamedMaterial{"ice", "ice of many crystals", {9.2e9, gammon}, {0.328, gammon}, {916.7, ice_density}, {}},
    NamedMaterial{"wood_douglas_fir",
                  "Douglas fir, as isotropic",
                  {1.03e10, wood_handbook},
                  {0.292, wood_handbook},
                  {515, wood_handbook},
                  {}},
    NamedMaterial{
        "concrete", "concrete of high strength", {3e10, halliday}, {0.2, poisson_table}, {2320, halliday}, {}},
    NamedMaterial{"glass", "glass", {6.5e10, halliday}, {0.265, poisson_middle}, {2190, halliday}, {}},
    NamedMaterial{"aluminium",
                  "aluminium",
                  {7e10, halliday},
                  {0.33, poisson_table},
                  {2710, halliday},
                  SourcedValue{1e-4, cremer},
                  SourcedValue{9.5e7, halliday}},
    NamedMaterial{"steel",
                  "structural steel",
                  {2e11, halliday},
                  {0.3, poisson_table},
                  {7860, halliday},
                  SourcedValue{4e-4, cremer},
                  SourcedValue{2.5e8, halliday}},
};

constexpr std::array frictions = {
    KnownFriction{"steel", "steel", 0.74, 0.57, serway},
    KnownFriction{"aluminium", "steel", 0.61, 0.47, serway},
    KnownFriction{"ice", "ice", 0.1, 0.03, serway},
    KnownFriction{"ice", "steel", 0.4, 0.02, openstax},
    KnownFriction{"glass", "glass", 0.94, 0.4, serway},
    KnownFriction{"rubber_natural", "concrete", 1.0, 0.8, serway},
    KnownFriction{"wood_douglas_fir", "wood_douglas_fir", 0.5, 0.3, openstax},
    KnownFriction{"wood_douglas_fir", "steel", 0.5, 0.3, openstax},
};

}  // namespace

std::span<const NamedMaterial> named_materials() {
    return materials;
}

std::span<const KnownFriction> known_frictions() {
    return frictions;
}

MaterialSettings named_material(std::string_view name) {
    const auto* const found = std::ranges::find(materials, name, &NamedMaterial::name);
    if (found == materials.end()) {
        std::string names;
        for (const NamedMaterial& material : materials) names.append(names.empty() ? "" : ", ").append(material.name);
        refuse("material", {}, "the name \"" + std::string(name) + "\"", "one of the names " + names);
    }
    constexpr Real negligible_loss = 0.01;
    MaterialSettings settings;
    settings.young_modulus = found->young_modulus.value;
    settings.poisson_ratio = found->poisson_ratio.value;
    settings.density = found->density.value;
    if (found->loss_factor && found->loss_factor->value >= negligible_loss)
        settings.loss_factor = found->loss_factor->value;
    for (const KnownFriction& pair : frictions)
        if (pair.first == name && pair.second == name) settings.friction = pair.dynamic_friction;
    return settings;
}

MaterialSettings ogden(std::span<const OgdenTerm> terms, Real bulk_modulus, MaterialSettings base) {
    if (terms.empty() || terms.size() > base.terms.size())
        refuse("material", "ogden", std::to_string(terms.size()) + " terms", "one to three terms");
    Real twice_shear = 0;
    for (const auto& [modulus, exponent] : terms) {
        if (!(modulus * exponent > 0))
            refuse("material", "ogden",
                   "the term (" + std::to_string(modulus) + " Pa, " + std::to_string(exponent) + ")",
                   "modulus and exponent of the same sign, not zero");
        twice_shear += modulus * exponent;
    }
    // Besides the products in the loop, only the bulk modulus needs a check. The shear modulus is half the sum of these
    // products, so it is positive; if the bulk modulus is positive, too, Poisson's ratio is between -1 and 0.5.
    if (!(bulk_modulus > 0))
        refuse("material", "bulk_modulus", std::to_string(bulk_modulus) + " Pa", "a modulus > 0 (Pa)");
    const Real shear = twice_shear / 2;
    base.model = MaterialModel::ogden;
    base.young_modulus = 9 * bulk_modulus * shear / (3 * bulk_modulus + shear);
    base.poisson_ratio = (3 * bulk_modulus - 2 * shear) / (6 * bulk_modulus + 2 * shear);
    base.terms = {};
    for (std::size_t p = 0; p < terms.size(); ++p)
        base.terms[p] = {terms[p].modulus * terms[p].exponent / twice_shear, terms[p].exponent};
    return base;
}

MaterialSettings mooney_rivlin(Real c10, Real c01, Real bulk_modulus, MaterialSettings base) {
    // Mooney-Rivlin is Ogden's law with mu_1 = 2 c10, exponent 2, and mu_2 = -2 c01, exponent -2.
    const std::array<OgdenTerm, 2> both{{{2 * c10, 2}, {-2 * c01, -2}}};
    return ogden(std::span(both).first(c01 == 0 ? 1 : 2), bulk_modulus, base);
}

MaterialSettings orthotropic(const OrthotropicModuli& moduli, MaterialSettings base) {
    base.model = MaterialModel::orthotropic;
    base.orthotropic = moduli;
    validate(base);
    MaterialConstants constants{.model = base.model, .shear_modulus = 0, .lame_lambda = 0, .density = base.density};
    set_orthotropic(moduli, constants);
    const IsotropicModuli softer = isotropic_moduli(constants);
    base.young_modulus = softer.young_modulus;
    base.poisson_ratio = softer.poisson_ratio;
    return base;
}

}  // namespace skerry
