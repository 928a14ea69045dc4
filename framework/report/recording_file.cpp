// One group per moment, by HDF5's library. The file is closed after each moment, so that a run that is killed between
// two leaves a whole file.
#include "report/recording_file.hpp"

#include <hdf5.h>

#include <stdexcept>

#include "partition/hdf5_handle.hpp"

namespace kerf {

namespace {

using hdf5::Handle;
using hdf5::put;

constexpr std::int64_t format = 1;

void expect(bool good, const std::string& path) {
  if (!good) throw std::runtime_error("cannot write \"" + path + "\"; is the disk full?");
}

template <class T>
hid_t memory_type() {
  if constexpr (std::is_same_v<T, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return H5T_NATIVE_UINT8;
  else
    return H5T_NATIVE_INT64;
}

/// A table of rows of `width` values, or a list where `width` is 0.
template <class T>
bool put_list(hid_t group, const char* name, const std::vector<T>& values, hsize_t width = 0) {
  const hsize_t size[2] = {width > 0 ? values.size() / width : values.size(), width};
  const Handle space(H5Screate_simple(width > 0 ? 2 : 1, size, nullptr), H5Sclose);
  const hid_t type = memory_type<T>();
  const Handle data(H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  return data.good() && (values.empty() || H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
}

bool put_elements(hid_t group, const RecordedMoment& m) {
  return put_list(group, "cells", m.cells, m.n_corners) && put_list(group, "points", m.points, 3) &&
         put_list(group, "element", m.element) && put_list(group, "element_seconds", m.element_seconds) &&
         put_list(group, "load_seconds", m.load_seconds) && put_list(group, "erosion_seconds", m.erosion_seconds) &&
         put_list(group, "eroded", m.eroded);
}

bool put_contact(hid_t moment, const RecordedMoment& m) {
  const Handle group(H5Gcreate2(moment, "contact", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  return group.good() && put_list(group, "slaves", m.slaves) && put_list(group, "facets", m.facets, 4) &&
         put_list(group, "pair_slave", m.pair_slave) && put_list(group, "pair_facet", m.pair_facet) &&
         put_list(group, "pair_touches", m.pair_touches) && put_list(group, "search_seconds", m.search_seconds) &&
         put_list(group, "force_seconds", m.force_seconds);
}

bool put_numbers(hid_t group, const RecordedMoment& m) {
  return put(group, "cycle", m.cycle) && put(group, "n_cycles", m.n_cycles) && put(group, "time", m.time) &&
         put(group, "rounds", m.rounds) && put(group, "agreements", m.agreements) &&
         put(group, "n_searches", m.n_searches) && put(group, "n_eroding", m.n_eroding);
}

}  // namespace

void begin_recording(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // messages are our own
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  expect(file.good() && put(file, "kerf_recording", format), path);
  const Handle group(H5Gcreate2(file, "moments", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  expect(group.good(), path);
}

void append_recording(const std::string& path, std::size_t place, const RecordedMoment& moment,
                      const RecordedRun& run) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  expect(file.good(), path);
  const std::string name = "moments/" + std::to_string(place);
  const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  expect(group.good() && put_numbers(group, moment) && put_elements(group, moment) && put_contact(group, moment) &&
             put(file, "node_seconds", run.node_seconds) && put(file, "record_bytes", run.record_bytes) &&
             put(file, "source", run.source) && H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0,
         path);
}

}  // namespace kerf
