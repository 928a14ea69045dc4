// Laws against curves that an independent program has computed: every file of tests/data/laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/curves.hpp"

namespace {

using kerf::test::CurveResult;
using kerf::test::family_of;
using kerf::test::Oracle;

/// Names of all files, without ".csv".
std::vector<std::string> all_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(KERF_SOURCE_DIR) + "/tests/data/laws"))
    if (entry.path().extension() == ".csv") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class EveryFile : public testing::TestWithParam<std::string> {};

TEST_P(EveryFile, stay_within_their_tolerances) {
  const Oracle oracle(GetParam());
  const auto* family = family_of(oracle);
  if (family == nullptr) GTEST_SKIP() << "no law of this file is known";
  const std::vector<CurveResult> results = family->check(oracle);
  EXPECT_FALSE(results.empty());
  for (const CurveResult& r : results)
    EXPECT_TRUE(r.passes()) << family->law << ", " << r.column << ": error " << r.error << " over " << r.tolerance
                            << ", row " << r.row;
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryFile, testing::ValuesIn(all_files()), [](const auto& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
});

/// The root mean square error of the von Mises stress, with `factor` times the steps of the file's check.
double stress_error(const std::string& file, double factor) {
  const kerf::test::FinerSteps finer(factor);
  const Oracle oracle(file);
  for (const CurveResult& r : family_of(oracle)->check(oracle))
    if (r.column == "rms of von_mises_Pa") return r.error;
  return 0.0;
}

TEST(LawCurves, laws_with_rate_or_damage_converge_with_first_order) {
  // With half the step the error is half of what it was: between 0.4 and 0.6 of it.
  for (const char* file : {"jh2_alumina_uniaxial_strain", "zerilli_armstrong_bcc_iron_uniaxial_strain",
                           "cowper_symonds_plastic_uniaxial_strain", "steinberg_guinan_copper_uniaxial_strain",
                           "johnson_cook_uniaxial_strain"}) {
    const double ratio = stress_error(file, 0.5) / stress_error(file, 0.25);
    EXPECT_GT(ratio, 0.4) << file;
    EXPECT_LT(ratio, 0.6) << file;
  }
}

}  // namespace
