#include "engine/scene/place_scene.h"

#include <Eigen/Geometry>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene_plan.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

/// Moves the entries of an included scene, and puts the name of the include in front of all names.
class Placing {
public:
    explicit Placing(const IncludeEntry& include)
        : include_(include), rotation_(rotation_matrix(include.rotation.value)) {}

    void place(SceneFile& scene) const {
        for (auto& [name, material] : scene.materials.items) rename(name);
        for (PairEntry& pair : scene.pairs)
            for (std::string& material : pair.materials) rename(material);
        name_and_prefix(scene.bodies, "body_");
        name_and_prefix(scene.colliders, "collider_");
        name_and_prefix(scene.joints, "joint_");
        name_and_prefix(scene.ties, "tie_");
        name_and_prefix(scene.cables, "cable_");
        name_and_prefix(scene.cavities, "cavity_");
        name_and_prefix(scene.springs, "spring_");
        name_and_prefix(scene.pipes, "pipe_");
        name_and_prefix(scene.loads, "load_");
        name_and_prefix(scene.fibres, "fibres_");
        for (BodyEntry& body : scene.bodies) place(body);
        for (ColliderEntry& collider : scene.colliders) place(collider);
        for (NoCollisionEntry& pair : scene.no_collision) {
            rename(pair.body);
            rename(pair.to_body);
            rename(pair.to_collider);
        }
        for (JointEntry& joint : scene.joints) {
            rename(joint.first);
            rename(joint.second);
            if (joint.mimic) rename(joint.mimic->joint);
            move(joint.point);
            turn(joint.axis);
        }
        for (TieEntry& tie : scene.ties) {
            rename(tie.body);
            rename(tie.to_body);
            rename(tie.to_collider);
        }
        for (CableEntry& cable : scene.cables)
            for (AnchorEntry& point : cable.points) place(point);
        for (CavityEntry& cavity : scene.cavities) rename(cavity.body);
        for (PipeEntry& pipe : scene.pipes) {
            rename(pipe.first);
            rename(pipe.second);
        }
        for (FibreEntry& fibres : scene.fibres) rename(fibres.body);
        for (LoadEntry& load : scene.loads) place(load);
        for (SpringEntry& spring : scene.springs) {
            place(spring.first);
            place(spring.second);
        }
        for (ProbeEntry& probe : scene.probes) {
            probe.name = include_.name + "_" + probe.name;  // names of probes must not contain "/"
            for (std::optional<std::string>* name : {&probe.body, &probe.collider, &probe.by, &probe.joint,
                                                     &probe.cable, &probe.cavity, &probe.spring, &probe.tie})
                rename(*name);
        }
        for (SliderEntry& slider : scene.sliders) place(slider);
    }

private:
    void rename(std::string& name) const { name = include_.name + "/" + name; }
    void rename(std::optional<std::string>& name) const {
        if (name) rename(*name);
    }
    /// Gives unnamed entries their default names, and then puts the name of the include in front of all names.
    template <class Entry>
    void name_and_prefix(std::vector<Entry>& entries, const char* kind) const {
        for (std::size_t i = 0; i < entries.size(); ++i) {
            if (entries[i].name.empty()) entries[i].name = kind + std::to_string(i);
            rename(entries[i].name);
        }
    }

    void move(Vec3& point) const { point = include_.position + rotation_ * point; }
    void turn(Vec3& direction) const { direction = rotation_ * direction; }
    void turn(std::optional<Vec3>& direction) const {
        if (direction) turn(*direction);
    }
    void turn(Rotation& rotation) const {
        rotation.value = rotation_vector(rotation_ * rotation_matrix(rotation.value));
    }

    void place(MotionEntry& motion) const {
        turn(motion.velocity);
        turn(motion.angular_velocity);
        for (KeyEntry& key : motion.keys) {
            move(key.position);
            turn(key.rotation);
        }
    }
    void place(BodyEntry& body) const {
        rename(body.material);
        for (auto& [part, material] : body.materials.items) rename(material);
        if (body.repeat) {
            body.positions = positions_of(body);
            body.repeat.reset();
        }
        for (Vec3& position : body.positions) move(position);
        move(body.position);
        turn(body.rotation);
        turn(body.velocity);
        turn(body.angular_velocity);
        for (PinEntry& pin : body.pin.items) {
            if (pin.axes && !include_.rotation.value.isZero(0))
                pin.place.key("axes").refuse("axes of the world in a scene that is included with a rotation",
                                             "nodes that are held along a \"direction\" or completely");
            place(pin.motion);
            move(pin.pivot);
            turn(pin.direction);
        }
    }
    void place(ColliderEntry& collider) const {
        rename(collider.material);
        move(collider.position);
        turn(collider.rotation);
        place(collider.motion);
    }
    void place(AnchorEntry& anchor) const {
        if (!anchor.body && !anchor.collider) move(anchor.point);
        rename(anchor.body);
        rename(anchor.collider);
    }
    void place(LoadEntry& load) const {
        if (!load.body)
            load.place.key("body").refuse("no body, so that the load acts on all bodies",
                                          "a body, because the scene is included with a name");
        rename(load.body);
        for (std::optional<Vec3>* vector : {&load.force, &load.traction, &load.acceleration, &load.wind}) turn(*vector);
    }
    void place(SliderEntry& slider) const {
        rename(slider.name);
        for (OneOrMore<std::string>* names :
             {&slider.collider, &slider.body, &slider.joint, &slider.cable, &slider.cavity, &slider.pipe,
              &slider.spring, &slider.load, &slider.fibres})
            for (std::string& name : names->items) rename(name);
        turn(slider.along);
        turn(slider.about);
    }

    const IncludeEntry& include_;
    Mat3 rotation_;
};

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void add_placed(const IncludeEntry& include, SceneFile& included, SceneFile& scene) {
    Placing(include).place(included);
    append(scene.materials.items, included.materials.items);
    append(scene.pairs, included.pairs);
    append(scene.bodies, included.bodies);
    append(scene.colliders, included.colliders);
    append(scene.no_collision, included.no_collision);
    append(scene.joints, included.joints);
    append(scene.ties, included.ties);
    append(scene.cables, included.cables);
    append(scene.cavities, included.cavities);
    append(scene.pipes, included.pipes);
    append(scene.fibres, included.fibres);
    append(scene.loads, included.loads);
    append(scene.springs, included.springs);
    append(scene.probes, included.probes);
    append(scene.sliders, included.sliders);
}

}  // namespace skerry
