#include "engine/program/fill_surface.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "skerry/error.h"

extern char** environ;

namespace skerry {

namespace {

constexpr useconds_t poll_interval = 20000;  // [us]

/// Temporary file without a name. The system removes it when this program ends, even after a crash.
using NamelessFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

NamelessFile nameless_file() {
    NamelessFile file(std::tmpfile(), std::fclose);
    if (!file) throw std::runtime_error("cannot create a temporary file: " + std::generic_category().message(errno));
    return file;
}

/// Path of skerry-fill, which is in the same folder as this program, both after a build and after an installation.
std::filesystem::path fill_program() {
    std::error_code ignored;
    return std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / "skerry-fill";
}

void write_surface(std::FILE* out, const SurfaceMesh& surface, Real largest_edge) {
    std::fprintf(out, "%zu %zu %.17g\n", surface.nodes.size(), surface.triangles.size(), largest_edge);
    for (const Vec3& x : surface.nodes) std::fprintf(out, "%.17g %.17g %.17g\n", x.x(), x.y(), x.z());
    for (const auto& t : surface.triangles) std::fprintf(out, "%d %d %d\n", t[0], t[1], t[2]);
    if (std::fflush(out) != 0)
        throw std::runtime_error("cannot write to a temporary file; free space in the folder for temporary files");
    std::rewind(out);
}

Mesh read_mesh(std::FILE* in) {
    std::rewind(in);
    std::size_t nodes = 0, tetrahedra = 0;
    Mesh mesh;
    if (std::fscanf(in, "%zu %zu", &nodes, &tetrahedra) != 2) return {};
    for (std::size_t n = 0; n < nodes; ++n) {
        Vec3 x;
        if (std::fscanf(in, "%lf %lf %lf", &x[0], &x[1], &x[2]) != 3) return {};
        mesh.nodes.push_back(x);
    }
    for (std::size_t e = 0; e < tetrahedra; ++e) {
        std::array<Index, 4> t{};
        if (std::fscanf(in, "%d %d %d %d", &t[0], &t[1], &t[2], &t[3]) != 4) return {};
        mesh.tetrahedra.push_back(t);
    }
    return mesh;
}

/// File redirection for a child process: its standard input, its file descriptor 3 and its messages.
struct FileActions {
    posix_spawn_file_actions_t actions;

    FileActions(int in, int out) {
        posix_spawn_file_actions_init(&actions);
        // The descriptors are first duplicated to high numbers. Without this the first redirection could overwrite the
        // second file, if that file has the number 0 or 3.
        posix_spawn_file_actions_adddup2(&actions, in, 100);
        posix_spawn_file_actions_adddup2(&actions, out, 101);
        posix_spawn_file_actions_adddup2(&actions, 100, STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, 101, 3);
        posix_spawn_file_actions_addclose(&actions, 100);
        posix_spawn_file_actions_addclose(&actions, 101);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    }
    ~FileActions() { posix_spawn_file_actions_destroy(&actions); }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
};

/// Runs skerry-fill and returns its status in the form of waitpid. Calls `wait` until the process ends.
int run_fill(std::FILE* in, std::FILE* out, const std::function<void()>& wait) {
    const std::string program = fill_program().string();
    char* arguments[] = {const_cast<char*>(program.c_str()), nullptr};
    FileActions files(fileno(in), fileno(out));
    pid_t child = 0;
    if (const int error = posix_spawn(&child, program.c_str(), &files.actions, nullptr, arguments, environ); error != 0)
        throw std::runtime_error(program + " cannot be started: " + std::generic_category().message(error));
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        wait();
        usleep(poll_interval);
    }
    return status;
}

}  // namespace

void require_fill() {
    if (access(fill_program().c_str(), X_OK) == 0) return;
    Complaint{
        .file = fill_program().string(),
        .object = "mesh repair",
        .field = {},
        .found = "no executable program at this path",
        .expected = "the program skerry-fill in the folder of skerry, which is built if Netgen's library is installed",
        .hint = "install Netgen's library (apt-get install libnglib-dev), then configure and build Skerry again"}
        .raise();
}

Mesh fill_surface(const SurfaceMesh& surface, Real largest_edge, const std::function<void()>& wait) {
    const NamelessFile in = nameless_file(), out = nameless_file();
    write_surface(in.get(), surface, largest_edge);
    const int status = run_fill(in.get(), out.get(), wait);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return {};
    Mesh mesh = read_mesh(out.get());
    // Netgen orders the corners of a tetrahedron for the opposite orientation.
    if (!mesh.tetrahedra.empty() && inspect(mesh).volume < 0)
        for (auto& t : mesh.tetrahedra) std::swap(t[2], t[3]);
    return mesh;
}

}  // namespace skerry
