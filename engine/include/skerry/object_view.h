// The part that the views of joints, ties, cables, cavities, fibres, loads, springs and surface sets have in common.
#pragma once

#include <string>
#include <vector>

#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// A view of all objects of one kind of a world. It is valid until the world is moved or destroyed. The objects belong
/// to the state of the world: they are saved, cloned and hashed. If a body or collider is removed, the objects that
/// name it are removed, too.
///
/// Functions that change something may only be called between calls of advance. They throw SceneError and change
/// nothing if a handle is stale or a value is out of range.
///
/// The header of each view has an `extern template` declaration for its kind, with the attribute that makes the shared
/// library export the functions.
template <class HandleType>
class ObjectView {
public:
    /// `world` must exist as long as the view.
    explicit ObjectView(World& world) : world_(&world) {}

    /// Removes an object, and wakes its bodies.
    void remove(HandleType object);
    /// True if the object is in the world, false if it was removed.
    bool alive(HandleType object) const;
    std::vector<HandleType> all() const;  // handles in the order added
    /// Name of an object for users and files. Default: its kind and a number, such as "cable_0". Names do not affect
    /// steps.
    std::string name(HandleType object) const;
    /// Sets the name of an object. Names need not differ, but find() needs a name that occurs once.
    void set_name(HandleType object, const std::string& name);
    /// Returns the object with this name. Throws SceneError if there is none, or more than one.
    HandleType find(const std::string& name) const;

protected:
    World* world_;  // the viewed world
};

}  // namespace skerry
#pragma GCC visibility pop
