#include "engine/python/read_settings.h"

#include <string>
#include <type_traits>

#include "components/options.h"
#include "engine/python/setting_members.h"
#include "skerry/error.h"

namespace skerry::python {

namespace {

template <class T>
struct OptionalOf : std::false_type {};
template <class T>
struct OptionalOf<std::optional<T>> : std::true_type {};
template <class T>
struct VectorOf : std::false_type {};
template <class T>
struct VectorOf<std::vector<T>> : std::true_type {};

template <class Struct>
void read_members(nb::handle object, Struct& settings);
template <class Struct>
nb::dict dict_of(const Struct& settings);
template <class Struct>
nb::object instance_of(const Struct& settings);

/// Reads members of a struct from the attributes of a Python object. Errors name the object and the attribute.
class Reader {
public:
    explicit Reader(nb::handle object) : object_(object) {}

    template <class T>
    void operator()(const char* name, T& value) const {
        if (!nb::hasattr(object_, name)) return;
        const nb::object attribute = nb::getattr(object_, name);
        if constexpr (OptionalOf<T>::value) {
            if (attribute.is_none()) {
                value.reset();
                return;
            }
            typename T::value_type inner{};
            convert(name, attribute, inner);
            value = inner;
        } else {
            convert(name, attribute, value);
        }
    }

private:
    template <class T>
    void convert(const char* name, const nb::object& attribute, T& value) const {
        if constexpr (std::is_enum_v<T>) {
            std::string text, expected;
            const bool is_text = nb::try_cast(attribute, text);
            for (const auto& [known, spelled] : EnumNames<T>::table) {
                if (is_text && text == spelled) {
                    value = known;
                    return;
                }
                expected += (expected.empty() ? "'" : ", '") + std::string(spelled) + "'";
            }
            complain(name, attribute, "one of " + expected);
        } else if constexpr (std::is_same_v<T, std::vector<Vec3>>) {
            Vectors rows;
            if (!nb::try_cast(attribute, rows)) complain(name, attribute, "an array of float64 of the shape (n, 3)");
            value.assign(span_of(rows).begin(), span_of(rows).end());
        } else if constexpr (std::is_same_v<T, std::vector<std::array<Index, 3>>>) {
            IndexRows<3> rows;
            if (!nb::try_cast(attribute, rows)) complain(name, attribute, "an array of int32 of the shape (n, 3)");
            value.assign(span_of(rows).begin(), span_of(rows).end());
        } else if constexpr (std::is_same_v<T, TimeTable>) {
            std::vector<std::array<Real, 2>> pairs;
            if (!nb::try_cast(attribute, pairs)) complain(name, attribute, "a list of pairs (time, value)");
            value = table_of(pairs);
        } else if constexpr (std::is_same_v<T, std::array<StretchTerm, 3>>) {
            std::vector<std::array<Real, 2>> pairs;
            if (!nb::try_cast(attribute, pairs) || pairs.size() > value.size())
                complain(name, attribute, "up to three pairs (share, exponent)");
            value = {};
            for (std::size_t p = 0; p < pairs.size(); ++p) value[p] = {pairs[p][0], pairs[p][1]};
        } else if constexpr (VectorOf<T>::value) {
            if (!nb::isinstance<nb::tuple>(attribute) && !nb::isinstance<nb::list>(attribute))
                complain(name, attribute, "a tuple of objects of the class " + text_of_class<typename T::value_type>());
            value.clear();
            for (const nb::handle item : attribute) convert(name, nb::borrow(item), value.emplace_back());
        } else if constexpr (HasSettings<T>) {
            if (nb::cast<std::string>(attribute.type().attr("__name__")) != class_name<T>)
                complain(name, attribute, "an object of the class " + text_of_class<T>());
            read_members(attribute, value);
        } else if constexpr (std::is_same_v<T, Vec3>) {
            std::array<Real, 3> numbers{};
            if (!nb::try_cast(attribute, numbers)) complain(name, attribute, expected_of(value));
            value = Vec3(numbers[0], numbers[1], numbers[2]);
        } else if constexpr (std::is_same_v<T, Mat3>) {
            std::array<std::array<Real, 3>, 3> rows{};
            if (!nb::try_cast(attribute, rows)) complain(name, attribute, "three rows of three numbers");
            for (std::size_t row = 0; row < 3; ++row)
                value.row(static_cast<Index>(row)) = Vec3(rows[row][0], rows[row][1], rows[row][2]);
        } else {
            if (!nb::try_cast(attribute, value)) complain(name, attribute, expected_of(value));
        }
    }
    template <class T>
    static std::string text_of_class() {
        return std::string("skerry.") + class_name<T>;
    }
    static std::string expected_of(const Vec3&) { return "three numbers"; }
    static std::string expected_of(Real) { return "a number"; }
    static std::string expected_of(bool) { return "True or False"; }
    static std::string expected_of(int) { return "a whole number"; }
    static std::string expected_of(std::uint32_t) { return "a whole number from 0 to 4294967295"; }
    static std::string expected_of(const std::string&) { return "a text"; }

    [[noreturn]] void complain(const char* name, const nb::object& attribute, const std::string& expected) const {
        Complaint{.file = {},
                  .object = nb::cast<std::string>(nb::hasattr(object_, "of") ? object_.attr("of")
                                                                             : object_.type().attr("__name__")),
                  .field = name,
                  .found = nb::cast<std::string>(nb::repr(attribute)),
                  .expected = expected,
                  .hint = {}}
            .raise();
    }

    nb::handle object_;
};

template <class Struct>
void read_members(nb::handle object, Struct& settings) {
    for_each_setting(settings, Reader(object));
}

class Writer {
public:
    explicit Writer(nb::dict& values) : values_(values) {}
    template <class T>
    void operator()(const char* name, const T& value) const {
        if constexpr (OptionalOf<T>::value) {
            if (value) {
                (*this)(name, *value);
            } else {
                values_[name] = nb::none();
            }
        } else if constexpr (std::is_enum_v<T>) {
            for (const auto& [known, spelled] : EnumNames<T>::table)
                if (known == value) values_[name] = nb::cast(std::string(spelled));
        } else if constexpr (std::is_same_v<T, std::array<StretchTerm, 3>>) {
            nb::list pairs;
            for (const StretchTerm& term : value)
                if (term.share != 0) pairs.append(nb::make_tuple(term.share, term.exponent));
            values_[name] = nb::tuple(pairs);
        } else if constexpr (std::is_same_v<T, Vec3>) {
            values_[name] = nb::make_tuple(value.x(), value.y(), value.z());
        } else if constexpr (std::is_same_v<T, std::vector<Vec3>>) {
            values_[name] = array_of(std::span<const Vec3>(value));
        } else if constexpr (std::is_same_v<T, std::vector<std::array<Index, 3>>>) {
            values_[name] = array_of<Index>(std::span<const std::array<Index, 3>>(value), {3});
        } else if constexpr (std::is_same_v<T, TimeTable>) {
            values_[name] = object_of(value);
        } else if constexpr (VectorOf<T>::value) {
            nb::list items;
            for (const auto& item : value) items.append(instance_of(item));
            values_[name] = nb::tuple(items);
        } else if constexpr (HasSettings<T>) {
            values_[name] = instance_of(value);
        } else {
            values_[name] = nb::cast(value);
        }
    }

private:
    nb::dict& values_;
};

template <class Struct>
nb::dict dict_of(const Struct& settings) {
    nb::dict values;
    for_each_setting(settings, Writer(values));
    return values;
}
template <class Struct>
nb::object instance_of(const Struct& settings) {
    return nb::module_::import_("skerry._settings").attr(class_name<Struct>)(**dict_of(settings));
}

/// Default values of each struct, by the name of its Python class.
template <class... Struct>
nb::dict defaults_of() {
    nb::dict defaults;
    ((defaults[class_name<Struct>] = dict_of(Struct{})), ...);
    return defaults;
}

}  // namespace

TimeTable table_of(const std::vector<std::array<Real, 2>>& pairs) {
    std::vector<TimeKey> keys;
    for (const auto& [time, value] : pairs) keys.push_back({time, value});
    return keys;
}

void read(nb::handle object, Settings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, MaterialSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, OrthotropicModuli& settings) {
    read_members(object, settings);
}
void read(nb::handle object, BodySettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, ColliderSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, LoadSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, SurfaceSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, Pose& settings) {
    read_members(object, settings);
}
void read(nb::handle object, Motion& settings) {
    read_members(object, settings);
}
void read(nb::handle object, JointSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, JointPassive& settings) {
    read_members(object, settings);
}
void read(nb::handle object, JointMotor& settings) {
    read_members(object, settings);
}
void read(nb::handle object, TieSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, GasFilling& settings) {
    read_members(object, settings);
}
void read(nb::handle object, LiquidFilling& settings) {
    read_members(object, settings);
}
void read(nb::handle object, SpringSettings& settings) {
    read_members(object, settings);
}
void read(nb::handle object, ProblemSettings& settings) {
    read_members(object, settings);
}

Shape read_shape(nb::handle object) {
    const std::string name = nb::cast<std::string>(object.type().attr("__name__"));
    std::optional<Shape> shape;
    std::string known;
    const auto try_shape = [&]<class Candidate>(Candidate candidate) {
        known += (known.empty() ? "" : ", ") + std::string(class_name<Candidate>);
        if (name != class_name<Candidate>) return;
        read_members(object, candidate);
        shape = std::move(candidate);
    };
    try_shape(Plane{});
    try_shape(Sphere{});
    try_shape(Box{});
    try_shape(Capsule{});
    try_shape(Cylinder{});
    try_shape(Bucket{});
    try_shape(SurfaceMesh{});
    if (!shape)
        Complaint{.file = {},
                  .object = "collider",
                  .field = "shape",
                  .found = "an object of the class " + name,
                  .expected = "one of " + known,
                  .hint = {}}
            .raise();
    return *std::move(shape);
}

nb::dict values_of(const Settings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const MaterialSettings& settings) {
    return dict_of(settings);
}

nb::dict values_of(const SpringSettings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const CableSettings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const TieSettings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const JointSettings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const PipeSettings& settings) {
    return dict_of(settings);
}
nb::dict values_of(const AnyLoad& settings) {
    return std::visit([](const auto& load) { return dict_of(load); }, settings);
}

nb::object object_of(const Shape& shape) {
    return std::visit([](const auto& known) { return instance_of(known); }, shape);
}
nb::object object_of(const Pose& pose) {
    return instance_of(pose);
}
nb::object object_of(const JointMotor& motor) {
    return instance_of(motor);
}
nb::object object_of(const JointPassive& passive) {
    return instance_of(passive);
}
nb::object object_of(const SurfaceSettings& surface) {
    return instance_of(surface);
}

nb::object object_of(const GasFilling& gas) {
    return instance_of(gas);
}
nb::object object_of(const LiquidFilling& liquid) {
    return instance_of(liquid);
}
nb::object object_of(const TimeTable& table) {
    nb::list pairs;
    for (const TimeKey& key : table.keys) pairs.append(nb::make_tuple(key.time, key.value));
    return nb::tuple(pairs);
}

void bind_settings(nb::module_& module) {
    module.def("defaults", &defaults_of<Settings, MaterialSettings, OrthotropicModuli, SurfaceSettings, Pose, MotionKey,
                                        Motion, JointPassive, MotorKey, JointMotor, GasFilling, LiquidFilling,
                                        ProblemSettings, Plane, Sphere, Box, Capsule, Cylinder, Bucket>);
}

}  // namespace skerry::python
