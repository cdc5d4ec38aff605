// Keys of sliders in a scene file. Also finds the objects that the sliders control.
#include <algorithm>
#include <numbers>
#include <set>

#include "engine/base/complaint.h"
#include "engine/rollout/controls.h"
#include "engine/scene/scene_plan.h"
#include "engine/scene/scene_rules.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"

namespace skerry {

namespace {

void check_slider(const Place& place, const SliderEntry& slider) {
    const bool moves = !slider.collider.items.empty() || !slider.body.items.empty();
    if (moves && !slider.along && !slider.about)
        place.refuse("neither \"along\" nor \"about\"", "one of them, for a slider that moves colliders or pins");
    for (const auto& [key, vector] : {std::pair("along", slider.along), std::pair("about", slider.about)}) {
        if (!vector) continue;
        if (!moves)
            place.key(key).refuse("this key in a slider without \"collider\" or \"body\"",
                                  "a slider with \"collider\" or \"body\"");
        if (vector->isZero(0)) place.key(key).refuse("a direction of length 0", "a direction of any other length");
    }
    if (slider.pin && slider.body.items.empty())
        place.key("pin").refuse("this key in a slider without \"body\"", "a slider with \"body\"");
    if (!(slider.low < slider.high))
        place.key("high").refuse(Json(slider.high).dump(), "more than \"low\", " + Json(slider.low).dump());
    // The value of the slider is computed from the rotation of its object. Angles of pi and -pi give the same rotation,
    // so neither is allowed.
    constexpr Real most_turn = std::numbers::pi_v<Real> - 1e-6;
    if (slider.about && std::max(-slider.low, slider.high) > most_turn)
        place.refuse("angles from " + Json(slider.low).dump() + " to " + Json(slider.high).dump() + " rad",
                     "less than half a revolution in each direction, at most 3.14159 rad");
}

/// Target of a slider that moves a collider or a pin. `motion`: motion that the scene prescribes for the object. Throws
/// SceneError unless `motion` is zero, because the slider alone must move the object.
template <class HandleType>
SliderTarget moved(const World& world, HandleType object, const Motion& motion, const Place& place) {
    if (!motion.keys.empty() || !motion.velocity.isZero(0) || !motion.angular_velocity.isZero(0))
        place.refuse("an object with a \"motion\"", "an object that only the slider moves");
    const MotionKey pose = world.pose(object);
    return {PoseControl{object}, {pose.position, pose.rotation}};
}

/// The object of this name, for example a joint or a cable. Throws SceneError unless exactly one object has this name.
template <class HandleType>
HandleType find_object(const ObjectView<HandleType>& objects, const std::string& name, const Place& place) {
    std::vector<std::string> names;
    for (const HandleType object : objects.all()) names.push_back(objects.name(object));
    const auto count = std::ranges::count(names, name);
    if (count != 1)
        place.refuse(in_quotes(name) + (count == 0 ? "" : ", which several objects have"),
                     names.empty() ? "a name, but the scene has no such object" : "one of " + listed(names),
                     nearest_hint(name, names));
    return objects.find(name);
}

[[noreturn]] void refuse_pin(const Place& place, const std::string& body, std::size_t pins, std::size_t pin) {
    if (pins == 0)
        place.refuse(in_quotes(body) + ", a body without \"pin\"", "a body with a pin", "add one to the body");
    place.refuse(in_quotes(body) + ", a body with " + std::to_string(pins) + (pins == 1 ? " pin" : " pins"),
                 "a body with a pin of the number " + std::to_string(pin) + ", counted from 0");
}

class SliderMaker {
public:
    SliderMaker(const ScenePlan& plan, const PlannedHandles& handles, World& world)
        : plan_(plan), handles_(handles), world_(world) {}

    Slider make(const SliderEntry& entry) {
        Slider slider{.name = entry.name, .unit = {}, .low = entry.low, .high = entry.high};
        slider.fastest = entry.fastest.value_or(entry.high - entry.low);
        if (entry.along) slider.along = entry.along->normalized();
        if (entry.about) slider.about = entry.about->normalized();
        slider.targets = targets_of(entry);
        if (slider.targets.empty()) entry.place.refuse("an empty list of objects", "the name of at least one object");
        for (const SliderTarget& target : slider.targets) {
            const std::string unit = entry.about ? "rad" : unit_of(world_, target.control);
            if (slider.unit.empty()) slider.unit = unit;
            if (unit != slider.unit)
                entry.place.refuse("objects whose values have the units " + slider.unit + " and " + unit,
                                   "objects that are driven in the same way");
        }
        const std::string bounds = Json(slider.low).dump() + " to " + Json(slider.high).dump();
        for (const SliderTarget& target : slider.targets) {
            const TimeTable own = called_at(entry.place, [&] { return course_of(world_, target.control); });
            const TimeTable start = entry.value ? TimeTable(*entry.value) : own;
            for (const TimeKey& key : start.keys)
                if (!(slider.low <= key.value && key.value <= slider.high))
                    entry.place.key(entry.value ? "value" : "low")
                        .refuse(entry.value ? Json(key.value).dump() : "the bounds " + bounds,
                                entry.value ? "a value from \"low\" to \"high\", " + bounds
                                            : "bounds that include " + Json(key.value).dump() +
                                                  ", a value that the driven object has");
            if (start != own)
                called_at(entry.place.key("value"), [&] { start_target(world_, slider, target, *entry.value); });
        }
        return slider;
    }

private:
    std::vector<SliderTarget> targets_of(const SliderEntry& entry) {
        std::vector<SliderTarget> found;
        const auto add = [&](const char* key, const OneOrMore<std::string>& names, auto&& target) {
            for (const std::string& name : names.items) {
                const Place place = entry.place.key(key);
                if (!taken_.insert(std::string(key) + " " + name + " " + std::to_string(entry.pin.value_or(0))).second)
                    place.refuse(in_quotes(name) + ", which another slider drives", "one slider for each object");
                found.push_back(target(name, place));
            }
        };
        const auto add_valued = [&]<class HandleType>(const char* key, const OneOrMore<std::string>& names,
                                                      const ObjectView<HandleType>& objects) {
            add(key, names, [&](const std::string& name, const Place& place) -> SliderTarget {
                return {ValueControl{find_object(objects, name, place)}};
            });
        };
        add("collider", entry.collider, [&](const std::string& name, const Place& place) {
            const std::size_t c = find_collider(plan_, name, place);
            return moved(world_, handles_.colliders[c], plan_.colliders[c].settings.motion, place);
        });
        add("body", entry.body, [&](const std::string& name, const Place& place) {
            const std::size_t b = find_body(plan_, name, place);
            const auto pin = static_cast<std::size_t>(entry.pin.value_or(0));
            const std::vector<PinPlan>& pins = plan_.bodies[b].pins;
            if (pin >= pins.size()) refuse_pin(place, name, pins.size(), pin);
            return moved(world_, handles_.pins[b][pin], pins[pin].motion, place);
        });
        add("joint", entry.joint, [&](const std::string& name, const Place& place) -> SliderTarget {
            const JointHandle joint = find_object<JointHandle>(Joints(world_), name, place);
            return {called_at(place, [&] { return motor_control(world_, joint); })};
        });
        add_valued("cable", entry.cable, ObjectView<CableHandle>(world_));
        add_valued("cavity", entry.cavity, ObjectView<CavityHandle>(world_));
        add_valued("pipe", entry.pipe, ObjectView<PipeHandle>(world_));
        add_valued("spring", entry.spring, ObjectView<SpringHandle>(world_));
        add_valued("load", entry.load, ObjectView<LoadHandle>(world_));
        add_valued("fibres", entry.fibres, ObjectView<FibreHandle>(world_));
        return found;
    }

    const ScenePlan& plan_;
    const PlannedHandles& handles_;
    World& world_;
    std::set<std::string> taken_;  // keys and names of the objects that the sliders made so far control
};

}  // namespace

template <>
const Rule<SliderEntry>& rule_of<SliderEntry>() {
    using Entry = SliderEntry;
    static const auto rule =
        Rule<Entry>("slider",
                    "A value that a user changes while the scene runs. It drives one object, or several objects in the "
                    "same way, given by their names (docs/view.md).")
            .key("name", &Entry::name, {.meaning = "name; no two sliders have the same", .required = true})
            .key("collider", &Entry::collider, {.meaning = "colliders to displace or to turn"})
            .key("body", &Entry::body, {.meaning = "bodies whose pins are displaced or turned"})
            .key("pin", &Entry::pin,
                 {.meaning = "number of the pin of each body, counted from 0; default: 0", .limits = at_least(0)})
            .key("along", &Entry::along,
                 {.meaning = "direction of the displacement in the world; the value is the displacement in m since the "
                             "start of the scene"})
            .key("about", &Entry::about,
                 {.meaning = "axis of the rotation in the world, through the origin of each collider or the pivot of "
                             "each pin; the value is the angle in rad since the start of the scene"})
            .key("joint", &Entry::joint, {.meaning = "joints; the slider sets the target of their motors, in its unit"})
            .key(
                "cable", &Entry::cable,
                {.meaning = "cables; the slider sets the tension in N, length in m or rate in m/s that each cable has"})
            .key("cavity", &Entry::cavity,
                 {.meaning = "cavities; the slider sets the pressure in Pa, inflow in kg/s or liquid volume in m^3"})
            .key("pipe", &Entry::pipe, {.meaning = "pipes; the slider sets the pressure of the reservoir in Pa"})
            .key("spring", &Entry::spring, {.meaning = "springs; the slider sets the rest length in m"})
            .key("load", &Entry::load, {.meaning = "loads; the slider sets the scale"})
            .key("fibres", &Entry::fibres, {.meaning = "fibres; the slider sets the active tension in Pa"})
            .key("low", &Entry::low, {.meaning = "least value", .required = true})
            .key("high", &Entry::high, {.meaning = "greatest value", .required = true})
            .key("value", &Entry::value,
                 {.meaning = "value at the start; default: the value that the rest of the scene gives, and 0 for a "
                             "displacement or a rotation"})
            .key("fastest", &Entry::fastest,
                 {.meaning = "greatest change of the value in a second; default: high - low", .limits = above(0)})
            .exactly_one({"collider", "body", "joint", "cable", "cavity", "pipe", "spring", "load", "fibres"})
            .at_most_one({"along", "about"})
            .check(check_slider);
    return rule;
}

std::vector<Slider> make_sliders(const ScenePlan& plan, const PlannedHandles& handles, World& world) {
    SliderMaker maker(plan, handles, world);
    std::vector<Slider> sliders;
    for (const SliderEntry& entry : plan.sliders) {
        choose_name(entry.name, names_of(sliders), "slider", entry.place);
        sliders.push_back(maker.make(entry));
    }
    return sliders;
}

}  // namespace skerry
