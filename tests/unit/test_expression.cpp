// Requirement: formulas of the input are computed as written, and what is none is refused with its place and the
// reason.
#include "core/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using kerf::Expression;
using kerf::read_expression;

const std::vector<std::string> names{"x", "y", "z", "r"};
const double values[] = {3.0, 4.0, -2.0, 5.0};

double value_of(const std::string& text) {
  const auto read = read_expression(text, names);
  EXPECT_EQ(read.error, "");
  return read.expression.value(values);
}
std::string error_of(const std::string& text) { return read_expression(text, names).error; }

struct Good {
  const char* text;
  double value;
};
class Computes : public testing::TestWithParam<Good> {};

TEST_P(Computes, value) {
  // Single operations are exact here; functions err by two units in the last place, units by a rounded factor.
  EXPECT_NEAR(value_of(GetParam().text), GetParam().value, 1e-14 * std::abs(GetParam().value));
}

INSTANTIATE_TEST_SUITE_P(Operators, Computes,
                         testing::Values(Good{"1 + 2 * 3", 7.0}, Good{"(1 + 2) * 3", 9.0}, Good{"2 - 3 - 4", -5.0},
                                         Good{"24 / 4 / 2", 3.0}, Good{"-x^2", -9.0}, Good{"2^3^2", 512.0},
                                         Good{"2^-1", 0.5}, Good{"-2^-2", -0.25}, Good{"3*-2", -6.0}, Good{"--3", 3.0},
                                         Good{"+x", 3.0}, Good{"x*y - z", 14.0}, Good{"(r)", 5.0}));

INSTANTIATE_TEST_SUITE_P(Truth, Computes,
                         testing::Values(Good{"x < y", 1.0}, Good{"x > y", 0.0}, Good{"x <= 3", 1.0},
                                         Good{"x >= 3.5", 0.0}, Good{"x == 3", 1.0}, Good{"x != 3", 0.0},
                                         Good{"x < y and z < 0", 1.0}, Good{"x > y and z < 0 or r == 5", 1.0},
                                         Good{"not x > y", 1.0}, Good{"not not x", 1.0},
                                         Good{"not (x < y or z > 0)", 0.0}, Good{"x + 1 == y", 1.0},
                                         Good{"1 or 0 and 0", 1.0}, Good{"not 0 and 0", 0.0},
                                         Good{"if(x < y, 10, 20) + 1", 11.0}));

INSTANTIATE_TEST_SUITE_P(Functions, Computes,
                         testing::Values(Good{"sqrt(x*x + y*y)", 5.0}, Good{"exp(1)", 2.718281828459045},
                                         Good{"log(10)", 2.302585092994046}, Good{"log10(1000)", 3.0},
                                         Good{"min(4, x, 9, y)", 3.0}, Good{"max(4, x, 9, y)", 9.0},
                                         Good{"abs(z)", 2.0}, Good{"sign(z)", -1.0}, Good{"sin(pi/6)", 0.5},
                                         Good{"cos(60 deg)", 0.5}, Good{"tan(45 deg)", 1.0},
                                         Good{"asin(1)", 1.5707963267948966}, Good{"acos(0)", 1.5707963267948966},
                                         Good{"atan(1)", 0.7853981633974483}, Good{"atan2(1, -1)", 2.356194490192345},
                                         Good{"tanh(0.5)", 0.46211715726000973}, Good{"hypot(x, y)", 5.0}));

INSTANTIATE_TEST_SUITE_P(Units, Computes,
                         testing::Values(Good{"2 GPa", 2e9}, Good{"x * 5 mm", 0.015}, Good{"300 m/s", 300.0},
                                         Good{"8.93 g/cm3", 8930.0}, Good{"1.5kJ/g", 1.5e6}, Good{"26.85 degC", 300.0},
                                         Good{"90 deg/s", 1.5707963267948966}, Good{"2 us", 2e-6},
                                         Good{"2 µs + 1 ns", 2.001e-6}, Good{"3 m and 1", 1.0}, Good{"6 mm / x", 0.002},
                                         Good{"1 kHz", 1000.0}, Good{"5 1/ms + 1", 5001.0}));

TEST(Expression, says_what_is_wrong_and_where) {
  EXPECT_EQ(error_of("1 + w"), "\"1 + w\", character 5: there is no variable `w`; the variables are x, y, z, r");
  EXPECT_EQ(error_of("sqr(x)"), "\"sqr(x)\", character 1: there is no function `sqr`; did you mean sqrt?");
  EXPECT_EQ(error_of("x +"), "\"x +\", character 4: the formula ends too early; expected a number, a name or `(`");
  EXPECT_EQ(error_of("(x"), "\"(x\", character 3: the formula ends too early; expected `)`");
  EXPECT_EQ(error_of("x)"), "\"x)\", character 2: unexpected `)`; expected an operator or the end");
  EXPECT_EQ(error_of("x y"), "\"x y\", character 3: unexpected `y`; expected an operator or the end");
  EXPECT_EQ(error_of(""), "\"\", character 1: the formula ends too early; expected a number, a name or `(`");
  EXPECT_EQ(error_of("x ** 2"), "\"x ** 2\", character 3: `**` is no operator; write `^` for a power");
  EXPECT_EQ(error_of("x = 2"), "\"x = 2\", character 3: `=` compares nothing; write `==`");
  EXPECT_EQ(error_of("1 < x < 4"), "\"1 < x < 4\", character 7: comparisons do not chain; write `a < b and b < c`");
  EXPECT_EQ(error_of("atan2(1)"), "\"atan2(1)\", character 1: atan2 takes 2 arguments, not 1");
  EXPECT_EQ(error_of("max(1)"), "\"max(1)\", character 1: max takes at least 2 arguments, not 1");
  EXPECT_EQ(error_of("2 x"),
            "\"2 x\", character 1: \"2 x\" has the unknown unit \"x\"; write `*` between a number and a name");
  EXPECT_EQ(error_of("1e999"), "\"1e999\", character 1: `1e999` is no number that fits double precision");
  EXPECT_EQ(error_of("x and and y"),
            "\"x and and y\", character 7: unexpected `and`; expected a number, a name or `(`");
  EXPECT_EQ(error_of("$a"), "\"$a\", character 1: there is no parameter \"a\"; declare it in the block `parameters`");
}

TEST(Expression, no_text_exhausts_the_stack) {
  EXPECT_NE(error_of(std::string(100'000, '(')), "");
  EXPECT_NE(error_of(std::string(100'000, '-') + "x"), "");
  std::string right = "x", nots = "x";
  for (int i = 0; i < 1000; ++i) right = "x^" + right, nots = "not " + nots;
  EXPECT_NE(error_of(right), "");
  EXPECT_NE(error_of(nots), "");
  std::string deep = "x";
  for (int i = 0; i < 40; ++i) deep = "x + (" + deep;
  EXPECT_NE(error_of(deep + std::string(40, ')')), "");
}

TEST(Expression, parameters_stand_for_numbers_with_units) {
  const std::string speed = "2 km/s", text = "north";
  const auto parameter = [&](const std::string& name) {
    return name == "speed" ? &speed : name == "text" ? &text : nullptr;
  };
  const auto read = read_expression("-$speed * x", names, parameter);
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.expression.value(values), -6000.0);
  EXPECT_EQ(read_expression("$text", names, parameter).error,
            "\"$text\", character 1: the parameter $text is \"north\"; expected a number");
}

TEST(Expression, names_its_variables_where_they_are_left_open) {
  const auto read = read_expression("damage > 0.5 and pressure < 0 or damage > 1", {});
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.expression.variables(), (std::vector<std::string>{"damage", "pressure"}));
  const double state[] = {0.6, -1.0};
  EXPECT_EQ(read.expression.value(state), 1.0);
}

TEST(Expression, lanes_give_the_bits_of_single_points) {
  const auto read =
      read_expression("if(x > 0, x^y * exp(-z), max(x, sin(y))) + atan2(z, x) / (r - 1) < 7 mm * x", names);
  ASSERT_EQ(read.error, "");
  double rows[4][kerf::lane_width];
  for (int i = 0; i < 4; ++i)
    for (int l = 0; l < kerf::lane_width; ++l) rows[i][l] = 0.37 * (i + 1) * (l - 3.5);
  const double* places[] = {rows[0], rows[1], rows[2], rows[3]};
  double together[kerf::lane_width];
  read.expression.values(places, together);
  for (int l = 0; l < kerf::lane_width; ++l) {
    const double point[] = {rows[0][l], rows[1][l], rows[2][l], rows[3][l]};
    const double alone = read.expression.value(point);
    EXPECT_TRUE(alone == together[l] || (std::isnan(alone) && std::isnan(together[l])));
  }
}

TEST(Expression, a_number_that_is_none_remains_visible) {
  EXPECT_TRUE(std::isnan(value_of("sqrt(z)")));
  EXPECT_TRUE(std::isnan(value_of("min(1, sqrt(z))")));
  EXPECT_TRUE(std::isnan(value_of("max(sqrt(z), 1)")));
}

TEST(Expression, what_hangs_on_a_number_that_is_none_is_unknown) {
  const std::string none = "sqrt(z)";  // z is negative
  for (const std::string& text :
       {none + " < 1", none + " >= 1", none + " == " + none, none + " != 1", "not " + none + " < 1",
        "x > 0 and " + none + " < 1", none + " < 1 or x < 0", "if(" + none + " < 1, 2, 3)"})
    EXPECT_TRUE(std::isnan(value_of(text))) << text;
  // What does not hang on it is known.
  EXPECT_EQ(value_of("z > 0 and " + none + " < 1"), 0.0);
  EXPECT_EQ(value_of(none + " < 1 and z > 0"), 0.0);
  EXPECT_EQ(value_of("x > 0 or " + none + " < 1"), 1.0);
  EXPECT_EQ(value_of("if(z > 0, " + none + " < 1, 7)"), 7.0);
}

TEST(Expression, knows_where_its_parts_stand_and_their_units) {
  const auto read = read_expression("damage > 0.9 and (pressure < 3 GPa)", {});
  ASSERT_EQ(read.error, "");
  std::vector<int> places;
  for (const auto& i : read.expression.program()) places.push_back(i.offset);
  EXPECT_EQ(places, (std::vector<int>{0, 9, 7, 18, 29, 27, 13}));
  ASSERT_EQ(read.expression.units().size(), 1u);
  EXPECT_EQ(read.expression.units()[0], (Expression::Dimension{-1, 1, -2, 0, 0, 0, 0}));
  EXPECT_EQ(read.expression.program()[4].index, 1);
  EXPECT_EQ(read_expression("1 + w", names).offset, 4);
}

}  // namespace
