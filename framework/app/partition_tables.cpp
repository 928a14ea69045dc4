// The tables of `kerf partition`: on the screen, as CSV, JSON and Markdown.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/partition_study.hpp"
#include "output/file.hpp"

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

template <class T>
double largest_over_mean(const std::vector<T>& values) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  if (!(sum > 0.0)) return -1.0;
  return static_cast<double>(*std::max_element(values.begin(), values.end())) * static_cast<double>(values.size()) /
         sum;
}

/// A number, or a dash where there is none.
std::string or_dash(double value, const char* pattern) {
  return value < 0.0 ? std::string("-") : fmt::format(fmt::runtime(pattern), value);
}
std::string moved_text(const FoundPartition& f) { return f.moved < 0 ? "-" : std::to_string(f.moved); }

Json or_null(double value) { return value < 0.0 ? Json(nullptr) : Json(value); }

std::string csv_of(const PartitionStudy& study) {
  std::string text =
      "state,time_s,method,parts,seconds,element_balance,work_balance,contact_balance,least_elements,most_elements,"
      "empty_parts,interface_nodes,most_interface_nodes,node_copies,most_neighbours,mean_neighbours,surface_index,"
      "largest_surface_index,moved_elements\n";
  for (const FoundPartition& f : study.found) {
    const PartitionFigures n = figures_of(f.quality);
    text += fmt::format("{},{:.9g},{},{},{:.4g},{:.6g},{:.6g},{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{}\n",
                        f.state.name, f.state.time, f.method.name, f.n_parts, f.seconds, n.element_balance,
                        n.work_balance, n.contact_balance < 0.0 ? "" : fmt::format("{:.6g}", n.contact_balance),
                        n.least_elements, n.most_elements, n.empty_parts, f.quality.all_interface_nodes,
                        n.most_interface_nodes, f.quality.node_copies, n.most_neighbours, n.mean_neighbours,
                        n.surface_index, n.largest_surface_index, f.moved < 0 ? "" : std::to_string(f.moved));
  }
  return text;
}

Json json_of(const FoundPartition& f) {
  const PartitionFigures n = figures_of(f.quality);
  const PartitionQuality& q = f.quality;
  return {{"state", f.state.name},
          {"frame", f.state.frame < 0 ? Json(nullptr) : Json(f.state.frame)},
          {"time", f.state.time},
          {"live_elements", f.state.n_elements},
          {"method", f.method.name},
          {"type", f.method.type},
          {"partitioner", f.method.block},
          {"parts", f.n_parts},
          {"seconds", f.seconds},
          {"element_balance", n.element_balance},
          {"work_balance", n.work_balance},
          {"contact_balance", or_null(n.contact_balance)},
          {"empty_parts", n.empty_parts},
          {"interface_nodes", q.all_interface_nodes},
          {"most_interface_nodes", n.most_interface_nodes},
          {"node_copies", q.node_copies},
          {"interface_faces", q.all_interface_faces},
          {"faces", q.all_faces},
          {"most_neighbours", n.most_neighbours},
          {"mean_neighbours", n.mean_neighbours},
          {"surface_index", n.surface_index},
          {"largest_surface_index", n.largest_surface_index},
          {"moved_elements", f.moved < 0 ? Json(nullptr) : Json(f.moved)},
          {"of_parts",
           {{"elements", q.elements},
            {"work", q.work},
            {"contact_work", q.contact_work},
            {"interface_nodes", q.interface_nodes},
            {"interface_faces", q.interface_faces},
            {"faces", q.faces},
            {"neighbours", q.neighbours}}}};
}

Json json_of(const PartitionStudy& study) {
  Json all = {{"kerf", KERF_VERSION},       {"input", study.input},   {"elements", study.n_elements},
              {"nodes", study.n_nodes},     {"ranks", study.n_ranks}, {"failures", study.failures},
              {"partitions", Json::array()}};
  for (const FoundPartition& f : study.found) all["partitions"].push_back(json_of(f));
  return all;
}

std::string markdown_of(const PartitionStudy& study) {
  std::string text = fmt::format(
      "# Partitions of {}\n\n{} elements, {} nodes; computed on {} rank{}. What the columns mean: "
      "doc/users/partition.md.\n",
      study.input, study.n_elements, study.n_nodes, study.n_ranks, study.n_ranks == 1 ? "" : "s");
  std::string state;
  for (const FoundPartition& f : study.found) {
    if (f.state.name != state) {
      state = f.state.name;
      text += fmt::format(
          "\n## {}\n\n{} live elements at {:.6g} s.\n\n| method | parts | elements | balance | work | contact | "
          "interface nodes | largest | neighbours, most | mean | surface index | largest | moved | time [s] "
          "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
          state, f.state.n_elements, f.state.time);
    }
    const PartitionFigures n = figures_of(f.quality);
    text += fmt::format(
        "| {} | {} | {} to {} | {:.3f} | {:.3f} | {} | {} | {} | {} | {:.2f} | {:.4f} | {:.4f} | {} | "
        "{:.2f} |\n",
        f.method.name, f.n_parts, n.least_elements, n.most_elements, n.element_balance, n.work_balance,
        or_dash(n.contact_balance, "{:.3f}"), f.quality.all_interface_nodes, n.most_interface_nodes, n.most_neighbours,
        n.mean_neighbours, n.surface_index, n.largest_surface_index, moved_text(f), f.seconds);
  }
  for (const std::string& line : study.failures) text += "\n" + line + "\n";
  return text;
}

}  // namespace

PartitionFigures figures_of(const PartitionQuality& q) {
  PartitionFigures n;
  const double n_parts = static_cast<double>(q.elements.size());
  n.least_elements = *std::min_element(q.elements.begin(), q.elements.end());
  n.most_elements = *std::max_element(q.elements.begin(), q.elements.end());
  n.empty_parts = std::count(q.elements.begin(), q.elements.end(), 0);
  n.element_balance = largest_over_mean(q.elements);
  n.work_balance = largest_over_mean(q.work);
  n.contact_balance = largest_over_mean(q.contact_work);
  n.most_interface_nodes = *std::max_element(q.interface_nodes.begin(), q.interface_nodes.end());
  n.most_neighbours = *std::max_element(q.neighbours.begin(), q.neighbours.end());
  n.mean_neighbours =
      static_cast<double>(std::accumulate(q.neighbours.begin(), q.neighbours.end(), std::int64_t{0})) / n_parts;
  n.surface_index = q.all_faces > 0 ? static_cast<double>(q.all_interface_faces) / static_cast<double>(q.all_faces) : 0;
  for (std::size_t p = 0; p < q.faces.size(); ++p)
    if (q.faces[p] > 0)
      n.largest_surface_index = std::max(n.largest_surface_index,
                                         static_cast<double>(q.interface_faces[p]) / static_cast<double>(q.faces[p]));
  return n;
}

std::string screen_heading() {
  return fmt::format("{:<12}{:<20}{:>6}{:>9}{:>9}{:>9}{:>11}{:>9}{:>7}{:>9}{:>9}{:>9}\n", "state", "method", "parts",
                     "balance", "work", "contact", "interface", "largest", "neigh.", "surface", "moved", "time");
}

std::string screen_line(const FoundPartition& f) {
  const PartitionFigures n = figures_of(f.quality);
  return fmt::format("{:<12}{:<20}{:>6}{:>9.3f}{:>9.3f}{:>9}{:>11}{:>9}{:>7}{:>9.4f}{:>9}{:>7.2f} s\n", f.state.name,
                     f.method.name, f.n_parts, n.element_balance, n.work_balance, or_dash(n.contact_balance, "{:.3f}"),
                     f.quality.all_interface_nodes, n.most_interface_nodes, n.most_neighbours, n.surface_index,
                     moved_text(f), f.seconds);
}

void write_tables(const PartitionStudy& study, const std::string& folder) {
  replace_file(folder + "/partitions.csv", csv_of(study));
  replace_file(folder + "/partitions.json", json_of(study).dump(1) + "\n");
  replace_file(folder + "/partitions.md", markdown_of(study));
}

}  // namespace kerf
