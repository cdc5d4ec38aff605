// SKERRY_CHECK: a cheap check of a precondition that the caller must meet. The check is enabled unless SKERRY_NO_CHECKS
// is defined (the release preset defines it).
#pragma once

#include <stdexcept>
#include <string>

namespace skerry {

/// Thrown when one part of the engine violates a precondition of another part. This is always a bug in the engine,
/// never an error in the input.
class CheckFailed : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

[[noreturn]] inline void check_failed(const char* condition, const char* file, int line) {
    throw CheckFailed(std::string(file) + ":" + std::to_string(line) + ": check failed: " + condition);
}

}  // namespace skerry

#ifdef SKERRY_NO_CHECKS
#define SKERRY_CHECK(condition) ((void)0)
#else
#define SKERRY_CHECK(condition) ((condition) ? (void)0 : ::skerry::check_failed(#condition, __FILE__, __LINE__))
#endif
