// Pressure on faces of bodies, and cavities that contain a gas or a liquid (docs/methods/cavities.md).
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "components/cavity_law.h"
#include "components/handle.h"
#include "components/types.h"
#include "skerry/object_view.h"
#include "skerry/time_table.h"

#pragma GCC visibility push(default)
namespace skerry {

inline constexpr Real standard_pressure = 101325;  // standard atmosphere [Pa]

/// A gas with the absolute pressure p and the volume V. While no gas flows in or out, p V^exponent is constant.
struct GasFilling {
    Real pressure = 0;                 // pressure above ambient at the start, > -ambient [Pa]
    Real exponent = 1.4;               // polytropic exponent, >= 1; 1: isothermal, 1.4: adiabatic air
    Real ambient = standard_pressure;  // absolute pressure outside of the body, > 0 [Pa]
    Real density = 1.204;              // density at ambient pressure, > 0; default: air at 20 degrees Celsius [kg/m^3]
    TimeTable inflow{};                // flow of gas into the cavity, negative to draw gas out [kg/s]
};

/// A liquid whose volume is prescribed, for example by a syringe. In a cavity of the volume V its pressure above
/// ambient is bulk_modulus log(volume / V), but not less than -ambient (vacuum).
///
/// The pressure compresses the liquid by about the fraction pressure / bulk_modulus. A smaller bulk modulus than that
/// of the real liquid compresses it more, which is often acceptable, and allows a longer stable step.
struct LiquidFilling {
    Real bulk_modulus = 2.2e9;  // bulk modulus, > 0; default: water [Pa]
    // volume of the liquid at ambient pressure, > 0; default: the volume of the cavity when it is added [m^3]
    std::optional<TimeTable> volume{};
    Real ambient = standard_pressure;  // absolute pressure outside of the body, >= 0 [Pa]
};

/// Faces of a body under one pressure. The pressure acts on the deformed faces, against the outward normal of the body.
/// The alternatives of `filling` are a prescribed pressure above ambient [Pa], a gas and a liquid.
struct CavitySettings {
    BodyHandle body{};  // body of the faces
    // Faces of World::surface, each given by its three nodes. Default: the walls of all hollows inside of the body, or
    // the whole surface of a body without hollows.
    std::optional<std::vector<std::array<Index, 3>>> faces{};
    // Prescribed pressure, gas or liquid; default: the pressure 0.
    std::variant<TimeTable, GasFilling, LiquidFilling> filling{};
    // Volume of the gas or liquid at the start [m^3]. Required for faces that enclose no volume, such as those of a
    // piston, and not allowed for faces that enclose one. Steps change this volume by the volume that the faces sweep.
    //
    // Calls that place nodes, such as World::reset(body), change neither the volume nor the mass of the gas.
    // World::reset(saved) restores both as in the saved world.
    std::optional<Real> volume{};
};

/// Present state of a cavity.
struct CavityState {
    BodyHandle body{};                    // body of the faces
    CavityLaw law = CavityLaw::pressure;  // kind of the filling
    Index faces = 0;                      // number of faces
    bool closed = false;                  // whether the faces enclose a volume
    Real pressure = 0;                    // pressure above ambient [Pa]
    Real volume = 0;                      // volume of the cavity; 0 if neither faces nor settings define it [m^3]
    Real mass = 0;                        // mass of the gas; 0 for other fillings [kg]
    Real energy = 0;                      // work that the filling would do if it expanded to ambient pressure [J]
    Vec3 force = Vec3::Zero();            // sum of the pressure forces on the body; zero for closed faces [N]
};

/// A pipe between two cavities with the same gas, or between a cavity and a reservoir of this gas. The mass flow is
/// conductance times the difference of the pressures.
struct PipeSettings {
    CavityHandle first{};                  // cavity at the first end
    std::optional<CavityHandle> second{};  // cavity at the second end; default: a reservoir
    Real conductance = 0;                  // mass flow per difference of the pressures, >= 0 [kg/(s Pa)]
    TimeTable pressure{};                  // pressure of the reservoir above ambient; 0: the atmosphere [Pa]
};

/// Present state of a pipe.
struct PipeState {
    CavityHandle first{};                  // cavity at the first end
    std::optional<CavityHandle> second{};  // cavity at the second end; missing for a reservoir
    Real conductance = 0;                  // mass flow per difference of the pressures [kg/(s Pa)]
    Real flow = 0;                         // mean mass flow out of the first cavity in the last step [kg/s]
};

extern template class __attribute__((visibility("default"))) ObjectView<CavityHandle>;
extern template class __attribute__((visibility("default"))) ObjectView<PipeHandle>;

/// A view of the cavities and pipes of a world. Setting an equal value again changes no bit of the state.
class Cavities : public ObjectView<CavityHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds a cavity. Removing it also removes its pipes.
    CavityHandle add(const CavitySettings& cavity);
    /// Adds a pipe. Both cavities must contain the same gas.
    PipeHandle add(const PipeSettings& pipe);
    using ObjectView::alive;
    using ObjectView::remove;
    /// Removes a pipe.
    void remove(PipeHandle pipe) { ObjectView<PipeHandle>(*world_).remove(pipe); }
    /// True if the pipe is in the world, false if it was removed.
    bool alive(PipeHandle pipe) const { return ObjectView<PipeHandle>(*world_).alive(pipe); }
    /// All pipes, in the order added.
    std::vector<PipeHandle> pipes() const { return ObjectView<PipeHandle>(*world_).all(); }
    /// Pressure, volume, mass and energy of a cavity after the last step.
    CavityState state(CavityHandle cavity) const;
    /// Cavities, conductance and flow of a pipe.
    PipeState state(PipeHandle pipe) const;
    /// Settings with which add() would make a cavity like this one in its present state: pressure and volume of the
    /// filling have their present values.
    CavitySettings settings(CavityHandle cavity) const;
    /// Settings with which add() would make a pipe like this one.
    PipeSettings settings(PipeHandle pipe) const;

    /// Sets the pressure above ambient of a cavity whose pressure is prescribed [Pa]. Throws SceneError for a gas or a
    /// liquid.
    void set_pressure(CavityHandle cavity, const TimeTable& pressure);
    /// Sets the flow of gas into a cavity [kg/s]. Throws SceneError if the cavity contains no gas.
    void set_inflow(CavityHandle cavity, const TimeTable& inflow);
    /// Sets the volume of a liquid at ambient pressure [m^3]. Throws SceneError if the cavity contains no liquid.
    void set_liquid_volume(CavityHandle cavity, const TimeTable& volume);
    /// Sets the conductance of a pipe, >= 0 [kg/(s Pa)].
    void set_conductance(PipeHandle pipe, Real conductance);
    /// Sets the pressure above ambient of the reservoir of a pipe [Pa]. Throws SceneError for a pipe between two
    /// cavities.
    void set_reservoir(PipeHandle pipe, const TimeTable& pressure);
};

}  // namespace skerry
#pragma GCC visibility pop
