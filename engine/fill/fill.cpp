#include "skerry/fill.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/fill/best_mesh.h"
#include "engine/fill/explicit_body.h"
#include "engine/mesh/repair/surface_distance.h"
#include "engine/mesh/repair/surface_measures.h"
#include "engine/mesh/surface/check_shells.h"

namespace skerry::mesh {

namespace {

// Edge length of the tetrahedra if none is given and the surface is not clean, as a fraction of the diagonal of its
// bounding box. fTetWild has the same default.
constexpr Real default_edge = 0.05;
// The triangles of a clean surface are kept if the ratio of the wanted edge to the mean edge of the surface is between
// these values. Otherwise fTetWild makes new triangles.
constexpr Real least_ratio = 2.0 / 3, most_ratio = 1.5;
// fTetWild may move the surface by this share of the tolerance. The rest is left for the removal of needles and caps,
// which are thin triangles.
constexpr Real envelope_share = 0.5;
// Netgen also fills the surface of fTetWild's mesh. Netgen's mesh must have at least this fraction of the number of
// tetrahedra of fTetWild's mesh. With fewer it would be coarser than wanted.
constexpr Real least_count = 0.7;
// Upper limit of the number of cubes, with the wanted edge as their side, that fill the bounding box. The memory of a
// computer does not suffice for more tetrahedra.
constexpr Real most_cells = 1e9;

const char* const install_ftetwild = "install the Python package of fTetWild: pip install wildmeshing==0.4.1";

/// A surface to fill, joined from files. For each file: its name, and the index in `surface` of its first triangle.
struct GivenSurface {
    SurfaceMesh surface;
    std::vector<std::string> names;
    std::vector<Index> first_triangle;

    void add(const SurfaceMesh& part, Real scale, std::string name) {
        const auto first = static_cast<Index>(surface.nodes.size());
        names.push_back(std::move(name));
        first_triangle.push_back(static_cast<Index>(surface.triangles.size()));
        for (const Vec3& node : part.nodes) surface.nodes.emplace_back(scale * node);
        for (const auto& [a, b, c] : part.triangles) surface.triangles.push_back({first + a, first + b, first + c});
    }
    std::size_t file_of(Index triangle) const {
        return static_cast<std::size_t>(std::ranges::upper_bound(first_triangle, triangle) - first_triangle.begin()) -
               1;
    }
};

class Filling {
public:
    Filling(const GivenSurface& given, const FillSettings& settings, const FillProgress& progress)
        : given_(given),
          settings_(settings),
          setup_{.limits = settings.limits, .python = settings.python, .progress = progress} {
        check_settings();
        say("checking the surface");
        result_.surface = settings.cavities ? check_surface_with_walls(given.surface, default_weld, given.names.front())
                                            : check_surface(given.surface, default_weld, given.names.front());
        if (surface().triangles.empty()) refuse("no triangles", "a surface with triangles");
        result_.tolerance = settings.tolerance * box_diagonal(surface());
        shells_ = shells_of(result_.surface, settings.cavities);
    }

    FilledMesh run() {
        const bool nested = shells_.has_regions() && !crossing();
        for (const SurfaceFault& fault : result_.surface.faults)
            // the notes of name_shells() already report nested regions
            if (!nested || fault.kind != SurfaceFaultKind::doubled_volumes) result_.notes.push_back(fault_text(fault));
        check_edge();
        const bool clean = result_.surface.can_be_filled();
        if (!clean || !keeps_triangles() || !fill_exactly()) fill_within_tolerance(clean);
        name_shells();
        measure();
        return std::move(result_);
    }

private:
    const SurfaceMesh& surface() const { return result_.surface.cleaned; }

    void say(const std::string& doing) const {
        if (setup_.progress) setup_.progress(doing);
    }

    [[noreturn]] void refuse(std::string found, std::string expected, std::string hint = {},
                             std::string object = "surface") const {
        refuse_in(given_.names.front(), object, {}, found, expected, hint);
    }

    void check_settings() const {
        const auto require = [&](bool valid, const char* name, Real value, const char* expected) {
            if (!valid) refuse(short_text(value), expected, {}, name);
        };
        require(settings_.scale > 0, "scale", settings_.scale, "a factor above 0");
        if (settings_.edge) require(*settings_.edge > 0, "edge", *settings_.edge, "a length above 0 m");
        require(settings_.tolerance >= 0 && settings_.tolerance < 1, "tolerance", settings_.tolerance,
                "a fraction of the diagonal of at least 0 and below 1");
        require(settings_.limits.seconds > 0, "time limit", settings_.limits.seconds, "a time above 0 s");
        require(settings_.limits.bytes > 0, "memory limit", settings_.limits.bytes, "a number of bytes above 0");
    }

    /// Refuses an edge length that does not fit the size of the surface, for example because the length is given in
    /// another unit.
    void check_edge() const {
        if (!settings_.edge) return;
        const Real edge = *settings_.edge, diagonal = box_diagonal(surface());
        const std::string size =
            "the surface measures " + short_text(diagonal) + " across its bounding box, " +
            (settings_.scale == 1 ? "in the unit of its file, to which no \"scale\" is applied" : "after scaling");
        if (edge > diagonal) refuse(short_text(edge), "an edge length below the size of the surface", size, "edge");
        const Real least = std::cbrt((result_.surface.upper - result_.surface.lower).prod() / most_cells);
        if (edge < least) refuse(short_text(edge), "an edge length of at least " + short_text(least), size, "edge");
    }

    /// True if the wanted tetrahedra have about the size of the triangles of the surface, if no edge is given, or if
    /// the tolerance of 0 forbids other triangles.
    bool keeps_triangles() const {
        if (!settings_.edge || settings_.tolerance == 0) return true;
        const Real ratio = *settings_.edge / mean_edge(surface());
        return ratio >= least_ratio && ratio <= most_ratio;
    }

    BestMesh best_mesh_of(const SurfaceMesh& clean, Real edge, Real tolerance, Real count) const {
        return best_mesh({.surface = clean,
                          .edge = edge,
                          .tolerance = tolerance,
                          .least_count = count,
                          .all_cavities = settings_.cavities,
                          .setup = setup_,
                          .stable_step = [this](const Mesh& mesh) { return stable_step(mesh); }});
    }

    /// Stable step of a body with this mesh [s]; 0 if the mesh has flat tetrahedra.
    Real stable_step(const Mesh& mesh) const {
        if (inspect(mesh).flat > 0) return 0;
        return explicit_body(mesh, {.material = settings_.material}).world.stable_step();
    }

    /// Fills the surface by Netgen, either unchanged or without needles and caps, which are thin triangles. Returns
    /// false if Netgen makes no mesh.
    bool fill_exactly() {
        BestMesh best =
            best_mesh_of(whole_surface(shells_), settings_.edge.value_or(mean_edge(surface())), result_.tolerance, 0);
        result_.may_change = best.may_change;
        if (best.step > 0) {
            take(std::move(best), "Netgen");
            return true;
        }
        netgen_failure_ = best.failure;
        netgen_missing_ = best.missing;
        result_.notes.push_back(netgen_failure_ + ": the surface was filled by fTetWild");
        return false;
    }

    void take(BestMesh best, std::string mesher) {
        result_.exact = mesher == "Netgen" && best.collapsed + best.flipped == 0;
        result_.mesh = std::move(best.mesh);
        result_.stable_step = best.step;
        result_.mesher = std::move(mesher);
        if (best.collapsed + best.flipped > 0)
            result_.notes.push_back(
                "very flat triangles of the surface were removed: " + std::to_string(best.collapsed) +
                " edges collapsed, " + std::to_string(best.flipped) + " flipped");
    }

    void fill_within_tolerance(bool clean) {
        if (settings_.tolerance == 0)
            refuse(clean ? netgen_failure_ : "a surface with holes, crossings or other faults, and a tolerance of 0",
                   clean ? "tetrahedra from Netgen, or a tolerance above 0, with which fTetWild fills the surface"
                         : "a clean surface, or a tolerance above 0",
                   netgen_missing_ ? install_netgen : "");
        const Real diagonal = box_diagonal(surface());
        const Real edge = settings_.edge.value_or(clean ? mean_edge(surface()) : default_edge * diagonal);
        MesherResult filled =
            fill_by_ftetwild(whole_surface(shells_), edge, envelope_share * result_.tolerance, setup_);
        if (!filled.mesh) refuse_ftetwild(filled, edge);
        if (shells_.has_regions() && !crossing()) label_regions(*filled.mesh, shells_);
        const Real step = stable_step(*filled.mesh);
        if (filled.mesh->label.empty() && !netgen_missing_) {
            const MeshReport report = inspect(*filled.mesh);
            BestMesh best = report.closed_manifold ? best_mesh_of(boundary(*filled.mesh), report.mean_edge,
                                                                  (1 - envelope_share) * result_.tolerance,
                                                                  least_count * static_cast<Real>(report.tetrahedra))
                                                   : BestMesh{};
            result_.may_change = result_.may_change || best.may_change;
            if (best.step > step) {
                take(std::move(best), "fTetWild and Netgen");
                return;
            }
        }
        if (!(step > 0)) {
            filled.failure = "made " + std::to_string(inspect(*filled.mesh).flat) + " flat tetrahedra";
            refuse_ftetwild(filled, edge);
        }
        take({.mesh = *std::move(filled.mesh), .step = step}, "fTetWild");
    }

    [[noreturn]] void refuse_ftetwild(const MesherResult& filled, Real edge) const {
        const std::string python = python_program(settings_.python);
        std::string found = netgen_failure_.empty() ? "" : netgen_failure_ + "; ";
        found += "fTetWild, started by " + python + ", " + filled.failure;
        std::string hint;
        if (filled.missing && netgen_missing_) found = "no installed mesher: " + found;
        if (filled.missing)
            hint = std::string(netgen_missing_ ? install_netgen : "") + (netgen_missing_ ? "; or " : "") +
                   install_ftetwild + ", and name its interpreter in SKERRY_FILL_PYTHON if it is not " + python;
        else if (filled.stopped)
            hint = "a larger edge than " + short_text(edge) +
                   " m or a larger tolerance takes less time and memory; or raise the limit";
        refuse(std::move(found), "tetrahedra inside the surface", std::move(hint));
    }

    bool crossing() const { return result_.surface.find(SurfaceFaultKind::shell_crossings) != nullptr; }

    /// Makes a mesh set of the faces of each shell. The name of the set is that of the file of the shell, or contains
    /// the number of the shell. Makes no sets unless there are regions, cavities or several files.
    void name_shells() {
        const std::size_t shells = shells_.shell.size(), files = given_.names.size();
        if (crossing()) {
            result_.notes.emplace_back("crossing shells were united");
            return;
        }
        if (shells < 2 || (files < 2 && !shells_.has_regions() && shells_.cavity_count() == 0)) return;
        const auto faces = faces_of_shells(result_.mesh, shells_);
        for (std::size_t s = 0; s < shells; ++s) {
            const Shell& shell = shells_.shell[s];
            std::string name =
                std::filesystem::path(given_.names[given_.file_of(shell.first_triangle)]).stem().string();
            if (files != shells || result_.mesh.sets.contains(name)) name = "shell_" + std::to_string(s + 1);
            result_.mesh.sets[name].faces = faces[s];
            result_.notes.push_back("set \"" + name + "\": a shell around " + short_text(shell.volume) + " m^3, " +
                                    (shell.cavity ? std::string("an empty cavity")
                                     : result_.mesh.label.empty()
                                         ? std::string("filled")
                                         : "the region with the label " + std::to_string(shell.label)));
        }
        turn_inverted(result_.mesh, given_.names.front());
    }

    void measure() {
        say("measuring the distance of the surfaces");
        const SurfaceMesh filled = without_unused_nodes({result_.mesh.nodes, faces_of_regions(result_.mesh)});
        result_.distance = surface_distance(surface(), filled);
        if (result_.distance.greatest() > result_.tolerance && !result_.exact)
            result_.notes.push_back("the new surface is up to " + short_text(result_.distance.greatest()) +
                                    " m from the given one, more than the tolerance of " +
                                    short_text(result_.tolerance) +
                                    " m: a hole was closed, or a part inside the body was removed");
        if (!result_.surface.can_be_filled()) return;
        Real volume = 0;
        for (const Shell& shell : shells_.shell) {
            const bool within = shell.parent != no_index;
            if (shell.cavity)
                volume -= shell.volume;
            else if (!within || shells_.shell[static_cast<std::size_t>(shell.parent)].cavity)
                volume += shell.volume;
        }
        result_.surface_volume = volume;
    }

    const GivenSurface& given_;
    const FillSettings& settings_;
    MesherSetup setup_;
    Shells shells_;
    FilledMesh result_;
    std::string netgen_failure_;
    bool netgen_missing_ = false;
};

}  // namespace

FilledMesh fill(const SurfaceMesh& surface, const std::string& name, const FillSettings& settings,
                const FillProgress& progress) {
    GivenSurface given;
    given.add(surface, settings.scale, name);
    return Filling(given, settings, progress).run();
}

FilledMesh fill(const std::vector<std::filesystem::path>& files, const FillSettings& settings,
                const FillProgress& progress) {
    if (files.empty()) refuse("surface", {}, "no files", "at least one file of a surface");
    GivenSurface given;
    std::vector<std::string> notes;
    for (const std::filesystem::path& file : files)
        given.add(read_surface(file.string(), &notes), settings.scale, file.string());
    FilledMesh filled = Filling(given, settings, progress).run();
    filled.notes.insert(filled.notes.begin(), notes.begin(), notes.end());
    return filled;
}

}  // namespace skerry::mesh
