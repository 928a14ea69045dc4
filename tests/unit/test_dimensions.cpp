// Requirement: a condition of the input whose sides have different dimensions, or that is none, is refused where it is
// wrong; units are converted.
#include "core/dimensions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/expression.hpp"

namespace {

using namespace kerf;

const std::map<std::string, std::string> units = {{"damage", "-"}, {"pressure", "Pa"}, {"temperature", "K"},
                                                  {"rate", "1/s"}, {"energy", "J"},    {"volume", "m3"}};

std::optional<std::string> unit_of(const std::string& name) {
  const auto found = units.find(name);
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

std::vector<DimensionFault> faults(const std::string& text) {
  const ReadExpression read = read_expression(text, {});
  EXPECT_EQ(read.error, "");
  return faults_of_condition(read.expression, unit_of);
}

/// The only fault's offset and sentence.
std::string only_fault(const std::string& text) {
  const auto all = faults(text);
  return all.size() == 1 ? std::to_string(all[0].offset) + ": " + all[0].sentence
                         : std::to_string(all.size()) + " faults";
}

bool holds(const std::string& text, const std::map<std::string, double>& values = {}) {
  const ReadExpression read = read_expression(text, {});
  EXPECT_EQ(read.error, "");
  EXPECT_TRUE(faults_of_condition(read.expression, unit_of).empty()) << text << ": " << only_fault(text);
  std::vector<double> row;
  for (const std::string& name : read.expression.variables()) row.push_back(values.at(name));
  return read.expression.value(row.data()) == 1.0;
}

TEST(Dimensions, conditions_know_precedence) {
  EXPECT_TRUE(holds("1 + 2 * 3 ^ 2 == 19"));
  EXPECT_TRUE(holds("-2 ^ 2 == -4"));
  EXPECT_TRUE(holds("2 ^ -1 == 0.5"));
  EXPECT_TRUE(holds("8 / 2 / 2 == 2 and 8 - 2 - 2 == 4"));
  EXPECT_TRUE(holds("1 < 2 or 1 > 2 and 1 > 2"));  // and is stronger
  EXPECT_FALSE(holds("(1 < 2 or 1 > 2) and 1 > 2"));
  EXPECT_TRUE(holds("not 1 > 2 and 1 < 2"));
  EXPECT_FALSE(holds("not (1 > 2 or 1 < 2)"));
  EXPECT_TRUE(holds("max(1, min(5, 3)) == 3 and abs(-2) == 2 and sqrt(9) == 3 and exp(0) == 1 and log(1) == 0"));
  EXPECT_TRUE(holds("1.5e3 >= 1500 and 1500 <= .15e4 and 1 != 2"));
}

TEST(Dimensions, units_are_converted) {
  EXPECT_TRUE(holds("pressure < -1.2 GPa", {{"pressure", -1.2000001e9}}));
  EXPECT_FALSE(holds("pressure < -1.2 GPa", {{"pressure", -1.1999999e9}}));
  EXPECT_TRUE(holds("rate > 5 1/ms", {{"rate", 5001.0}}));
  EXPECT_TRUE(holds("pressure > 3 kJ/m3", {{"pressure", 3001.0}}));
  EXPECT_TRUE(holds("energy / volume > 2 MPa", {{"energy", 3.0}, {"volume", 1e-6}}));
  EXPECT_TRUE(holds("temperature > 1e3", {{"temperature", 1001.0}}));  // bare numbers are in SI
  EXPECT_TRUE(holds("1 mm / 1 um == 1000 or abs(1 mm / 1 um - 1000) < 1e-9"));
}

TEST(Dimensions, wrong_ones_are_refused_where_they_are) {
  EXPECT_EQ(only_fault("damage > 0.9 and pressure < 3 mm"),
            "26: the sides of this operator have different dimensions, m-1 kg s-2 and m; expected the same");
  EXPECT_EQ(only_fault("damage > 1 GPa"),
            "7: the sides of this operator have different dimensions, no unit and m-1 kg s-2; expected the same");
  EXPECT_EQ(only_fault("exp(temperature) > 1"), "0: this function takes a number without unit, and this has K");
  EXPECT_EQ(only_fault("pressure ^ damage > 1"),
            "9: a quantity with a unit is raised to a power that is not written as a number");
  EXPECT_TRUE(faults("sqrt(pressure ^ 2) > 1 MPa").empty());
  EXPECT_TRUE(faults("if(pressure > 0, temperature, 300 K) > 400 and atan2(pressure, 1 Pa) < 90 deg").empty());
  EXPECT_EQ(only_fault("if(damage > 0, temperature, pressure) > 1"),
            "0: the sides of this operator have different dimensions, K and m-1 kg s-2; expected the same");
  EXPECT_EQ(only_fault("max(temperature, 1 mm) > 1"),
            "0: the sides of this operator have different dimensions, K and m; expected the same");
}

TEST(Dimensions, what_is_no_condition_is_refused) {
  EXPECT_EQ(only_fault("damage"), "0: expected a condition, such as \"damage > 0.9\", and this is a number");
  EXPECT_EQ(only_fault("damage and damage > 1"), "7: expected conditions at this operator, and one side is a number");
  EXPECT_EQ(only_fault("(damage > 1) + 1 > 2"), "13: expected numbers at this operator, and one side is a condition");
}

}  // namespace
