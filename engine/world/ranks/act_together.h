// Errors that occur on only one of the ranks (processes that simulate one world together).
#pragma once

#include <cstdlib>
#include <exception>
#include <new>

#include "jobs/ranks/ranks.h"
#include "skerry/error.h"

namespace skerry {

/// Calls act(), a function that all ranks run together. An error on this rank only, for example lack of memory, ends
/// all ranks, because the others would wait forever. A SceneError occurs on all ranks alike and is passed on. `ranks`:
/// null if this process is alone.
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
