#include "engine/fill/mesher_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include "engine/world/complaint.h"

namespace skerry::mesh {

namespace {

constexpr useconds_t poll_interval = 20000;  // [us]
constexpr int exit_not_started = 127;        // exit code of a process that could not start its program
constexpr int output = 3;                    // file descriptor to which the mesher writes

/// Temporary file without a name. The system removes it when this program ends, even after a crash.
using NamelessFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void refuse(const std::string& what) {
    throw std::system_error(errno, std::generic_category(), what);
}

NamelessFile nameless_file() {
    NamelessFile file(std::tmpfile(), std::fclose);
    if (!file) refuse("cannot create a temporary file");
    return file;
}

void write_surface(std::FILE* out, const SurfaceMesh& surface, Real largest_edge) {
    std::fprintf(out, "%zu %zu %.17g\n", surface.nodes.size(), surface.triangles.size(), largest_edge);
    for (const Vec3& x : surface.nodes) std::fprintf(out, "%.17g %.17g %.17g\n", x.x(), x.y(), x.z());
    for (const auto& t : surface.triangles) std::fprintf(out, "%d %d %d\n", t[0], t[1], t[2]);
    if (std::fflush(out) != 0) refuse("cannot write to a temporary file");
    std::rewind(out);
}

/// Reads the text that a mesher wrote. Returns nothing if it is not a mesh of positive tetrahedra.
std::optional<Mesh> read_mesh(std::FILE* in) {
    std::rewind(in);
    std::size_t nodes = 0, tetrahedra = 0;
    Mesh mesh;
    if (std::fscanf(in, "%zu %zu", &nodes, &tetrahedra) != 2 || tetrahedra == 0) return {};
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
    try {
        // A mesher may order all corners for the opposite orientation.
        turn_inverted(mesh, "mesher");
        const MeshReport report = inspect(mesh);
        if (report.inverted + report.flat > 0) return {};
    } catch (const SceneError&) {
        return {};
    }
    return mesh;
}

std::string last_line(std::FILE* in) {
    std::rewind(in);
    std::string line, last;
    for (int c = std::fgetc(in); c != EOF; c = std::fgetc(in)) {
        if (c != '\n') {
            line += static_cast<char>(c);
        } else if (!line.empty()) {
            last = std::exchange(line, {});
        }
    }
    return line.empty() ? last : line;
}

/// A child process. It ends with the object, or with this program, whichever ends first.
class Child {
public:
    Child(const std::vector<std::string>& command, int in, int out, int messages) {
        std::vector<char*> arguments;
        for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
        arguments.push_back(nullptr);
        const pid_t parent = getpid();
        id_ = fork();
        if (id_ < 0) refuse("cannot create a process for " + command.front());
        if (id_ == 0) start(arguments.data(), parent, in, out, messages);
    }
    ~Child() {
        if (id_ == 0) return;
        stop();
        waitpid(id_, nullptr, 0);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Returns the status in the form of waitpid once the process has ended.
    std::optional<int> ended() {
        int status = 0;
        if (waitpid(id_, &status, WNOHANG) == 0) return {};
        id_ = 0;
        return status;
    }
    /// Memory that the process uses [bytes].
    Real memory() const {
        std::ifstream file("/proc/" + std::to_string(id_) + "/statm");
        Real pages = 0, resident = 0;
        file >> pages >> resident;
        return resident * static_cast<Real>(sysconf(_SC_PAGESIZE));
    }

private:
    /// Kills the process and all processes that it started, which belong to its group.
    void stop() const {
        kill(-id_, SIGKILL);
        kill(id_, SIGKILL);
    }

    /// Runs in the new process, and calls only functions that are allowed after fork() in a program with threads.
    [[noreturn]] static void start(char** arguments, pid_t parent, int in, int out, int messages) {
        setpgid(0, 0);
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(exit_not_started);  // the parent ended before the call of prctl
        // The files are first duplicated to high numbers, so that no redirection overwrites another file.
        constexpr int above = 100;
        const int from[] = {fcntl(in, F_DUPFD_CLOEXEC, above), fcntl(out, F_DUPFD_CLOEXEC, above),
                            fcntl(messages, F_DUPFD_CLOEXEC, above), open("/dev/null", O_WRONLY | O_CLOEXEC)};
        const int to[] = {STDIN_FILENO, output, STDERR_FILENO, STDOUT_FILENO};
        for (int i = 0; i < 4; ++i) dup2(from[i], to[i]);
        execvp(arguments[0], arguments);
        _exit(exit_not_started);
    }

    pid_t id_ = 0;
};

MesherResult failed(std::string failure, bool missing = false, bool stopped = false) {
    return {.mesh = {}, .failure = std::move(failure), .missing = missing, .stopped = stopped};
}

}  // namespace

MesherResult run_mesher(const SurfaceMesh& surface, Real largest_edge, const MesherCall& call) {
    const NamelessFile in = nameless_file(), out = nameless_file(), messages = nameless_file();
    write_surface(in.get(), surface, largest_edge);
    Child child(call.command, fileno(in.get()), fileno(out.get()), fileno(messages.get()));
    const auto start = std::chrono::steady_clock::now();
    std::optional<int> status = child.ended();
    for (; !status; status = child.ended()) {
        const std::chrono::duration<Real> elapsed = std::chrono::steady_clock::now() - start;
        if (elapsed.count() > call.limits.seconds)
            return failed("was stopped after the time limit of " + short_text(call.limits.seconds) + " s", false, true);
        if (child.memory() > call.limits.bytes)
            return failed("was stopped because it needed more memory than the limit of " +
                              short_text(call.limits.bytes / 1e9) + " GB",
                          false, true);
        if (call.wait) call.wait();
        usleep(poll_interval);
    }
    const auto with_message = [&](std::string text) {
        const std::string message = last_line(messages.get());
        return message.empty() ? text : text + " (" + message + ")";
    };
    if (WIFSIGNALED(*status)) {
        MesherResult crash = failed(with_message(std::string("crashed: ") + strsignal(WTERMSIG(*status))));
        crash.crashed = true;
        return crash;
    }
    const int code = WEXITSTATUS(*status);
    if (code == exit_not_started || code == exit_missing) return failed(with_message("could not be started"), true);
    if (code != 0) return failed(with_message("found no tetrahedra, exit code " + std::to_string(code)));
    MesherResult result{.mesh = read_mesh(out.get())};
    if (!result.mesh) result.failure = "wrote a file that is not a valid mesh";
    return result;
}

}  // namespace skerry::mesh
