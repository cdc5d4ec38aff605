#include "engine/fill/mesher_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/base/complaint.h"

namespace skerry::mesh {

namespace {

constexpr useconds_t poll_interval = 20000;  // [us]
constexpr int exit_not_started = 127;        // exit code of a process that could not start its program
constexpr int output = 3;                    // file descriptor to which the mesher writes

/// Temporary file without a name. The system removes it when this program ends, even after a crash.
using NamelessFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void refuse_mesher(const std::string& what) {
    throw std::system_error(errno, std::generic_category(), what);
}

NamelessFile nameless_file() {
    NamelessFile file(std::tmpfile(), std::fclose);
    if (!file) refuse_mesher("cannot create a temporary file");
    return file;
}

/// Appends a number to a text. Unlike printf, it does not depend on the locale of the host program.
void append_number(auto number, char end, std::string& text) {
    char digits[32];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr) += end;
}

void write_surface(std::FILE* out, const SurfaceMesh& surface, Real largest_edge) {
    std::string text;
    append_number(surface.nodes.size(), ' ', text);
    append_number(surface.triangles.size(), ' ', text);
    append_number(largest_edge, '\n', text);
    for (const Vec3& x : surface.nodes)
        for (Index a = 0; a < 3; ++a) append_number(x[a], a < 2 ? ' ' : '\n', text);
    for (const auto& t : surface.triangles)
        for (std::size_t a = 0; a < 3; ++a) append_number(t[a], a < 2 ? ' ' : '\n', text);
    if (std::fwrite(text.data(), 1, text.size(), out) < text.size() || std::fflush(out) != 0)
        refuse_mesher("cannot write to a temporary file");
    std::rewind(out);
}

std::string text_of(std::FILE* in) {
    std::rewind(in);
    std::string text;
    char part[4096];
    while (const std::size_t count = std::fread(part, 1, sizeof part, in)) text.append(part, count);
    return text;
}

/// Takes the next number from a text and returns true, or returns false if there is none. Unlike scanf, it does not
/// depend on the locale of the host program.
bool take_number(std::string_view& text, auto& number) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return error == std::errc{};
}

/// Reads the text that a mesher wrote. Returns nothing if the text is not a mesh, or if a tetrahedron stays inverted
/// after turn_inverted().
std::optional<Mesh> read_mesh(std::FILE* in) {
    const std::string all = text_of(in);
    std::string_view text = all;
    std::size_t nodes = 0, tetrahedra = 0;
    Mesh mesh;
    if (!take_number(text, nodes) || !take_number(text, tetrahedra) || tetrahedra == 0) return {};
    for (std::size_t n = 0; n < nodes; ++n) {
        Vec3 x;
        for (Index a = 0; a < 3; ++a)
            if (!take_number(text, x[a])) return {};
        mesh.nodes.push_back(x);
    }
    for (std::size_t e = 0; e < tetrahedra; ++e) {
        std::array<Index, 4> t{};
        for (Index& node : t)
            if (!take_number(text, node)) return {};
        mesh.tetrahedra.push_back(t);
    }
    try {
        // A mesher may order the corners of all tetrahedra for the opposite orientation; turn_inverted() then reorders
        // them.
        turn_inverted(mesh, "mesher");
        if (inspect(mesh).inverted > 0) return {};
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
        if (id_ < 0) refuse_mesher("cannot create a process for " + command.front());
        if (id_ == 0) start(arguments.data(), parent, in, out, messages);
    }
    ~Child() {
        if (id_ == 0) return;
        stop();
        waitpid(id_, nullptr, 0);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Returns nothing while the process runs. Once it has ended, kills the processes that it left behind and returns
    /// its status in the form of waitpid.
    std::optional<int> ended() {
        siginfo_t found{};
        // WNOWAIT keeps the number of the ended process reserved until waitpid. So kill() cannot meet another process
        // group that got the same number.
        if (waitid(P_PID, static_cast<id_t>(id_), &found, WEXITED | WNOHANG | WNOWAIT) == 0 && found.si_pid == 0)
            return {};
        kill(-id_, SIGKILL);
        int status = 0;
        waitpid(id_, &status, 0);
        id_ = 0;
        return status;
    }
    /// Memory that the process and the processes that it started use [bytes].
    Real memory() const { return memory_of(std::to_string(id_)); }

private:
    static Real memory_of(const std::string& process) {
        const std::string folder = "/proc/" + process;
        std::ifstream file(folder + "/statm");
        Real pages = 0, resident = 0;
        file >> pages >> resident;
        Real sum = resident * static_cast<Real>(sysconf(_SC_PAGESIZE));
        std::ifstream children(folder + "/task/" + process + "/children");
        for (std::string child; children >> child;) sum += memory_of(child);
        return sum;
    }

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
        // The file descriptors are first duplicated to numbers from `above` on. Otherwise a call of dup2 could
        // overwrite a descriptor that a later call still needs.
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
