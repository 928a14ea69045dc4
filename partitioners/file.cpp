// Parts from a file: a division that was made elsewhere, by `kerf partition`, by another program or by hand.
#include <algorithm>
#include <filesystem>

#include "file/division.hpp"
#include "kerf/partitioner.hpp"

namespace kerf {
namespace {

/// Rank 0's bytes on all ranks. Collective.
void share(MPI_Comm comm, std::string& text) {
  auto size = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&size, 1, MPI_INT64_T, 0, comm);
  text.resize(static_cast<std::size_t>(size));
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, 0, comm);
}

constexpr const char* initial = "initial";  // state of a model before the first step

class FilePartitioner final : public Partitioner {
 public:
  static void describe(Schema<FilePartitioner>& s) {
    s.texts(&FilePartitioner::files, "file",
            "file with the part of each element, named relative to the input file: lines `element part`, or HDF5 as "
            "`kerf partition` writes it; of several files, or several partitions of a file, the one is taken that has "
            "as many parts as there are ranks");
    s.text(&FilePartitioner::method, "method",
           "method whose partition is taken, where an HDF5 file has those of several")
        .optional();
    s.text(&FilePartitioner::state, "state",
           "state of the model whose partition is taken: initial, or frame_N of results")
        .by_default(initial);
    s.rule("file", "file must not be an empty list", [](const FilePartitioner& p) { return !p.files.empty(); });
  }

  // Rank 0 reads, and tells the others what is wrong or what it has found.
  std::vector<std::string> complaints(const PartitionProblem& problem) override {
    if (division_.n_parts != problem.n_parts) {
      int rank = 0;
      MPI_Comm_rank(problem.comm, &rank);
      std::string text;
      if (rank == 0)
        for (const std::string& line : read(problem)) text += line + "\n";
      share(problem.comm, text);
      if (!text.empty()) {
        std::vector<std::string> lines;
        for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
          lines.push_back(text.substr(at, text.find('\n', at) - at));
        division_ = {};
        return lines;
      }
      share_division(problem.comm);
    }
    return missing(problem);
  }

  std::vector<int> partition(const PartitionProblem& problem) override {
    std::vector<int> parts;
    parts.reserve(problem.ids.size());
    for (const std::int64_t id : problem.ids) parts.push_back(division_.parts[place_of(id)]);
    return parts;
  }

  std::vector<std::string> files;
  std::string method, state;

 private:
  /// A file named in the input is relative to the input's folder, one named on the command line to the present one.
  std::string path_of(const std::string& name) const {
    const std::size_t column = origin.rfind(':');
    const std::size_t line = column == std::string::npos ? column : origin.rfind(':', column - 1);
    if (origin.rfind("--", 0) == 0 || line == std::string::npos) return name;
    return (std::filesystem::path(origin.substr(0, line)).parent_path() / name).string();
  }

  /// Finds the division into so many parts. Returns what is wrong. On rank 0.
  std::vector<std::string> read(const PartitionProblem& problem) {
    std::string counts, beyond;
    for (const std::string& name : files) {
      const DivisionRequest request{path_of(name), state, method, problem.n_parts, problem.n_elements};
      FoundDivision found = is_hdf5(request.path) ? read_hdf5_division(request) : read_text_division(request);
      if (!found.complaints.empty()) return found.complaints;
      if (!found.is_chosen && (!method.empty() || state != initial))
        return {origin + ": error: " + request.path + " has one division only, of which `method` and `state` cannot " +
                "choose; expected neither of the two keys, or a file of `kerf partition`"};
      if (found.line_beyond > 0)
        beyond = " (line " + std::to_string(found.line_beyond) + " has the first part above " +
                 std::to_string(problem.n_parts - 1) + ")";
      if (found.found) {
        division_ = std::move(found.division);
        return {};
      }
      for (const int n : found.other_counts) counts += (counts.empty() ? "" : ", ") + std::to_string(n);
    }
    return {path_of(files.front()) + ": error: the number of parts is " + (counts.empty() ? "0" : counts) +
            (files.size() == 1 ? beyond : "") + ", and the number asked for is " + std::to_string(problem.n_parts) +
            "; expected as many parts as there are ranks"};
  }

  void share_division(MPI_Comm comm) {
    std::int64_t sizes[2] = {static_cast<std::int64_t>(division_.ids.size()), division_.n_parts};
    MPI_Bcast(sizes, 2, MPI_INT64_T, 0, comm);
    division_.ids.resize(static_cast<std::size_t>(sizes[0]));
    division_.parts.resize(static_cast<std::size_t>(sizes[0]));
    division_.n_parts = static_cast<int>(sizes[1]);
    MPI_Bcast(division_.ids.data(), static_cast<int>(sizes[0]), MPI_INT64_T, 0, comm);
    MPI_Bcast(division_.parts.data(), static_cast<int>(sizes[0]), MPI_INT32_T, 0, comm);
  }

  std::size_t place_of(std::int64_t id) const {
    const auto at = std::lower_bound(division_.ids.begin(), division_.ids.end(), id);
    return static_cast<std::size_t>(at - division_.ids.begin());
  }

  /// Elements of the model without a part. Collective.
  std::vector<std::string> missing(const PartitionProblem& problem) const {
    std::int64_t n_missing = 0, least = problem.n_elements;
    for (const std::int64_t id : problem.ids) {
      const std::size_t at = place_of(id);
      if (at < division_.ids.size() && division_.ids[at] == id) continue;
      ++n_missing;
      least = std::min(least, id);
    }
    MPI_Allreduce(MPI_IN_PLACE, &n_missing, 1, MPI_INT64_T, MPI_SUM, problem.comm);
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT64_T, MPI_MIN, problem.comm);
    if (n_missing == 0) return {};
    return {path_of(files.front()) + ": error: " + std::to_string(n_missing) +
            (n_missing == 1 ? " element has" : " elements have") + " no part, the first of them element " +
            std::to_string(least) + "; expected a part for every element of the model"};
  }

  Division division_;
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::FilePartitioner, "file", "parts that a file gives, made by `kerf partition` or elsewhere")
