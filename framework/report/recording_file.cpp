// One group per moment. The file is in its next state after each, in one step, so that a run that is killed leaves the
// moments that it has written.
#include "report/recording_file.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <stdexcept>

namespace kerf {

namespace {

constexpr std::int64_t format = 2;
constexpr char format_key[] = "kerf_recording", moments_key[] = "moments";

std::int64_t end_of(const hdf5::Group& moment) { return moment.integer("cycle") + moment.integer("n_cycles"); }

void put_numbers(hdf5::Group& group, const RecordedMoment& m) {
  group.set("cycle", m.cycle);
  group.set("n_cycles", m.n_cycles);
  group.set_real("time", m.time);
  group.set_real("rounds", m.rounds);
  group.set_real("agreements", m.agreements);
  group.set_real("friction", m.friction);
  group.set_real("renewed", m.renewed);
  group.set("n_loads", m.n_loads);
  group.set_real("slave_reach", m.slave_reach);
  group.set_real("facet_reach", m.facet_reach);
  group.set_real("n_searches", m.n_searches);
  group.set_real("n_renewals", m.n_renewals);
  group.set_real("n_refreshes", m.n_refreshes);
  group.set_real("n_eroding", m.n_eroding);
}

}  // namespace

/// A table of rows of `width` values, or a list where `width` is 0.
template <class T>
void RecordingFile::put(hdf5::Group& group, const char* name, const std::vector<T>& values, std::size_t width) {
  hdf5::Dataset& data = group.datasets[name];
  data.type = hdf5::type_of<T>();
  data.size = {width > 0 ? values.size() / width : values.size()};
  if (width > 0) data.size.push_back(width);
  if (values.empty()) return;
  data.places = {file_.allocate(values.size() * sizeof(T))};
  file_.write(data.places[0], std::as_bytes(std::span(values)));
}

void RecordingFile::put_arrays(hdf5::Group& group, const RecordedMoment& m) {
  put(group, "cells", m.cells, m.n_corners);
  put(group, "node", m.node);
  put(group, "points", m.points, 3);
  put(group, "element", m.element);
  put(group, "element_seconds", m.element_seconds);
  put(group, "load_seconds", m.load_seconds);
  put(group, "erosion_seconds", m.erosion_seconds);
  put(group, "eroded", m.eroded);
  hdf5::Group& contact = group.groups["contact"];
  put(contact, "slaves", m.slaves);
  put(contact, "facets", m.facets, 4);
  put(contact, "pair_slave", m.pair_slave);
  put(contact, "pair_facet", m.pair_facet);
  put(contact, "pair_touches", m.pair_touches);
  put(contact, "search_seconds", m.search_seconds);
  put(contact, "force_seconds", m.force_seconds);
}

RecordingFile RecordingFile::create(const std::string& path) {
  RecordingFile recording;
  recording.file_ = hdf5::Hdf5File::create(MPI_COMM_SELF, path + ".part");
  recording.file_.root.set(format_key, format);
  recording.file_.root.groups[moments_key];
  recording.file_.take_turns();
  recording.file_.commit();
  recording.file_.publish(path);
  return recording;
}

RecordingFile RecordingFile::resume(const std::string& path, std::int64_t cycle) {
  if (!std::filesystem::exists(path)) return create(path);
  RecordingFile recording;
  recording.goes_on_ = true;
  try {
    recording.file_ = hdf5::Hdf5File::open(MPI_COMM_SELF, path, true, false);
    if (recording.file_.root.integer(format_key) != format) throw std::runtime_error("it has another format");
    auto& moments = recording.file_.root.groups.at(moments_key).groups;
    std::erase_if(moments, [cycle](const auto& moment) { return end_of(moment.second) > cycle + 1; });
  } catch (const std::exception& e) {
    throw std::runtime_error("cannot go on with the recording \"" + path + "\": " + e.what() +
                             "; move the file away, or take output.recording_interval out");
  }
  recording.file_.take_turns();
  recording.file_.commit();  // before new arrays are written over the old ones
  return recording;
}

std::int64_t RecordingFile::next_cycle() const {
  std::int64_t next = 1;
  for (const auto& [name, moment] : file_.root.groups.at(moments_key).groups) next = std::max(next, end_of(moment));
  return next;
}

double RecordingFile::node_cycles() const {
  double sum = 0.0;
  for (const auto& [name, moment] : file_.root.groups.at(moments_key).groups)
    sum += static_cast<double>(moment.integer("n_cycles")) * static_cast<double>(moment.datasets.at("points").size[0]);
  return sum;
}

double RecordingFile::node_seconds() const {
  return n_moments() > 0 ? node_cycles() * file_.root.real("node_seconds") : 0.0;
}

void RecordingFile::append(const RecordedMoment& moment, const RecordedRun& run) {
  hdf5::Group& group = file_.root.groups.at(moments_key).groups[std::to_string(n_moments())];
  put_numbers(group, moment);
  put_arrays(group, moment);
  file_.root.set_real("node_seconds", run.node_seconds);
  file_.root.set("record_bytes", run.record_bytes);
  file_.root.set("source", run.source);
  file_.commit();
}

}  // namespace kerf
