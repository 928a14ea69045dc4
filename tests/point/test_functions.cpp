// Elementary functions: their errors against long double, their special values, and that every lane, compiler and
// machine gives the same bits.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "kerf/math.hpp"

namespace {

constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

/// Numbers that are the same with every library and compiler (Knuth's linear congruential generator).
class Random {
 public:
  std::uint64_t bits() { return state_ = state_ * 6364136223846793005u + 1442695040888963407u; }
  double between(double low, double high) { return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53); }
  /// Of random sign, with a magnitude from 2^low to 2^high.
  double over_magnitudes(double low, double high) {
    const double size = std::ldexp(between(1.0, 2.0), static_cast<int>(std::floor(between(low, high))));
    return (bits() >> 63) != 0 ? -size : size;
  }

 private:
  std::uint64_t state_ = 20240601;
};

/// Error in units in the last place of the result.
double error_of(double result, long double right) {
  if (std::isnan(right) || std::isinf(static_cast<double>(right)))
    return result == static_cast<double>(right) || (std::isnan(result) && std::isnan(right)) ? 0.0 : 1e9;
  int exponent = 0;
  std::frexp(static_cast<double>(right), &exponent);
  const long double unit = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  const auto error = static_cast<double>(std::fabs((static_cast<long double>(result) - right) / unit));
  return std::isnan(error) ? 1e9 : error;
}

struct Function {
  std::string name;
  double (*ours)(double);
  long double (*right)(long double);
  double limit;  // of the error, as functions.hpp states it
  double (*argument)(Random&);
};

#define KERF_BOTH(name) [](double x) { return kerf::name(x); }, [](long double x) { return std::name(x); }
// clang-format off
const std::vector<Function> functions = {
    {"exp", KERF_BOTH(exp), 0.9, [](Random& r) { return r.between(-708.0, 709.7); }},
    {"exp near 0", KERF_BOTH(exp), 0.9, [](Random& r) { return r.between(-2.0, 2.0); }},
    {"expm1", KERF_BOTH(expm1), 1.5, [](Random& r) { return r.over_magnitudes(-60, 7); }},
    {"log", KERF_BOTH(log), 0.9, [](Random& r) { return std::fabs(r.over_magnitudes(-1073, 1024)); }},
    {"log near 1", KERF_BOTH(log), 0.9, [](Random& r) { return 1.0 + r.over_magnitudes(-52, -1); }},
    {"positive_log", [](double x) { return kerf::positive_log(x); }, [](long double x) { return std::log(x); }, 0.9,
     [](Random& r) { return std::fabs(r.over_magnitudes(-1022, 1024)); }},
    {"log10", KERF_BOTH(log10), 2.0, [](Random& r) { return std::fabs(r.over_magnitudes(-40, 40)); }},
    {"sin", KERF_BOTH(sin), 0.9, [](Random& r) { return r.over_magnitudes(-30, 20); }},
    {"cos", KERF_BOTH(cos), 0.9, [](Random& r) { return r.over_magnitudes(-30, 20); }},
    {"sin near multiples of pi/2", KERF_BOTH(sin), 0.9,
     [](Random& r) { return std::rint(r.between(-6e5, 6e5)) * 1.5707963267948966; }},
    {"tan", KERF_BOTH(tan), 2.5, [](Random& r) { return r.over_magnitudes(-30, 20); }},
    {"asin", KERF_BOTH(asin), 2.3, [](Random& r) { return r.between(-1.0, 1.0); }},
    {"acos", KERF_BOTH(acos), 1.3, [](Random& r) { return r.between(-1.0, 1.0); }},
    {"acos near 1", KERF_BOTH(acos), 1.3, [](Random& r) { return 1.0 - std::fabs(r.over_magnitudes(-53, -1)); }},
    {"atan", KERF_BOTH(atan), 2.3, [](Random& r) { return r.over_magnitudes(-40, 40); }},
    {"tanh", KERF_BOTH(tanh), 3.0, [](Random& r) { return r.over_magnitudes(-30, 6); }},
};
// clang-format on

TEST(Functions, errors_are_no_larger_than_stated) {
  for (const Function& f : functions) {
    Random random;
    double worst = 0.0, at = 0.0;
    for (int i = 0; i < 200'000; ++i) {
      const double x = f.argument(random), error = error_of(f.ours(x), f.right(static_cast<long double>(x)));
      if (error > worst) worst = error, at = x;
    }
    EXPECT_LE(worst, f.limit) << f.name << " at " << at;
  }
}

struct Pair {
  double x, y;
};
double worst_power(Pair (*arguments)(Random&)) {
  Random random;
  double worst = 0.0;
  for (int i = 0; i < 200'000; ++i) {
    const auto [x, y] = arguments(random);
    worst =
        std::max(worst, error_of(kerf::pow(x, y), std::pow(static_cast<long double>(x), static_cast<long double>(y))));
  }
  return worst;
}

TEST(Functions, errors_of_pow_are_no_larger_than_stated) {
  // powl of the C library errs by some units of 2^-64, of which a unit of double has 2048.
  EXPECT_LE(worst_power([](Random& r) {
              return Pair{std::fabs(r.over_magnitudes(-20, 20)), r.between(-30.0, 30.0)};
            }),
            1.5);
  EXPECT_LE(worst_power([](Random& r) {
              const double x = r.between(0.5, 2.0);
              return Pair{x, r.between(-700.0, 700.0) / std::fabs(std::log(x))};
            }),
            1.5);
  EXPECT_LE(worst_power([](Random& r) { return Pair{r.between(-9.0, 9.0), std::rint(r.between(-99.0, 99.0))}; }), 1.5);
}

TEST(Functions, errors_of_positive_power_grow_with_the_logarithm_of_the_result) {
  Random random;
  for (int i = 0; i < 200'000; ++i) {
    const double x = std::fabs(random.over_magnitudes(-200, 200)), y = random.between(-4.9, 4.9);
    const long double right = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    ASSERT_LE(error_of(kerf::positive_power(x, y), right), 2.0 * std::fabs(y * std::log2(x)) + 2.0) << x << ' ' << y;
  }
  EXPECT_EQ(kerf::positive_power(1e-300, 5.0), 0x1p-1000);
}

TEST(Functions, errors_of_atan2_and_hypot_are_no_larger_than_stated) {
  Random random;
  for (int i = 0; i < 200'000; ++i) {
    const double x = random.over_magnitudes(-500, 500), y = x * random.over_magnitudes(-6, 6);
    const auto lx = static_cast<long double>(x), ly = static_cast<long double>(y);
    ASSERT_LE(error_of(kerf::atan2(y, x), std::atan2(ly, lx)), 2.3) << y << ' ' << x;
    ASSERT_LE(error_of(kerf::hypot(x, y), std::hypot(lx, ly)), 1.2) << x << ' ' << y;
  }
}

const double special[] = {0.0,          -0.0,   1.0,           -1.0,  0.5,    -0.5,   2.0, -2.0, 3.0, -3.0,
                          0x1p52 + 1.0, 0x1p53, -0x1p52 - 1.0, 1e300, -1e300, 1e-300, inf, -inf, nan};

/// The same number with the same sign, or both NaN; a value that is rounded may differ by its error.
void expect_alike(double ours, double right, const std::string& what) {
  if (std::isnan(right)) {
    EXPECT_TRUE(std::isnan(ours)) << what << ": " << ours;
  } else if (right == 0.0 || std::isinf(right)) {
    EXPECT_EQ(ours, right) << what;
    EXPECT_EQ(std::signbit(ours), std::signbit(right)) << what;
  } else {
    EXPECT_LE(error_of(ours, static_cast<long double>(right)), 3.5) << what << ": " << ours << ", " << right;
  }
}

TEST(Functions, special_values_are_those_of_the_library) {
  for (const double x : special) {
    const std::string at = std::to_string(x);
    expect_alike(kerf::exp(x), std::exp(x), "exp " + at);
    expect_alike(kerf::expm1(x), std::expm1(x), "expm1 " + at);
    expect_alike(kerf::log(x), std::log(x), "log " + at);
    expect_alike(kerf::tanh(x), std::tanh(x), "tanh " + at);
    expect_alike(kerf::atan(x), std::atan(x), "atan " + at);
    expect_alike(kerf::asin(x), std::asin(x), "asin " + at);
    expect_alike(kerf::acos(x), std::acos(x), "acos " + at);
    if (!(std::fabs(x) > 0x1p20)) {
      expect_alike(kerf::sin(x), std::sin(x), "sin " + at);
      expect_alike(kerf::cos(x), std::cos(x), "cos " + at);
    } else {
      EXPECT_TRUE(std::isnan(kerf::sin(x)) && std::isnan(kerf::cos(x)) && std::isnan(kerf::tan(x)));
    }
    for (const double y : special) {
      const std::string both = at + " " + std::to_string(y);
      expect_alike(kerf::pow(x, y), std::pow(x, y), "pow " + both);
      expect_alike(kerf::atan2(x, y), std::atan2(x, y), "atan2 " + both);
      if (!(std::isnan(x) || std::isnan(y))) expect_alike(kerf::hypot(x, y), std::hypot(x, y), "hypot " + both);
    }
  }
  for (const double x : {-745.13321910194122, -745.2, -708.4, 709.78271289338397, 709.78271289338409, 1000.0})
    expect_alike(kerf::exp(x), std::exp(x), "exp " + std::to_string(x));
}

TEST(Functions, floats_are_rounded_doubles) {
  static_assert(std::is_same_v<decltype(kerf::exp(1.0f)), float> && std::is_same_v<decltype(kerf::exp(1)), double>);
  Random random;
  for (int i = 0; i < 20'000; ++i) {
    const auto x = static_cast<float>(random.between(0.01, 20.0)), y = static_cast<float>(random.between(-5.0, 5.0));
    EXPECT_EQ(kerf::exp(x), static_cast<float>(std::exp(static_cast<long double>(x))));
    EXPECT_EQ(kerf::log(x), static_cast<float>(std::log(static_cast<long double>(x))));
    EXPECT_EQ(kerf::pow(x, y), static_cast<float>(std::pow(static_cast<long double>(x), static_cast<long double>(y))));
  }
}

/// A function in loops that the compiler vectorises, and alone.
template <class Function>
struct InLoop {
  [[gnu::noinline]] static void lanes(const double* x, double* result) {
#pragma omp simd
    for (int l = 0; l < kerf::lane_width; ++l) result[l] = Function{}(x[l]);
  }
  [[gnu::noinline]] static double alone(double x) { return Function{}(x); }
};

std::uint64_t mixed(std::uint64_t hash, double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return (hash ^ bits) * 1099511628211u;  // Fowler, Noll & Vo
}

/// Hash of many results; each lane has to give what the function gives alone.
template <class Function>
std::uint64_t hash_of_results(double low, double high, Function) {
  using Loop = InLoop<Function>;
  Random random;
  std::uint64_t hash = 14695981039346656037u;
  alignas(64) double x[kerf::lane_width], result[kerf::lane_width];
  for (int i = 0; i < 20'000; ++i) {
    for (double& each : x) each = random.between(low, high);
    Loop::lanes(x, result);
    for (int l = 0; l < kerf::lane_width; ++l) {
      if (result[l] != Loop::alone(x[l])) return 0;
      hash = mixed(hash, result[l]);
    }
  }
  return hash;
}

#define KERF_CALL(call) \
  [](double x) __attribute__((always_inline)) { return call; }

// The hashes were printed by this test itself. What it shows is that they are the same everywhere: no compiler, machine
// or option may change one. They change with the functions, on purpose only.
TEST(Functions, bits_are_the_same_in_every_lane_on_every_machine) {
  EXPECT_EQ(hash_of_results(-700.0, 700.0, KERF_CALL(kerf::exp(x))), 7578836497015087598u);
  EXPECT_EQ(hash_of_results(-3.0, 3.0, KERF_CALL(kerf::expm1(x))), 5901239060348571834u);
  EXPECT_EQ(hash_of_results(0.0, 3.0, KERF_CALL(kerf::log(x))), 6876952334295860785u);
  EXPECT_EQ(hash_of_results(0.0, 3.0, KERF_CALL(kerf::pow(x, 0.168))), 7382443206039255257u);
  EXPECT_EQ(hash_of_results(-300.0, 300.0, KERF_CALL(kerf::pow(3.3, x))), 5332426401140816268u);
  EXPECT_EQ(hash_of_results(-9.0, 9.0, KERF_CALL(kerf::sin(x))), 2480872066349541461u);
  EXPECT_EQ(hash_of_results(-1e6, 1e6, KERF_CALL(kerf::cos(x))), 16567066277769970190u);
  EXPECT_EQ(hash_of_results(-9.0, 9.0, KERF_CALL(kerf::tan(x))), 9884781668440803974u);
  EXPECT_EQ(hash_of_results(-1.0, 1.0, KERF_CALL(kerf::asin(x))), 9251153842934932629u);
  EXPECT_EQ(hash_of_results(-1.0, 1.0, KERF_CALL(kerf::acos(x))), 17908033294058494874u);
  EXPECT_EQ(hash_of_results(-9.0, 9.0, KERF_CALL(kerf::atan2(x, 1.5))), 10404280043486985427u);
  EXPECT_EQ(hash_of_results(-9.0, 9.0, KERF_CALL(kerf::atan2(1.5, x))), 3966824295911132734u);
  EXPECT_EQ(hash_of_results(-9.0, 9.0, KERF_CALL(kerf::tanh(x))), 1171361533096750757u);
  EXPECT_EQ(hash_of_results(0.01, 3.0, KERF_CALL(kerf::positive_log(x))), 8933686703149552589u);
  EXPECT_EQ(hash_of_results(0.01, 3.0, KERF_CALL(kerf::positive_power(x, 0.168))), 13491339412185772357u);
  EXPECT_EQ(hash_of_results(-1.0, 1.0, KERF_CALL(kerf::hypot(x, 0.3))), 12656303999661781037u);
  EXPECT_EQ(hash_of_results(-80.0, 80.0, KERF_CALL(kerf::exp(static_cast<float>(x)))), 3820431275085559589u);
}

}  // namespace
