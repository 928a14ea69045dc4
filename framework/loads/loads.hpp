// Adds the forces of all loads of the input to the nodes, the same on every number of ranks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "loads/external_load.hpp"
#include "loads/facet_marks.hpp"
#include "model/model.hpp"

namespace kerf {

class Loads {
 public:
  /// The input must outlive this.
  explicit Loads(const ModelInput& input);
  /// Chooses facets in the undeformed, distributed model. Local.
  void begin(Model& model);
  /// To be called whenever local nodes came, went or changed places. Local.
  void renumbered(const Model& model);
  /// Lets another one add forces as well; it must outlive this.
  void add_source(ForceSource& source) { source_ = &source; }
  /// Adds what acts at the end of a step to the force of all copies of nodes. Pre: these are sums over all copies
  /// already. Collective.
  void add_forces(Model& model, const Step& step);
  /// A sentence about a force of this rank, of the last add_forces(), that cannot be; empty where all is well.
  const std::string& trouble() const { return trouble_; }
  /// What the last add_forces() added, or restore() brought back.
  const ExternalLoad& acting() const { return acting_; }

  /// See FacetMarks.
  void before_erosion(const Model& model, const std::vector<ExteriorFacet>& failing) {
    marks_.before_erosion(model, failing);
  }
  void after_erosion(Model& model, const std::vector<ExteriorFacet>& opened);

  /// Takes back the forces of a restart, which any rank may bring. Pre: the model is distributed. Collective.
  void restore(const Model& model, const std::vector<LoadOnNode>& share);
  /// On how many facets or nodes each load of the input acts, on all ranks together. Collective.
  std::vector<std::int64_t> count_targets(const Model& model) const;
  /// What laws have against facets that they are to load, one line for each law that has. Collective.
  std::vector<std::string> complaints(const Model& model);
  /// Warnings of loads that come after the end of the run, as complaints() has found them.
  const std::vector<std::string>& late() const { return late_; }

 private:
  /// A load on nodes, with its nodes of this rank. One of the laws is set.
  struct OnNodes {
    const Load* load = nullptr;
    const NodalLoad* nodal = nullptr;
    const BodyLoad* body = nullptr;
    std::vector<std::int32_t> nodes;
    std::vector<Vec3> reference;  // of these, where the law reads it [m]
  };
  struct OnFacet {
    FacetMarks::Marked mark;
    Vec3 reference;  // where the law reads it [m]
  };
  void find_facets(const Model& model);
  LoadedFacet seen(const Model& model, const OnFacet& on, const std::array<Vec3, 4>& shares) const;
  void add_facet_forces(const Model& model, double time);
  void add_node_forces(const Model& model, const OnNodes& on, const Step& step);
  void add(const Model& model, std::int32_t node, Vec3 newton, const ForceActor& actor);
  void note_failure(const char* what);
  void hand_over(Model& model);

  bool has_source() const { return source_ != nullptr && source_->adds_forces(); }

  const ModelInput& input_;
  ForceSource* source_ = nullptr;
  FacetMarks marks_;
  std::vector<OnNodes> on_nodes_;
  std::vector<OnFacet> on_facets_;
  std::int64_t arrangement_ = -1;  // of the elements, when on_facets_ was made
  std::vector<std::int64_t> force_;  // four per local node, in force quanta
  ExternalLoad acting_;
  std::string trouble_;
  std::vector<std::string> late_;
  const Load* asked_ = nullptr;  // the law that is being evaluated
};

}  // namespace kerf
