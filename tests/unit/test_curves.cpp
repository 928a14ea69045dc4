// Requirement: a curve is what its points say, from a table or from a file, and every fault of a file has its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "input/csv_table.hpp"
#include "input/curve_table.hpp"
#include "kerf/curve.hpp"

namespace {

using namespace kerf;
using ::testing::ElementsAre;

TEST(Curve, is_linear_between_its_points_and_constant_outside) {
  const Curve curve({1.0, 2.0, 4.0}, {0.0, 1.0, -3.0});
  EXPECT_EQ(curve.at(-5.0), 0.0);
  EXPECT_EQ(curve.at(1.0), 0.0);
  EXPECT_EQ(curve.at(1.25), 0.25);
  EXPECT_EQ(curve.at(2.0), 1.0);
  EXPECT_EQ(curve.at(3.0), -1.0);
  EXPECT_EQ(curve.at(4.0), -3.0);
  EXPECT_EQ(curve.at(1e9), -3.0);
  EXPECT_EQ(curve.greatest(), 3.0);
}

TEST(Curve, of_one_point_is_constant) {
  EXPECT_EQ(Curve({3.0}, {7.0}).at(-1.0), 7.0);
  EXPECT_EQ(Curve({3.0}, {7.0}).at(5.0), 7.0);
}

TEST(Curve, repeats_after_its_period_and_closes_the_gap) {
  const Curve curve({1.0, 2.0, 4.0}, {0.0, 1.0, -3.0}, 4.0);
  EXPECT_EQ(curve.at(4.5), -1.5);  // half of the way from the last point to the first one of the next period
  for (const double t : {1.0, 1.25, 3.0, 4.0, 4.5})
    for (const double shift : {-8.0, -4.0, 4.0, 400.0})
      EXPECT_EQ(curve.at(t + shift), curve.at(t)) << t << " " << shift;
}

TEST(Curve, whose_points_fill_the_period_jumps) {
  const Curve saw({0.0, 1.0}, {0.0, 1.0}, 1.0);
  EXPECT_EQ(saw.at(0.75), 0.75);
  EXPECT_EQ(saw.at(1.0), 0.0);
  EXPECT_EQ(saw.at(-0.25), 0.75);
}

TEST(Curve, tells_its_slope_from_a_time_on) {
  const Curve curve({1.0, 2.0, 4.0}, {0.0, 1.0, -3.0}), again({1.0, 2.0, 4.0}, {0.0, 1.0, -3.0}, 4.0);
  for (const auto& [time, slope] : {std::pair{0.5, 0.0}, {1.0, 1.0}, {1.9, 1.0}, {2.0, -2.0}, {4.0, 0.0}, {9.0, 0.0}})
    EXPECT_EQ(curve.slope_after(time), slope) << time;
  for (const auto& [time, slope] : {std::pair{-1.0, -2.0}, {0.5, 3.0}, {1.0, 1.0}, {4.5, 3.0}, {5.0, 1.0}, {6.5, -2.0}})
    EXPECT_EQ(again.slope_after(time), slope) << time;
  EXPECT_EQ(Curve({3.0}, {7.0}).slope_after(3.0), 0.0);
}

TEST(Curve, that_is_absent_is_one) {
  EXPECT_EQ(value_of(nullptr, 3.0), 1.0);
  EXPECT_EQ(greatest_of(nullptr), 1.0);
}

TEST(CsvTable, reads_chosen_columns_by_name_and_by_number) {
  Diagnostics diagnostics;
  const std::string text = "# a gauge\r\n\r\ntime, p1 ,p2\r\n 0,1,10\r\n1e-6,2, 20\r\n";
  const CsvColumns by_name = read_csv_columns(text, "a.csv", {"time", "p2"}, diagnostics);
  EXPECT_THAT(by_name.first, ElementsAre(0.0, 1e-6));
  EXPECT_THAT(by_name.second, ElementsAre(10.0, 20.0));
  EXPECT_THAT(by_name.line, ElementsAre(4, 5));
  EXPECT_THAT(by_name.column, ElementsAre(2, 1));
  EXPECT_THAT(read_csv_columns(text, "a.csv", {"1", "2"}, diagnostics).second, ElementsAre(1.0, 2.0));
  EXPECT_THAT(read_csv_columns("0,1\n1,2", "a.csv", {"1", "2"}, diagnostics).second, ElementsAre(1.0, 2.0));
  EXPECT_FALSE(diagnostics.has_errors());
}

std::vector<std::string> csv_errors(const std::string& text, const std::vector<std::string>& columns) {
  Diagnostics diagnostics;
  read_csv_columns(text, "a.csv", columns, diagnostics);
  return diagnostics.errors();
}

TEST(CsvTable, names_file_line_and_column_of_each_fault) {
  EXPECT_THAT(csv_errors("", {"1", "2"}),
              ElementsAre("a.csv:1:1: error: the file holds no numbers; expected at least one line of them"));
  EXPECT_THAT(csv_errors("t,p\n", {"1", "2"}),
              ElementsAre("a.csv:1:1: error: no line of numbers follows the heading; expected at least one"));
  EXPECT_THAT(csv_errors("t,p\n0,1\n1, 2x\n", {"t", "p"}),
              ElementsAre("a.csv:3:4: error: \"2x\" is not a number; expected one without unit, for example 2.5e-6"));
  EXPECT_THAT(
      csv_errors("t,p\n0,1\n1\n", {"t", "p"}),
      ElementsAre("a.csv:3:1: error: the line has 1 field, and column p is asked for; expected a number there"));
  EXPECT_THAT(csv_errors("time,p\n0,1\n", {"tim", "p"}),
              ElementsAre("a.csv:1:1: error: there is no column \"tim\"; did you mean `time`?"));
  EXPECT_THAT(csv_errors("# of one\n0\n", {"1", "2"}),
              ElementsAre("a.csv:2:1: error: there is no column 2; this line has 1 field"));
}

/// One curve of an input, with a file that says `text`.
class Curves {
 public:
  explicit Curves(const std::string& text = {}) : text_(text) { inputs_.push_back(std::make_unique<CurveInput>()); }
  CurveInput& input() { return *inputs_.front(); }
  CurveTable table() {
    input().name = "pulse";
    return CurveTable(
        inputs_, "cases",
        [this](const std::string& path, std::string& failure) {
          asked.push_back(path);
          if (text_.empty()) failure = "there is none";
          return text_;
        },
        origins_, diagnostics);
  }
  Diagnostics diagnostics;
  std::vector<std::string> asked;

 private:
  std::string text_;
  CurveTable::Inputs inputs_;
  OriginMap origins_;
};

TEST(CurveTable, scales_times_and_values) {
  Curves curves;
  curves.input().times = {0.0, 2.0};
  curves.input().values = {0.0, 1.0};
  curves.input().time_scale = 1e-6;
  curves.input().value_scale = -3.0;
  CurveTable table = curves.table();
  EXPECT_EQ(table.find("pulse")->at(1e-6), -1.5);
  EXPECT_EQ(table.find("puls"), nullptr);
  EXPECT_FALSE(curves.diagnostics.has_errors());
}

TEST(CurveTable, reads_a_file_from_the_folder_of_the_input_once) {
  Curves curves("0,0\n2,1\n");
  curves.input().file = "data/pulse.csv";
  curves.input().columns = {"1", "2"};
  CurveTable table = curves.table();
  EXPECT_EQ(table.find("pulse")->at(1.0), 0.5);
  EXPECT_EQ(table.find("pulse")->at(2.0), 1.0);
  table.finish();
  EXPECT_THAT(curves.asked, ElementsAre("cases/data/pulse.csv"));
  EXPECT_THAT(table.file_texts(), ElementsAre("0,0\n2,1\n"));
  EXPECT_TRUE(curves.diagnostics.warnings().empty());
}

TEST(CurveTable, refuses_files_that_cannot_be_and_warns_of_what_nobody_uses) {
  Curves falling("0,0\n2,1\n2,3\n"), absent;
  for (Curves* c : {&falling, &absent}) {
    c->input().file = "pulse.csv";
    c->input().columns = {"1", "2"};
    c->table().finish();
  }
  EXPECT_THAT(falling.diagnostics.errors(),
              ElementsAre("cases/pulse.csv:3:1: error: the time 2 follows 2; expected times that ascend strictly"));
  EXPECT_THAT(
      absent.diagnostics.errors(),
      ElementsAre("error: the file \"cases/pulse.csv\" cannot be read: there is none; expected a CSV file, named "
                  "relative to the input file"));
  Curves idle;
  idle.input().times = {0.0};
  idle.input().values = {1.0};
  idle.table().finish();
  ASSERT_EQ(idle.diagnostics.warnings().size(), 1u);
  EXPECT_THAT(idle.diagnostics.warnings().front(), ::testing::HasSubstr("nothing uses the curve `pulse`"));
}

}  // namespace
