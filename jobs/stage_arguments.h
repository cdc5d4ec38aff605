// Functions that make the arguments of TaskGraph::stage: read(...), write(...), make(...), value(...), inputs<X>(...),
// outputs<X>(...), only_if(...).
#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "jobs/access.h"

namespace skerry {

namespace access_detail {

struct Read {
    decltype(auto) operator()(const Binder& binder, const auto& object) const { return binder.read(object); }
};
struct Write {
    auto operator()(const Binder& binder, auto& column) const { return binder.write(column); }
};
struct Make {
    auto& operator()(const Binder& binder, auto& object) const { return binder.make(object); }
};
struct Value {
    const auto& operator()(const Binder& binder, const auto& object) const { return binder.value(object); }
};
template <class X>
struct Bind {
    X operator()(const Binder& binder, auto&... objects) const { return X::bind(binder, objects...); }
};

// Stage argument: the functor `Take` converts the objects to the value that is passed to the stage function. When the
// stage is added to the graph, `Take` declares the accesses. Whenever the stage starts, `Take` computes the value
// again.
template <class Take, class... Objects>
struct Argument {
    using Passed = std::invoke_result_t<Take, const Binder&, Objects&...>;
    static constexpr bool guards = false;

    std::tuple<Objects*...> objects;

    bool allows() const { return true; }
    std::tuple<Passed> pass() const { return std::tuple<Passed>(take(Binder())); }
    void declare(AccessList& list) const { take(Binder(list)); }

private:
    Passed take(const Binder& binder) const {
        return std::apply([&](Objects*... object) -> Passed { return Take()(binder, *object...); }, objects);
    }
};

template <class Predicate, class... Args>
struct Guard {
    static constexpr bool guards = true;

    Predicate predicate;
    std::tuple<Args...> arguments;

    bool allows() const {
        return std::apply([&](const Args&... args) { return std::apply(predicate, std::tuple_cat(args.pass()...)); },
                          arguments);
    }
    std::tuple<> pass() const { return {}; }
    void declare(AccessList& list) const {
        std::apply([&](const Args&... args) { (args.declare(list), ...); }, arguments);
    }
};

template <class F>
inline constexpr bool is_stateless = std::is_empty_v<F> || std::is_function_v<std::remove_pointer_t<F>>;

AccessList joined(const auto&... args) {
    AccessList list;
    (args.declare(list), ...);
    return list;
}

}  // namespace access_detail

/// Passes to the stage function a span<const T> for a column, a RaggedView<T> for a Ragged, and a const T& for any
/// other object.
template <Resource T>
auto read(const T& object) {
    return access_detail::Argument<access_detail::Read, const T>{{&object}};
}
template <Resource T>
void read(const T&&) = delete;  // deleted, because a temporary object no longer exists when the stage runs

/// Passes a span<T> for a column that the stage writes.
template <class T>
auto write(Column<T>& column) {
    return access_detail::Argument<access_detail::Write, Column<T>>{{&column}};
}

/// Passes a T&. It is for stages that add rows to an object or overwrite the entire object.
template <Resource T>
requires(!std::is_const_v<T>) auto make(T& object) {
    return access_detail::Argument<access_detail::Make, T>{{&object}};
}

/// Passes a const T& to an object that no stage writes. If a stage writes the object, compile() of the graph throws an
/// exception.
template <Resource T>
auto value(const T& object) {
    return access_detail::Argument<access_detail::Value, const T>{{&object}};
}
template <Resource T>
void value(const T&&) = delete;

/// Passes X::bind(binder, objects...). X is a struct of inputs. Its function bind declares which members of the objects
/// (mostly columns of tables) X reads.
template <class X, Resource... T>
auto inputs(T&... objects) {
    return access_detail::Argument<access_detail::Bind<X>, const T...>{{&objects...}};
}

/// Passes X::bind(binder, objects...). X is a struct of spans to which the stage writes.
template <class X, Resource... T>
auto outputs(T&... objects) {
    return access_detail::Argument<access_detail::Bind<X>, T...>{{&objects...}};
}

/// Skips the stage if predicate(values of args) is false when the stage is due. The predicate must be stateless,
/// because captured variables could read data that the stage has not declared.
template <class Predicate, class... Args>
auto only_if(Predicate predicate, Args... args) {
    static_assert(access_detail::is_stateless<Predicate>,
                  "only_if: pass the data that the predicate reads as arguments, do not capture them");
    static_assert(sizeof...(Args) > 0,
                  "only_if: pass the data that the predicate reads as arguments, or it may run too early");
    return access_detail::Guard<Predicate, Args...>{predicate, {args...}};
}

}  // namespace skerry
