// A world as Python holds it, and the rule that only one thread at a time may use it.
#pragma once

#include <atomic>
#include <type_traits>
#include <utility>

#include "engine/python/bind.h"
#include "skerry/joint.h"
#include "skerry/world.h"

namespace skerry::python {

/// A world, the thread that uses it at present, and the number of arrays that show its memory.
struct WorldObject {
    World world;
    std::atomic<unsigned long> user{0};  // number of the thread that is inside a call; 0 if none is
    int depth = 0;                       // number of nested calls of this thread
    int views = 0;                       // number of living arrays that show memory of the world

    explicit WorldObject(World&& from) : world(std::move(from)) {}
};

/// Marks a world as in use by this thread until the end of the scope. If another thread uses the world, raises
/// skerry.BusyError.
class Use {
public:
    explicit Use(WorldObject& object) : object_(object) {
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

private:
    [[noreturn]] static void raise_busy();

    WorldObject& object_;
};

/// Raises BufferError if arrays show memory of the world, which `action` would move.
void require_no_views(const WorldObject& object, const char* action);

template <class Result, class... Arguments>
auto guarded_as(Result (*function)(World&, Arguments...)) {
    return [function](WorldObject& object, Arguments... arguments) -> Result {
        Use use(object);
        return function(object.world, std::forward<Arguments>(arguments)...);
    };
}
/// Makes a method of WorldObject of a function of World: guarded([](World& world, ...) {...}).
template <class Function>
auto guarded(Function function) {
    return guarded_as(+function);
}

}  // namespace skerry::python
