#include "readers.h"

#include <array>

namespace skerry::test {

std::span<const FileReaderCase> all_readers() {
    static constexpr std::array<FileReaderCase, 16> readers{{{"gmsh", read_gmsh_bytes},
                                                             {"abaqus", read_abaqus_bytes},
                                                             {"medit", read_medit_bytes},
                                                             {"vtk", read_vtk_bytes},
                                                             {"vtu", read_vtu_bytes},
                                                             {"obj", read_obj_bytes},
                                                             {"ply", read_ply_bytes},
                                                             {"stl", read_stl_bytes},
                                                             {"tetgen", read_tetgen_bytes},
                                                             {"body", read_body_bytes},
                                                             {"collider", read_collider_bytes},
                                                             {"scene", read_scene_bytes},
                                                             {"problem", read_problem_bytes},
                                                             {"problem_values", read_problem_values_bytes},
                                                             {"saved", read_saved_bytes},
                                                             {"saved_values", read_saved_values_bytes}}};
    return readers;
}

}  // namespace skerry::test
