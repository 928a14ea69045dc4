// How often the rounds of impacts were too few.
#include <gtest/gtest.h>

#include "contact/impacts.hpp"

namespace {

using namespace kerf;

TEST(ImpactTally, counts_steps_that_act_that_end_too_early_and_that_had_all_rounds) {
  ImpactTally tally;
  const auto step = [&](int rounds, std::int64_t last_bad_look, double excess) {
    tally.add({rounds, 0.0}, {last_bad_look, excess});
  };
  step(12, 0, 0.0);  // nothing touches
  EXPECT_EQ(tally.steps, 0);
  step(12, 9, 1.0);  // solved in time
  EXPECT_EQ(tally.steps, 1);
  EXPECT_EQ(tally.unsettled, 0);
  step(12, 12, 1.0);  // too much in the last look, and the next step gets more rounds
  EXPECT_EQ(tally.unsettled, 1);
  EXPECT_EQ(tally.at_limit, 0);
  EXPECT_GT(Impacts::next_pace({12, 0.0}, {12, 1.0}).rounds, 12);
  step(Impacts::most_rounds, Impacts::most_rounds, 1.0);
  EXPECT_EQ(tally.steps, 3);
  EXPECT_EQ(tally.unsettled, 2);
  EXPECT_EQ(tally.at_limit, 1);
}

}  // namespace
