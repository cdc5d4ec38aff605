// Run-time check of accesses to columns. If SKERRY_CHECK_ACCESS is defined (debug and sanitizer builds), every access
// to a column is compared with the accesses that the running stage has declared. Otherwise the check compiles to
// nothing.
#pragma once

#include <cstddef>

namespace skerry {

#ifdef SKERRY_CHECK_ACCESS
inline constexpr bool access_is_checked = true;
#else
inline constexpr bool access_is_checked = false;
#endif

/// Interface that checks accesses to columns. While an AccessScope exists on a thread, each access of this thread to a
/// column calls touched(), which throws if the access is not allowed. `column`: address of the Column or of one of its
/// members. `bytes`: size of the object at this address.
class AccessWatch {
public:
    virtual void touched(const void* column, std::size_t bytes, bool writes) const = 0;

protected:
    ~AccessWatch() = default;
};

#ifdef SKERRY_CHECK_ACCESS

namespace access_detail {
inline constinit thread_local const AccessWatch* watch_of_thread = nullptr;
}

inline const AccessWatch* current_access_watch() {
    return access_detail::watch_of_thread;
}

inline void check_access(const void* column, std::size_t bytes, bool writes) {
    if (const AccessWatch* watch = access_detail::watch_of_thread) watch->touched(column, bytes, writes);
}

/// Sets the AccessWatch of this thread to `watch` until the end of the scope, then restores the previous one. If
/// `watch` is null, every access is allowed. Scopes can be nested, because a thread that waits inside one stage may
/// meanwhile run another stage.
class AccessScope {
public:
    explicit AccessScope(const AccessWatch* watch) : before_(access_detail::watch_of_thread) {
        access_detail::watch_of_thread = watch;
    }
    ~AccessScope() { access_detail::watch_of_thread = before_; }
    AccessScope(const AccessScope&) = delete;
    AccessScope& operator=(const AccessScope&) = delete;

private:
    const AccessWatch* before_;
};

/// Member of Column that reports copies and moves of the column to the AccessWatch of the thread. If the access is not
/// allowed, AccessWatch::touched() throws. A copy passes the exception on; a move is noexcept, so the program
/// terminates with a message.
class CopyCheck {
public:
    CopyCheck() = default;
    CopyCheck(const CopyCheck& other) { other.report(false); }
    CopyCheck(CopyCheck&& other) noexcept { other.report(true); }
    CopyCheck& operator=(const CopyCheck& other) {
        other.report(false);
        report(true);
        return *this;
    }
    CopyCheck& operator=(CopyCheck&& other) noexcept {
        other.report(true);
        report(true);
        return *this;
    }
    ~CopyCheck() = default;

private:
    void report(bool writes) const { check_access(this, 1, writes); }
};

#else

constexpr const AccessWatch* current_access_watch() {
    return nullptr;
}
constexpr void check_access(const void*, std::size_t, bool) {}

class AccessScope {
public:
    constexpr explicit AccessScope(const AccessWatch*) {}
};

class CopyCheck {};

#endif

}  // namespace skerry
