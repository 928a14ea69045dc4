// What a law may tell about its use before the first step: what is wrong with its parameters, warnings, energy that it
// holds back, and fronts that run through its material.
//
// Each of the four is a class that a law of an element (material, solid, equation of state, erosion criterion) may
// derive from beside its own base. A law that does not is not asked.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// A law in one part of the undeformed model. Functions are collective: all ranks call them in the same order, and get
/// the same answer.
class LawUse {
 public:
  std::string part;  // name
  double density = 0.0;  // reference density [kg/m3]
  double end = 0.0;  // of the run [s]
  // dp/d(rho e) of the equation of state, or the solid, at the reference state, and at 1.1 times the density [-]
  double grueneisen = 0.0, grueneisen_compressed = 0.0;
  std::int64_t n_elements = 0;
  double length = 0.0;  // cube root of the mean volume of the part's elements [m]

  LawUse() = default;
  LawUse(const LawUse&) = delete;
  LawUse& operator=(const LawUse&) = delete;
  virtual ~LawUse() = default;

  /// Least and greatest value of a state variable in the part's elements, the latter of those below `below`; infinity
  /// and its negative where there are none.
  virtual double least(const std::string& variable) = 0;
  virtual double greatest(const std::string& variable, double below) = 0;
  /// How many elements have a value of at least `limit`.
  virtual std::int64_t count_from(const std::string& variable, double limit) = 0;
  /// Least distance of the centre of an element from the place that is nearest to it, over all parts of the law's
  /// material [m].
  virtual double distance(const std::function<Vec3(Vec3)>& nearest) = 0;
};

/// What is wrong with one parameter of a law; an empty name stands for the whole law.
struct ParameterComplaint {
  std::string parameter, sentence;  // the latter without a full stop: "what is wrong; what is expected"
};

/// A law whose parameters can be judged only together with the density of its material. What it finds is an error of
/// the input, at the line of the parameter.
class DensityCheckedLaw {
 public:
  virtual ~DensityCheckedLaw() = default;
  virtual std::vector<ParameterComplaint> complaints(double reference_density) const = 0;  // [kg/m3]
};

/// A law that has something to say about its parameters, or about a part, before a run. `kerf check` and `kerf run`
/// print it, and summary.json lists it.
class WarningLaw {
 public:
  virtual ~WarningLaw() = default;
  /// Sentences without a full stop: "what is odd; what to do". The engine puts the place in the input before them. Once
  /// for each part of the law's material; what several parts say alike is printed once.
  virtual std::vector<std::string> warnings(LawUse& use) const = 0;
};

/// A law that holds back energy which its initial_energy_density() contains, and sets it free in the course of a run:
/// the chemical energy of an explosive. The books show it apart.
class EnergyHolder {
 public:
  virtual ~EnergyHolder() = default;
  /// What is left of it, per reference volume [J/m3]; `state` is in the order of state_variables().
  virtual double energy_held(std::span<const double> state) const = 0;
  /// Whether the law will set its material in motion, though nothing strikes it.
  virtual bool acts_by_itself() const = 0;
};

/// Where and when a front starts.
struct FrontOrigin {
  Vec3 point;  // [m]
  double time = 0.0;  // [s]
};

/// A law whose material a front runs through at a given speed, round what is of another material: a detonation. The
/// engine finds when it arrives at each element, on the undeformed mesh, from |grad t| = 1/speed. It runs on through
/// parts that share nodes with the part, and whose laws are of this kind as well.
class FrontLaw {
 public:
  static constexpr double never = 1e30;  // [s] the arrival time where no front comes

  virtual ~FrontLaw() = default;
  /// False where the law does without: the engine then leaves the law's state alone.
  virtual bool asks_for_arrival() const = 0;
  virtual double front_speed(double reference_density) const = 0;  // [m/s]
  virtual int n_origins() const = 0;
  /// The place of an origin, which may be a line or a plane, that is nearest to x.
  virtual FrontOrigin origin(int number, Vec3 x) const = 0;
  /// The state variable that takes the arrival time.
  virtual std::string arrival_variable() const = 0;
};

}  // namespace kerf

KERF_SIZES(law_use, KERF_SIZE(LawUse), KERF_SIZE(ParameterComplaint), KERF_SIZE(DensityCheckedLaw),
           KERF_SIZE(WarningLaw), KERF_SIZE(EnergyHolder), KERF_SIZE(FrontOrigin), KERF_SIZE(FrontLaw))
