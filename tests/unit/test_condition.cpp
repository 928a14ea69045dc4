// Conditions of the input: values, precedence, units, and what is refused and where.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/condition.hpp"

namespace {

using namespace kerf;

const std::map<std::string, std::string> units = {{"damage", "-"}, {"pressure", "Pa"}, {"temperature", "K"},
                                                  {"rate", "1/s"}, {"energy", "J"},    {"volume", "m3"}};

std::optional<std::string> unit_of(const std::string& name) {
  const auto found = units.find(name);
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

std::vector<Condition::Fault> faults(const std::string& text) { return Condition(text).faults(unit_of); }

/// The only fault's offset and sentence.
std::string only_fault(const std::string& text) {
  const auto all = faults(text);
  return all.size() == 1 ? std::to_string(all[0].offset) + ": " + all[0].sentence
                         : std::to_string(all.size()) + " faults";
}

bool holds(const std::string& text, const std::map<std::string, double>& values = {}) {
  const Condition e(text);
  EXPECT_TRUE(e.faults(unit_of).empty()) << text << ": " << only_fault(text);
  std::vector<std::vector<double>> rows;
  std::vector<const double*> pointers;
  for (const Condition::Variable& v : e.variables()) rows.emplace_back(lane_width, values.at(v.name));
  for (const auto& row : rows) pointers.push_back(row.data());
  double out[lane_width];
  e.evaluate(pointers.data(), out);
  EXPECT_TRUE(std::all_of(out, out + lane_width, [&](double v) { return v == out[0]; }));
  return out[0] == 1.0;
}

TEST(Condition, knows_precedence) {
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

TEST(Condition, converts_units) {
  EXPECT_TRUE(holds("pressure < -1.2 GPa", {{"pressure", -1.2000001e9}}));
  EXPECT_FALSE(holds("pressure < -1.2 GPa", {{"pressure", -1.1999999e9}}));
  EXPECT_TRUE(holds("rate > 5 1/ms", {{"rate", 5001.0}}));
  EXPECT_TRUE(holds("pressure > 3 kJ/m3", {{"pressure", 3001.0}}));
  EXPECT_TRUE(holds("energy / volume > 2 MPa", {{"energy", 3.0}, {"volume", 1e-6}}));
  EXPECT_TRUE(holds("temperature > 1e3", {{"temperature", 1001.0}}));  // bare numbers are in SI
  EXPECT_TRUE(holds("1 mm / 1 um == 1000 or abs(1 mm / 1 um - 1000) < 1e-9"));
}

TEST(Condition, evaluates_points_side_by_side) {
  const Condition e("damage > 0.9 and pressure < 0");
  ASSERT_TRUE(e.faults(unit_of).empty());
  double damage[lane_width], pressure[lane_width], out[lane_width];
  for (int l = 0; l < lane_width; ++l) {
    damage[l] = l % 2 == 0 ? 0.95 : 0.5;
    pressure[l] = l < 4 ? -1.0 : 1.0;
  }
  const double* rows[] = {damage, pressure};
  e.evaluate(rows, out);
  for (int l = 0; l < lane_width; ++l) EXPECT_EQ(out[l], l % 2 == 0 && l < 4 ? 1.0 : 0.0);
  EXPECT_FALSE(holds("damage > 0.9", {{"damage", std::nan("")}}));
}

TEST(Condition, lists_its_variables_once) {
  const Condition e("damage > 0.9 and (pressure < 0 or damage > 2 * pressure / pressure)");
  ASSERT_EQ(e.variables().size(), 2u);
  EXPECT_EQ(e.variables()[0].name, "damage");
  EXPECT_EQ(e.variables()[1].name, "pressure");
  EXPECT_EQ(e.variables()[1].offset, 18);
}

TEST(Condition, refuses_wrong_dimensions_where_they_are) {
  EXPECT_EQ(only_fault("damage > 0.9 and pressure < 3 mm"),
            "26: the sides of this operator have different dimensions, m-1 kg s-2 and m; expected the same");
  EXPECT_EQ(only_fault("damage > 1 GPa"),
            "7: the sides of this operator have different dimensions, no unit and m-1 kg s-2; expected the same");
  EXPECT_EQ(only_fault("exp(temperature) > 1"), "0: exp takes a number without unit, and this has K");
  EXPECT_EQ(only_fault("pressure ^ damage > 1"),
            "9: a quantity with a unit is raised to a power that is not written as a number");
  EXPECT_TRUE(faults("sqrt(pressure ^ 2) > 1 MPa").empty());
}

TEST(Condition, refuses_what_is_no_condition) {
  EXPECT_EQ(only_fault("damage"), "0: expected a condition, such as \"damage > 0.9\", and this is a number");
  EXPECT_EQ(only_fault("damage and damage > 1"), "7: expected conditions at this operator, and one side is a number");
  EXPECT_EQ(only_fault("(damage > 1) + 1 > 2"), "13: expected numbers at this operator, and one side is a condition");
}

TEST(Condition, refuses_what_cannot_be_read_where_it_is) {
  EXPECT_EQ(only_fault("damage > "), "9: expected a value before the end");
  EXPECT_EQ(only_fault("damage > 1)"), "10: expected an operator or the end");
  EXPECT_EQ(only_fault("(damage > 1"), "11: expected a closing parenthesis");
  EXPECT_EQ(only_fault("0 < damage < 1"), "11: expected `and` between two comparisons");
  EXPECT_EQ(only_fault("pressure > 1 Gpa"),
            "13: \"Gpa\" is no unit, or has a shifted zero; expected a unit such as GPa, m/s or K");
  EXPECT_EQ(only_fault("temperature > 20 degC"),
            "17: \"degC\" is no unit, or has a shifted zero; expected a unit such as GPa, m/s or K");
  EXPECT_EQ(only_fault("sin(damage) > 1"),
            "0: there is no function \"sin\"; the functions are abs, sqrt, exp, log, min and max");
  EXPECT_EQ(only_fault("max(damage) > 1"), "10: expected a comma and a second value");
  EXPECT_EQ(only_fault("damage > 1 and"), "14: expected a value before the end");
  EXPECT_EQ(only_fault(""), "0: expected a value before the end");
  EXPECT_EQ(faults(std::string(5000, '(')).size(), 1u);
  EXPECT_EQ(faults(std::string(5000, '-') + "1 > 0").size(), 1u);
}

}  // namespace
