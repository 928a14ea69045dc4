// Kerf's own form of a mesh: everything comes back to the bit, and no damaged file is taken for a mesh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "mesh/mesh_digest.hpp"
#include "output/hdf5_memory.hpp"
#include "support/mesh_files.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const char* const samples[] = {"bar_and_plate_v22.msh", "bar_and_plate_v41_binary.msh",
                               "Tensile.inp",           "jc_ti64_abq_builtin.inp",
                               "cubes_contact.g",       "shapes_nc4.exo"};

FileMesh sample(const std::string& name) {
  Diagnostics diagnostics;
  FileMesh mesh = read_mesh_file(sample_path(name), diagnostics);
  EXPECT_THAT(diagnostics.errors(), testing::IsEmpty());
  return mesh;
}

/// With all that a mesh can hold, and numbers that do not survive rounding.
FileMesh full_mesh() {
  FileMesh mesh = sample("bar_and_plate_v22.msh");
  mesh.points[0] = {-0.0, 0.1 + 0.2, std::numeric_limits<double>::denorm_min()};
  mesh.node_labels[1] = std::numeric_limits<std::int64_t>::max() - 1;
  mesh.cell_sets.push_back({"empty set", -3, {}, {7, 2}});
  mesh.cell_sets.push_back({"", 4, {0, 2}, {}});
  mesh.left_out = {{"S4R shells", 12}, {"", 1}};
  mesh.labels_repeat = true;
  return mesh;
}

template <class Blocks>
void expect_same_blocks(const Blocks& a, const Blocks& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].name, b[k].name);
    EXPECT_EQ(a[k].label, b[k].label);
    EXPECT_EQ(a[k].cells, b[k].cells);
    EXPECT_EQ(a[k].place.line, b[k].place.line);
    EXPECT_EQ(a[k].place.column, b[k].place.column);
  }
}

void expect_same(const FileMesh& a, const FileMesh& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_EQ(std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof a.points[0]), 0);
  EXPECT_EQ(a.node_labels, b.node_labels);
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.cell_labels, b.cell_labels);
  ASSERT_EQ(a.cell_places.size(), b.cell_places.size());
  for (std::size_t c = 0; c < a.cell_places.size(); ++c) {
    EXPECT_EQ(a.cell_places[c].line, b.cell_places[c].line);
    EXPECT_EQ(a.cell_places[c].column, b.cell_places[c].column);
  }
  expect_same_blocks(a.blocks, b.blocks);
  expect_same_blocks(a.cell_sets, b.cell_sets);
  ASSERT_EQ(a.node_sets.size(), b.node_sets.size());
  for (std::size_t k = 0; k < a.node_sets.size(); ++k) {
    EXPECT_EQ(a.node_sets[k].name, b.node_sets[k].name);
    EXPECT_EQ(a.node_sets[k].label, b.node_sets[k].label);
    EXPECT_EQ(a.node_sets[k].nodes, b.node_sets[k].nodes);
  }
  ASSERT_EQ(a.face_sets.size(), b.face_sets.size());
  for (std::size_t k = 0; k < a.face_sets.size(); ++k) {
    EXPECT_EQ(a.face_sets[k].name, b.face_sets[k].name);
    EXPECT_EQ(a.face_sets[k].label, b.face_sets[k].label);
    EXPECT_EQ(a.face_sets[k].faces, b.face_sets[k].faces);
  }
  EXPECT_EQ(a.left_out, b.left_out);
  EXPECT_EQ(a.labels_repeat, b.labels_repeat);
  EXPECT_EQ(a.format, b.format);
}

FileMesh read_back(const std::string& bytes) {
  Diagnostics diagnostics;
  FileMesh mesh = read_kerf_mesh({bytes, "mesh.h5"}, diagnostics);
  EXPECT_THAT(diagnostics.errors(), testing::IsEmpty());
  return mesh;
}

std::vector<std::string> complaints_about(const std::string& bytes) {
  Diagnostics diagnostics;
  read_kerf_mesh({bytes, "mesh.h5"}, diagnostics);
  return diagnostics.errors();
}

TEST(KerfMesh, comes_back_to_the_bit) {
  for (const char* name : samples) {
    const FileMesh mesh = sample(name);
    expect_same(read_back(kerf_mesh_bytes(mesh)), mesh);
  }
  expect_same(read_back(kerf_mesh_bytes(full_mesh())), full_mesh());
  expect_same(read_back(kerf_mesh_bytes({})), {});
}

TEST(KerfMesh, is_the_same_file_each_time_and_takes_the_place_of_an_old_one) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "kerf_test_kerf_mesh";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "mesh.h5").string();
  for (const char* name : samples) {
    const FileMesh mesh = sample(name);
    write_mesh(mesh, path);
    EXPECT_EQ(bytes_of(path), kerf_mesh_bytes(mesh));
    Diagnostics diagnostics;
    expect_same(read_mesh_file(path, diagnostics), mesh);
    EXPECT_THAT(diagnostics.errors(), testing::IsEmpty());
  }
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  std::filesystem::remove_all(folder);
  EXPECT_THROW(write_mesh({}, path), std::runtime_error);
}

TEST(KerfMesh, digest_is_that_of_the_mesh_and_not_of_the_form) {
  const std::string text = digest_text(sample("bar_and_plate_v22.msh"));
  EXPECT_EQ(text.size(), 16u);
  EXPECT_EQ(digest_text(read_back(kerf_mesh_bytes(sample("bar_and_plate_v22.msh")))), text);
  FileMesh same = sample("bar_and_plate_v22.msh");
  same.format = "another";
  same.cell_places.clear();
  same.blocks[0].place = {99, 9};
  same.left_out["lines"] = 5;
  EXPECT_EQ(digest_text(same), text);
}

TEST(KerfMesh, digest_knows_every_array) {
  const std::function<void(FileMesh&)> changes[] = {
      [](FileMesh& m) { m.points[3][1] = std::nextafter(m.points[3][1], 1e9); },
      [](FileMesh& m) { ++m.node_labels.back(); },
      [](FileMesh& m) { std::swap(m.cells[0], m.cells[1]); },
      [](FileMesh& m) { ++m.cell_labels.front(); },
      [](FileMesh& m) { m.blocks[1].name += "s"; },
      [](FileMesh& m) { ++m.blocks[1].label; },
      [](FileMesh& m) { m.blocks[1].cells.pop_back(); },
      [](FileMesh& m) {
        m.cell_sets.push_back({"all", 1, {0}, {}});
      },
      [](FileMesh& m) {
        m.node_sets.push_back({"one", 1, {0}});
      },
      [](FileMesh& m) {
        m.node_sets.push_back({"one", 1, {1}});
      },
      [](FileMesh& m) { std::swap(m.face_sets.front().faces.front()[0], m.face_sets.front().faces.front()[1]); },
  };
  std::vector<std::string> digests{digest_text(sample("bar_and_plate_v22.msh"))};
  for (const auto& change : changes) {
    FileMesh mesh = sample("bar_and_plate_v22.msh");
    change(mesh);
    digests.push_back(digest_text(mesh));
  }
  std::sort(digests.begin(), digests.end());
  EXPECT_EQ(std::adjacent_find(digests.begin(), digests.end()), digests.end());
}

TEST(KerfMesh, tells_what_is_wrong_with_the_file) {
  const std::string whole = kerf_mesh_bytes(sample("Tensile.inp"));
  EXPECT_THAT(complaints_about("no mesh"),
              ElementsAre("mesh.h5: error: the file is no file of Kerf's: too short; expected a mesh that Kerf has "
                          "written"));
  EXPECT_THAT(complaints_about(std::string(500, 'x')), ElementsAre(HasSubstr("was not written by this version")));
  EXPECT_THAT(complaints_about(whole.substr(0, whole.size() - 1)),
              ElementsAre(AllOf(HasSubstr("is damaged: it has "), HasSubstr(" bytes and should have "))));
  EXPECT_THAT(complaints_about(whole + "x"), ElementsAre(HasSubstr(" bytes and should have ")));
  std::string changed = whole;
  changed[200] = static_cast<char>(changed[200] ^ 1);
  EXPECT_THAT(complaints_about(changed), ElementsAre(HasSubstr("is damaged: bytes 128 to ")));
  hdf5::BytesWriter other;
  other.root.set("kerf_recording", 2);
  const std::vector<std::byte> bytes = other.finish();
  EXPECT_THAT(complaints_about({reinterpret_cast<const char*>(bytes.data()), bytes.size()}),
              ElementsAre(HasSubstr("the file is a file of Kerf's, but no mesh; expected")));
}

/// A file whose checksums are right and whose contents are not, as of another program.
TEST(KerfMesh, with_right_checksums_still_has_to_make_sense) {
  using hdf5::BytesWriter;
  using Numbers = std::vector<std::int64_t>;
  using Members = std::vector<std::int32_t>;
  const auto build = [](const std::function<void(BytesWriter&)>& change) {
    BytesWriter w;
    w.root.set("kerf_mesh", 1);
    w.root.set("ids_repeat", 0);
    w.root.set("format", std::string("by hand"));
    FileMesh empty;
    w.root.set("digest", digest_text(empty));
    w.put<double>(w.root, "points", {}, 3);
    w.put<std::int64_t>(w.root, "node_id", {});
    w.put<std::int32_t>(w.root, "cells", {}, 8);
    w.put<std::int64_t>(w.root, "element_id", {});
    w.put<std::int32_t>(w.root, "place", {}, 2);
    for (const char* name : {"blocks", "element_sets", "node_sets", "face_sets"}) {
      hdf5::Group& group = w.root.groups[name];
      w.put(group, "name", std::vector<std::string>{});
      w.put<std::int64_t>(group, "label", {});
      w.put<std::int64_t>(group, "first", Numbers{0});
      w.put<std::int32_t>(group, "members", {}, std::string(name) == "face_sets" ? 4 : 0);
      w.put<std::int32_t>(group, "place", {}, 2);
    }
    w.put(w.root, "left_out", std::vector<std::string>{});
    w.put<std::int64_t>(w.root, "n_left_out", {});
    change(w);
    const std::vector<std::byte> bytes = w.finish();
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  expect_same(read_back(build([](BytesWriter&) {})), [] {
    FileMesh mesh;
    mesh.format = "by hand";
    return mesh;
  }());
  const auto in = [](BytesWriter& w, const char* group) -> hdf5::Group& { return w.root.groups.at(group); };
  const std::pair<std::function<void(BytesWriter&)>, const char*> cases[] = {
      {[](BytesWriter& w) { w.root.set("kerf_mesh", 2); }, "has version 2 of the form, and this Kerf reads version 1"},
      {[](BytesWriter& w) { w.root.set("digest", std::string("0123456789abcdef")); }, "does not fit its digest"},
      {[](BytesWriter& w) { w.root.attributes.pop_back(); }, "has no text \"digest\""},
      {[](BytesWriter& w) { w.root.datasets.erase("points"); }, "has no dataset \"points\""},
      {[](BytesWriter& w) { w.put<double>(w.root, "points", {}, 4); }, "has a dataset \"points\" of another kind"},
      {[](BytesWriter& w) { w.put<float>(w.root, "points", {}, 3); }, "has a dataset \"points\" of another kind"},
      {[](BytesWriter& w) { w.put<std::int64_t>(w.root, "node_id", Numbers{5}); }, "its lists differ in length"},
      {[](BytesWriter& w) { w.root.groups.erase("node_sets"); }, "has no group \"node_sets\""},
      {[&](BytesWriter& w) { w.put<std::int64_t>(in(w, "blocks"), "first", Numbers{}); },
       "\"blocks\" differ in length"},
      {[&](BytesWriter& w) { w.put<std::int64_t>(in(w, "blocks"), "label", Numbers{1}); },
       "\"blocks\" differ in length"},
      {[&](BytesWriter& w) {
         w.put(in(w, "node_sets"), "name", std::vector<std::string>{"n"});
         w.put<std::int64_t>(in(w, "node_sets"), "label", Numbers{1});
         w.put<std::int64_t>(in(w, "node_sets"), "first", Numbers{0, 1});
         w.put<std::int32_t>(in(w, "node_sets"), "members", Members{0});
       },
       "\"node_sets\" has a member that does not exist"},
      {[&](BytesWriter& w) {
         w.put<double>(w.root, "points", std::vector<double>(3), 3);
         w.put<std::int64_t>(w.root, "node_id", Numbers{1});
         w.put(in(w, "node_sets"), "name", std::vector<std::string>{"n", "m"});
         w.put<std::int64_t>(in(w, "node_sets"), "label", Numbers{1, 2});
         w.put<std::int64_t>(in(w, "node_sets"), "first", Numbers{0, 2, 1});
         w.put<std::int32_t>(in(w, "node_sets"), "members", Members{0});
       },
       "\"node_sets\" has members out of order"},
  };
  for (const auto& [change, expected] : cases)
    EXPECT_THAT(complaints_about(build(change)), ElementsAre(HasSubstr(expected)));
}

/// No byte of the file may change what is read: either the file is refused, or the byte was padding.
TEST(KerfMesh, with_any_one_byte_changed_is_refused_or_the_same) {
  const FileMesh mesh = sample("Tensile.inp");
  const std::string whole = kerf_mesh_bytes(mesh);
  int same = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
    Diagnostics diagnostics;
    const FileMesh read = read_kerf_mesh({changed, "mesh.h5"}, diagnostics);
    if (diagnostics.has_errors()) continue;
    ++same;
    expect_same(read, mesh);
  }
  EXPECT_LT(same, 200) << "bytes between datasets, which begin at multiples of eight";
}

TEST(KerfMesh, cut_off_mixed_up_or_overwritten_is_refused) {
  std::mt19937 random(20261128);
  for (const char* name : {"bar_and_plate_v22.msh", "jc_ti64_abq_builtin.inp"}) {
    const FileMesh mesh = sample(name);
    const std::string whole = kerf_mesh_bytes(mesh);
    for (int i = 0; i < 1000; ++i) {
      std::string changed = whole;
      const std::size_t at = random() % whole.size(), n = 1 + random() % 2000, from = random() % whole.size();
      switch (random() % 4) {
        case 0:
          changed.resize(at);
          break;
        case 1:
          changed.replace(at, n, whole.substr(from, std::min(n, whole.size() - at)));
          break;
        case 2:
          changed.insert(at, whole.substr(from, n));
          break;
        default:
          for (std::size_t k = 0; k < 1 + n % 8; ++k) changed[random() % whole.size()] = static_cast<char>(random());
      }
      Diagnostics diagnostics;
      const FileMesh read = read_kerf_mesh({changed, "mesh.h5"}, diagnostics);
      if (!diagnostics.has_errors()) expect_same(read, mesh);
    }
  }
}

}  // namespace
