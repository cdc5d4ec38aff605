// Run-time check of column accesses. With SKERRY_CHECK_ACCESS (debug and sanitizer builds) every access to a column is
// checked against the declarations of the running stage; without it the check costs nothing.
#pragma once

#include <cstddef>

namespace skerry {

#ifdef SKERRY_CHECK_ACCESS
inline constexpr bool access_is_checked = true;
#else
inline constexpr bool access_is_checked = false;
#endif

/// Is notified of every access to a column while a thread works under it. Throws if the access is not allowed.
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

/// Sets the watch of this thread to `watch` until the end of the scope, then restores the previous one. Null allows
/// every access. Scopes nest, because a thread that waits inside one stage may meanwhile work for another.
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

/// A member that reports copies and moves of its owner as accesses. A forbidden move terminates the program with a
/// message, because a move must not throw.
class CopyCheck {
public:
    CopyCheck() = default;
    CopyCheck(const CopyCheck& other) { other.note(false); }
    CopyCheck(CopyCheck&& other) noexcept { other.note(true); }
    CopyCheck& operator=(const CopyCheck& other) {
        other.note(false);
        note(true);
        return *this;
    }
    CopyCheck& operator=(CopyCheck&& other) noexcept {
        other.note(true);
        note(true);
        return *this;
    }
    ~CopyCheck() = default;

private:
    void note(bool writes) const { check_access(this, 1, writes); }
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
