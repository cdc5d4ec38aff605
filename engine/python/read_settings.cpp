#include "engine/python/read_settings.h"

#include <string>
#include <type_traits>

#include "components/options.h"
#include "skerry/error.h"

namespace skerry::python {

namespace {

// The members of each struct, by the names that Python and scene files use. `visit(name, member)` is called for each.

template <class Struct, class Visit>
requires std::is_same_v<std::remove_const_t<Struct>, Settings>
void for_each_setting(Struct& s, Visit&& visit) {
    visit("gravity", s.gravity);
    visit("step_size", s.step_size);
    visit("theta", s.theta);
    visit("implicit_step", s.implicit_step);
    visit("integrator", s.integrator);
    visit("clusters", s.clusters);
    visit("backend", s.backend);
    visit("threads", s.threads);
    visit("contact_regions", s.contact_regions);
    visit("method", s.method);
    visit("friction", s.friction);
    visit("tolerance", s.tolerance);
    visit("max_iterations", s.max_iterations);
    visit("recovery_speed", s.recovery_speed);
    visit("start_overlaps", s.start_overlaps);
    visit("sleep", s.sleep);
    visit("sleep_time", s.sleep_time);
    visit("continuous_collision", s.continuous_collision);
}

template <class Struct, class Visit>
requires std::is_same_v<std::remove_const_t<Struct>, MaterialSettings>
void for_each_setting(Struct& s, Visit&& visit) {
    visit("young_modulus", s.young_modulus);
    visit("poisson_ratio", s.poisson_ratio);
    visit("density", s.density);
    visit("friction", s.friction);
    visit("static_friction", s.static_friction);
    visit("dynamic_friction", s.dynamic_friction);
    visit("restitution", s.restitution);
    visit("damping", s.damping);
    visit("loss_factor", s.loss_factor);
    visit("bulk_viscosity", s.bulk_viscosity);
    visit("model", s.model);
}

template <class Struct, class Visit>
requires std::is_same_v<std::remove_const_t<Struct>, BodySettings>
void for_each_setting(Struct& s, Visit&& visit) {
    visit("position", s.position);
    visit("rotation", s.rotation);
    visit("velocity", s.velocity);
    visit("angular_velocity", s.angular_velocity);
    visit("contact_distance", s.contact_distance);
    visit("self_contact", s.self_contact);
    visit("dynamics", s.dynamics);
    visit("collision_group", s.collision_group);
    visit("collision_mask", s.collision_mask);
    visit("element", s.element);
    visit("name", s.name);
}

template <class T>
struct OptionalOf : std::false_type {};
template <class T>
struct OptionalOf<std::optional<T>> : std::true_type {};

/// Reads one value; complains about the field `name` of an object of the class `object`.
class Reader {
public:
    explicit Reader(nb::handle from) : from_(from) {}

    template <class T>
    void operator()(const char* name, T& value) const {
        if (!nb::hasattr(from_, name)) return;
        const nb::object given = nb::getattr(from_, name);
        if constexpr (OptionalOf<T>::value) {
            if (given.is_none()) {
                value.reset();
                return;
            }
            typename T::value_type inner{};
            convert(name, given, inner);
            value = inner;
        } else {
            convert(name, given, value);
        }
    }

private:
    template <class T>
    void convert(const char* name, const nb::object& given, T& value) const {
        if constexpr (std::is_enum_v<T>) {
            std::string text, expected;
            const bool is_text = nb::try_cast(given, text);
            for (const auto& [known, spelled] : EnumNames<T>::table) {
                if (is_text && text == spelled) {
                    value = known;
                    return;
                }
                expected += (expected.empty() ? "'" : ", '") + std::string(spelled) + "'";
            }
            complain(name, given, "one of " + expected);
        } else if constexpr (std::is_same_v<T, Vec3>) {
            std::array<Real, 3> numbers{};
            if (!nb::try_cast(given, numbers)) complain(name, given, expected_of(value));
            value = Vec3(numbers[0], numbers[1], numbers[2]);
        } else {
            if (!nb::try_cast(given, value)) complain(name, given, expected_of(value));
        }
    }
    static std::string expected_of(const Vec3&) { return "three numbers"; }
    static std::string expected_of(Real) { return "a number"; }
    static std::string expected_of(bool) { return "True or False"; }
    static std::string expected_of(int) { return "a whole number"; }
    static std::string expected_of(std::uint32_t) { return "a whole number from 0 to 4294967295"; }
    static std::string expected_of(const std::string&) { return "a text"; }

    [[noreturn]] void complain(const char* name, const nb::object& given, const std::string& expected) const {
        Complaint{.file = {},
                  .object = nb::cast<std::string>(from_.type().attr("__name__")),
                  .field = name,
                  .found = nb::cast<std::string>(nb::repr(given)),
                  .expected = expected,
                  .hint = {}}
            .raise();
    }

    nb::handle from_;
};

class Writer {
public:
    explicit Writer(nb::dict& to) : to_(to) {}
    template <class T>
    void operator()(const char* name, const T& value) const {
        if constexpr (OptionalOf<T>::value) {
            if (value) {
                (*this)(name, *value);
            } else {
                to_[name] = nb::none();
            }
        } else if constexpr (std::is_enum_v<T>) {
            for (const auto& [known, spelled] : EnumNames<T>::table)
                if (known == value) to_[name] = nb::cast(std::string(spelled));
        } else if constexpr (std::is_same_v<T, Vec3>) {
            to_[name] = nb::make_tuple(value.x(), value.y(), value.z());
        } else {
            to_[name] = nb::cast(value);
        }
    }

private:
    nb::dict& to_;
};

template <class Struct>
nb::dict dict_of(const Struct& settings) {
    nb::dict values;
    for_each_setting(settings, Writer(values));
    return values;
}

}  // namespace

void read(nb::handle from, Settings& to) {
    for_each_setting(to, Reader(from));
}
void read(nb::handle from, MaterialSettings& to) {
    for_each_setting(to, Reader(from));
}
void read(nb::handle from, BodySettings& to) {
    for_each_setting(to, Reader(from));
}

nb::dict values_of(const Settings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const MaterialSettings& settings) {
    return dict_of(settings);
}

}  // namespace skerry::python
