// Errors that only one rank has.
#pragma once

#include <cstdlib>
#include <exception>
#include <new>

#include "jobs/ranks/ranks.h"
#include "skerry/error.h"

namespace skerry {

/// Calls act(), which all ranks do together. An error that only this rank has, for example because it runs out of
/// memory, ends all ranks: the others would wait for this rank forever, and its state may be half changed. A SceneError
/// occurs on all ranks alike and is passed on. `ranks`: null if this process is alone.
void act_together(Ranks* ranks, auto&& act) {
    if (ranks == nullptr) return act();
    try {
        act();
    } catch (const SceneError&) {
        throw;
    } catch (const std::bad_alloc&) {
        ranks->abort("found too little memory, expected enough for the bodies of this rank (use more machines)",
                     EXIT_FAILURE);
    } catch (const std::exception& error) {
        ranks->abort(error.what(), EXIT_FAILURE);
    }
}

}  // namespace skerry
