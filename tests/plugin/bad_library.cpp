// A material with the fault that its input names, and a registration with the fault that the environment names.
#include <kerf/material.hpp>

#include <chrono>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>

using namespace kerf;

namespace {

bool registration_is(const char* fault) {
  const char* asked = std::getenv("BAD_REGISTRATION");
  return asked && std::string(asked) == fault;
}

[[gnu::noinline]] void loop_for_ever() {
  for (volatile unsigned i = 0;; i = i + 1) {
  }
}

#ifdef BAD_START
[[gnu::noinline]] int crash() { return *reinterpret_cast<volatile int*>(8); }
int started = crash();
#endif

[[gnu::noinline]] int recurse_for_ever(int n) {
  volatile char room[1000] = {};
  room[n % 1000] = 1;
  return recurse_for_ever(n + 1) + room[5];
}

}  // namespace

/// Elastic, with faults in elements whose centre lies below `x`.
struct Bad final : PointwiseMaterial<Bad> {
  static constexpr unsigned inputs = with_reference_position;
  using State = NoVariables;
  std::string fault;
  double x = 0.0;

  static void describe(Schema<Bad>& s) {
    if (registration_is("loops")) loop_for_ever();
    if (registration_is("throws")) throw std::runtime_error("the licence has run out");
    if (registration_is("throws a number")) throw 7;
    s.choice(&Bad::fault, "fault",
             {"none", "throws", "nan_stress", "nan_modulus", "aborts", "crashes", "loops", "slow", "escapes",
              "recurses", "calls"},
             "what is wrong")
        .by_default("none");
    s.real(&Bad::x, "x", "m", any_value, "elements below it have the fault").by_default("1 m");
  }

  [[gnu::noinline]] void act(double time) const noexcept {
    if (time < 1e-6) return;
    if (fault == "aborts") std::abort();
    if (fault == "crashes") *reinterpret_cast<volatile int*>(8) = 1;
    if (fault == "loops") loop_for_ever();
    if (fault == "escapes") throw std::runtime_error("the table has no such row");
    if (fault == "recurses") recurse_for_ever(1);
    if (fault == "calls") {
      void (*volatile nothing)() = nullptr;
      nothing();
    }
  }

  void update_point(const PointInputWith<inputs>& in, SymTensor& stress, State&, double& modulus) const {
    stress = stress + (2.0 * 80e9) * deviator(in.strain_increment);
    modulus = 80e9;
    if (in.reference_position.x > x || in.time < 1e-6) return;
    act(in.time);
    if (fault == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (fault == "throws") throw std::runtime_error("the table has no such row");
    if (fault == "nan_stress") stress.xx = std::numeric_limits<double>::quiet_NaN();
    if (fault == "nan_modulus") modulus = std::numeric_limits<double>::quiet_NaN();
  }
};

/// Cannot be made.
struct Unmade final : PointwiseMaterial<Unmade> {
  using State = NoVariables;
  Unmade() {
    if (registration_is("constructor loops")) loop_for_ever();
    throw std::runtime_error("there is no table of constants");
  }
  static void describe(Schema<Unmade>&) {}
  void update_point(const PointInput&, SymTensor&, State&, double&) const {}
};

#ifdef BAD_NAME
KERF_MATERIAL(Bad, BAD_NAME, "has the name of another one")
#else
KERF_REGISTER(KERF_TYPE(Bad, "material", "bad", "has the fault that is asked for")
                  KERF_TYPE(Unmade, "material", "unmade", "cannot be made"))
#endif
