// `kerf partition`: divides the elements of a model by one method after the other, and tells what each is worth.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "app/commands.hpp"
#include "app/failures.hpp"
#include "app/load_input.hpp"
#include "app/partition_options.hpp"
#include "app/partition_study.hpp"
#include "app/result_folder.hpp"
#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "kerf/measure.hpp"
#include "model/names.hpp"
#include "model/setup.hpp"
#include "output/collective.hpp"
#include "output/results.hpp"
#include "parallel/communicator.hpp"
#include "parallel/runtime.hpp"
#include "partition/frame.hpp"
#include "partition/partitions_file.hpp"
#include "partition/problem.hpp"
#include "report/result_fields.hpp"

namespace kerf {

namespace {

/// A live element of this rank and its part; also what rank 0 gathers.
struct PartOfElement {
  std::int64_t id;
  std::int64_t part;
};

/// The mesh with a field for each partition, for pictures.
class MeshWriter {
 public:
  MeshWriter(Model& model, const std::string& folder, const PartitionedState& state)
      : results_(model.comm, folder + "/results.vtkhdf", model.n_nodes, model.n_elements, false) {
    write_topology(model, results_);
    results_.begin_frame(state.time);
    std::vector<std::int64_t> owned;
    std::vector<double> positions;
    for (int i = 0; i < model.nodes.n(); ++i) {
      if (!model.nodes.owned[i]) continue;
      owned.push_back(model.nodes.id[i]);
      const Vec3 x = model.nodes.x(i);
      positions.insert(positions.end(), {x.x, x.y, x.z});
    }
    results_.add_points(owned, HeldValues<double>::in_order(positions, 3));
  }
  void add(const std::string& name, const std::vector<std::int64_t>& ids, const std::vector<int>& parts) {
    const std::vector<double> values(parts.begin(), parts.end());
    results_.add_element_field(name, 1, ids, HeldValues<double>::in_order(values, 1));
  }
  void finish(const std::vector<std::int64_t>& ids) {
    results_.add_alive(ids);
    results_.end_frame();
    results_.close();
  }

 private:
  ResultsWriter results_;
};

std::vector<std::int64_t> labels_of_elements(const Model& model) {
  std::vector<std::int64_t> labels(static_cast<std::size_t>(model.n_elements));
  for (std::size_t e = 0; e < labels.size(); ++e) labels[e] = element_label(model, static_cast<std::int64_t>(e));
  return labels;
}

/// Works through states, methods and numbers of parts.
class Study {
 public:
  Study(MPI_Comm comm, const PartitionOptions& options, const ModelInput& input, const Registry& registry)
      : options_(options), registry_(registry), methods_(methods_asked(options, registry)) {
    create_parts(model_, comm, input);
    counts_ = parts_asked(options.parts, model_.n_elements);
    frames_ = frames_asked(options);
    folder_ = result_folder(options.run, ".partition");
    make_result_folder(comm, folder_);
    generate_mesh(model_);
    report_ = {options.run.input, model_.n_elements, model_.n_nodes, model_.n_ranks(), {}, {}};
    if (model_.rank() == 0)
      on_rank_0([&] {
        file_ = std::make_unique<PartitionsFile>(folder_ + "/partitions.h5", options.run.input, model_.n_elements);
        if (has_labels(model_)) file_->name_elements(labels_of_elements(model_));
      });
    share_failure();
  }

  /// Returns the exit code.
  int run() {
    if (model_.rank() == 0) fmt::print("{}", screen_heading());
    if (frames_.empty()) run_state({"initial", -1, 0.0, 0});
    for (const std::int64_t frame : frames_) {
      const FrameState state = take_frame(model_, options_.results, frame);
      run_state({fmt::format("frame_{}", frame), frame, state.time, 0});
    }
    if (model_.rank() == 0)
      on_rank_0([&] {
        file_->close();
        write_tables(report_, folder_);
      });
    share_failure();
    if (model_.rank() == 0) {
      fmt::print("written: {}/partitions.csv, .json, .md and .h5{}\n", folder_,
                 options_.no_mesh ? "" : ", and the mesh in a folder for each state");
      for (const std::string& line : report_.failures) fmt::print(stderr, "{}\n", line);
    }
    return report_.failures.empty() ? exit_done : exit_other;
  }

 private:
  void run_state(PartitionedState state) {
    state.n_elements = sum_of(model_.comm, model_.n_live_local());
    contact_ = contact_work(model_);
    ids_.clear();
    for (const PartModel& p : model_.parts)
      for (int s = 0; s < p.store->n_slots(); ++s)
        if (p.store->live(s)) ids_.push_back(p.store->id(s));
    sorted_before_ = std::move(sorted_);
    sorted_ = ids_;
    std::sort(sorted_.begin(), sorted_.end());
    if (model_.rank() == 0) on_rank_0([&] { file_->begin_state(state.name, state.frame, state.time); });
    share_failure();
    std::unique_ptr<MeshWriter> mesh;
    if (!options_.no_mesh) {
      make_result_folder(model_.comm, folder_ + "/" + state.name);
      mesh = std::make_unique<MeshWriter>(model_, folder_ + "/" + state.name, state);
    }
    for (const PartitionMethod& method : methods_)
      for (const int n_parts : counts_) {
        activity::beat();
        run_one(state, method, n_parts, mesh.get());
      }
    if (mesh) mesh->finish(ids_);
  }

  void run_one(const PartitionedState& state, const PartitionMethod& method, int n_parts, MeshWriter* mesh) {
    Kept& kept = kept_[{method.name, n_parts}];
    if (!kept.partitioner) kept.partitioner = make_partitioner(method, registry_);
    PartitionProblem problem = problem_of(model_, *kept.partitioner, n_parts);
    if (kept.is_known)
      for (const std::int64_t id : problem.ids) problem.present_parts.push_back(part_before(kept, id));
    FoundPartition found{state, method, n_parts, 0.0, -1, {}};
    std::vector<int> parts;
    try {
      MPI_Barrier(model_.comm);
      const double start = MPI_Wtime();
      parts = find_parts(*kept.partitioner, problem);
      found.seconds = greatest(model_.comm, MPI_Wtime() - start);
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& e) {
      report_.failures.push_back(fmt::format("{}: error: no partition of {} into {} parts by {}: {}",
                                             options_.run.input, state.name, n_parts, method.name, e.what()));
      kept = {};
      return;
    }
    found.quality = measure_quality(model_, parts, n_parts, contact_);
    found.moved = count_moved(kept, parts);
    keep(kept, parts);
    if (mesh) mesh->add(fmt::format("{}_{}", method.name, n_parts), problem.ids, parts);
    store(found, problem.ids, parts);
    if (model_.rank() == 0) {
      fmt::print("{}", screen_line(found));
      std::fflush(stdout);
    }
    report_.found.push_back(std::move(found));
  }

  /// What is kept from one state to the next, where there is a next one.
  struct Kept {
    std::unique_ptr<Partitioner> partitioner;
    std::vector<int> parts;  // of the elements of this rank, in the order of sorted_before_
    bool is_known = false;
  };

  void keep(Kept& kept, const std::vector<int>& parts) const {
    if (frames_.size() < 2) return;
    kept.parts.resize(parts.size());
    for (std::size_t e = 0; e < parts.size(); ++e) kept.parts[place_in(sorted_, ids_[e])] = parts[e];
    kept.is_known = true;
  }

  static std::size_t place_in(const std::vector<std::int64_t>& sorted, std::int64_t id) {
    return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), id) - sorted.begin());
  }
  int part_before(const Kept& kept, std::int64_t id) const { return kept.parts[place_in(sorted_before_, id)]; }

  /// Of the elements that live now; -1 where there was no state before. Collective.
  std::int64_t count_moved(const Kept& kept, const std::vector<int>& parts) const {
    if (!kept.is_known) return -1;
    std::int64_t moved = 0;
    for (std::size_t e = 0; e < parts.size(); ++e) moved += part_before(kept, ids_[e]) != parts[e] ? 1 : 0;
    return sum_of(model_.comm, moved);
  }

  void store(const FoundPartition& found, const std::vector<std::int64_t>& ids, const std::vector<int>& parts) {
    std::vector<PartOfElement> local;
    for (std::size_t e = 0; e < ids.size(); ++e) local.push_back({ids[e], parts[e]});
    const std::vector<PartOfElement> all = gather_to_root(model_.comm, local);
    if (model_.rank() == 0)
      on_rank_0([&] {
        std::vector<std::int32_t> by_id(static_cast<std::size_t>(model_.n_elements), -1);
        for (const PartOfElement& e : all) by_id[static_cast<std::size_t>(e.id)] = static_cast<std::int32_t>(e.part);
        file_->add(found.method.name, found.method.type, found.n_parts, by_id, found.seconds);
      });
    share_failure();
  }

  template <class Work>
  void on_rank_0(Work&& work) {
    try {
      work();
    } catch (const std::exception& e) {
      failure_ = e.what();
    }
  }
  /// Throws on all ranks what has failed on rank 0. Collective.
  void share_failure() {
    if (const std::string text = broadcast(model_.comm, failure_); !text.empty()) throw OutputError(text);
  }

  const PartitionOptions& options_;
  const Registry& registry_;
  std::vector<PartitionMethod> methods_;
  std::vector<int> counts_;
  std::vector<std::int64_t> frames_;
  std::string folder_, failure_;
  Model model_;
  std::vector<double> contact_;
  std::vector<std::int64_t> ids_;  // of the live elements of this rank, in the order of the stores
  std::vector<std::int64_t> sorted_, sorted_before_;  // the same in ascending order, now and in the state before
  std::map<std::pair<std::string, int>, Kept> kept_;
  std::unique_ptr<PartitionsFile> file_;  // on rank 0
  PartitionStudy report_;
};

}  // namespace

int partition_command(const PartitionOptions& options, Registry& registry) {
  int argc = 0;
  char** argv = nullptr;
  const ParallelRuntime runtime(argc, argv);
  try {
    const auto input = load_input(runtime.comm(), options.run, registry);
    const activity::Task task("partitioning", {input->checks.stall_limit, "checks.stall_limit", exit_other});
    return Study(runtime.comm(), options, *input, registry).run();
  } catch (const InputError& e) {
    return fail_together(runtime.comm(), e.lines(), exit_input_error);
  } catch (const OutputError& e) {
    return fail_together(runtime.comm(), {fmt::format("error: {}", e.what())}, exit_other);
  } catch (const std::exception& e) {
    return fail_alone(runtime.comm(), e);
  }
}

}  // namespace kerf
