// Who may touch a column. With SKERRY_CHECK_ACCESS (debug and sanitizer builds) every column asks the thread that
// touches it; without it nothing of this costs anything.
#pragma once

#include <cstddef>

namespace skerry {

#ifdef SKERRY_CHECK_ACCESS
inline constexpr bool access_is_checked = true;
#else
inline constexpr bool access_is_checked = false;
#endif

/// Hears of every touch of a column while a thread works under it, and throws where it must not be.
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

/// The thread works under `watch` (none: whatever it likes) until the end of the scope, then as before: who waits in
/// one stage may meanwhile work for another.
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

/// A member that tells of copies and moves of what it lies in. A move that must not be ends the program, with a
/// message: it may not throw.
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
