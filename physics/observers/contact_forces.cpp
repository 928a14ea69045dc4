// What contact definitions do to parts over time.
#include "kerf/observer.hpp"

namespace kerf {
namespace {

class ContactForces final : public Observer {
 public:
  static void describe(Schema<ContactForces>& s) {
    s.texts(&ContactForces::names, "parts", "parts on which forces are reported; all where absent").optional();
    describe_interval(s);
  }

  std::vector<std::string> references() const override { return names; }
  ObserverCalls calls() const override { return {.contacts = true}; }

  void prepare(ObservedModel& model) override {
    if (names.empty())
      for (const ObservedPart& part : model.parts) names.push_back(part.name);
    for (const ObservedContact& contact : model.contacts()) definitions.push_back(contact.name);
    if (definitions.empty())
      throw std::runtime_error("the model has no contact definition; expected at least one under `contacts`");
  }

  std::vector<ObservedColumn> columns() const override {
    std::vector<ObservedColumn> all;
    for (const std::string& contact : definitions) {
      all.push_back({contact + ".work", "J", "energy taken from the nodes"});
      all.push_back({contact + ".friction_work", "J", "the share of friction in it"});
      for (const std::string& part : names)
        for (const char* axis : {"x", "y", "z"}) {
          all.push_back({contact + "." + part + ".force_" + axis, "N", "force on the part in the coming step"});
          all.push_back({contact + "." + part + ".impulse_" + axis, "N s", "impulse on the part since time zero"});
        }
    }
    return all;
  }

  void sample(ObservedModel& model, std::span<double> row) override {
    std::size_t at = 0;
    for (const ObservedContact& contact : model.contacts()) {
      row[at++] = contact.work;
      row[at++] = contact.friction_work;
      for (const std::string& name : names) {
        const auto part = static_cast<std::size_t>(model.find_part(name));
        for (int d = 0; d < 3; ++d) {
          row[at++] = contact.force[part][d];
          row[at++] = contact.impulse[part][d];
        }
      }
    }
  }

 private:
  std::vector<std::string> names, definitions;
};

}  // namespace
}  // namespace kerf

KERF_OBSERVER(kerf::ContactForces, "contact_forces", "force, impulse and work of every contact definition over time")
