// Requirement: numbers with units become SI values, and everything else is refused with a sentence that helps.
#include "core/units.hpp"

#include <gtest/gtest.h>

namespace {

using kerf::to_si;

struct Good {
  const char *text, *unit;
  double value;
};
class Converts : public testing::TestWithParam<Good> {};

TEST_P(Converts, to_si) {
  const kerf::Quantity q = to_si(GetParam().text, GetParam().unit);
  EXPECT_EQ(q.error, "");
  // udunits2 multiplies by rounded factors; a few units in the last place are all that may differ.
  EXPECT_NEAR(q.value, GetParam().value, 1e-14 * std::abs(GetParam().value));
}

INSTANTIATE_TEST_SUITE_P(Units, Converts,
                         testing::Values(Good{"2.586 GPa", "Pa", 2.586e9}, Good{"1646 m/s", "m/s", 1646.0},
                                         Good{"7.805 g/cm3", "kg/m3", 7805.0},
                                         Good{"45 deg", "rad", 0.7853981633974483}, Good{"50 us", "s", 50e-6},
                                         Good{"50 µs", "s", 50e-6}, Good{"12.9mm", "m", 0.0129},
                                         Good{"1.5 km/s", "m/s", 1500.0}, Good{"26.85 degC", "K", 300.0},
                                         Good{"452 J/kg/K", "J/kg/K", 452.0}, Good{"3 kJ/g", "J/kg", 3e6},
                                         Good{"5 1/s", "1/s", 5.0}, Good{"1 Mbar", "Pa", 1e11},
                                         Good{"0.5 rad", "rad", 0.5}, Good{"1000 Hz", "1/s", 1000.0}));

INSTANTIATE_TEST_SUITE_P(BareNumbersAreSi, Converts,
                         testing::Values(Good{"1e-7", "s", 1e-7}, Good{"1.0e-7", "s", 1e-7}, Good{"+3", "-", 3.0},
                                         Good{"-1646", "m/s", -1646.0}, Good{".5", "-", 0.5},
                                         Good{"  7  ", "Pa", 7.0}));

struct Bad {
  const char *text, *unit, *message;
};
class Refuses : public testing::TestWithParam<Bad> {};

TEST_P(Refuses, with_this_message) { EXPECT_EQ(to_si(GetParam().text, GetParam().unit).error, GetParam().message); }

INSTANTIATE_TEST_SUITE_P(
    Units, Refuses,
    testing::Values(
        Bad{"5400 kg", "m/s", "\"5400 kg\" has the wrong dimension; expected a velocity in m/s, for example 5400 m/s"},
        Bad{"45 %", "rad", "\"45 %\" has the wrong dimension; expected an angle in rad, for example 45 rad"},
        Bad{"3 gpa", "Pa", "\"3 gpa\" has the unknown unit \"gpa\"; did you mean GPa?"},
        Bad{"3 furlongs/fortnite", "m/s",
            "\"3 furlongs/fortnite\" has the unknown unit \"furlongs/fortnite\"; expected a velocity in m/s"},
        Bad{"010", "m", "\"010\" begins with a zero, which some programs take for an octal number; leave the zero out"},
        Bad{"0x1F", "-", "\"0x1F\" is not a number; expected a number without unit"},
        Bad{"0.3 mm", "-", "\"0.3 mm\" has a unit; expected a number without unit, for example 0.3"},
        Bad{"m since 4", "m", "\"m since 4\" is not a number; expected a length in m"},
        Bad{"1 m since 4", "m", "\"1 m since 4\" has the unknown unit \"m since 4\"; expected a length in m"}));

INSTANTIATE_TEST_SUITE_P(Numbers, Refuses,
                         testing::Values(Bad{"", "m", "\"\" is not a number; expected a length in m"},
                                         Bad{"fast", "m/s", "\"fast\" is not a number; expected a velocity in m/s"},
                                         Bad{"nan", "-", "\"nan\" is not a number; expected a number without unit"},
                                         Bad{"inf", "Pa", "\"inf\" is not a number; expected a pressure in Pa"},
                                         Bad{".inf", "Pa", "\".inf\" is not a number; expected a pressure in Pa"},
                                         Bad{"1,5 mm", "m",
                                             "\"1,5 mm\" is not a number; write a decimal point, not a comma"},
                                         Bad{"1 000 m", "m", "\"1 000 m\" is not a number; expected a length in m"},
                                         Bad{"1e999", "-", "\"1e999\" does not fit a double-precision number"}));

TEST(ParseNumber, is_strict) {
  double value = 0.0;
  EXPECT_TRUE(kerf::parse_number(" 1e-7 ", value));
  EXPECT_EQ(value, 1e-7);
  EXPECT_FALSE(kerf::parse_number("1e-7s", value));
  EXPECT_FALSE(kerf::parse_number("0x10", value));
  EXPECT_FALSE(kerf::parse_number("infinity", value));
  EXPECT_FALSE(kerf::parse_number("", value));
}

}  // namespace
