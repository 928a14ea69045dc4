// What the balance says about laws that give more to the nodes than they have taken.
#include <gtest/gtest.h>

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

}  // namespace
