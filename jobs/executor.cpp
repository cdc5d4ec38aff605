#include "jobs/executor.h"

#include <array>
#include <stdexcept>
#include <string>

#include "jobs/backends.h"

namespace skerry {

namespace {

// The build system defines SKERRY_BACKEND_LIST, with a comma after each name.
constexpr std::array built_backends{SKERRY_BACKEND_LIST Backend::serial};

}  // namespace

std::unique_ptr<Executor> make_executor(Backend backend, int workers) {
    if (workers < 0)
        throw std::invalid_argument("number of workers: found " + std::to_string(workers) +
                                    ", expected an integer >= 0");
    switch (backend) {
        case Backend::automatic:
            return make_executor(built_backends.front(), workers);
#ifdef SKERRY_HAS_TBB
        case Backend::tbb:
            return make_tbb_executor(workers);
#endif
#ifdef SKERRY_HAS_OPENMP
        case Backend::openmp:
            return make_openmp_executor(workers);
#endif
#ifdef SKERRY_HAS_THREADS
        case Backend::threads:
            return make_threads_executor(workers);
#endif
        case Backend::serial:
            return make_serial_executor();
        default:
            break;
    }
    std::string message = "this build lacks the backend " + std::string(name_of(backend)) + "; use one of:";
    for (Backend built : built_backends) message += " " + std::string(name_of(built));
    throw std::invalid_argument(message);
}

std::span<const Backend> available_backends() {
    return built_backends;
}

}  // namespace skerry
