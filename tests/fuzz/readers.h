// All readers of files, callable with arbitrary bytes by the fuzzers and by the replay of found cases.
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

/// Returns if the bytes were read into something valid or refused with SceneError. Everything else is a fault: another
/// exception (which is passed on), a number that is not finite, or an index out of range. The last two end the program,
/// as a sanitizer does.
using ReadBytes = void (*)(FileBytes);

struct FileReaderCase {
    std::string_view name;  // also the name of its folder of found cases
    ReadBytes read;
};
/// gmsh, abaqus, medit, vtk, vtu, obj, ply, stl, tetgen (a .node and a .ele), body (a .vtk that is put into a world),
/// collider (an .obj), scene, problem (FCLIB as bytes of HDF5), problem_values (FCLIB in valid HDF5 files with changed
/// values), saved (World::from_bytes), saved_values (valid saved worlds with changed values, moved by a step).
std::span<const FileReaderCase> all_readers();

/// Ends the program if a value that was read is not valid.
inline void expect_valid(bool good, const char* what) {
    if (good) return;
    std::fprintf(stderr, "read, but not valid: %s\n", what);
    std::abort();
}

// Readers by their names in all_readers.
void read_gmsh_bytes(FileBytes bytes);
void read_abaqus_bytes(FileBytes bytes);
void read_medit_bytes(FileBytes bytes);
void read_vtk_bytes(FileBytes bytes);
void read_vtu_bytes(FileBytes bytes);
void read_obj_bytes(FileBytes bytes);
void read_ply_bytes(FileBytes bytes);
void read_stl_bytes(FileBytes bytes);
/// Reads the .node file, a zero byte and the .ele file. Without a zero byte each file gets half of the bytes.
void read_tetgen_bytes(FileBytes bytes);
void read_body_bytes(FileBytes bytes);
void read_collider_bytes(FileBytes bytes);
void read_scene_bytes(FileBytes bytes);
void read_problem_bytes(FileBytes bytes);
/// Reads a sample problem after changes that the bytes encode, four bytes for each change.
void read_problem_values_bytes(FileBytes bytes);

void read_saved_bytes(FileBytes bytes);
/// Reads a saved world after changes that the bytes encode, five bytes for each change.
void read_saved_values_bytes(FileBytes bytes);

std::string sample_saved_world();
/// A local and a global problem in HDF5 files, the start of read_problem_values_bytes.
std::vector<std::string> sample_problems();

}  // namespace skerry::test
