#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include "components/hash.h"
#include "skerry/error.h"
#include "skerry/fill.h"

namespace skerry::mesh {

namespace {

// A change of this number makes earlier cache files unused. Raise it when fill() returns other meshes than before.
constexpr std::uint64_t cache_version = 2;

/// Name of the cache file: the name of the surface file, a hash, and .msh.
std::filesystem::path cache_file(const std::filesystem::path& file, const SurfaceMesh& surface,
                                 const FillSettings& settings) {
    Hash hash;
    hash.add(cache_version);
    // A format may divide the surface among several files, so the hash covers the arrays and not the named file.
    hash.add(surface.nodes.size());
    for (const Vec3& node : surface.nodes) hash.add(node.data(), sizeof(Real) * 3);
    hash.add(std::span<const std::array<Index, 3>>(surface.triangles));
    const Real numbers[] = {settings.edge.value_or(0), settings.tolerance, settings.cavities ? 1.0 : 0.0};
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

}  // namespace

Mesh fill_cached(const std::filesystem::path& file, const FillSettings& settings, const FillProgress& progress,
                 std::vector<std::string>* notes) {
    // Only one case of a sweep fills the surface. The other cases wait for it and then read the cache file.
    const FileLock lock(file);
    const SurfaceMesh surface = read_surface(file.string(), notes);
    const std::filesystem::path cache = cache_file(file, surface, settings);
    if (std::filesystem::exists(cache)) try {
            Mesh mesh = read(cache.string());
            // A mesh without labels is written with the label 1 everywhere.
            if (std::ranges::all_of(mesh.label, [](int label) { return label == 1; })) mesh.label.clear();
            return mesh;
        } catch (const SceneError&) {
            // A damaged file is replaced below.
        }
    FillSettings of_cache = settings;
    of_cache.material = {};
    FilledMesh filled = fill(surface, file.string(), of_cache, progress);
    if (notes)
        for (const std::string& note : filled.notes) notes->push_back(file.string() + ": " + note);
    try {
        write(cache.string(), filled.mesh);
    } catch (const SceneError&) {
        // The folder may be read-only.
    }
    return std::move(filled.mesh);
}

}  // namespace skerry::mesh
