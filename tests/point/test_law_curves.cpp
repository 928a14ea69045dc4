// Laws against curves that an independent program has computed: the drive files of tests/curves, and every file of
// tests/data/laws that is no path of one element.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "drive/drive.hpp"
#include "support/curves.hpp"
#include "support/make_law.hpp"

namespace {

using kerf::DriveCheck;
using kerf::DrivenCurve;
using kerf::test::CurveResult;
using kerf::test::family_of;
using kerf::test::Oracle;

const std::string tests = std::string(KERF_SOURCE_DIR) + "/tests/";

/// Names of all files of a folder with an extension, without it.
std::vector<std::string> all_files(const std::string& folder, const std::string& extension) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(tests + folder))
    if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string test_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
}

class EveryFile : public testing::TestWithParam<std::string> {};

TEST_P(EveryFile, stay_within_their_tolerances) {
  const Oracle oracle(GetParam());
  const auto* family = family_of(oracle);
  if (family == nullptr) GTEST_SKIP() << "a path of tests/curves, or the case of a run";
  const std::vector<CurveResult> results = family->check(oracle);
  EXPECT_FALSE(results.empty());
  for (const CurveResult& r : results)
    EXPECT_TRUE(r.passes()) << family->law << ", " << r.column << ": error " << r.error << " over " << r.tolerance
                            << ", row " << r.row;
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryFile, testing::ValuesIn(all_files("data/laws", ".csv")),
                         [](const auto& info) { return test_name(info.param); });

/// The curves of a drive file of tests/curves, in `refine` times as many steps.
std::vector<DrivenCurve> driven(const std::string& law, double refine = 1.0,
                                const std::vector<std::string>& overrides = {}) {
  const std::string path = tests + "curves/" + law + ".yaml";
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  const auto input = kerf::read_drive_input(path, text.str(), overrides, kerf::test::builtin_plugins());
  return kerf::drive(*input, tests + "curves", refine);
}

class EveryPath : public testing::TestWithParam<std::string> {};

TEST_P(EveryPath, stays_within_its_tolerances) {
  for (const DrivenCurve& curve : driven(GetParam())) {
    EXPECT_FALSE(curve.checks.empty()) << curve.path;
    for (const DriveCheck& c : curve.checks)
      EXPECT_TRUE(c.passes()) << curve.path << ", " << c.column << ": error " << c.error << " over " << c.tolerance
                              << ", row " << c.row;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryPath, testing::ValuesIn(all_files("curves", ".yaml")),
                         [](const auto& info) { return test_name(info.param); });

/// Paths that a drive file of tests/curves or a family reads.
TEST(LawCurves, no_file_of_a_path_is_left_out) {
  std::string read;
  for (const std::string& law : all_files("curves", ".yaml")) {
    std::ifstream in(tests + "curves/" + law + ".yaml");
    read += std::string(std::istreambuf_iterator<char>(in), {});
  }
  for (const std::string& file : all_files("data/laws", ".csv")) {
    const Oracle oracle(file);
    if (!oracle.path.is_object() || oracle.law().empty()) continue;
    EXPECT_TRUE(family_of(oracle) != nullptr || read.find("/" + file + ".csv") != std::string::npos) << file;
  }
}

/// The root mean square error of the von Mises stress of a path, with `refine` times the steps of its file.
double stress_error(const std::string& law, const std::string& path, double refine) {
  for (const DrivenCurve& curve : driven(law, refine))
    for (const DriveCheck& c : curve.checks)
      if (curve.path == path && c.column == "rms of von_mises") return c.error;
  return 0.0;
}

TEST(LawCurves, laws_with_rate_or_damage_converge_with_first_order) {
  // With half the step the error is half of what it was: between 0.4 and 0.6 of it.
  for (const auto& [law, path] : {std::pair{"johnson_holmquist_2", "jh2_alumina_uniaxial_strain"},
                                  {"zerilli_armstrong", "zerilli_armstrong_bcc_iron_uniaxial_strain"},
                                  {"cowper_symonds", "cowper_symonds_plastic_uniaxial_strain"},
                                  {"power_law", "power_law_rate_uniaxial_strain"},
                                  {"steinberg_guinan", "steinberg_guinan_copper_uniaxial_strain"},
                                  {"johnson_cook", "johnson_cook_uniaxial_strain"}}) {
    const double ratio = stress_error(law, path, 0.25) / stress_error(law, path, 0.5);
    EXPECT_GT(ratio, 1.0 / 0.6) << path;
    EXPECT_LT(ratio, 1.0 / 0.4) << path;
  }
}

}  // namespace
