#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "components/hash.h"
#include "engine/fill/meshers.h"
#include "skerry/error.h"
#include "skerry/fill.h"

namespace skerry::mesh {

namespace {

// Version of fill(). It is part of the hash in the name of a cache file, so a new version does not find files of an
// older one. Increase it when a change of the code lets fill() return other meshes.
constexpr std::uint64_t cache_version = 2;

/// Name of the cache file: the name of the surface file, a hash, and .msh.
std::filesystem::path cache_file(const std::filesystem::path& file, const SurfaceMesh& surface,
                                 const FillSettings& settings, bool has_netgen) {
    Hash hash;
    hash.add(cache_version);
    // A format may divide the surface among several files, so the hash covers the arrays and not the named file.
    hash.add(surface.nodes.size());
    for (const Vec3& node : surface.nodes) hash.add(node.data(), sizeof(Real) * 3);
    hash.add(std::span<const std::array<Index, 3>>(surface.triangles));
    const Real numbers[] = {settings.edge.value_or(0), settings.tolerance, settings.cavities ? 1.0 : 0.0,
                            has_netgen ? 1.0 : 0.0};
    hash.add(std::span<const Real>(numbers));
    char text[32];
    std::snprintf(text, sizeof text, ".%016llx.msh", static_cast<unsigned long long>(hash.value()));
    return file.string() + text;
}

/// Lock on a file, which other processes wait for. The system releases it when this process ends.
class FileLock {
public:
    explicit FileLock(const std::filesystem::path& file) : descriptor_(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (descriptor_ >= 0) flock(descriptor_, LOCK_EX);
    }
    ~FileLock() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    int descriptor_;
};

/// Name of the text file with the notes of the filling, one in each line.
std::filesystem::path notes_file(std::filesystem::path cache) {
    return cache.replace_extension(".txt");
}

std::vector<std::string> read_notes(const std::filesystem::path& cache) {
    std::ifstream in(notes_file(cache));
    std::vector<std::string> notes;
    for (std::string line; std::getline(in, line);) notes.push_back(line);
    return notes;
}

/// Writes the notes, then the mesh, so that a mesh is never without its notes. Returns false if a file cannot be
/// written.
bool write_cache(const std::filesystem::path& cache, const FilledMesh& filled) {
    const std::filesystem::path beside = notes_file(cache);
    std::error_code failure;
    std::filesystem::remove(beside, failure);
    if (failure) return false;
    if (!filled.notes.empty()) {
        std::ofstream out(beside);
        for (std::string note : filled.notes) {
            std::ranges::replace(note, '\n', ' ');
            out << note << '\n';
        }
        if (!out.flush()) return false;
    }
    try {
        write(cache.string(), filled.mesh);
    } catch (const SceneError&) {
        return false;  // the folder may be read-only
    }
    return true;
}

}  // namespace

Mesh fill_cached(const std::filesystem::path& file, const FillSettings& settings, const FillProgress& progress,
                 std::vector<std::string>* notes) {
    // If several processes need the mesh, such as the cases of a parameter study, only one fills the surface. The
    // others wait here and then read the cache file.
    const FileLock lock(file);
    const auto note = [&](const std::string& text) {
        if (notes) notes->push_back(file.string() + ": " + text);
    };
    SurfaceMesh surface = read_surface(file.string(), notes);
    for (Vec3& node : surface.nodes) node *= settings.scale;
    const bool has_netgen = !netgen_program().empty();
    const std::filesystem::path cache = cache_file(file, surface, settings, has_netgen);
    if (std::filesystem::exists(cache)) try {
            Mesh mesh = read(cache.string());
            // A mesh without labels is written with the label 1 everywhere.
            if (std::ranges::all_of(mesh.label, [](int label) { return label == 1; })) mesh.label.clear();
            std::ranges::for_each(read_notes(cache), note);
            return mesh;
        } catch (const SceneError&) {
            // A damaged file is replaced below.
        }
    FillSettings of_cache = settings;
    of_cache.material = {};
    of_cache.scale = 1;
    FilledMesh filled = fill(surface, file.string(), of_cache, progress);
    std::ranges::for_each(filled.notes, note);
    if (filled.may_change && has_netgen)
        note(
            "the mesh was not stored, because Netgen did not start, crashed or reached a limit; every run fills the "
            "surface again");
    else if (!write_cache(cache, filled))
        note("the mesh could not be stored, because " + cache.string() +
             " cannot be written; every run fills the surface again");
    return std::move(filled.mesh);
}

}  // namespace skerry::mesh
