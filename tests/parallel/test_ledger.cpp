// What the balance says about laws that give more to the nodes than they have taken.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "model/ledger.hpp"

namespace {

using namespace kerf;

Balance judged(double contact, double friction, double hourglass, double error) {
  Ledger ledger;
  ledger.initial_energy = 100.0;
  Balance b;
  b.contact = contact;
  b.friction = friction;
  b.hourglass = hourglass;
  b.error = error;
  ledger.judge(b);
  return b;
}

TEST(Ledger, counts_what_contact_and_hourglass_control_give_as_an_error_of_the_same_sign) {
  EXPECT_EQ(judged(5.0, 2.0, 1.0, 0.01).error, 0.01);
  const Balance contact = judged(1.0, 3.0, 1.0, 0.01);  // friction has taken 3 J, so impacts have given 2 J
  EXPECT_EQ(contact.given_back, 2.0);
  EXPECT_DOUBLE_EQ(contact.error, 0.03);
  const Balance hourglass = judged(5.0, 2.0, -4.0, -0.01);
  EXPECT_EQ(hourglass.hourglass_given_back, 4.0);
  EXPECT_DOUBLE_EQ(hourglass.error, -0.05);
}

std::vector<std::string> names_of(unsigned places) {
  std::vector<std::string> names;
  for (const BookLine& line : book_lines())
    if ((line.places & places) != 0) names.push_back(line.name);
  return names;
}

TEST(Books, keep_the_columns_of_history_csv_in_their_places) {
  const std::vector<std::string> columns = names_of(in_history);
  const std::vector<std::string> first = {"time",           "dt",           "kinetic",    "internal",   "hourglass",
                                          "bulk_viscosity", "contact",      "friction",   "external",   "eroded",
                                          "balance_error",  "momentum_x",   "momentum_y", "momentum_z", "mass",
                                          "eroded_count",   "let_go_count", "imbalance"};
  ASSERT_GE(columns.size(), first.size());
  EXPECT_TRUE(std::equal(first.begin(), first.end(), columns.begin()));
}

TEST(Books, add_up_what_has_to_stay_what_it_was) {
  Balance b;
  b.kinetic = 1.0;
  b.internal = 2.0;
  b.hourglass = 4.0;
  b.bulk_viscosity = 8.0;
  b.contact = 16.0;
  b.eroded = 32.0;
  b.chemical = 64.0;
  b.friction = b.external = b.initial = 1e6;  // a share of contact, what was put in, and what there was
  b.released = b.eroded_chemical = 1e6;  // shares of other lines
  EXPECT_EQ(b.total(), 127.0);
}

TEST(Accounts, keep_their_places_in_restart_files) {
  Accounts a;
  a.hourglass = 1;
  a.contact = 2;
  a.external = 3;
  a.impulse = {7, 8, 9};
  a.dropped_mass = 13;
  a.eroded_elements = 14;
  a.friction = 15;
  const AccountNumbers n = numbers_of(a);
  ASSERT_GE(n.size(), 15u);
  EXPECT_EQ(n[0], 1);
  EXPECT_EQ(n[1], 2);
  EXPECT_EQ(n[2], 3);
  EXPECT_EQ(n[6], 7);
  EXPECT_EQ(n[8], 9);
  EXPECT_EQ(n[12], 13);
  EXPECT_EQ(n[13], 14);
  EXPECT_EQ(n[14], 15);
  EXPECT_EQ(numbers_of(accounts_of(n)), n);
}

}  // namespace
