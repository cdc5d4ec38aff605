// Every reader of files, fed with any bytes: what fuzzers call and what the replay of found cases calls.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skerry::test {

using FileBytes = std::span<const std::uint8_t>;

/// Returns when the bytes were read into something valid, or refused with SceneError. Everything else is a fault:
/// another exception (which goes on), a number that is not finite, an index out of range (both end the program, as a
/// sanitizer does).
using ReadBytes = void (*)(FileBytes);

struct FileReaderCase {
    std::string_view name;  // also of its folder of found cases
    ReadBytes read;
};
/// gmsh, vtk, obj, stl, tetgen (a .node and a .ele), body (a .vtk that is put into a world), collider (an .obj), scene,
/// problem (FCLIB as bytes of HDF5), problem_values (FCLIB in whole HDF5 files, so that what stands in them is
/// reached), saved (World::load), saved_values (saved worlds that are whole, with any values in them, moved by a step).
std::span<const FileReaderCase> all_readers();

/// Ends the program when something that was read is not valid.
inline void expect_valid(bool good, const char* what) {
    if (good) return;
    std::fprintf(stderr, "read, but not valid: %s\n", what);
    std::abort();
}

// By the name in all_readers.
void read_gmsh_bytes(FileBytes bytes);
void read_vtk_bytes(FileBytes bytes);
void read_obj_bytes(FileBytes bytes);
void read_stl_bytes(FileBytes bytes);
/// The .node file, a byte 0, the .ele file. Without a byte 0 the half of the bytes is taken for each.
void read_tetgen_bytes(FileBytes bytes);
void read_body_bytes(FileBytes bytes);
void read_collider_bytes(FileBytes bytes);
void read_scene_bytes(FileBytes bytes);
void read_problem_bytes(FileBytes bytes);
/// A sample problem, changed as the bytes say, four for each change.
void read_problem_values_bytes(FileBytes bytes);

void read_saved_bytes(FileBytes bytes);
/// A saved world, changed as the bytes say, five for each change.
void read_saved_values_bytes(FileBytes bytes);

std::string sample_saved_world();
/// A local and a global problem in HDF5 files, as read_problem_values starts from.
std::vector<std::string> sample_problems();

}  // namespace skerry::test
