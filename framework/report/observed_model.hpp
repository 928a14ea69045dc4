// What observers see of a simulation.
#pragma once

#include <mpi.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "dynamics/simulation.hpp"
#include "kerf/observer.hpp"
#include "report/meeting_point.hpp"

namespace kerf {

class SimulationView final : public ObservedModel {
 public:
  explicit SimulationView(Simulation& simulation);
  /// Takes up what the simulation is now. To be called before an observer sees the view.
  void refresh(double at_time, double of_step, std::int64_t at_cycle);
  const MeetingPoint& meeting() const { return meeting_; }

  std::int64_t arrangement() const override { return number_; }
  Vec3 reference(int node) const override;
  bool belongs_to(int node, int part) const override;
  std::span<const double> kinetic_energy() override;
  std::span<const Vec3> contact_force() override;
  std::span<const Vec3> load_force() override;
  std::span<const std::int64_t> elements(int part) const override { return listed_[index(part)].ids; }
  std::int32_t element_node(int part, int i, int k) const override;
  int n_components(const std::string& field) const override;
  std::vector<ObservedColumn> columns_of_field(const std::string& name) const override;
  std::vector<ObservedColumn> columns_of_node_field(const std::string& name) const override;
  std::vector<double> field(int part, const std::string& name) const override;
  std::vector<double> field_of(int part, int i, const std::string& name) const override;
  std::vector<double> node_field(int node, const std::string& name) const override;
  std::vector<double> mass_in(int part) override;
  std::vector<double> sums(const std::vector<std::span<const double>>& lists) override;
  std::vector<double> greatest(std::vector<double> values) override;
  std::vector<double> least(std::vector<double> values) override;
  std::pair<double, std::int64_t> nearest(double value, std::int64_t id) override;
  std::vector<double> from_holder(bool mine, std::vector<double> values) override;
  std::vector<ObservedReaction> reactions() override;
  std::vector<ObservedContact> contacts() override;

 private:
  /// Live elements of a part on this rank.
  struct Listed {
    std::int64_t arrangement = -1;
    std::vector<std::int64_t> ids;
    std::vector<int> slots;
  };
  std::size_t index(int part) const;
  const PartStore& store(int part) const { return *simulation_.model().parts[index(part)].store; }
  int slot(int part, int i) const;
  void list_elements();
  std::vector<Vec3> on_nodes(const std::vector<std::int32_t>& which, const std::vector<std::int64_t>& force) const;

  Simulation& simulation_;
  MeetingPoint meeting_;
  std::vector<Listed> listed_;
  std::vector<double> kinetic_;
  std::vector<Vec3> contact_force_, load_force_;
  std::vector<NodeShare> shares_;  // of the owned nodes that parts share
  bool kinetic_known_ = false, contact_known_ = false, loads_known_ = false, shares_known_ = false;
  std::int64_t number_ = 0, node_arrangement_ = -1;
};

}  // namespace kerf
