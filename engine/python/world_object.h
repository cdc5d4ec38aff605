// A world as Python holds it, and the rule that only one thread at a time may use it.
#pragma once

#include <atomic>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/python/bind.h"
#include "skerry/world.h"

namespace skerry::python {

/// A world with a record of the thread that uses it at present and of the NumPy arrays that show its memory.
struct WorldObject {
    World world;
    std::atomic<unsigned long> user{0};  // PyThread_get_thread_ident() of the thread inside a call; 0: none
    int depth = 0;                       // number of nested calls of the thread `user`; 1 in an outermost call
    std::vector<BodyHandle> views{};     // for each living NumPy array that shows memory of the world: its body

    explicit WorldObject(World&& from);
    /// In a process made by fork(), the threads of the world do not exist. The world is then left in memory, because
    /// its destructor would wait for them.
    ~WorldObject();
};

/// Marks a world as in use by this thread until the end of the scope. Raises skerry.BusyError if another thread uses
/// the world. Raises RuntimeError if this process was forked after a world had started threads.
class Use {
public:
    explicit Use(WorldObject& object) : object_(object) {
        require_threads();
        const unsigned long self = PyThread_get_thread_ident();
        unsigned long none = 0;
        if (object.user.load() != self && !object.user.compare_exchange_strong(none, self)) raise_busy();
        ++object.depth;
    }
    ~Use() {
        if (--object_.depth == 0) object_.user.store(0);
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

    /// Raises RuntimeError if fork() has left this process without the threads of its worlds.
    static void require_threads() {
        if (threads_lost) raise_threads_lost();
    }
    /// Called when a world starts or may start threads. A later fork() would lose these threads.
    static void note_threads() { threads_started = true; }
    /// Called in a new process after fork().
    static void note_fork() { threads_lost = threads_started; }
    static bool lost_threads() { return threads_lost; }

private:
    [[noreturn]] static void raise_busy();
    [[noreturn]] static void raise_threads_lost();

    // threads_started: a world of this process may have started threads. threads_lost: fork() has left this process
    // without them. Changed only with the GIL held.
    static inline bool threads_started = false, threads_lost = false;

    WorldObject& object_;
};

/// Raises BufferError if arrays show memory of the world, because the call `action` could move this memory. The message
/// names the bodies and the number of arrays of each.
void require_no_views(const WorldObject& object, const char* action);

template <class Result, class... Arguments>
auto guarded_as(Result (*function)(World&, Arguments...)) {
    return [function](WorldObject& object, Arguments... arguments) -> Result {
        Use use(object);
        return function(object.world, std::forward<Arguments>(arguments)...);
    };
}
/// Converts a function of World, such as [](World& world, ...) {...}, to a method of WorldObject that marks the world
/// as in use (class Use).
template <class Function>
auto guarded(Function function) {
    return guarded_as(+function);
}

}  // namespace skerry::python
