// Books beside the ledger: impulse and work of each boundary condition and each contact definition.
//
// They are kept only where an observer asks for them. Everything is counted in whole quanta by the owner of a node.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "contact/engine.hpp"
#include "contact/load.hpp"
#include "model/ledger.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

class SideBooks {
 public:
  void keep_reactions(const Model& model);
  void keep_contacts(const Model& model);
  bool keeps_reactions() const { return !reactions_.empty(); }
  bool keeps_contacts() const { return !contacts_.empty(); }

  /// What one boundary condition has done to the nodes.
  struct Reaction {
    std::array<std::int64_t, 3> impulse{};  // [momentum quanta]
    std::int64_t work = 0;  // [energy quanta]
  };
  /// What one contact definition has taken from the nodes, and given to each part.
  struct Contact {
    std::int64_t work = 0, friction = 0;  // [energy quanta]
    std::vector<std::array<std::int64_t, 3>> impulse;  // per part [momentum quanta]
  };

  /// Books of the change that one condition made to the velocity of an owned node in a step: from `free_flight` to
  /// `left`, where the node was at `before` and will be at `after` when all conditions have acted [m/s].
  void count_reaction(const Ledger& ledger, const Model& model, std::size_t boundary, double mass, Vec3 free_flight,
                      Vec3 left, Vec3 before, Vec3 after);
  /// Takes note of the forces that will act in the coming step.
  void take_contacts(const std::vector<std::unique_ptr<ContactEngine>>& contacts);
  /// Takes note of velocities before the kick, to be called before it.
  void before_kick(const Model& model);
  /// Books the work and impulse of the forces that were taken. Nodes must have the numbers that they had then.
  void after_kick(const Model& model, const Step& step, const Ledger& ledger);

  /// Totals of all ranks up to the middle of the last step. Collective.
  std::vector<Reaction> reactions(const Model& model) const;
  std::vector<Contact> contacts(const Model& model) const;
  /// Work and friction of one definition up to the start of `next`, counted as Integrator::sample() does [J].
  /// Collective.
  struct ContactWork {
    double work = 0.0, friction = 0.0;
  };
  std::vector<ContactWork> contact_work(const Model& model, const Step& next, const Ledger& ledger) const;
  /// Force of each definition on each part, of all ranks [force quanta]. Collective.
  std::vector<std::vector<std::array<std::int64_t, 3>>> contact_forces(const Model& model) const;

  // For restart
  /// All books one after another, of all ranks. Collective.
  std::vector<std::int64_t> totals(const Model& model) const;
  /// Takes the books up again; rank 0 alone passes numbers that are not zero. Returns whether there were as many.
  bool restore(const std::vector<std::int64_t>& totals);
  /// Forces of the definitions on owned nodes.
  const std::vector<ContactLoad>& loads() const { return loads_; }
  /// Takes up the forces of a definition on owned nodes.
  void restore_load(std::size_t contact, ContactLoad load) { loads_[contact] = std::move(load); }

 private:
  std::vector<std::int64_t> numbers() const;

  std::vector<Reaction> reactions_;
  std::vector<Contact> contacts_;
  std::vector<ContactLoad> loads_;  // per definition
  std::vector<std::vector<Vec3>> velocity_before_;  // of their nodes [m/s]
};

}  // namespace kerf
