// Damaged files: truncated, or with changed bytes. They load or are refused; nothing else may happen.
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>
#include <random>

#include "mesh_samples.h"
#include "skerry/error.h"

namespace {
std::atomic<std::size_t> largest_request{0};  // since the last reset to 0 [bytes]

void* counted(std::size_t size) {
    if (size > largest_request) largest_request = size;
    if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
    throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
    return counted(size);
}
void* operator new[](std::size_t size) {
    return counted(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return std::malloc(size > 0 ? size : 1);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
    return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace skerry::test::mesh_fuzz_test {

namespace {

Mesh small_mesh() {
    Mesh mesh = mesh::box({0.1, 0.2, 0.3}, {1, 1, 1});
    mesh.label = {1, 1, 2, 2, -3, -3};
    return mesh;
}

/// Returns the name under which the damaged file is to be written. Also writes an intact .node and .ele of that name,
/// because these two are read together.
std::string write_partners(const TemporaryFolder& folder, const SampleFile& file) {
    const int first_number = file.name.starts_with("one") ? 1 : 0;
    folder.write("hit.node", node_file(small_mesh(), first_number));
    folder.write("hit.ele", ele_file(small_mesh(), first_number));
    return "hit" + file.name.substr(file.name.find('.'));
}

/// Reads a damaged file. Returns true if it loads, false after SceneError; no other exception may occur.
bool loads(const std::string& path, std::size_t size) {
    largest_request = 0;
    bool loaded = false;
    try {
        const SurfaceMesh surface = mesh::read_surface(path);
        for (const std::array<Index, 3>& t : surface.triangles)
            for (const Index n : t) REQUIRE((n >= 0 && static_cast<std::size_t>(n) < surface.nodes.size()));
        for (const Vec3& x : surface.nodes) REQUIRE(x.allFinite());
        loaded = true;
    } catch (const SceneError& error) {
        REQUIRE(std::string(error.what()).size() > path.size());
    }
    // The rows that a file's bytes can hold limit the memory that it may request: 24 bytes of position for 3 bytes of
    // text, and the faces of a tetrahedron.
    REQUIRE(largest_request <= 64 * size + 65536);
    return loaded;
}

}  // namespace

TEST_CASE("a file cut anywhere loads or is refused", "[unit]") {
    const TemporaryFolder folder;
    for (const SampleFile& file : all_sample_files(small_mesh())) {
        INFO(file.name);
        const std::string name = write_partners(folder, file);
        CHECK(loads(folder.write(name, file.content), file.content.size()));
        std::size_t loaded = 0, cuts = 0;
        for (std::size_t length = 0; length < file.content.size(); length += 1 + length / 200) {
            loaded += loads(folder.write(name, file.content.substr(0, length)), file.content.size());
            ++cuts;
        }
        CHECK(loaded < cuts);
    }
}

TEST_CASE("a file with changed bytes loads or is refused", "[unit]") {
    const TemporaryFolder folder;
    std::mt19937 random(12345);
    for (const SampleFile& file : all_sample_files(small_mesh())) {
        INFO(file.name << ", seed 12345");
        const std::string name = write_partners(folder, file);
        for (int round = 0; round < 200; ++round) {
            std::string content = file.content;
            const int hits = 1 + static_cast<int>(random() % 4);
            for (int h = 0; h < hits; ++h) {
                const std::size_t at = random() % content.size();
                // Every other time a digit or sign: these survive the parser and reach the later checks.
                content[at] = round % 2 == 0 ? static_cast<char>(random() % 256) : "0123456789-. \n\xff"[random() % 15];
            }
            loads(folder.write(name, content), content.size());
        }
    }
}

}  // namespace skerry::test::mesh_fuzz_test
