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
void read_members(nb::handle from, Struct& to);
template <class Struct>
nb::dict dict_of(const Struct& settings);
template <class Struct>
nb::object instance_of(const Struct& settings);

/// Reads members of a struct from the attributes of the Python object `from`. Errors name the object and the attribute.
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
        } else if constexpr (std::is_same_v<T, std::vector<Vec3>>) {
            Vectors rows;
            if (!nb::try_cast(given, rows)) complain(name, given, "an array of float64 of the shape (n, 3)");
            value.assign(span_of(rows).begin(), span_of(rows).end());
        } else if constexpr (std::is_same_v<T, std::vector<std::array<Index, 3>>>) {
            IndexRows<3> rows;
            if (!nb::try_cast(given, rows)) complain(name, given, "an array of int32 of the shape (n, 3)");
            value.assign(span_of(rows).begin(), span_of(rows).end());
        } else if constexpr (std::is_same_v<T, TimeTable>) {
            std::vector<std::array<Real, 2>> pairs;
            if (!nb::try_cast(given, pairs)) complain(name, given, "a list of pairs (time, value)");
            value = table_of(pairs);
        } else if constexpr (std::is_same_v<T, std::array<StretchTerm, 3>>) {
            std::vector<std::array<Real, 2>> pairs;
            if (!nb::try_cast(given, pairs) || pairs.size() > value.size())
                complain(name, given, "up to three pairs (share, exponent)");
            value = {};
            for (std::size_t p = 0; p < pairs.size(); ++p) value[p] = {pairs[p][0], pairs[p][1]};
        } else if constexpr (VectorOf<T>::value) {
            if (!nb::isinstance<nb::tuple>(given) && !nb::isinstance<nb::list>(given))
                complain(name, given, "a tuple of objects of the class " + text_of_class<typename T::value_type>());
            value.clear();
            for (const nb::handle item : given) convert(name, nb::borrow(item), value.emplace_back());
        } else if constexpr (HasSettings<T>) {
            if (nb::cast<std::string>(given.type().attr("__name__")) != class_name<T>)
                complain(name, given, "an object of the class " + text_of_class<T>());
            read_members(given, value);
        } else if constexpr (std::is_same_v<T, Vec3>) {
            std::array<Real, 3> numbers{};
            if (!nb::try_cast(given, numbers)) complain(name, given, expected_of(value));
            value = Vec3(numbers[0], numbers[1], numbers[2]);
        } else if constexpr (std::is_same_v<T, Mat3>) {
            std::array<std::array<Real, 3>, 3> rows{};
            if (!nb::try_cast(given, rows)) complain(name, given, "three rows of three numbers");
            for (std::size_t row = 0; row < 3; ++row)
                value.row(static_cast<Index>(row)) = Vec3(rows[row][0], rows[row][1], rows[row][2]);
        } else {
            if (!nb::try_cast(given, value)) complain(name, given, expected_of(value));
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

    [[noreturn]] void complain(const char* name, const nb::object& given, const std::string& expected) const {
        Complaint{.file = {},
                  .object = nb::cast<std::string>(nb::hasattr(from_, "of") ? from_.attr("of")
                                                                           : from_.type().attr("__name__")),
                  .field = name,
                  .found = nb::cast<std::string>(nb::repr(given)),
                  .expected = expected,
                  .hint = {}}
            .raise();
    }

    nb::handle from_;
};

template <class Struct>
void read_members(nb::handle from, Struct& to) {
    for_each_setting(to, Reader(from));
}

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
        } else if constexpr (std::is_same_v<T, std::array<StretchTerm, 3>>) {
            nb::list pairs;
            for (const StretchTerm& term : value)
                if (term.share != 0) pairs.append(nb::make_tuple(term.share, term.exponent));
            to_[name] = nb::tuple(pairs);
        } else if constexpr (std::is_same_v<T, Vec3>) {
            to_[name] = nb::make_tuple(value.x(), value.y(), value.z());
        } else if constexpr (std::is_same_v<T, std::vector<Vec3>>) {
            to_[name] = array_of(std::span<const Vec3>(value));
        } else if constexpr (std::is_same_v<T, std::vector<std::array<Index, 3>>>) {
            to_[name] = array_of<Index>(std::span<const std::array<Index, 3>>(value), {3});
        } else if constexpr (std::is_same_v<T, TimeTable>) {
            to_[name] = object_of(value);
        } else if constexpr (VectorOf<T>::value) {
            nb::list items;
            for (const auto& item : value) items.append(instance_of(item));
            to_[name] = nb::tuple(items);
        } else if constexpr (HasSettings<T>) {
            to_[name] = instance_of(value);
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

void read(nb::handle from, Settings& to) {
    read_members(from, to);
}
void read(nb::handle from, MaterialSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, OrthotropicModuli& to) {
    read_members(from, to);
}
void read(nb::handle from, BodySettings& to) {
    read_members(from, to);
}
void read(nb::handle from, ColliderSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, LoadSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, SurfaceSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, Pose& to) {
    read_members(from, to);
}
void read(nb::handle from, Motion& to) {
    read_members(from, to);
}
void read(nb::handle from, JointSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, JointPassive& to) {
    read_members(from, to);
}
void read(nb::handle from, JointMotor& to) {
    read_members(from, to);
}
void read(nb::handle from, TieSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, GasFilling& to) {
    read_members(from, to);
}
void read(nb::handle from, LiquidFilling& to) {
    read_members(from, to);
}
void read(nb::handle from, SpringSettings& to) {
    read_members(from, to);
}
void read(nb::handle from, ProblemSettings& to) {
    read_members(from, to);
}

Shape read_shape(nb::handle from) {
    const std::string name = nb::cast<std::string>(from.type().attr("__name__"));
    std::optional<Shape> shape;
    std::string known;
    const auto try_shape = [&]<class Candidate>(Candidate candidate) {
        known += (known.empty() ? "" : ", ") + std::string(class_name<Candidate>);
        if (name != class_name<Candidate>) return;
        read_members(from, candidate);
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
